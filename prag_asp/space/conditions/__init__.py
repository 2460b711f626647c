"""Conditions on tasks: their words, and the logic that tests them."""
