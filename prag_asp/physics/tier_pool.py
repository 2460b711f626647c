"""Check many witnesses, in order, in one process or in several: the outcomes are the same."""

from __future__ import annotations

from collections.abc import Generator, Iterable, Mapping
from typing import Any

from prag_asp.errors import QueryError
from prag_asp.physics.filming.episode_options import Staging
from prag_asp.physics.pool import pooled
from prag_asp.physics.tier_cascade import Passage, open_cascade
from prag_asp.physics.verdict import Budget
from prag_asp.physics.witness import Witness
from prag_asp.scene.scene import Scene
from prag_asp.task import Task

Shown = tuple[int, tuple[Task, Witness]]
"""The index of a task, the task, and its witness."""


def pass_numbered(
    witnesses: Iterable[Shown],
    scene: Scene,
    *,
    budget: Budget,
    seed: int = 0,
    workers: int = 1,
    staging: Staging | None = None,
) -> Generator[Passage, None, None]:
    """Yield how far each witness comes through the tiers of a budget; closing the iterator ends the workers at once.

    Raises:
        QueryError: the number of workers is not positive.
        SceneError: the scene cannot be built.
        WorkerError: workers died again and again, or cannot be started.
    """
    if workers < 1:
        raise QueryError(f"checking needs at least 1 worker; got {workers}")
    settings = {"budget": budget, "staging": staging, "seed": seed}
    if workers == 1:
        return _in_process(witnesses, scene, settings)
    return pooled(witnesses, "prag_asp.physics.checker", (scene, settings), workers)


def _in_process(
    witnesses: Iterable[Shown], scene: Scene, settings: Mapping[str, Any]
) -> Generator[Passage, None, None]:
    """Yield how far witnesses come, in this process."""
    with open_cascade(scene, **settings) as passage:
        for index, (task, witness) in witnesses:
            yield passage(task, witness, index)
