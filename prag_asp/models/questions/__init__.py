"""Queries about all answer sets: the optimal ones, facets, and explanations of inconsistency."""
