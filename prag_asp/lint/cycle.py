"""Cycles among declarations that may have none."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import clingo


def find_cycle(successors: Mapping[clingo.Symbol, Sequence[clingo.Symbol]]) -> list[clingo.Symbol]:
    """Return a term, the successor of each, and the term again; nothing where no term comes after itself."""
    finished: set[clingo.Symbol] = set()
    for start in successors:
        path: list[clingo.Symbol] = []
        branches = [iter([start])]
        while branches:
            name = next(branches[-1], None)
            if name is None:
                branches.pop()
                finished |= {path.pop()} if path else set()
            elif name in path:
                return [*path[path.index(name) :], name]
            elif name not in finished:
                path.append(name)
                branches.append(iter(successors.get(name, ())))
    return []
