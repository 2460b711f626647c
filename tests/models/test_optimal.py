"""Among optimal answer sets: those of best value, found by brute force, are counted, listed and sampled."""

from __future__ import annotations

from collections import Counter

import clingo
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from prag_asp import DomainError, QueryError, answer_sets
from tests.chance import examples
from tests.models.programs import count_in_process, literal, program
from tests.models.test_random_programs import read

PICKS = "{ pick(1..4) }.\n:- pick(1), pick(2).\n:~ not pick(X), X=1..4. [X]"


def optimal_by_clingo(text: str, costs: list[tuple[str, int, int]]) -> tuple[Counter[tuple[str, ...]], list[int]]:
    """Return the answer sets of least cost by evaluating the costs of all of them, and these costs.

    Each literal has its weight and its priority.
    """
    control = clingo.Control(["0"], logger=lambda *_: None)
    control.add("base", [], text)
    control.ground([("base", [])])
    priorities = sorted({priority for _, _, priority in costs}, reverse=True)
    found: list[tuple[list[int], tuple[str, ...]]] = []

    def keep(model: clingo.Model) -> None:
        atoms = set(map(str, model.symbols(atoms=True)))

        def holds(each: str) -> bool:
            return (each.removeprefix("not ").removeprefix("not ") in atoms) == (each.count("not") != 1)

        values = [sum(w for each, w, at in costs if at == priority and holds(each)) for priority in priorities]
        found.append((values, tuple(map(str, sorted(model.symbols(shown=True))))))

    control.solve(on_model=keep)
    best = min((values for values, _ in found), default=[])
    return Counter(shown for values, shown in found if values == best), best


costs_of_literals = st.lists(st.tuples(literal, st.integers(-4, 5), st.integers(0, 2)), min_size=1, max_size=5)


@given(program(), costs_of_literals)
@settings(max_examples=examples(15))
def test_the_optimal_answer_sets_are_those_of_least_cost(text: str, costs: list[tuple[str, int, int]]) -> None:
    whole = text + " ".join(f":~ {each}. [{w}@{at},{place}]" for place, (each, w, at) in enumerate(costs))
    found = read(whole, optimal=True)
    if found is None:
        return
    expected, best = optimal_by_clingo(text, costs)
    counts = {count_in_process(whole, optimal=True), answer_sets(text=whole, optimal=True, engine="clingo").count()}
    assert {found.count(), *counts} == {sum(expected.values())}
    assert Counter(tuple(map(str, each)) for each in found) == expected
    if expected:
        assert {tuple(map(str, each)) for each in found.sample(4, seed=1)} <= set(expected)
        assert found.optimum is not None
        values = dict(found.optimum.values)  # a priority is missing where no rule derives its atoms
        priorities = sorted({at for _, _, at in costs}, reverse=True)
        assert all(values.get(at, value) == value for at, value in zip(priorities, best, strict=True))


def test_the_best_value_of_each_priority_is_noted() -> None:
    notes: list[str] = []
    assert answer_sets(text=PICKS, optimal=True, tell=notes.append).count() == 1
    assert notes == ["the best value is 1"]
    two = "{ a(1..3) }. #maximize { X@2 : a(X), X < 3 }. #minimize { 1@1,X : a(X) }."
    found = answer_sets(text=two, optimal=True)
    assert str(found.optimum) == "the best values are -3 at priority 2, 2 at priority 1"
    assert [" ".join(map(str, each)) for each in found] == ["a(1) a(2)"]
    assert answer_sets(text=f"{two} :- a(1). :- not a(1).", optimal=True).optimum is None


def test_optimal_answer_sets_are_projected_weighed_and_enumerated_by_clingo_as_well() -> None:
    text = "{ a(1..2); b }. :~ a(X). [1@1,X] :- not a(1), not a(2). #show a/1. weight(a(1),3)."
    assert answer_sets(text=text, optimal=True).count() == 4
    assert answer_sets(text=text, optimal=True, project=True).count() == 2
    assert answer_sets(text=text, optimal=True, weighted=True).total() == 8
    cyclic = "{ e(1,2); e(2,1) }. #edge (X,Y) : e(X,Y). #maximize { 1,X : e(X,_) }."
    assert answer_sets(text=cyclic, optimal=True).count() == 2


def test_in_a_grid_the_largest_independent_sets_are_the_two_colours_of_a_chessboard() -> None:
    grid = "v(1..4,1..4). { in(X,Y) : v(X,Y) }. :- in(X,Y), in(X+1,Y). :- in(X,Y), in(X,Y+1). "
    most = answer_sets(text=grid + "#maximize { 1,X,Y : in(X,Y) }.", optimal=True)
    fixed = answer_sets(text=grid + ":- #count { X,Y : in(X,Y) } != 8.")
    assert most.optimum is not None and most.optimum.values == ((0, -8),)
    assert most.count() == fixed.count() and set(most) == set(fixed)


@pytest.mark.parametrize(
    ("text", "optimal", "problem"),
    [
        (PICKS, False, "<text>:3: a weak constraint or #minimize is not supported .* add --optimal"),
        ("{ a(1..3) }.\n#minimize { X*100000*100000,X : a(X) }.", True, "<text>:2: .* out of range"),
        (
            "{a;b}.\n#minimize { 2147483647 : a; 1,b : b }.",
            True,
            "<text>:2: the weights of priority 0 sum to more than",
        ),
    ],
)
def test_costs_that_cannot_be_added_exactly_are_refused_by_their_line(text: str, optimal: bool, problem: str) -> None:
    with pytest.raises(DomainError, match=problem):
        answer_sets(text=text, optimal=optimal)


def test_a_program_without_costs_has_nothing_to_optimise() -> None:
    with pytest.raises(QueryError, match="--optimal: the program optimises nothing"):
        answer_sets(text="{a}.", optimal=True)
    assert answer_sets(text="{a}. #minimize { 1 : b }.", optimal=True).count() == 2
