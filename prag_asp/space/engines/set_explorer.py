"""The exploration of skeletons by a subset construction (Rabin and Scott 1959) with sets of states as diagrams."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from prag_asp.logic.diagram.diagrams import EMPTY, Node
from prag_asp.logic.step.transition import Transition
from prag_asp.program.entity_names import action_name
from prag_asp.space.automaton.automaton import NOTHING, Automaton, Completions
from prag_asp.space.automaton.layers import Layers
from prag_asp.space.engines.reachability import Allow, Explorer, Halt, Reach
from prag_asp.space.limits import LimitClock
from prag_asp.stop_reason import StopReason


@dataclass
class SetWords:
    """The explored part of the skeleton automaton of a domain, whose states are sets of states.

    A partial automaton may lack words but has no wrong ones, because its sets contain only reachable states.
    """

    edges: list[list[tuple[int, int]]] = field(default_factory=list)
    accepting: list[bool] = field(default_factory=list)
    horizon: int | None = None

    def follow(self, layers: Layers, names: Sequence[int], length: int) -> None:
        """Explore the sets reachable within `length` steps; `names` holds the number of each letter's name."""
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
        """The automaton, in which states that were not expanded have no edges."""
        if not self.accepting:
            return NOTHING
        rows = [*self.edges, *([] for _ in range(len(self.accepting) - len(self.edges)))]
        offsets = np.cumsum([0, *map(len, rows)]).astype(np.int64)
        edges = np.array([edge for row in rows for edge in row], dtype=np.int64).reshape(-1, 2)
        return Automaton(offsets, edges[:, 0], edges[:, 1], np.array(self.accepting, dtype=np.bool_),
                         horizon=self.horizon)  # fmt: skip


@dataclass(frozen=True)
class SetExplorer(Explorer):
    """The explorer of a domain's skeletons, which works on sets of states."""

    def reach(
        self,
        transition: Transition,
        length: int,
        clock: LimitClock,
        halt: Halt | None = None,
        allow: Allow | None = None,
    ) -> Reach:
        """Return the skeletons of up to `length` steps, as far as the limits permit."""
        actions = list(map(action_name, transition.actions))
        letters = tuple(sorted(set(actions)))
        names = [letters.index(name) for name in actions]
        watch = _Watch(clock)
        skeletons = SetWords()
        try:
            layers = Layers(transition, watch.look, self.tell or (lambda words: None))
            if layers.inhabited:
                try:
                    layers.extend(length)
                except _Spent:
                    watch.close()
                skeletons.follow(layers, names, length)
        except _Spent:
            watch.close()
        return Reach(letters, letters, Completions(skeletons.automaton), None, watch.stop, sets=True)


class _Spent(Exception):
    """A limit was reached."""


@dataclass
class _Watch:
    """A check of the limits; `stop` is the first limit that was reached."""

    clock: LimitClock
    stop: StopReason | None = None

    def look(self) -> None:
        """Raise an error if a limit is reached."""
        reason = self.clock.reached_limit()
        if reason:
            self.stop = self.stop or reason
            raise _Spent

    def close(self) -> None:
        """Extend the time limit a little, to leave time for partial results."""
        self.clock = self.clock.to_report()
