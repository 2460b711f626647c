"""The tasks and initial subgoals of episodes: given in the reset options, or sampled."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from prag_asp.dataset.scenario import Scenario
from prag_asp.dataset.scenarios import Scenarios, searched
from prag_asp.dataset.store.instructions import LEVELS, PLAIN, TaskTexts, captioner_like, captioner_of
from prag_asp.domain.load import Domain
from prag_asp.errors import QueryError
from prag_asp.physics import Witness
from prag_asp.rl.curriculum.task_sampler import Attempt, EpisodeResult
from prag_asp.rl.environment_options import ANY, is_whole
from prag_asp.rl.goals import Subgoal, subgoals_of
from prag_asp.rl.observations import Layout, skill
from prag_asp.rl.tasks.task_origin import TaskOrigin
from prag_asp.rl.tasks.task_sources import Assignment, SingleTask, TaskSource, WitnessFinder, assign_witness
from prag_asp.task import Task

CACHED = 512
"""The number of cached tasks with checked witnesses and subgoals, so that their episodes begin quickly."""

Made = TypeVar("Made")


class Probability(Fraction):
    """An exact probability that becomes a float in arrays, because episode recorders store `info` in arrays."""

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[np.float64]:
        return np.array(float(self), dtype=dtype)


@dataclass(frozen=True)
class EpisodeStart:
    """The task of an episode with its subgoals and texts, and the `stage`, the index of the initial subgoal.

    `chance` is the probability of the stage, or None if it was not sampled; `named` is true if the options give the
    stage.
    """

    assignment: Assignment
    subgoals: tuple[Subgoal, ...]
    texts: TaskTexts
    stage: int
    chance: Fraction | None
    named: bool

    def info(self) -> dict[str, Any]:
        """Return the info for each observation of the episode."""
        assignment, written = self.assignment, dict(self.texts.whole)
        levels = {level: written.get(level, written.get(PLAIN, "")) for level in LEVELS}
        return {
            "task": str(assignment.task),
            "scenario": "" if assignment.scenario is None else str(assignment.scenario),
            "instruction": levels["default"],
            "instruction_vague": levels["vague"],
            "instruction_exact": levels["exact"],
            "subgoals": len(self.subgoals),
            "rank": assignment.rank,
            "log_probability": assignment.task.log_probability,
            "probability": None if assignment.probability is None else Probability(assignment.probability),
            "stage_probability": None if self.chance is None else Probability(self.chance),
            "rejected": assignment.rejected,
        }


class EpisodeSampler:
    """A sampler of tasks and initial subgoals, with curricula that it updates with the results of episodes.

    Raises:
        QueryError: a single task has no witness, or has the witness of another task.
    """

    def __init__(
        self,
        origin: TaskOrigin,
        witness: Witness | None,
        stage: int | str,
        finder: WitnessFinder,
        *,
        domain: Domain,
        layout: Layout,
        language: str,
    ):
        self.finder, self.seeded = finder, False
        self._stage, self._domain, self._scene, self._layout = stage, domain, finder.scene, layout
        self._scenarios = Scenarios(domain)
        self._captioner = (
            captioner_of(domain, language, seed=0)
            if origin.dataset is None
            else captioner_like(domain, origin.dataset.manifest.spec)
        )
        self._cached: OrderedDict[tuple[int, ...], tuple[tuple[object, ...], Any]] = OrderedDict()
        alone = origin.task is not None or witness is not None
        self._source: TaskSource = SingleTask(self._assign(origin.task, witness)) if alone else origin.source(finder)
        self._subgoals = origin.stages.subgoal_sampler() if origin.stages else None

    def seed(self, rng: np.random.Generator) -> None:
        """Reset all samplers with seeds from a generator."""
        self._source.seed(int(rng.integers(2**31)))
        if self._subgoals is not None:
            self._subgoals.seed(int(rng.integers(2**31)))
        self.seeded = True

    def begin(self, options: Mapping[str, Any], rng: np.random.Generator) -> EpisodeStart:
        """Return the start of an episode; values that the options lack are sampled.

        Raises:
            QueryError: the options name something that does not exist, or the task has no witness.
            NotFound: `PATIENCE` samples in a row are not feasible.
        """
        task, witness, rank, stage, texts = (
            options.get(name) for name in ("task", "witness", "rank", "stage", "texts")
        )
        if options.get("scenario") is not None:
            assignment = self._of_scenario(options["scenario"])
        elif task is not None or witness is not None:
            assignment = self._assign(task, witness)
        else:
            assignment = self._source.draw() if rank is None else self._source.ranked(rank)
        subgoals = self._once(lambda: subgoals_of(assignment.task, self._scene), assignment.task)
        texts = (
            texts
            or assignment.texts
            or self._once(lambda: self._captioner(assignment.task, {}), "texts", assignment.task)
        )
        initial = self._initial_stage(stage, assignment.task, rng)
        return EpisodeStart(assignment, subgoals, texts, *initial, stage is not None)

    def update(self, start: EpisodeStart, stage: int, *, success: bool) -> None:
        """Pass the result of an episode, which ended at the subgoal `stage`, to the curricula that chose its start."""
        actions = start.assignment.task.actions
        attempts = [
            Attempt(actions[i], actions[i - 1] if i else None, i < stage or success)
            for i in range(start.stage, stage + 1)
        ]
        result = EpisodeResult(len(actions), start.stage, attempts, success)
        if start.assignment.probability is not None:
            self._source.update(result)
        if self._subgoals is not None and not start.named:
            self._subgoals.update(result)

    def summary(self) -> dict[str, Any]:
        """Return the progress of the curricula."""
        return {**self._source.summary(), **(self._subgoals.summary() if self._subgoals is not None else {})}

    def state_dict(self) -> dict[str, Any]:
        """Return the state of the samplers as JSON values."""
        return {
            "source": self._source.state_dict(),
            "subgoals": None if self._subgoals is None else self._subgoals.state_dict(),
        }

    def load_state_dict(self, state: Mapping[str, Any]) -> None:
        """Continue from a state returned by `state_dict`; a malformed state raises a Python error."""
        self._source.load_state_dict(state["source"])
        if self._subgoals is not None:
            self._subgoals.load_state_dict(state["subgoals"])

    def _assign(self, task: object, witness: object) -> Assignment:
        """Return a given task with its witness; if no witness is given, search for one.

        Raises:
            QueryError: the task does not belong to the domain, or has no witness.
        """
        if not isinstance(task, Task) or not isinstance(witness, Witness | None):
            raise QueryError(f"a task is a Task, a witness that of a task; got {task!r:.80} and {witness!r:.80}")
        for action in task.actions:
            if skill(action, self._scene) not in self._layout.skills:
                raise QueryError(
                    f"{action} is not an action of the domain {self._domain.name}; give a task of that domain"
                )
        if witness is None:
            return Assignment(task, self.finder.required(task))
        return self._once(lambda: assign_witness(task, witness, self._scene), task, witness)

    def _of_scenario(self, scenario: object) -> Assignment:
        """Return the task of a scenario, given as a value or as its id, with its witness.

        Raises:
            QueryError: the value is not a scenario of the domain, or has no initial state.
        """
        parsed = scenario if isinstance(scenario, Scenario) else Scenario.parse(str(scenario))
        if parsed.start is None:
            raise QueryError(f"scenario {parsed}: has no initial state; give one that physics found feasible")
        record = searched(self._scenarios.task(parsed), parsed.start, self.finder.validator)
        witness = Witness.from_json(record.witness or {})
        return Assignment(record.task, witness, parsed.rank, scenario=parsed)

    def _once(self, make: Callable[[], Made], *whose: object) -> Made:
        """Return the result of `make`, cached by the identity of the values that it depends on."""
        key = tuple(map(id, whose))
        if key not in self._cached:
            self._cached[key] = whose, make()
        self._cached.move_to_end(key)
        if len(self._cached) > CACHED:
            self._cached.popitem(last=False)
        cached: Made = self._cached[key][1]
        return cached

    def _initial_stage(
        self, requested: int | str | None, task: Task, rng: np.random.Generator
    ) -> tuple[int, Fraction | None]:
        """Return the initial subgoal of a task, and its probability if it is sampled."""
        count = len(task.actions)
        if count == 0:
            raise QueryError("a task without actions has no subgoal; give another one")
        if requested is None and self._subgoals is not None:
            return self._subgoals.stage(count)
        stage = self._stage if requested is None else requested
        if isinstance(stage, str):
            stages = [i for i, action in enumerate(task.actions) if stage in (ANY, action.name)]
            if stages:
                return stages[int(rng.integers(len(stages)))], Fraction(1, len(stages))
        if not is_whole(stage) or not -count <= int(stage) < count:
            told = f"stage {stage!r}: the task has the stages 0 to {count - 1}"
            raise QueryError(f"{told}; {ANY} samples one, the name of an action one with that action")
        return int(stage) % count, None
