"""Tasks from plans: states, subgoals, canonical names, readings."""
