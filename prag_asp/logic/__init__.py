"""The ground rules of a domain, and one step as a function from state to state."""
