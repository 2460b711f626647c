"""The feasible ones of the tasks that are drawn from a space."""

from __future__ import annotations

from collections.abc import Generator, Iterator
from contextlib import closing
from itertools import islice, tee
from pathlib import Path
from typing import TYPE_CHECKING, Any

from prag_asp.dataset.episode_files import Recordings
from prag_asp.dataset.jsonl import Record
from prag_asp.dataset.pass_rates import Tally
from prag_asp.dataset.scenes import scene_of
from prag_asp.errors import QueryError
from prag_asp.physics import Budget, Staging, Tier, Verdict, validate_numbered

if TYPE_CHECKING:
    from prag_asp.scene.scene import Scene
    from prag_asp.space.task_space import TaskSpace
    from prag_asp.task import Task


def feasible(
    space: TaskSpace,
    scene: Scene | None = None,
    *,
    seed: int = 0,
    workers: int = 1,
    budget: Budget | None = None,
    demonstrate: str | Path | None = None,
    staging: Staging | None = None,
    draws: int | None = None,
    tally: Tally | None = None,
    **drawing: Any,
) -> Generator[Record, None, None]:
    """Yield the feasible tasks among those drawn from a space, each with its verdict and its witness, without end.

    `scene` is that of the space's domain unless another is given, `drawing` what `TaskSpace.stream` takes beside the
    seed; with ``distinct=True`` (and weights alone), no task is drawn twice, and it ends with the last one. It ends
    after so many `draws`, feasible or not; `tally` counts all of them. With `demonstrate`, the robot performs each
    task, and recordings are written into that folder, which is made where it is missing, with what `staging` asks for:
    cameras that film, and what varies. What is yielded depends on the seed alone, not on the number of `workers`. A
    `tally` that has counted draws before goes on after those.

    Raises:
        SceneError: the domain has no scene, or a task speaks of something for which the scene has no shape.
        QueryError: the space is empty, or the draw is asked for in a wrong way.
        OutputError: a recording cannot be written.
        WorkerError: workers died again and again.
    """
    looked_at = draws_looked_at(
        space, scene, seed=seed, workers=workers, budget=budget, demonstrate=demonstrate, staging=staging, draws=draws,
        tally=tally, **drawing,
    )  # fmt: skip
    return _feasible(looked_at)


def draws_looked_at(
    space: TaskSpace,
    scene: Scene | None = None,
    *,
    seed: int = 0,
    workers: int = 1,
    budget: Budget | None = None,
    demonstrate: str | Path | None = None,
    staging: Staging | None = None,
    draws: int | None = None,
    tally: Tally | None = None,
    **drawing: Any,
) -> Generator[Record | None, None, None]:
    """Yield the record of each draw as `feasible` does, and None for each that is not feasible.

    Raises:
        PragError: as `feasible` does.
    """
    scene = scene_of(space.domain) if scene is None else scene
    if staging is not None:
        require_demonstrated(staging, demonstrate)
        staging.cameras_of(scene)
    budget, tally = budget_of(budget, demonstrate), Tally() if tally is None else tally
    asked, kept = tee(islice(space.stream(seed=seed, **drawing), tally.seen, draws))
    numbered = enumerate(asked, tally.seen)
    verdicts = validate_numbered(numbered, scene, seed=seed, workers=workers, budget=budget, staging=staging)
    return _recorded(kept, verdicts, Recordings(demonstrate), tally)


def _feasible(looked_at: Generator[Record | None, None, None]) -> Generator[Record, None, None]:
    """Yield the records alone."""
    with closing(looked_at):
        for record in looked_at:
            if record is not None:
                yield record


def _recorded(
    tasks: Iterator[Task], verdicts: Generator[Verdict, None, None], recordings: Recordings, tally: Tally
) -> Generator[Record | None, None, None]:
    """Yield the records of the feasible ones of some tasks, record their demonstrations, and count all."""
    with closing(verdicts):
        for task, verdict in zip(tasks, verdicts, strict=False):
            tally.add(verdict)
            if not verdict.feasible:
                yield None
                continue
            told = verdict.to_json()
            witness = told.pop("witness")
            name = recordings.write(tally.passed, verdict.demonstration)
            if name is not None:
                told["demonstration"] = name
            yield Record(task, told, witness)


def budget_of(budget: Budget | None, demonstrate: str | Path | None) -> Budget:
    """Return a budget with the tier of demonstrations where these are to be recorded."""
    budget = budget or Budget()
    return budget if demonstrate is None else Budget(budget.restarts, budget.samples, Tier.DEMONSTRATION)


def require_demonstrated(staging: Staging, demonstrate: str | Path | None) -> None:
    """Check that tasks are demonstrated where that is staged.

    Raises:
        QueryError: they are not.
    """
    if demonstrate is None and (staging.cameras or staging.vary):
        what = "cameras film" if staging.cameras else f"{staging.vary[0]} varies in"
        raise QueryError(f"{what} demonstrations; ask for them by `demonstrate`, the folder of the recordings")
