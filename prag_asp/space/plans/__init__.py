"""Tasks from plans: states, subgoals, canonical names and readings."""
