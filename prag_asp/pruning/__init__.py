"""Find the actions and composites that can never occur. Counts omit them, and the linter reports them.

    rejected actions -> rejected composites -> (relaxed rules) -> relaxed reachability, static fluents

An action is *pruned* if every state rejects it: its preconditions and effects are dropped. It is *unreachable* if its
preconditions are relaxed-unreachable: no step tries it.
"""

from prag_asp.pruning.pruning import Pruning, find_pruning

__all__ = ["Pruning", "find_pruning"]
