"""Task spaces that share what is the same for all of them."""

from __future__ import annotations

from copy import copy
from itertools import chain, islice

from prag_asp import Domain, TaskSpace
from prag_asp.space.domain_engines import DomainEngines
from prag_asp.space.engines import Draw
from prag_asp.space.engines.automaton_engine import AutomatonEngine
from prag_asp.space.limits import UNLIMITED
from prag_asp.space.sampling.streams import make_sampler, sample_batches
from prag_asp.space.weights.weights import Weights


def with_engine(space: TaskSpace, engine: str) -> TaskSpace:
    """Return a space with a new engine, which shares nothing with that of the other but the logic of the domain."""
    other = copy(space)
    other.engines = DomainEngines(space.engines.model, engine, None, UNLIMITED)
    return other


def with_engines(domain: Domain, *engines: str) -> list[TaskSpace]:
    """Return the space of a domain with each engine, of length 0: `at` another length, it uses what it has found."""
    space = TaskSpace(domain, 0)
    return [with_engine(space, engine) for engine in engines]


def draws_of(engine: AutomatonEngine, length: int, weights: Weights, seed: int) -> list[Draw]:
    """Return the first draws of an engine, each with its probability."""
    sampler = make_sampler(engine, engine._model.domain.facts, engine._level, length, weights)
    return list(islice(chain.from_iterable(sample_batches(sampler, engine.letters, seed)), 20))
