"""Boolean functions as diagrams are what their truth tables say."""

from __future__ import annotations

from itertools import product
from random import Random

import pytest
from hypothesis import given, settings
from hypothesis.strategies import integers

from prag_asp.logic.diagram import functions as module
from prag_asp.logic.diagram.functions import FALSE, TRUE, Functions, Node, TooLarge
from tests.chance import examples

VARIABLES = 4
ROWS = list(product((False, True), repeat=VARIABLES))


def drawn(functions: Functions, draw: Random, depth: int) -> tuple[Node, list[bool]]:
    """Return a random function with its truth table."""
    if not depth:
        number, value = draw.randrange(VARIABLES), draw.random() < 0.5
        return functions.variable(number, value=value), [row[number] == value for row in ROWS]
    parts = [drawn(functions, draw, depth - 1) for _ in range(3)]
    (a, x), (b, y), (c, z) = parts
    kind = draw.choice(("choice", "all", "any", "opposite", "at least"))
    if kind == "choice":
        return functions.choice(a, b, c), [q if p else r for p, q, r in zip(x, y, z, strict=True)]
    if kind == "opposite":
        return functions.opposite(a), [not p for p in x]
    if kind == "at least":
        weights, bound = [draw.randint(1, 3) for _ in parts], draw.randint(-1, 8)
        rows = zip(x, y, z, strict=True)
        table = [sum(w for w, so in zip(weights, row, strict=True) if so) >= bound for row in rows]
        return functions.at_least(bound, list(zip((a, b, c), weights, strict=True))), table
    join = all if kind == "all" else any
    return getattr(functions, kind)((a, b, c)), [join(row) for row in zip(x, y, z, strict=True)]


@settings(max_examples=examples(50))
@given(seed=integers(0, 10**6))
def test_a_function_its_cubes_and_its_cases_have_its_truth_table(seed: int) -> None:
    draw, functions = Random(seed), Functions(10_000)
    function, table = drawn(functions, draw, 2)
    other, others = drawn(functions, draw, 2)
    assert (function == other) == (table == others)
    cubes = functions.cubes(function)
    cases = list(functions.cases((function, other), lambda cube: True))
    for row, so, also in zip(ROWS, table, others, strict=True):
        values = dict(enumerate(row))
        assert functions.where(function, values) == (TRUE if so else FALSE)
        assert any(all(row[number] == value for number, value in cube) for cube in cubes) == so
        ((_, found),) = [case for case in cases if all(row[number] == value for number, value in case[0])]
        assert found == (functions.where(function, values), functions.where(other, values))
        inner = {number: other if value else functions.opposite(other) for number, value in values.items()}
        composed = table[ROWS.index(tuple(value == also for value in row))]
        assert functions.where(functions.composed(function, inner), values) == (TRUE if composed else FALSE)
    assert len(cubes) == len(set(cubes))
    assert functions.variables([function]) <= set(range(VARIABLES))


def test_a_function_of_too_many_variables_or_nodes_is_refused() -> None:
    small = Functions(10**6, deepest=10)
    assert small.cubes(small.all(map(small.variable, range(10)))) == (tuple((number, True) for number in range(10)),)
    with pytest.raises(TooLarge):
        small.all(map(small.variable, range(11)))
    functions = Functions(50)
    with pytest.raises(TooLarge):
        functions.at_least(10, [(functions.variable(number), 1) for number in range(20)])


def test_a_function_of_too_many_conjunctions_is_refused_though_its_diagram_is_small(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(module, "MOST_CUBES", 2**7)
    functions = Functions(10**6)
    odd = FALSE
    for number in range(9):
        odd = functions.choice(functions.variable(number), functions.opposite(odd), odd)
        if number < 8:
            assert len(functions.cubes(odd)) == 2**number
    with pytest.raises(TooLarge):
        functions.cubes(odd)
