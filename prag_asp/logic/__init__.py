"""Ground the rules of a domain, and turn them into a function from state to state."""
