"""Conditions on tasks: their syntax, and the logic that tests them."""
