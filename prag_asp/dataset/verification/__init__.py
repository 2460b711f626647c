"""Verify a dataset: that all it says is so, by other means than those that made it where there are some."""
