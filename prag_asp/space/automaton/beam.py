"""How many words diagrams know of when a limit ends them: a lower bound, by following some states and no others."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from heapq import nlargest

from prag_asp.logic.diagram.diagrams import Word as State
from prag_asp.space.automaton.layers import Layers
from prag_asp.stop_reason import LimitCheck

WIDER = 4
"""Times as many states are followed in the next round, as long as there is time."""


def count_along(layers: Layers, length: int, prefix: Sequence[Collection[int]], check: LimitCheck) -> int:
    """Return a number of words of a length that there are at least, found until `check` says that a limit is reached.

    From step to step, those states go on that most ways lead to: first one, then four, and so on (beam search). Where
    it is known what completes them, that is taken. What diagrams have found is true, if not all, and each way that is
    counted is a word.
    """
    rows = layers.rows_so_far(length)
    left = min(len(rows) - 1, length - len(prefix))
    best, width, dropped = 0, 1, True
    while left >= 0 and dropped:
        ways: dict[State, int] = {layers.start: 1}
        dropped = False
        for step in range(length - left):
            following: dict[State, int] = {}
            for state, number in ways.items():
                if check():
                    return best
                for edge in layers.onward(state):
                    if step >= len(prefix) or edge.letter in prefix[step]:
                        following[edge.state] = following.get(edge.state, 0) + number * edge.weight
            dropped = dropped or len(following) > width
            ways = dict(nlargest(width, following.items(), key=lambda each: each[1]))
        best = max(best, sum(number * layers.diagrams.value(rows[left], state) for state, number in ways.items()))
        width *= WIDER
    return best
