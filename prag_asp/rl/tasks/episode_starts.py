"""What episodes begin with: a task with its witness, and one of its subgoals, named in the options or drawn."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, Literal, TypeVar

import numpy as np

from prag_asp.domain.load import Domain
from prag_asp.errors import QueryError
from prag_asp.physics import Witness
from prag_asp.rl.curriculum.course import Attempt, Episode
from prag_asp.rl.environment_options import is_whole
from prag_asp.rl.goals import Subgoal, subgoals_of
from prag_asp.rl.observations import Layout, skill
from prag_asp.rl.tasks.source_options import Origin
from prag_asp.rl.tasks.task_sources import Assignment, Finder, OneTask, Source, fitting
from prag_asp.task import Task

KEPT = 512
"""How many tasks that were begun with, and subgoals of tasks, are kept, so that to begin with them again is quick."""

Made = TypeVar("Made")


@dataclass(frozen=True)
class Beginning:
    """What an episode begins with: the subgoals of the task that is given, and the stage, which is one's number.

    `chance` is the probability of the stage where it was drawn; `named` is whether the options have said it.
    """

    given: Assignment
    subgoals: tuple[Subgoal, ...]
    stage: int
    chance: Fraction | None
    named: bool

    def told(self) -> dict[str, Any]:
        """Return what is told of it beside the first observation."""
        given = self.given
        return {
            "task": str(given.task),
            "rank": given.rank,
            "log_probability": given.task.log_probability,
            "probability": given.probability,
            "stage_probability": self.chance,
            "rejected": given.rejected,
        }


class Draws:
    """Draws tasks and their stages by the curricula, and lets these hear how the episodes end that they began.

    Raises:
        QueryError: one task alone is asked for, and has no witness, or that of another one.
    """

    def __init__(
        self,
        origin: Origin,
        witness: Witness | None,
        stage: int | Literal["any"],
        finder: Finder,
        *,
        domain: Domain,
        layout: Layout,
    ):
        self.finder, self.seeded = finder, False
        self._stage, self._domain, self._scene, self._layout = stage, domain, finder.scene, layout
        self._kept: OrderedDict[tuple[int, ...], tuple[tuple[object, ...], Any]] = OrderedDict()
        alone = origin.task is not None or witness is not None
        self._source: Source = OneTask(self._named(origin.task, witness)) if alone else origin.source(finder)
        self._walk = origin.stages.walk() if origin.stages else None

    def seed(self, rng: np.random.Generator) -> None:
        """Begin all draws anew, by seeds that are drawn."""
        self._source.seed(int(rng.integers(2**31)))
        if self._walk is not None:
            self._walk.seed(int(rng.integers(2**31)))
        self.seeded = True

    def begin(self, options: Mapping[str, Any], rng: np.random.Generator) -> Beginning:
        """Return what an episode begins with; what the options leave out is drawn.

        Raises:
            QueryError: the options name something that there is not, or the task has no witness.
            NotFound: no feasible task is drawn in `PATIENCE` draws.
        """
        task, witness, rank, stage = (options.get(name) for name in ("task", "witness", "rank", "stage"))
        if task is not None or witness is not None:
            given = self._named(task, witness)
        else:
            given = self._source.draw() if rank is None else self._source.ranked(rank)
        subgoals = self._once(lambda: subgoals_of(given.task, self._scene), given.task)
        return Beginning(given, subgoals, *self._first(stage, len(subgoals), rng), stage is not None)

    def report(self, begun: Beginning, stage: int, *, success: bool) -> None:
        """Let the curricula that had a say in an episode hear at which stage it has ended."""
        actions = begun.given.task.actions
        attempts = [
            Attempt(actions[i], actions[i - 1] if i else None, i < stage or success)
            for i in range(begun.stage, stage + 1)
        ]
        episode = Episode(len(actions), begun.stage, attempts, success)
        if begun.given.probability is not None:
            self._source.report(episode)
        if self._walk is not None and not begun.named:
            self._walk.report(episode)

    def told(self) -> dict[str, Any]:
        """Return in few words what the curricula have come to."""
        return {**self._source.told(), **(self._walk.told() if self._walk is not None else {})}

    def state_dict(self) -> dict[str, Any]:
        """Return what the draws have come to, of what JSON can write."""
        return {
            "source": self._source.state_dict(),
            "walk": None if self._walk is None else self._walk.state_dict(),
        }

    def load_state_dict(self, state: Mapping[str, Any]) -> None:
        """Go on from what `state_dict` returned; what is loaded amiss raises what Python does."""
        self._source.load_state_dict(state["source"])
        if self._walk is not None:
            self._walk.load_state_dict(state["walk"])

    def _named(self, task: object, witness: object) -> Assignment:
        """Return a task that somebody names, with a witness: that given for it, or one that is found.

        Raises:
            QueryError: it is none, or has none.
        """
        if not isinstance(task, Task) or not isinstance(witness, Witness | None):
            raise QueryError(f"a task is a Task, a witness that of a task; got {task!r:.80} and {witness!r:.80}")
        for action in task.actions:
            if skill(action, self._scene) not in self._layout.skills:
                raise QueryError(f"{action} is no action of the domain {self._domain.name}; give a task of that domain")
        if witness is None:
            return Assignment(task, self.finder.required(task))
        return self._once(lambda: fitting(task, witness, self._scene), task, witness)

    def _once(self, make: Callable[[], Made], *whose: object) -> Made:
        """Return what is made of some values, and was made of the very same ones not long ago; both are kept."""
        key = tuple(map(id, whose))
        if key not in self._kept:
            self._kept[key] = whose, make()
        self._kept.move_to_end(key)
        if len(self._kept) > KEPT:
            self._kept.popitem(last=False)
        found: Made = self._kept[key][1]
        return found

    def _first(self, asked: int | str | None, count: int, rng: np.random.Generator) -> tuple[int, Fraction | None]:
        """Return the number of the subgoal of so many to begin with, and its probability where it was drawn."""
        if count == 0:
            raise QueryError("a task of no action has no subgoal; give another one")
        if asked is None and self._walk is not None:
            return self._walk.stage(count)
        stage = self._stage if asked is None else asked
        if stage == "any":
            return int(rng.integers(count)), Fraction(1, count)
        if not is_whole(stage) or not -count <= int(stage) < count:
            raise QueryError(f"stage {stage!r}: the task has the stages 0 to {count - 1}; any draws one")
        return int(stage) % count, None
