"""Checks of a witness by fresh eyes: its states, its furniture, and whether it settles."""
