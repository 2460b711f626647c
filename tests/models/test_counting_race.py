"""Counters have turns before a diagram is compiled; whoever counts, the number is the same, and no process is left."""

from __future__ import annotations

from collections.abc import Callable
from itertools import product

import pytest

from prag_asp import QueryError, answer_sets
from prag_asp.errors import EngineError
from prag_asp.logic.formula import counter
from prag_asp.logic.formula.cnf import Cnf
from prag_asp.logic.formula.counter import D4, GANAK, count_models
from prag_asp.models.counting_race import count_unless_compiled
from prag_asp.models.enumeration.effort import Turn
from prag_asp.models.prepared_formula import propagate_units
from prag_asp.models.sums.sum_table import TableCount
from prag_asp.processes.workers import WorkerGroup
from tests.chance import Chance
from tests.processes import children
from tests.space.engines.test_engines_clauses import needs_ganak

needs_d4 = pytest.mark.skipif("not __import__('importlib.util').util.find_spec('py_d4')", reason="no d4")
TWO_OF_THREE = Cnf(3, ((1, 2), (1, 3), (2, 3)), {}, (1, 2, 3))


def random_clauses(source: Chance, number: int) -> list[tuple[int, list[tuple[int, ...]]]]:
    """Return formulas of clauses of one to three literals, which may repeat or contradict each other."""
    formulas = []
    for place in range(number):
        chance = source.generator(place)
        variables = chance.randint(1, 7)
        literals = [*range(1, variables + 1), *range(-variables, 0)]
        formulas.append(
            (variables, [tuple(chance.choices(literals, k=chance.choice([1, 2, 2, 3, 3]))) for _ in range(9)])
        )
    return formulas


def models_of(variables: int, clauses: list[tuple[int, ...]]) -> list[tuple[bool, ...]]:
    """Return the models, tried one by one."""
    every = product([False, True], repeat=variables)
    return [each for each in every if all(any(each[abs(one) - 1] == (one > 0) for one in clause) for clause in clauses)]


@needs_d4
def test_d4_counts_as_trying_every_assignment_does(chance: Chance) -> None:
    with WorkerGroup(D4.module) as processes:
        d4 = processes.start()
        for variables, clauses in random_clauses(chance, chance.examples(40)):
            d4.send((variables, range(1, variables + 1), clauses))
            assert d4.receive(60) == len(models_of(variables, clauses)), clauses


def test_unit_propagation_fixes_what_all_models_have_and_drops_nothing_else(chance: Chance) -> None:
    for variables, clauses in random_clauses(chance, chance.examples(300)):
        fixed, left = propagate_units(clauses)
        models = models_of(variables, clauses)
        if left is None:
            assert not models
            continue
        assert models == models_of(variables, [*left, *((literal,) for literal in fixed)])
        assert all(len(clause) > 1 and fixed.isdisjoint({*clause, *(-one for one in clause)}) for clause in left)


@needs_d4
def test_the_engine_d4_counts_but_neither_projects_nor_samples() -> None:
    text = "{ in(1..40) } = 20. #show in/1."
    assert answer_sets(text=text, engine="d4").count() == 137846528820
    with pytest.raises(QueryError, match="engine d4: it does not project; choose the engine ganak or diagram"):
        answer_sets(text=text, engine="d4", project=True).count()
    with pytest.raises(QueryError, match="engine d4: it only counts; choose the engine diagram"):
        list(answer_sets(text=text, engine="d4").sample(1))


def test_without_d4_its_engine_names_the_package(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("prag_asp.logic.formula.counter.find_spec", lambda name: None)
    with pytest.raises(EngineError, match="engine d4: the package py_d4 is missing; pip install"):
        answer_sets(text="{a}.", engine="d4").count()


@needs_d4
@needs_ganak
def test_a_counter_whose_turn_is_over_waits_and_goes_on_beside_the_compiler() -> None:
    before, begun = set(children()), []
    turns = [Turn(D4, 1e-9), Turn(GANAK, 0, 2)]

    def compile_slowly(look: object) -> None:
        assert callable(look)
        while True:
            look()

    assert count_unless_compiled(turns, lambda: TWO_OF_THREE, compile_slowly, begun.append) == 4
    assert count_unless_compiled([Turn(GANAK, 0, 10**9)], lambda: TWO_OF_THREE, lambda _: None, begun.append) is None
    assert count_unless_compiled([Turn(GANAK, 0)], lambda: TWO_OF_THREE, compile_slowly, begun.append) == 4
    assert begun[-1] == GANAK
    assert set(children()) <= before


@needs_d4
def test_counters_go_on_beside_a_table_that_takes_long(monkeypatch: pytest.MonkeyPatch) -> None:
    def endless(_: TableCount, seconds: float, look: Callable[[], None] | None = None) -> None:
        while look is not None and seconds > 0:
            look()

    monkeypatch.setattr(TableCount, "within", endless)
    monkeypatch.setattr("prag_asp.models.counting_race.turns_of_engines", lambda *_, **__: (Turn(D4, 1e-9),))
    not_all = "{x(1..40)}. :- #sum { 2,X : x(X), X <= 20; 1,X : x(X), X > 20 } >= 60."
    assert answer_sets(text=not_all).count() == 2**40 - 1


@needs_d4
def test_a_counter_that_fails_leaves_the_answer_to_the_others(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: object) -> None:
        raise EngineError("it cannot")

    monkeypatch.setattr(counter, "check_formula", fail)
    found = count_unless_compiled(
        [Turn(D4, 1), Turn(GANAK, 1)], lambda: TWO_OF_THREE, lambda look: look(), lambda _: None
    )
    assert found is None
    with pytest.raises(EngineError, match="it cannot"):
        count_models(TWO_OF_THREE, counter=D4)
