"""Very long words are counted as step by step, to the last digit."""

from __future__ import annotations

import sys
from itertools import islice

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from prag_asp import TaskSpace, load_domain
from prag_asp.integers import digits_of
from prag_asp.space.automaton import recurrence
from prag_asp.space.automaton.automaton import Automaton, Completions
from prag_asp.space.automaton.recurrence import count_by_recurrence, shortest_recurrence


@st.composite
def automata(draw: st.DrawFn) -> Automaton:
    """Automata of up to 12 states, with and without weights, some of which lead nowhere."""
    states = draw(st.integers(1, 12))
    rows = draw(st.lists(st.lists(st.integers(0, states - 1), max_size=4), min_size=states, max_size=states))
    targets = np.array([target for row in rows for target in row], dtype=np.int64)
    heaviest = draw(st.sampled_from([1, 1, 3, 10**30]))
    weights = None
    if heaviest > 1:
        given_weights = draw(st.lists(st.integers(0, heaviest), min_size=len(targets), max_size=len(targets)))
        weights = np.array(given_weights, dtype=object)
    return Automaton(
        np.cumsum([0, *map(len, rows)]),
        np.array([letter for row in rows for letter in range(len(row))], dtype=np.int64),
        targets,
        np.array(draw(st.lists(st.booleans(), min_size=states, max_size=states))),
        weights,
    )


@given(automata(), st.lists(st.integers(0, 700), min_size=1, max_size=3))
def test_a_count_by_recurrence_is_that_step_by_step(automaton: Automaton, lengths: list[int]) -> None:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(recurrence, "SHORTEST", 0)
        for length in (*lengths, 150, 151):
            found = count_by_recurrence(Completions(automaton), length)
            long = length >= 2 * (automaton.states + recurrence.HIGHEST_ORDER)
            assert found == (int(Completions(automaton).last_row(length)[0]) if long else None)


def test_a_prime_that_is_too_small_for_the_coefficients_is_found_out(monkeypatch: pytest.MonkeyPatch) -> None:
    terms = [1, 1]
    for _ in range(200):
        terms.append(100 * terms[-1] + 99 * terms[-2])
    assert shortest_recurrence(terms[:20], 2**127 - 1) == [100, 99]
    assert shortest_recurrence(terms[:20], 13) != [100, 99]
    two = Automaton(
        np.array([0, 2, 3]), np.array([0, 1, 0]), np.array([0, 1, 0]), np.array([True, False]),
        np.array([100, 1, 99], dtype=object),
    )  # fmt: skip
    monkeypatch.setattr(recurrence, "SHORTEST", 0)
    expected = int(Completions(two).last_row(500)[0])
    for primes, found in (((13,), None), ((13, 2**127 - 1), expected)):
        monkeypatch.setattr(recurrence, "PRIMES", primes)
        assert count_by_recurrence(Completions(two), 500) == found


def test_an_order_that_is_too_high_or_a_limit_is_left_to_the_steps() -> None:
    cycle = Automaton(np.arange(101), np.zeros(100, dtype=np.int64), np.roll(np.arange(100), -1), np.arange(100) == 0)
    assert count_by_recurrence(Completions(cycle), 5000) is None
    loop = Automaton(np.array([0, 2]), np.array([0, 1]), np.array([0, 0]), np.array([True]))
    assert count_by_recurrence(Completions(loop), 5000) == 2**5000
    assert count_by_recurrence(Completions(loop), 5000, lambda: "the time limit") is None
    assert count_by_recurrence(Completions(loop), 10) is None


@pytest.mark.parametrize("by", ["plan", "task", "skeleton"])
def test_a_shipped_domain_counts_long_words_as_step_by_step(by: str, monkeypatch: pytest.MonkeyPatch) -> None:
    space = TaskSpace(load_domain("prag"), 2500)
    fast = space.count(by)  # type: ignore[arg-type]
    monkeypatch.setattr("prag_asp.space.engines.automaton_engine.count_by_recurrence", lambda *_: None)
    assert fast == space.engines.engine(by, space.length).count(2500)  # type: ignore[arg-type]


def test_long_words_are_counted_modulo_primes_as_powers_of_the_matrix_say() -> None:
    space = TaskSpace(load_domain("prag"), 200_000, engine="automaton")
    found = space.count("skeleton")
    automaton = space.engines.engine("skeleton", space.length).explored(1).completions.automaton  # type: ignore[attr-defined]
    for prime in (1_000_003, 998_244_353):
        matrix = np.zeros((automaton.states, automaton.states), dtype=object)
        for source, target in zip(automaton.sources, automaton.targets, strict=True):
            matrix[source, target] += 1
        vector = automaton.accepting.astype(object)
        for bit in bin(200_000)[:1:-1]:
            if bit == "1":
                vector = matrix.dot(vector) % prime
            matrix = matrix.dot(matrix) % prime
        assert found % prime == vector[0]


def test_long_numbers_are_spelled_as_python_spells_them() -> None:
    before = sys.get_int_max_str_digits() if hasattr(sys, "get_int_max_str_digits") else None
    if before is not None:
        sys.set_int_max_str_digits(0)
    try:
        for bits in (1, 9_999, 10_000, 10_001, 20_003, 65_537):
            for number in islice((3**bits >> bits // 2, (1 << bits) - 1, 1 << bits, -(1 << bits)), 4):
                assert digits_of(number) == str(number)
    finally:
        if before is not None:
            sys.set_int_max_str_digits(before)
