"""Check a witness independently of the search: its states, its motions, and whether it settles."""
