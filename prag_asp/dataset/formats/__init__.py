"""Export datasets to the formats of other programs: one module per format, behind one protocol."""
