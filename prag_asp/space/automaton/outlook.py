"""Forecasts of the size of an exploration, and a note if it will take long."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from prag_asp.processes.progress_events import Note
from prag_asp.space.automaton.exploration import Extent

FAR = 1e18
"""Number of states at which a forecast stops."""

WORK, TIMES = 50_000_000, 5
"""After this amount of work, measured in 64-bit words of the states that edges reach, an exploration that will take
`TIMES` times as much gets a note; this work takes a few seconds."""


def forecast_states(sizes: Sequence[int], further: int) -> float:
    """Forecast the number of states after some further steps, from the numbers of states within one, two, ... steps.

    The forecast assumes that the ratio of new states in successive steps keeps falling at the same rate, because growth
    slows down as a space fills up.
    """
    layers = [later - sooner for sooner, later in zip([0, *sizes], sizes, strict=False)]
    ratios = [later / sooner for sooner, later in zip([1, *layers], layers, strict=False) if sooner]
    states, layer = float(sizes[-1]), float(layers[-1])
    ratio = ratios[-1] if ratios else 0.0
    falling = min(ratio / ratios[-2], 1.0) if len(ratios) > 2 and ratios[-2] else 1.0
    for _ in range(further):
        ratio *= falling
        layer *= ratio
        states += layer
        if layer < 1 or states > FAR:
            break
    return states


@dataclass
class Outlook:
    """The forecast for an exploration, which sends one note if the exploration will take long.

    `names` holds the action name of each letter; `width` is the number of 64-bit words in a state.
    """

    tell: Callable[[str], None]
    names: Sequence[str]
    length: int
    width: int
    sizes: dict[int, int] = field(default_factory=dict)
    noted: bool = False

    def watch(self, extent: Extent) -> None:
        """Record the extent of the exploration, and send the note if it is due."""
        self.sizes[extent.depth] = extent.states
        if self.noted or extent.edges * self.width < WORK:
            return
        complete = [states for depth, states in self.sizes.items() if depth < extent.depth]
        states = forecast_states(complete or [1], self.length - extent.depth)
        edges = extent.edges / extent.expanded * states
        if edges < TIMES * extent.edges:
            return
        self.noted = True
        shares: Counter[str] = Counter()
        for name, number in zip(self.names, extent.by_letter, strict=True):
            shares[name] += int(number)
        name, most = shares.most_common(1)[0]
        times, within = f"{edges / extent.edges:,.0f} times", f"{self.length - 1:,} steps"
        each, share = f"{extent.edges // extent.expanded:,} actions each", f"{most / extent.edges:.0%}"
        self.tell(
            Note(
                f"note: exploring {self.length:,} steps may take {times} as long as so far: within {within} there "
                f"may be {states:,.0f} states with {each}, {share} of them {name}; ask for fewer steps or entities, "
                "or set --time"
            )
        )
