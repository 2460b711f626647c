"""What can never occur: counts prune it, and the linter reports it.

    rejected actions -> rejected composites -> (relaxed rules) -> relaxed reachability, static fluents

An action is *pruned* where every state rejects it: nothing that it states is kept. It is *unreachable* where nothing
ever makes what it needs: no step tries it.
"""

from prag_asp.pruning.pruning import Pruning, find_pruning

__all__ = ["Pruning", "find_pruning"]
