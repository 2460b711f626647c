"""Sample tasks from a space, and keep those that physics finds feasible."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator
from contextlib import closing
from itertools import islice, tee
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from prag_asp.dataset.dataset_spec import budget_of, require_demonstrated
from prag_asp.dataset.episode_files import write_episode
from prag_asp.dataset.jsonl import Record
from prag_asp.dataset.pass_rates import Tally
from prag_asp.dataset.scenes import scene_of
from prag_asp.output import make_folder
from prag_asp.physics import Budget, Staging, Verdict, validate_numbered

if TYPE_CHECKING:
    from prag_asp.domain.load import Domain
    from prag_asp.scene.scene import Scene
    from prag_asp.task import Task


class TaskStream(Protocol):
    """A domain with a stream of its tasks, such as a `TaskSpace`."""

    @property
    def domain(self) -> Domain:
        """The domain of the tasks."""

    @property
    def stream(self) -> Callable[..., Iterator[Task]]:
        """The function that yields tasks, given a seed and sampling options."""


def feasible(
    space: TaskStream,
    scene: Scene | None = None,
    *,
    seed: int = 0,
    workers: int = 1,
    budget: Budget | None = None,
    demonstrate: str | Path | None = None,
    staging: Staging | None = None,
    draws: int | None = None,
    keep: Callable[[Task], bool] | None = None,
    tally: Tally | None = None,
    progress: Callable[[], None] = lambda: None,
    **drawing: Any,
) -> Generator[Record, None, None]:
    """Yield feasible tasks sampled from a space, each with its verdict and its witness, endlessly.

    By default, `scene` is the scene of the domain. `drawing` holds options of `TaskSpace.stream`; with
    ``distinct=True``, no task is sampled twice, and the iterator ends with the last task. It also ends after `draws`
    draws, feasible or not; `tally` counts all draws, and `progress` is called after each draw. Tasks that do not
    satisfy `keep` (see `exclude`) do not count as draws. With `demonstrate`, the robot executes each task, and
    recordings are written into that folder, which is created if it is missing; `staging` holds the cameras that record
    the tasks and the properties that vary. The results depend only on the seed, not on the number of `workers`.

    Raises:
        SceneError: the domain has no scene, or the scene lacks the shape of an entity in a task.
        QueryError: the space is empty, or a sampling option is wrong.
        OutputError: a recording cannot be written.
        WorkerError: workers died repeatedly.
    """
    scene = scene_of(space.domain) if scene is None else scene
    if staging is not None:
        require_demonstrated(staging, demonstrate)
        staging.cameras_of(scene)
    budget, tally = budget_of(budget, demonstrate), Tally() if tally is None else tally
    stream = space.stream(seed=seed, **drawing)
    tasks, again = tee(islice(stream if keep is None else filter(keep, stream), draws))
    verdicts = validate_numbered(enumerate(tasks), scene, seed=seed, workers=workers, budget=budget, staging=staging)
    folder = None if demonstrate is None else make_folder(demonstrate)
    return _records(again, verdicts, folder, tally, progress)


def _records(
    tasks: Iterator[Task],
    verdicts: Generator[Verdict, None, None],
    folder: Path | None,
    tally: Tally,
    progress: Callable[[], None],
) -> Generator[Record, None, None]:
    """Yield the record of each feasible task, save demonstrations, and count all tasks."""
    with closing(verdicts):
        for task, verdict in zip(tasks, verdicts, strict=False):
            tally.add(verdict)
            progress()
            if verdict.feasible:
                values = verdict.to_json()
                witness = values.pop("witness")
                name = write_episode(folder, tally.passed, verdict.demonstration)
                if name is not None:
                    values["demonstration"] = name
                yield Record(task, values, witness)
