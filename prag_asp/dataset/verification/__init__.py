"""Verify a dataset: check all of its contents, where possible by means other than those that generated it."""
