"""Verify a dataset: check all contents, if possible by other means than those that generated them."""
