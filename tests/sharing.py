"""What tests of commands, physics, data sets and learning need of logic, computed once in a process; small pictures.

What it says of a domain is tested elsewhere. Here spaces of equal domains share it, as those that `TaskSpace.at` makes.
"""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from prag_asp.dataset.pages import dataset_card
from prag_asp.domain import load
from prag_asp.logic.domain_logic import DomainLogic
from prag_asp.program.paths import data_folder
from prag_asp.space import domain_engines, task_space
from prag_asp.space.domain_engines import DomainEngines
from prag_asp.space.engines.engine import Progress
from prag_asp.space.limits import UNLIMITED, Limits
from tests.checks import checks_shared

KEPT = 16
"""How many domains and conditions are kept: a data set has one of each split, a file of tests few."""

_shared: deque[DomainEngines] = deque(maxlen=KEPT)


@contextmanager
def logic_shared() -> Iterator[None]:
    """Let all task spaces that are made share the logic of equal domains, and check shipped domains once.

    Those that tell of progress or have limits have engines of their own, on the same logic; domains that count with
    fewer entities are as ever.
    """
    with checks_shared(), pytest.MonkeyPatch.context() as patch:
        patch.setattr(task_space, "DomainEngines", _known)
        patch.setattr(domain_engines, "DomainEngines", _known)  # those under conditions are made there
        yield


@contextmanager
def small_pictures() -> Iterator[None]:
    """Draw few pictures of data sets, and small ones: a large one takes as long as a dozen verdicts."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(dataset_card, "STRIP_SIZE", (60, 52))
        patch.setattr(dataset_card, "STRIPS", 1)
        patch.setattr(dataset_card, "STATES", 2)
        yield


@pytest.fixture(scope="package", autouse=True)
def shared_logic() -> Iterator[None]:
    """Share logic in all tests of a folder whose conftest imports this."""
    with logic_shared():
        yield


@pytest.fixture(scope="package", autouse=True)
def pictures_are_small() -> Iterator[None]:
    """Draw small pictures in all tests of a folder whose conftest imports this."""
    with small_pictures():
        yield


@pytest.fixture(scope="package", autouse=True)
def automata_are_cached(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Cache automata, as commands do for users, in one folder for all tests and processes of a run."""
    folder = tmp_path_factory.getbasetemp()
    with pytest.MonkeyPatch.context() as patch:
        cache = (folder.parent if "PYTEST_XDIST_WORKER" in os.environ else folder) / "cache"
        patch.setenv("PRAG_ASP_CACHE", str(cache))
        yield


def _known(
    model: DomainLogic,
    engine: str,
    progress: Progress | None,
    limits: Limits,
    fewest_actions: int = 0,
    shortest: bool = False,
) -> DomainEngines:
    """Return what a space shares with others: all that there is, or the logic alone."""
    if model.domain.reduction is not None or model.domain.irreducible:
        return DomainEngines(model, engine, progress, limits, fewest_actions, shortest)
    like = [each for each in _shared if _alike(each.model, model)]
    model = like[0].model if like else model
    options = fewest_actions, shortest
    shared = next(
        (each for each in like if (each.name, each.fewest_actions, each.shortest) == (engine, *options)), None
    )
    if shared is None:
        shared = DomainEngines(model, engine, None, UNLIMITED, *options)
        _shared.append(shared)
    alone = progress is not None or limits is not UNLIMITED
    return DomainEngines(model, engine, progress, limits, *options) if alone else shared


def _alike(one: DomainLogic, other: DomainLogic) -> bool:
    """Tell whether models say the same: what tells entities apart in others, without conditions or whole, they have."""
    others = (one.bare, other.bare), (one.part_of, other.part_of)
    return _equal(one.domain, other.domain) and all(
        mine is yours or (mine is not None and yours is not None and _alike(mine, yours)) for mine, yours in others
    )


def _equal(one: load.Domain, other: load.Domain) -> bool:
    """Tell whether domains say the same, wherever they lie: a data set has a copy of its own, also of the encodings."""
    if one is other:
        return True
    ours, theirs = ((each.name, each.constants, each.learned, each.program.text) for each in (one, other))
    return ours == theirs and one.encodings in (other.encodings, data_folder("encodings")) and one.facts == other.facts
