"""Plans told as tasks: states, subgoals, names, readings."""
