"""Distances of tasks of random domains are the least over all renamings that their interchangeable entities have."""

from __future__ import annotations

import itertools
from collections.abc import Mapping

from hypothesis import given, settings
from hypothesis import strategies as st

from prag_asp import Task, TaskSpace
from prag_asp.logic.symmetry.symmetries import Symmetries
from prag_asp.similarity import Interchange, compare
from prag_asp.similarity.background import Background
from tests.chance import examples
from tests.domains import domain_of
from tests.similarity.random_tasks import renamed
from tests.strategies import symmetric_texts

METRICS = ("levenshtein", "levenshtein-classes", "hamming-effects", "goal", "states", "links", "combined")


def all_renamings(symmetries: Symmetries) -> list[Mapping[str, str]]:
    """Return all renamings that the swaps of a domain generate."""
    swaps = [
        dict(zip(map(str, (*one, *other)), map(str, (*other, *one)), strict=True))
        for alike in (*([(each,) for each in group] for group in symmetries.groups), *symmetries.joint)
        for one, other in itertools.combinations(alike, 2)
    ]
    names = sorted(map(str, symmetries.entities))
    found = {tuple(names)}
    for image in (queue := [tuple(names)]):
        for swap in swaps:
            after = tuple(swap.get(name, name) for name in image)
            if after not in found:
                found.add(after)
                queue.append(after)
    return [dict(zip(names, image, strict=True)) for image in found]


def some_tasks(space: TaskSpace) -> list[Task]:
    """Return up to four tasks, spread over the space."""
    count = space.count()
    return [space[rank] for rank in sorted({0, count // 3, count // 2, count - 1})] if count else []


@settings(max_examples=examples(5))
@given(text=symmetric_texts(), metric=st.sampled_from(METRICS))
def test_distances_are_the_least_over_all_renamings_and_keep_the_axioms(text: str, metric: str) -> None:
    space = TaskSpace(domain_of(text), 2)
    tasks, known = some_tasks(space), space.background
    assert len(known.interchange.entities) == len(space.symmetries.entities)
    still = Background(known.classes, known.parents, Interchange(), known.preconditions)
    renamings = all_renamings(space.symmetries)
    between = {}
    for one, other in itertools.product(tasks, repeat=2):
        least = min(compare(one, renamed(other, names), metric, still).distance for names in renamings)
        between[one, other] = one.distance(other, metric, within=space)
        assert between[one, other] == least
    for one, middle, other in itertools.product(tasks, repeat=3):
        assert between[one, other] == between[other, one] <= between[one, middle] + between[middle, other]
        assert (between[one, other] == 0) == (one == other) or metric in ("goal", "links", "states", "hamming-effects")
