"""The distribution of distances equals what all pairs give, and known figures."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from fractions import Fraction
from itertools import product

import pytest

from prag_asp import LimitReached, Limits, QueryError, TaskSpace, load_domain
from prag_asp.analysis import hamming_distribution, mean_hamming
from prag_asp.analysis.hamming import primes_below
from prag_asp.space.engines import Level
from tests.analysis.orbit_spaces import orbit_spaces
from tests.chance import Chance
from tests.domains import domain_of

LENGTH = 3


def differing(one: tuple[str, ...], other: tuple[str, ...]) -> int:
    return sum(a != b for a, b in zip(one, other, strict=True))


def at_each_distance(sets: Iterable[Iterable[tuple[str, ...]]], length: int = LENGTH) -> tuple[int, ...]:
    """Return the numbers of pairs of sets by the least distance of a plan of one and a plan of the other."""
    found = list(map(list, sets))
    least = Counter(min(differing(p, q) for p, q in product(one, other)) for one, other in product(found, repeat=2))
    return tuple(least[distance] for distance in range(length + 1))


@pytest.mark.parametrize("constant", ["FEW_COMPARED", "SAFE", "TOGETHER", "MOST_AGREEMENTS"])
def test_the_distribution_is_that_of_all_pairs(constant: str, chance: Chance, monkeypatch: pytest.MonkeyPatch) -> None:
    """Compare with pairs of states, 64 bits or primes, in pieces or at once, or with a list of the words."""
    monkeypatch.setattr("prag_asp.analysis.hamming.FEW_COMPARED", 0)
    monkeypatch.setattr(f"prag_asp.analysis.hamming.{constant}", 0)
    orders = set()
    for case, space, orbits in orbit_spaces(chance, 6, LENGTH):
        plans = {plan for orbit in orbits for plan in orbit}
        names = {tuple(action.partition("(")[0] for action in plan) for plan in plans}
        words = {"plan": [{plan} for plan in plans], "task": orbits, "skeleton": [{name} for name in names]}
        orders.add(space.symmetries.order)
        level: Level
        for level in ("plan", "task", "skeleton"):
            found = hamming_distribution(space, level)
            assert found.pairs == at_each_distance(words[level]), (level, case.text())
            assert found.words == len(words[level]) and found.share(LENGTH) == 1
            if level != "task":
                assert mean_hamming(space, level) == found.mean
    assert max(orders) > 1


def test_the_mean_of_different_tasks_leaves_out_pairs_of_the_same() -> None:
    two = TaskSpace(domain_of("fluent(f). action(a). action(b). postcondition(a,f,true). postcondition(b,f,false)."), 1)
    found = hamming_distribution(two)
    assert (found.pairs, found.mean, found.mean_of_different) == ((2, 2), Fraction(1, 2), 1)
    one = hamming_distribution(two.at(0))
    assert (one.pairs, one.mean, one.mean_of_different) == ((1,), 0, 0)


def test_distances_of_the_paper_are_exact() -> None:
    space = TaskSpace(load_domain("prag"), 15)
    found = hamming_distribution(space)
    assert sum(found.pairs) == space.count() ** 2 and found.pairs[0] == space.count()
    assert float(found.mean) == pytest.approx(14.425103881761759, abs=1e-12)
    assert float(mean_hamming(space.at(1000), "skeleton")) == pytest.approx(798.8839, abs=1e-4)


def test_engines_that_list_no_states_give_the_same_pairs() -> None:
    domain = load_domain("blocks")
    expected = hamming_distribution(TaskSpace(domain, 3)).pairs
    for engine in ("symbolic", "clingo", "sat"):
        assert hamming_distribution(TaskSpace(domain, 3, engine=engine)).pairs == expected


def test_what_cannot_be_compared_is_refused_in_one_line() -> None:
    space = TaskSpace(load_domain("blocks"), 3)
    with pytest.raises(QueryError, match=r"there is no task of blocks of length 3, where .* to compare"):
        hamming_distribution(space.where("has at least 4 stack"))
    with pytest.raises(QueryError, match="needs their distribution"):
        mean_hamming(space, "task")
    small = TaskSpace(load_domain("tabletop"), 5, limits=Limits(memory_bytes=10**6))
    small.engines._engines |= TaskSpace(load_domain("tabletop"), 5).engines._engines
    with pytest.raises(LimitReached):
        hamming_distribution(small)


def test_the_moduli_are_the_largest_primes() -> None:
    primes = primes_below(100)
    assert [next(primes) for _ in range(5)] == [97, 89, 83, 79, 73]
