"""Whichever engine counts, and however far clingo enumerated before, the number is the same."""

from __future__ import annotations

from math import log2
from statistics import fmean
from typing import Any

import pytest

from prag_asp import answer_sets
from prag_asp.logic.formula.cnf import Cnf
from prag_asp.logic.formula.counter import D4, GANAK, count_models
from prag_asp.models.enumeration.bounded_enumeration import BoundedEnumeration, Effort
from prag_asp.models.enumeration.effort import NARROW, SOON, OwnEngine, turns_of_engines
from tests.chance import Chance
from tests.models.programs import answer_sets_by_clingo
from tests.models.test_known_numbers import CYCLE, LATIN, QUEENS
from tests.space.engines.test_engines_clauses import needs_ganak

PIGEONS = "{ a(P,1..n-1) } = 1 :- P = 1..n. :- a(P,H), a(Q,H), P < Q."
PARITY = "{ x(1..n) }. :- { x(1..n) } = 2*K, K = 0..n/2."
NOTHING = Effort(0, 0)


def count_by_counter(text: str, monkeypatch: pytest.MonkeyPatch, **how: object) -> int:
    """Return the count if clingo is given no time."""
    with monkeypatch.context() as patch:
        patch.setattr("prag_asp.models.counting_race.first_effort", lambda _: NOTHING)
        patch.setattr(BoundedEnumeration, "count_within", lambda *_: None)
        for name in ("COMPILATION", "LONGER_COMPILATION"):
            patch.setattr(f"prag_asp.models.enumeration.effort.{name}", 0)
        return answer_sets(text=text, **how).count()  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("text", "n", "known"), [(PIGEONS, 4, 0), (PIGEONS, 7, 0), (PARITY, 7, 64), (QUEENS, 9, 352), (CYCLE, 6, 120)]
)
def test_small_numbers_are_enumerated(text: str, n: int, known: int, monkeypatch: pytest.MonkeyPatch) -> None:
    def never(*_: object, **__: object) -> None:
        raise AssertionError

    monkeypatch.setattr("prag_asp.models.compiled_program.model_formula", never)
    assert answer_sets(text=text, constants={"n": n}).count() == known


def test_a_limit_of_work_ends_an_enumeration_at_the_same_place_each_time() -> None:
    def rounds() -> list[Any]:
        ground = answer_sets(text=LATIN, constants={"n": 4}).ground
        enumeration = BoundedEnumeration(ground, project=False)
        return [
            enumeration.count(Effort(575, 10**6)),
            enumeration._depths(),
            enumeration.count(Effort(10**6, 5)),
            enumeration.count(Effort(576, 10**6)),
            enumeration.count(Effort(10**6, 10**6)),
        ]

    first = rounds()
    assert first == rounds()
    assert first[0] is None and first[2] is None and first[3:] == [576, 576]
    assert 7 < log2(fmean(2**depth for depth in first[1])) < 12  # the logarithm of 576 is 9.2


@needs_ganak
def test_counters_are_asked_whether_there_is_a_model_at_all() -> None:
    pigeons = answer_sets(text=PIGEONS, constants={"n": 5}, engine="ganak")
    assert pigeons.count() == 0
    assert count_models(Cnf(2, ((1, 2), (-1, 2), (-2,)), {}, (1, 2))) == 0


def test_engines_agree_on_what_clingo_did_not_finish(chance: Chance, monkeypatch: pytest.MonkeyPatch) -> None:
    source = chance.generator(1)
    for _ in range(chance.examples(6)):
        rules = ["{x(1..6)}."]
        for _ in range(source.randint(1, 5)):
            body = ", ".join(source.choice(["", "not "]) + f"x({source.randint(1, 6)})" for _ in range(3))
            rules.append(f"{source.choice(['', 'y', 'z'])} :- {body}.")
        rules.append(source.choice(["#show y/0. #show _z : z.", "", "#show t(X) : x(X), y. #show.", "#project y/0."]))
        text, project = " ".join(rules), source.random() < 0.5
        counted = count_by_counter(text, monkeypatch, project=project)
        assert counted == answer_sets(text=text, project=project).count(), text
        assert counted == answer_sets(text=text, project=project, engine="clingo").count(), text
        if not project:
            assert counted == sum(answer_sets_by_clingo(text, project=False).values())


@pytest.mark.parametrize(
    ("text", "count"),
    [
        ("#show _hit/0. {pin(1)}. _hit :- pin(1).", 2),
        ("{a; b}. #show. #show _x : a. #show _x : b.", 2),
        ("{a; b; c}. #show. #show f(1) : a. #show f(1) : b. #show _g : c, not a.", 4),
        ("{a; b}. #show.", 1),
        ("{a; b}. #show h/0. h.", 1),
        ("{a; b}. :- a. :- not a. #show.", 0),
    ],
)
@pytest.mark.parametrize("engine", ["auto", "diagram", "clingo"])
def test_projection_is_on_everything_shown_whatever_its_name(text: str, count: int, engine: str) -> None:
    found = answer_sets(text=text, project=True, engine=engine)
    assert found.count() == count == len(set(found))


def test_clingo_enumerates_narrow_programs_also_where_a_busy_machine_doubles_the_prediction() -> None:
    def engines(predicted: float) -> list[object]:
        return [turn.engine for turn in turns_of_engines(predicted, NARROW, tight=True, whole=True, swept=True)]

    assert engines(SOON) == [OwnEngine.DIAGRAM, OwnEngine.CLINGO, D4, GANAK]
    assert engines(1.5 * SOON) == [OwnEngine.DIAGRAM, D4, GANAK, OwnEngine.CLINGO]
    assert OwnEngine.CLINGO not in engines(3 * SOON)
