"""The logic program of a domain: its files, their syntax, and the facts that they state."""
