"""Data sets in the forms of other programs: one file a form, behind one protocol."""
