"""The tasks of each part of a requested dataset, in the order of sampling without replacement."""

from __future__ import annotations

from typing import TYPE_CHECKING

from prag_asp.space.task_space import TaskSpace
from prag_asp.space.without_replacement import ordered_parts

if TYPE_CHECKING:
    from prag_asp.dataset.dataset_spec import DatasetSpec
    from prag_asp.space.distinct_sampling import TaskOrder


def requested_parts(space: TaskSpace, spec: DatasetSpec) -> dict[str, TaskOrder]:
    """Return the tasks of each part of a request, in the order of sampling.

    Raises:
        QueryError: a part is empty, there is nothing to sample, or the request is wrong.
        LimitReached: a limit was reached.
    """
    among = None
    if spec.apart:
        from prag_asp.analysis.distant_tasks import tasks_apart_from_all

        others = [(each.space(space), each.distance) for each in spec.apart]
        among = [tasks_apart_from_all(space.at(length), others) for length in space.lengths]
    return ordered_parts(
        space, spec.division, seed=spec.seed, weights=space.weights(spec.weights, spec.temperature),
        over=spec.over or None, evenly=spec.evenly, deal=spec.deal, excluded=spec.excluded_ranks, among=among,
    )  # fmt: skip
