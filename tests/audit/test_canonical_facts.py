"""Forms of facts are equal just where some renaming of interchangeable objects maps one set on the other."""

from __future__ import annotations

import random
from collections.abc import Iterator
from itertools import permutations, product

from hypothesis import given, settings
from hypothesis.strategies import integers

from prag_asp.audit import canonical_form
from prag_asp.audit.goal_distance import goal_distance
from tests.chance import examples

Facts = frozenset[tuple[str, tuple[str, ...]]]


def random_facts(chance: random.Random, colours: dict[str, str]) -> Facts:
    names = list(colours)
    return frozenset(
        (chance.choice("pq"), tuple(chance.choice(names) for _ in range(chance.choice([1, 2, 2]))))
        for _ in range(chance.randrange(6))
    )


def renamings(ours: dict[str, str], theirs: dict[str, str]) -> Iterator[dict[str, str]]:
    """Yield all bijections between objects that keep colours."""
    for order in permutations(theirs):
        if all(ours[one] == theirs[other] for one, other in zip(ours, order, strict=True)):
            yield dict(zip(ours, order, strict=True))


def renamed(facts: Facts, names: dict[str, str]) -> Facts:
    return frozenset((label, tuple(names.get(each, each) for each in objects)) for label, objects in facts)


@settings(max_examples=examples(150))
@given(seed=integers(0, 10**6))
def test_forms_are_equal_just_where_a_renaming_exists(seed: int) -> None:
    chance = random.Random(seed)
    colours = {f"o{number}": chance.choice("ab") for number in range(chance.randrange(1, 6))}
    first = random_facts(chance, colours)
    names = chance.choice([*renamings(colours, colours)])
    assert canonical_form(colours, renamed(first, names)) == canonical_form(colours, first)
    second = (
        random_facts(chance, colours) if chance.random() < 0.5 else first ^ frozenset([("p", (next(iter(colours)),))])
    )
    exists = any(renamed(first, each) == second for each in renamings(colours, colours))
    assert (canonical_form(colours, first) == canonical_form(colours, second)) == exists


def test_regular_facts_that_refinement_does_not_distinguish_have_different_forms() -> None:
    def cycles(*lengths: int) -> list[tuple[str, tuple[str, str]]]:
        return [
            ("next", (f"{ring}.{place}", f"{ring}.{(place + 1) % length}"))
            for ring, length in enumerate(lengths)
            for place in range(length)
        ]

    def form(*lengths: int) -> object:
        rows = cycles(*lengths)
        return canonical_form({each: "ring" for _, objects in rows for each in objects}, rows)

    assert form(3, 3) != form(6)
    assert form(4, 5, 3) == form(3, 4, 5) != form(4, 4, 4)


def test_the_form_of_many_alike_objects_takes_no_time() -> None:
    size = range(6)
    grid = [("at", (f"n{row}{column}", f"r{row}", f"c{column}")) for row, column in product(size, size)]
    colours = {name: name[0] for _, objects in grid for name in objects}
    other = {name: colours[name] for name in reversed(colours)}
    assert canonical_form(colours, grid) == canonical_form(other, reversed(grid))
    row = {f"cup_{number}": "cup" for number in range(60)}
    assert canonical_form(row, [("on", (cup,)) for cup in row]) == canonical_form(row, [("on", (cup,)) for cup in row])


@settings(max_examples=examples(100))
@given(seed=integers(0, 10**6))
def test_the_distance_of_goals_is_the_smallest_over_all_renamings(seed: int) -> None:
    chance = random.Random(seed)
    colours = {f"o{number}": chance.choice("ab") for number in range(chance.randrange(1, 5))}
    first, second = (random_facts(chance, colours) for _ in range(2))
    smallest = min(len(renamed(first, each) ^ second) for each in renamings(colours, colours))
    assert goal_distance([*first], [*second], (colours, colours)) == smallest
    assert goal_distance([*second], [*first], (colours, colours)) == smallest
