"""Conditions on tasks: their words, and the logic that tests them."""

from prag_asp.space.conditions.clauses import Part
from prag_asp.space.conditions.condition import Condition, conditioned

__all__ = ["Condition", "Part", "conditioned"]
