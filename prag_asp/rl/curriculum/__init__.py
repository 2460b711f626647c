"""Curricula choose the next task and its subgoal: values that describe them, and courses that record the results."""
