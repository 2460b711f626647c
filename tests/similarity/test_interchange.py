"""The renamings that matter are one of each class of renamings that give the same distance."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Mapping

import pytest

from prag_asp.similarity import Interchange
from tests.chance import Chance

NESTED = Interchange((("p", "q"), ("r", "s"), tuple("defg")), ((("A", "p", "q"), ("B", "r", "s")),))
"""Two trays with two interchangeable cups each, and four interchangeable things."""

CASES = {
    "one group": Interchange((tuple("abcde"),)),
    "two groups": Interchange((tuple("abc"), tuple("xyz"))),
    "units": Interchange((), ((("a", "x"), ("b", "y"), ("c", "z")),)),
    "groups in units": NESTED,
    "nothing": Interchange(),
}


def whole_group(given: Interchange[str]) -> list[dict[str, str]]:
    """Return all renamings: what the swaps generate."""
    names = sorted(given.entities)
    swaps = [
        dict(zip(pair, reversed(pair), strict=True)) for g in given.groups for pair in itertools.combinations(g, 2)
    ]
    for units in given.joint:
        for one, other in itertools.combinations(units, 2):
            swaps.append({**dict(zip(one, other, strict=True)), **dict(zip(other, one, strict=True))})
    found = {tuple(names)}
    for element in (queue := [tuple(names)]):
        for swap in swaps:
            after = tuple(swap.get(name, name) for name in element)
            if after not in found:
                found.add(after)
                queue.append(after)
    return [dict(zip(names, element, strict=True)) for element in found]


def images_up_to(
    group: Iterable[Mapping[str, str]], mentioned: tuple[str, ...], fixed: set[str]
) -> set[frozenset[tuple[str, ...]]]:
    """Return the classes of images of `mentioned` by renamings that leave `fixed` in place, each as a set."""
    group = list(group)
    still = [g for g in group if all(g.get(each, each) == each for each in fixed)]
    images = {tuple(g.get(each, each) for each in mentioned) for g in group}
    return {frozenset(tuple(h.get(each, each) for each in image) for h in still) for image in images}


@pytest.mark.parametrize("case", CASES)
def test_each_class_of_renamings_is_met_once_and_the_first_changes_nothing(case: str, chance: Chance) -> None:
    given, generator = CASES[case], chance.generator(1)
    group = whole_group(given)
    for _ in range(chance.examples(12)):
        pool = [*sorted(given.entities), "other"]
        mentioned = tuple(generator.sample(pool, generator.randint(0, min(len(pool), 5))))
        fixed = set(generator.sample(pool, generator.randint(0, min(len(pool), 4))))
        expected = images_up_to(group, mentioned, fixed)
        found = [tuple(names.get(each, each) for each in mentioned) for names in given.renamings(mentioned, fixed)]
        assert found[0] == mentioned and len(found) == len(expected)
        assert {next(each for each in expected if image in each) for image in found} == expected


def test_a_few_of_many_entities_are_matched_without_a_list_of_all_renamings() -> None:
    many = Interchange((tuple(map(str, range(1000))),))
    found = list(many.renamings(("1", "2", "3"), ("500", "501")))
    assert len(found) == 1 + 3 * 2 + 3 * 2  # none, one or two of the three are matched with the two


def test_the_stabilizer_fixes_units_as_a_whole() -> None:
    assert NESTED.fixing("p") == Interchange((("r", "s"), tuple("defg")))
    assert set(NESTED.orbit("p")) == set("pqrs") and set(NESTED.orbit("A")) == set("AB")
