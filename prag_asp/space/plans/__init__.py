"""Turn plans into tasks: states, subgoals, canonical names and readings."""
