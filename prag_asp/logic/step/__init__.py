"""One step as a function of a state and an action, evaluated on many states at once."""
