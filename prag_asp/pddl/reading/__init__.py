"""Readers of PDDL files, which return plain values and rewrite numbers and time, which the translation lacks."""
