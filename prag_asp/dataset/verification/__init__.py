"""Verify a dataset: check all of its contents, where possible by other means than those that generated it."""
