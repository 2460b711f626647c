"""From plans to tasks: states, subgoals, canonical names and readings."""
