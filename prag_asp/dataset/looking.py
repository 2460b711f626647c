"""What physics says of some draws, and of further first states of those that pass, in the order of the draws."""

from __future__ import annotations

from collections import deque
from collections.abc import Generator, Iterator
from contextlib import closing
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from prag_asp.physics import Budget, Verdict, validate_numbered

if TYPE_CHECKING:
    from prag_asp.physics import Staging
    from prag_asp.scene.model import Scene
    from prag_asp.space.ordered import Placed
    from prag_asp.task import Task

START = 1 << 32
"""How far the index of a search is from that of the same task's search for the next first state."""

Drawn = tuple[int, "Placed", "Task"]
"""The number of a draw, and what was drawn."""


@dataclass(frozen=True)
class Look:
    """How physics looks at tasks: the scene, the seed, the budget, first states a task, the workers, and cameras."""

    scene: Scene
    seed: int
    budget: Budget
    starts: int
    workers: int
    staging: Staging | None = None


@dataclass
class _Pending:
    """A draw with the verdicts that are there, by first states, and how many there are to be."""

    drawn: Drawn
    wanted: int = 1
    verdicts: dict[int, Verdict] = field(default_factory=dict)

    @property
    def whole(self) -> bool:
        return len(self.verdicts) == self.wanted


def looked_at(drawn: Iterator[Drawn], look: Look) -> Generator[tuple[Drawn, list[Verdict]], None, None]:
    """Yield each draw with the verdict on it, and where it passes with those on its other first states.

    The search for first state s of draw d has the index ``d + s * START``, so it depends on the seed and these two
    alone. Closing the iterator ends the workers at once.

    Raises:
        SceneError: a task speaks of something for which the scene has no shape.
        WorkerError: workers died again and again.
    """
    waiting: deque[_Pending] = deque()
    further: deque[tuple[_Pending, int]] = deque()
    handed: deque[tuple[_Pending, int]] = deque()

    def feed() -> Iterator[tuple[int, Task]]:
        while True:
            if further:
                pending, start = further.popleft()
            elif (new := next(drawn, None)) is not None:
                pending, start = _Pending(new), 0
                waiting.append(pending)
            else:
                return
            handed.append((pending, start))
            number, _, task = pending.drawn
            yield number + start * START, task

    while True:
        found = validate_numbered(
            feed(), look.scene, seed=look.seed, workers=look.workers, budget=look.budget, staging=look.staging
        )
        with closing(found) as verdicts:
            for verdict in verdicts:
                pending, start = handed.popleft()
                pending.verdicts[start] = verdict
                if start == 0 and verdict.feasible:
                    pending.wanted = look.starts
                    further.extend((pending, other) for other in range(1, look.starts))
                while waiting and waiting[0].whole:
                    first = waiting.popleft()
                    yield first.drawn, [first.verdicts[start] for start in range(first.wanted)]
        if not further:  # the last draws may have passed when nothing more was handed out
            return
