"""Data sets in the forms of other programs, read back by these, or by readers of what they publish."""
