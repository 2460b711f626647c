"""Read PDDL files into plain values, and rewrite numbers and time, which the translation does not support."""
