"""The automaton of skeletons by sets of states, each a diagram (Rabin and Scott 1959): as far as it is known."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from prag_asp.logic.diagram.diagrams import EMPTY, Node
from prag_asp.space.automaton.automaton import NOTHING, Automaton
from prag_asp.space.automaton.layers import Layers


@dataclass
class SetWords:
    """The automaton of the skeletons of a domain, as far as it is known: its states are sets of the domain's.

    What is missing makes words fewer, never wrong: each state that follows others in part is a set of states that are
    reached.
    """

    edges: list[list[tuple[int, int]]] = field(default_factory=list)
    accepting: list[bool] = field(default_factory=list)
    horizon: int | None = None

    def follow(self, layers: Layers, names: Sequence[int], length: int) -> None:
        """Find what is reached within `length` steps; `names` has the number of each letter's name."""
        start = layers.only_start()
        numbers: dict[Node, int] = {}
        frontier = [start]
        self.accepting.append(layers.accepts(start))
        numbers[start] = 0
        for _ in range(length):
            following: list[Node] = []
            for states in frontier:
                by_name: dict[int, Node] = {}
                for letter, image in layers.images(states):
                    name = names[letter]
                    by_name[name] = layers.diagrams.join(by_name.get(name, EMPTY), image)
                row = []
                for name, image in sorted(by_name.items()):
                    if image not in numbers:
                        self.accepting.append(layers.accepts(image))
                        numbers[image] = len(numbers)
                        following.append(image)
                    row.append((name, numbers[image]))
                self.edges.append(row)
            frontier = following
        self.horizon = length if frontier else None

    @property
    def automaton(self) -> Automaton:
        """The automaton; a state that was not followed has no edges."""
        if not self.accepting:
            return NOTHING
        rows = [*self.edges, *([] for _ in range(len(self.accepting) - len(self.edges)))]
        offsets = np.cumsum([0, *map(len, rows)]).astype(np.int64)
        edges = np.array([edge for row in rows for edge in row], dtype=np.int64).reshape(-1, 2)
        return Automaton(offsets, edges[:, 0], edges[:, 1], np.array(self.accepting, dtype=np.bool_),
                         horizon=self.horizon)  # fmt: skip
