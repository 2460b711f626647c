"""Make a dataset: sample without replacement, validate each task by physics, write it down."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from prag_asp.dataset.dataset_spec import DatasetSpec
from prag_asp.dataset.making.executors import executor_of
from prag_asp.dataset.making.run import DatasetRun, Progress
from prag_asp.dataset.store.domain_snapshot import snapshot_of
from prag_asp.missing import require_pyarrow

if TYPE_CHECKING:
    from prag_asp.dataset.store.dataset import Dataset
    from prag_asp.space.task_space import TaskSpace
    from prag_asp.space.task_spaces import TaskSpaces


def generate(
    space: TaskSpace | TaskSpaces,
    folder: str | Path,
    spec: DatasetSpec | None = None,
    *,
    workers: int = 1,
    on: str | None = None,
    max_draws: int | None = None,
    progress: Progress = lambda words, done, total: None,
    **request: Any,
) -> Dataset:
    """Write a dataset of different feasible tasks of a space into a folder, and open it.

    The request is a `spec`, or keywords such as ``tasks=100, seed=7, split={"train": 0.8, "test": 0.2}``, which
    `DatasetSpec.of` takes and documents. A part of the split is given up after `max_draws` draws, by default 1000 for
    each task.

    An interrupted run is resumed by the same call; a larger number of tasks extends the dataset. Its bytes depend on
    the request alone, not on the number of `workers`, nor on where these run: with ``on="ray"``, on the nodes of a Ray
    cluster. With ``part="3/64"``, the folder holds one of 64 machine parts, of which `merge` makes the dataset.

    Raises:
        QueryError: there is nothing to sample, or the request is wrong.
        SceneError: the domain has no scene, or a task names something for which the scene has no shape.
        OutputError: the folder holds something else, or a file cannot be written.
        NotFound: fewer tasks are found in `max_draws` draws a part, or there are no more; those found are written.
        WorkerError: workers died again and again.
        DatasetsMissingError: pyarrow is not installed.
        RayMissingError: Ray is requested, but not installed.
        TypeError: there is neither a `spec` nor a request, or both.
    """
    require_pyarrow()
    executor = executor_of(workers, on)
    if spec is None:
        spec = DatasetSpec.of(space.domain, **request)
    elif request:
        raise TypeError(f"a spec is given, so {', '.join(request)} cannot be; change the spec")
    return DatasetRun(space, Path(folder), spec, snapshot_of(space.domain), executor, progress, max_draws).done()
