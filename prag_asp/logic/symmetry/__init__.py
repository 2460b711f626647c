"""Interchangeable entities, found on the ground program."""
