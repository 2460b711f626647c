"""Generate a dataset: sample without replacement, validate each task with physics, and write the result."""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any

from prag_asp.dataset.dataset_spec import DatasetSpec
from prag_asp.dataset.making.executors import executor_of
from prag_asp.dataset.making.run import DatasetRun, Progress
from prag_asp.dataset.scenarios import excluded_ranks
from prag_asp.dataset.store.domain_snapshot import snapshot_of
from prag_asp.dataset.strata.stratified_sampling import allocated
from prag_asp.errors import QueryError
from prag_asp.missing import require_pyarrow
from prag_asp.processes.progress_events import report_progress

if TYPE_CHECKING:
    from prag_asp.dataset.scenario import Scenario
    from prag_asp.dataset.store.dataset import Dataset
    from prag_asp.space.strata.allocation import Stratification
    from prag_asp.space.task_space import TaskSpace


def generate(
    space: TaskSpace,
    folder: str | Path,
    spec: DatasetSpec | None = None,
    *,
    workers: int = 1,
    on: str | None = None,
    max_draws: int | None = None,
    excluded: Iterable[Scenario] = (),
    stratification: Stratification | None = None,
    progress: Progress = report_progress,
    **request: Any,
) -> Dataset:
    """Write a dataset of distinct feasible tasks from a space into a folder, and open it.

    The request is a `spec`, or keywords such as ``tasks=100, seed=7, split={"train": 0.8, "test": 0.2}``, which
    `DatasetSpec.of` documents. Sampling for a part of the split stops after `max_draws` draws, by default 1000 per
    task. The tasks of `excluded` scenarios of the same domain and conditions are left out, so the dataset is disjoint
    from earlier ones.

    With ``cover=2`` instead of a number of tasks, the tasks cover all combinations of 2 factors of an action; if
    physics rejects a task, others with its combinations replace it. With ``diverse=50``, there are 50 tasks that are
    far apart, chosen from sampled ones. dataset.json states the coverage or the distances.

    With a `stratification`, the parts are the strata of a sample, and dataset.json has the exact weight of the tasks in
    each part.

    The same call resumes an interrupted run; a larger number of tasks extends the dataset. The bytes of the dataset
    depend only on the request, not on the number of `workers` or on the machines that run them; with ``on="ray"``,
    these are the nodes of a Ray cluster. With ``part="3/64"``, the folder is one of 64 machine parts, which `merge`
    combines into one dataset.

    Raises:
        QueryError: the space is empty, or the request is wrong.
        SceneError: the domain has no scene, or the scene lacks the shape of an entity in a task.
        OutputError: the folder contains something else, or a file cannot be written.
        NotFound: `max_draws` draws per part, or the whole space, contain too few feasible tasks; those found are
            written.
        WorkerError: workers died repeatedly.
        DatasetsMissingError: pyarrow is not installed.
        RayMissingError: Ray is requested, but not installed.
        TypeError: both a `spec` and keywords are given, or neither.
    """
    require_pyarrow()
    executor = executor_of(workers, on)
    if stratification is not None:
        if spec is not None or request.get("split") is not None:
            raise QueryError("the parts of a stratified sample are its strata; leave the split out")
        if request.get("tasks") is None:
            raise QueryError("a stratified sample needs a number of tasks; give tasks")
        request |= {
            "split": stratified_shares(space, stratification, request["tasks"], request.get("seed", 0)),
            "strata": stratification.by,
        }
    if spec is None:
        spec = DatasetSpec.of(space.domain, excluded=excluded_ranks(space, excluded), **request)
    elif request:
        raise TypeError(f"a spec is given with {', '.join(request)}; change the spec instead")
    return DatasetRun(space, Path(folder), spec, snapshot_of(space.domain), executor, progress, max_draws).done()


def stratified_shares(space: TaskSpace, stratification: Stratification, tasks: int, seed: int = 0) -> dict[str, str]:
    """Return the share of each stratum in a sample of a given number of tasks, as exact fractions.

    Raises:
        QueryError: the space is empty, or too small or too finely divided for that many tasks.
    """
    quotas = allocated(space, tasks, stratification, seed)
    return {stratum.name: str(Fraction(quota, tasks)) for stratum, quota in quotas}
