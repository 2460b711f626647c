"""Tables of partial sums count what trying every assignment counts."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from prag_asp import answer_sets
from prag_asp.models.sums.sum_table import TableCount
from tests.chance import examples
from tests.models.programs import answer_sets_by_clingo, program

ATOMS = 8
"""The number of atoms x(1), x(2), ... of a choice."""

COMPARED = {
    "<": int.__lt__, "<=": int.__le__, "=": int.__eq__, "!=": int.__ne__, ">=": int.__ge__, ">": int.__gt__,
}  # fmt: skip


@dataclass(frozen=True)
class Aggregate:
    """An aggregate: its elements are a weight, the rest of a tuple, and a literal."""

    name: str
    elements: tuple[tuple[int, int, int], ...]
    lower: int | None
    relation: str
    bound: int
    negated: bool

    def __str__(self) -> str:
        parts = "; ".join(f"{weight},{rest}: {_text(literal)}" for weight, rest, literal in self.elements)
        lower = "" if self.lower is None else f"{self.lower} <= "
        return f"{'not ' * self.negated}{lower}#{self.name} {{ {parts} }} {self.relation} {self.bound}"

    def holds(self, atoms: tuple[bool, ...]) -> bool:
        """Return whether the aggregate is true; equal tuples count once."""
        tuples = {(weight, rest) for weight, rest, literal in self.elements if _true(literal, atoms)}
        weights = [weight for weight, _ in tuples if weight > 0 or self.name != "sum+"]
        value = len(weights) if self.name == "count" else sum(weights)
        inside = (self.lower is None or self.lower <= value) and COMPARED[self.relation](value, self.bound)
        return inside != self.negated


def _text(literal: int) -> str:
    return f"{'not ' * (literal < 0)}x({abs(literal)})"


def _true(literal: int, atoms: tuple[bool, ...]) -> bool:
    return atoms[abs(literal) - 1] == (literal > 0)


def aggregates(atoms: int) -> st.SearchStrategy[Aggregate]:
    """Return aggregates over the first atoms, numbered from 1."""
    literal = st.builds(int.__mul__, st.integers(1, atoms), st.sampled_from([1, 1, -1]))
    element = st.tuples(st.integers(-4, 9), st.integers(1, 4), literal)
    return st.builds(
        Aggregate,
        st.sampled_from(["sum", "sum", "sum+", "count"]),
        st.lists(element, min_size=1, max_size=12).map(tuple),
        st.none() | st.integers(-5, 10),
        st.sampled_from(sorted(COMPARED)),
        st.integers(-6, 25),
        st.booleans(),
    )


bodies = st.tuples(
    st.lists(aggregates(ATOMS + 2), max_size=2),
    st.lists(st.integers(1, ATOMS + 2).flatmap(lambda atom: st.sampled_from([atom, -atom])), max_size=2),
)
"""Bodies of constraints: aggregates and literals over the choices and the two derived atoms."""

definitions = st.tuples(st.lists(aggregates(ATOMS), min_size=1, max_size=2), st.integers(1, ATOMS))
"""Bodies of a derived atom's rule: aggregates and a choice."""


def by_table(text: str, *, project: bool = False) -> int | None:
    """Return the number that a table gives, or None if the program has no sum, or positive loops."""
    found = answer_sets(text=text, project=project)._compiled
    return None if found.no_clauses or found.sums is None else TableCount(found.sums).within(60)


@given(st.lists(bodies, min_size=1, max_size=3), st.tuples(definitions, definitions))
@settings(max_examples=examples(60))
def test_tables_count_random_sums_as_trying_every_choice_does(constraints: list, derived: tuple) -> None:  # type: ignore[type-arg]
    lines = [f"{{ x(1..{ATOMS}) }}."]
    for number, (some, choice) in enumerate(derived, ATOMS + 1):
        lines += [f"x({number}) :- {each}, x({choice})." for each in some]
    for some, literals in constraints:
        if body := ", ".join([*map(str, some), *map(_text, literals)]):
            lines.append(f":- {body}.")
    expected = 0
    shown = set()
    for choices in product([False, True], repeat=ATOMS):
        atoms = choices
        for some, choice in derived:
            atoms = (*atoms, choices[choice - 1] and any(each.holds(choices) for each in some))
        if any(
            all(each.holds(atoms) for each in some) and all(_true(literal, atoms) for literal in literals)
            for some, literals in constraints
            if some or literals
        ):
            continue
        expected += 1
        shown.add((atoms[:3], atoms[ATOMS]))
    text = "\n".join(lines)
    assert by_table(text) in {expected, None}, text
    projected = f"{text}\n#show. #show x(X) : x(X), X <= 3. #show x({ATOMS + 1}) : x({ATOMS + 1})."
    assert by_table(projected, project=True) in {len(shown), None}, text


@given(program(), st.booleans())
@settings(max_examples=examples(30))
def test_tables_count_the_answer_sets_that_clingo_finds(text: str, project: bool) -> None:
    try:
        number = by_table(text + ":- #sum {1,1: a; 2,2: b; 3,3: p(1); 1,4: p(2)} = 3.", project=project)
    except Exception as error:
        assert "unsafe" in str(error) or "conditional literal in the head" in str(error), error
        return
    expected = answer_sets_by_clingo(text + ":- #sum {1,1: a; 2,2: b; 3,3: p(1); 1,4: p(2)} = 3.", project=project)
    assert number in {None, sum(expected.values())}


def partial_sums(weights: list[int]) -> dict[int, int]:
    """Return the number of subsets for each sum."""
    numbers = {0: 1}
    for weight in weights:
        for total, number in sorted(numbers.items(), reverse=True):
            numbers[total + weight] = numbers.get(total + weight, 0) + number
    return numbers


@pytest.mark.parametrize(
    ("text", "number"),
    [
        ("{x(1..60)}. :- #sum{X:x(X)} != 900.", partial_sums(list(range(1, 61)))[900]),
        ("{x(1..40)}. :- #sum{X*X,X:x(X)} != 5000.", partial_sums([each**2 for each in range(1, 41)])[5000]),
    ],
)
def test_one_sum_over_many_numbers_is_counted_within_two_seconds_without_a_counter(
    text: str, number: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("prag_asp.models.counting_race.turns_of_engines", lambda *_, **__: pytest.fail("too slow"))
    assert answer_sets(text=text).count() == number


def test_a_table_continues_where_its_time_ended() -> None:
    found = answer_sets(text="{x(1..40)}. :- #sum{X:x(X)} != 400.")._compiled.sums
    assert found is not None
    table = TableCount(found)
    turns = 0
    while (number := table.within(0)) is None:
        turns += 1
    assert turns > 5
    assert number == partial_sums(list(range(1, 41)))[400]
