"""Counts for programs whose difficulty lies in sums over many atoms."""
