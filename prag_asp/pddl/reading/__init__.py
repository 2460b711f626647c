"""Read the files of PDDL into plain values, and rewrite what the translation does not know: numbers and time."""
