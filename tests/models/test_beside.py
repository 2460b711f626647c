"""Where something takes longer, a model counter counts as well: whoever is done first, the number is the same."""

from __future__ import annotations

from errno import EMFILE, ENOSPC

import pytest

from prag_asp import EngineError, TaskSpace, answer_sets
from prag_asp.logic.formula import counter
from prag_asp.logic.formula.cnf import Cnf
from prag_asp.models.enumeration.bounded_enumeration import BoundedEnumeration, Effort
from tests.domains import domain_of
from tests.models.test_approximate import LINKED
from tests.processes import children
from tests.space.engines.test_engines import TWO
from tests.space.engines.test_engines_clauses import needs_ganak

APART = TWO + "#program base. action(c). action(d). #program step(t). :- occurs(A,t), occurs(A,t-2), t > 2."
"""An action differs from the last but one, which the automaton does not express."""

BESIDE = "prag_asp.{}.PATIENCE"


@needs_ganak
def test_where_clingo_would_never_end_a_counter_answers_and_that_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(BESIDE.format("space.engines.auto_engine"), 0)
    notes: list[str] = []
    before = set(children())
    space = TaskSpace(domain_of(APART), 40, progress=notes.append)
    assert space.count("plan") == 4**2 * 3**38
    assert space.count("plan", ["a"]) == 4 * 3**38
    assert sum("engine sharp as well, because clingo" in line for line in notes) == 2
    assert set(children()) <= before


@needs_ganak
@pytest.mark.parametrize("fails", [False, True])
def test_a_counter_that_fails_leaves_the_question_to_clingo(fails: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(BESIDE.format("space.engines.auto_engine"), 0)
    monkeypatch.setattr("prag_asp.space.engines.clingo_engine.POLL", 0)

    def fail(*_: object) -> None:
        raise EngineError("it cannot")

    if fails:
        monkeypatch.setattr(counter, "check_formula", fail)
    space = TaskSpace(domain_of(APART), 0)
    assert [space.at(length).count("plan") for length in (2, 4, 8)] == [16, 144, 4**2 * 3**6]
    assert space.at(3).count("plan", ["d", "d"]) == 3


@needs_ganak
@pytest.mark.parametrize(
    ("what", "error"),
    [
        ("logic.formula.counter.TemporaryFile", OSError(ENOSPC, "No space left on device")),
        ("processes.workers.Pipe", OSError(EMFILE, "Too many open files")),
        ("processes.workers.Worker.send", MemoryError()),
        ("processes.workers.Worker.receive", MemoryError()),
    ],
)
def test_where_there_is_no_room_for_a_counter_the_count_goes_on_alone(
    what: str, error: Exception, monkeypatch: pytest.MonkeyPatch
) -> None:
    tried: list[str] = []

    def no_room(*_: object) -> None:
        tried.append(what)
        raise error

    before = set(children())
    monkeypatch.setattr(f"prag_asp.{what}", no_room)
    with counter.CountBeside(lambda: (Cnf(2, ((1, 2),), {}, (1, 2)), ()), 0) as beside:
        assert beside() is None
        while beside._child is not None:
            beside._child.connection.poll(600)
            assert beside() is None
        assert beside() is None
    assert tried == [what]
    assert set(children()) <= before


@needs_ganak
def test_an_error_of_a_listener_is_no_failure_of_the_counter() -> None:
    def tell() -> None:
        raise BrokenPipeError

    before = set(children())
    formula = Cnf(2, ((1, 2),), {}, (1, 2))
    with pytest.raises(BrokenPipeError), counter.CountBeside(lambda: (formula, ()), 0, tell) as beside:
        beside()
    assert set(children()) <= before


@needs_ganak
def test_a_program_that_is_not_tight_is_counted_by_whoever_is_done_first(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(BESIDE.format("models.enumeration.effort"), 0)
    monkeypatch.setattr("prag_asp.models.counting_race.first_effort", lambda _: Effort(0, 0))
    monkeypatch.setattr(BoundedEnumeration, "count_within", lambda *_: None)
    monkeypatch.setattr("prag_asp.models.enumeration.effort.COMPILATION", 0)
    monkeypatch.setattr("prag_asp.models.compiler.LOOK", 1)
    waited: list[bool] = []

    def slow(self: counter.CountBeside) -> int | None:
        """Have compiling wait for the counter once it is there."""
        found = ask(self)
        if self._child is not None and found is None:
            waited.append(self._child.connection.poll(600))
            return ask(self)
        return found

    ask = counter.CountBeside.__call__
    text = LINKED + " reach(Y) :- reach(X), edge(Y,X)."
    expected = answer_sets(text=text, engine="diagram").count()
    notes: list[str] = []
    assert answer_sets(text=text, tell=notes.append).count() == expected == 2**6
    monkeypatch.setattr(counter.CountBeside, "__call__", slow)
    found = answer_sets(text=text, tell=notes.append)
    assert found.count() == expected
    assert waited == [True] and "_diagram" not in found.__dict__
    assert any("Ganak also counts" in note for note in notes)
    assert sum(found.marginals().values()) > 0
