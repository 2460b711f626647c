"""Counts of a domain that is simulated in plain Python: no logic program, and no code of the library."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Hashable, Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property

Act = tuple[str, ...]
"""An action: its name, then what it refers to."""

Word = tuple[Act, ...]
Configuration = tuple[Hashable, frozenset[Word]]
"""A state, and the actions that each way to read the plan so far still has to end with."""


@dataclass(frozen=True)
class Simulation:
    """A start, what an action makes of a state (None where it is invalid), and the units that plans are made of.

    What was found of a configuration is kept for all questions.
    """

    start: Hashable
    actions: tuple[Act, ...]
    step: Callable[[Hashable, Act], Hashable | None]
    units: tuple[Word, ...]

    @cached_property
    def flat(self) -> Simulation:
        return Simulation(self.start, self.actions, self.step, tuple((action,) for action in self.actions))

    def without(self, things: Iterable[str]) -> Simulation:
        """Return the simulation in which no action refers to any of `things`."""
        kept = tuple(action for action in self.actions if not set(things) & set(action))
        units = tuple(unit for unit in self.units if set(unit) <= set(kept))
        return Simulation(self.start, kept, self.step, units)

    @cached_property
    def _known(self) -> dict[Configuration, list[tuple[str, Configuration]]]:
        return {}

    def following(self, configuration: Configuration) -> list[tuple[str, Configuration]]:
        """Return what each action that is possible makes of a configuration, with its name."""
        if configuration not in self._known:
            found = ((action[0], self.after(configuration, action)) for action in self.actions)
            self._known[configuration] = [(name, reached) for name, reached in found if reached is not None]
        return self._known[configuration]

    def after(self, configuration: Configuration, action: Act) -> Configuration | None:
        state, left = configuration
        following = set()
        for word in left:
            following |= {unit[1:] for unit in ([word] if word else self.units) if unit[0] == action}
        reached = self.step(state, action) if following else None
        return None if reached is None else (reached, frozenset(following))

    def plans(self, length: int) -> list[int]:
        """Return the number of plans of each length up to `length`."""
        layer: dict[Configuration, int] = {(self.start, frozenset({()})): 1}
        counts = []
        for steps_left in reversed(range(length + 1)):
            counts.append(sum(number for (_, left), number in layer.items() if () in left))
            following: dict[Configuration, int] = {}
            for configuration, number in layer.items() if steps_left else ():
                for _, reached in self.following(configuration):
                    following[reached] = following.get(reached, 0) + number
            layer = following
        return counts

    def tasks(self, length: int, swaps: Sequence[Sequence[str]]) -> list[int]:
        """Return the number of plans up to swaps, each of which moves some things of its own (Burnside's lemma)."""
        parts = itertools.product(*(((), swap) for swap in swaps))
        unchanged = [self.without({*itertools.chain(*moved)}).plans(length) for moved in parts]
        return [sum(numbers) // len(unchanged) for numbers in zip(*unchanged, strict=True)]

    def skeletons(self, length: int) -> list[int]:
        """Return the number of sequences of names of each length up to `length`."""
        layer: dict[frozenset[Configuration], int] = {frozenset({(self.start, frozenset({()}))}): 1}
        counts = []
        for steps_left in reversed(range(length + 1)):
            counts.append(sum(n for group, n in layer.items() if any(() in left for _, left in group)))
            following: dict[frozenset[Configuration], int] = {}
            for group, number in layer.items() if steps_left else ():
                by_name: dict[str, set[Configuration]] = {}
                for configuration in group:
                    for name, reached in self.following(configuration):
                        by_name.setdefault(name, set()).add(reached)
                for found in map(frozenset, by_name.values()):
                    following[found] = following.get(found, 0) + number
            layer = following
        return counts
