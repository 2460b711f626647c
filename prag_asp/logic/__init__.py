"""A Domain made into ground rules, and these into a function from state to state."""
