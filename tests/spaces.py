"""Task spaces that share what is the same for all of them."""

from __future__ import annotations

from copy import copy

from prag_asp import Domain, TaskSpace
from prag_asp.space.domain_engines import DomainEngines
from prag_asp.space.limits import UNLIMITED


def with_engine(space: TaskSpace, engine: str) -> TaskSpace:
    """Return a space with a new engine, which shares nothing with that of the other but the logic of the domain."""
    other = copy(space)
    other.engines = DomainEngines(space.engines.model, engine, None, UNLIMITED)
    return other


def with_engines(domain: Domain, *engines: str) -> list[TaskSpace]:
    """Return the space of a domain with each engine, of length 0: `at` another length, it uses what it has found."""
    space = TaskSpace(domain, 0)
    return [with_engine(space, engine) for engine in engines]
