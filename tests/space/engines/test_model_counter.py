"""The model counter sees only what it can take, and never outlives the question."""

from __future__ import annotations

import pytest

from prag_asp import EngineError, load_domain
from prag_asp.logic.domain_logic import DomainLogic
from prag_asp.logic.formula.cnf import Cnf
from prag_asp.logic.formula.counter import count_models
from prag_asp.space.engines import engine_class
from prag_asp.space.engines.sharp_engine import SharpEngine
from prag_asp.space.limits import UNLIMITED, Limits
from tests.domains import domain_of
from tests.processes import children
from tests.space.engines.test_engines import TWO
from tests.space.engines.test_engines_clauses import needs_ganak


def test_without_ganak_one_line_says_how_to_install_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("prag_asp.logic.formula.counter.find_spec", lambda name: None)
    with pytest.raises(EngineError, match=r"pip install 'prag_asp\[sharp\]'"):
        engine_class("sharp")(DomainLogic(domain_of(TWO)), "plan", None, UNLIMITED)


@needs_ganak
@pytest.mark.parametrize(
    ("variables", "clauses", "shown", "reason"),
    [
        (0, (), (), "0 variables"),
        (2**31, ((1,),), (1,), "variables; Ganak takes"),
        (2, ((1,), ()), (1,), "a clause is empty"),
        (2, ((1, 2**40),), (1,), "the literal 1099511627776 is none"),
        (2, ((1, 0),), (1,), "the literal 0 is none"),
        (2, ((1,),), (3,), "the literal 3 is none"),
    ],
)
def test_formulas_that_ganak_miscounts_or_aborts_on_never_reach_it(
    variables: int, clauses: tuple[tuple[int, ...], ...], shown: tuple[int, ...], reason: str
) -> None:
    with pytest.raises(EngineError, match=reason):
        count_models(Cnf(variables, clauses, {}, shown))


@needs_ganak
def test_a_variable_of_no_clause_counts_twice_if_it_is_shown() -> None:
    assert count_models(Cnf(3, ((1,), (1, 2)), {}, (1, 2, 3))) == 4
    assert count_models(Cnf(3, ((1,), (1, 2)), {}, (1, 2))) == 2
    assert count_models(Cnf(3, ((1,), (1, 2)), {}, ())) == 1
    assert count_models(Cnf(3, ((1,), (1, 2)), {}, ()), [-1]) == 0


@needs_ganak
def test_a_count_that_takes_too_long_ends_with_an_error_and_no_process() -> None:
    engine = SharpEngine(DomainLogic(load_domain("tabletop")), "plan", limits=Limits(seconds=1.5))
    before = set(children())
    with pytest.raises(EngineError, match=r"no count after [\d.]+ s; allow more"):
        pytest.fail(f"it has counted {engine.count(30)}")
    assert set(children()) <= before
