"""Curricula, which choose the next task and its initial subgoal: parameters, and samplers that record results."""
