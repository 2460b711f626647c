"""Curricula, which choose the next task and its initial subgoal: their parameters, and samplers that record results."""
