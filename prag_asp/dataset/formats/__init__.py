"""Datasets in the formats of other programs: one file a form, behind one protocol."""
