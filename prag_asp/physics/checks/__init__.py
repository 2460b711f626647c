"""Checks of a witness that are independent of the search: its states, its motions, and settling."""
