"""Where draws are looked at: in this process, in others of this machine, or on the nodes of a Ray cluster."""

from __future__ import annotations

from collections.abc import Generator, Iterator
from contextlib import closing
from dataclasses import dataclass
from functools import partial
from typing import Protocol

from prag_asp.dataset.validation_jobs import Draw, Found, Look, looker
from prag_asp.errors import QueryError
from prag_asp.missing import require_ray

CHUNK = 4
"""Searches that a process of this machine is handed together."""

RAY = "ray"
"""The name of the places that are not on this machine."""


class Place(Protocol):
    """Looks at draws, and tells what it finds in their order; that does not depend on the place."""

    @property
    def tells(self) -> bool:
        """Whether draws come without their tasks, which are told there, and found with their rows."""
        ...

    def look(self, draws: Iterator[Draw], look: Look) -> Generator[Found, None, None]:
        """Yield what is known of draws, in their order; closing the iterator ends the work at once.

        Raises:
            SceneError: a task speaks of something for which the scene has no shape.
            WorkerError: workers died again and again, or there are none.
        """
        ...


@dataclass(frozen=True)
class Processes:
    """Processes of this machine: so many, or this one alone, as where physics is not asked."""

    workers: int
    tells: bool = False

    def look(self, draws: Iterator[Draw], look: Look) -> Generator[Found, None, None]:
        """Yield what is known of draws, in their order."""
        if self.workers == 1 or look.scene is None:
            with looker(look) as looked_at:
                for draw in draws:
                    yield looked_at(draw.search, draw)
            return
        from prag_asp.physics.validator import ACTIVITY
        from prag_asp.processes.worker_pool import map_ordered

        numbered = ((draw.search, draw) for draw in draws)
        chunk = max(CHUNK // look.starts, 1)
        mapped = map_ordered(numbered, partial(looker, look), self.workers, activity=ACTIVITY, chunk=chunk)
        with closing(mapped) as found:
            yield from found


def place_of(workers: int, on: str | None) -> Place:
    """Return the place that is asked for.

    Raises:
        QueryError: there is none of that name, no worker, or workers are asked for of Ray, which has its own.
        RayMissingError: Ray is not installed.
    """
    if workers < 1:
        raise QueryError(f"validation needs at least 1 worker; got {workers}")
    if on is None:
        return Processes(workers)
    if on != RAY:
        raise QueryError(f"no place {on!r} to look at tasks; there is {RAY}")
    if workers > 1:
        raise QueryError("a Ray cluster has as many workers as it has processors; leave the number of workers out")
    require_ray()
    from prag_asp.dataset.making.on_ray import Cluster

    return Cluster()
