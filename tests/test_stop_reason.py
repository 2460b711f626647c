"""Reasons of a stop are values, and become words where a message is printed."""

from __future__ import annotations

import pickle

import pytest

from prag_asp import EngineError, LimitReached, TaskSpace, load_domain
from prag_asp.space.limits import Limits, limit_error
from prag_asp.stop_reason import StopKind, StopReason


@pytest.mark.parametrize(
    ("reason", "words"),
    [
        (StopReason(StopKind.TIME, 0.5), "the time limit of 0.5 s"),
        (StopReason(StopKind.MEMORY, 2_500_000_000), "the memory limit of 2,500 MB"),
        (StopReason(StopKind.CRASH), "the end of a child process"),
    ],
)
def test_a_reason_names_the_limit_with_its_unit(reason: StopReason, words: str) -> None:
    assert reason.prose() == words


@pytest.mark.parametrize(("kind", "option"), [(StopKind.TIME, "--time"), (StopKind.MEMORY, "--memory")])
def test_the_error_of_a_limit_names_the_option_that_moves_it(kind: StopKind, option: str) -> None:
    error = limit_error(StopReason(kind, 1.0), 7, "plan", 3, states=5)
    assert option in str(error) and "with 5 states explored" in str(error) and error.at_least == 7


@pytest.mark.parametrize("engine", ["automaton", "clingo", "sat", "symbolic"])
def test_an_engine_that_a_limit_ends_says_which_as_a_value(engine: str) -> None:
    space = TaskSpace(load_domain("prag"), 14, engine=engine, limits=Limits(seconds=0, cached=False))
    with pytest.raises(LimitReached) as reached:
        space.count("plan")
    assert reached.value.reason == StopReason(StopKind.TIME, 0)


def test_errors_keep_their_fields_from_process_to_process() -> None:
    limit = pickle.loads(pickle.dumps(limit_error(StopReason(StopKind.MEMORY, 10), 3, "task", 2)))
    assert (limit.at_least, limit.reason) == (3, StopReason(StopKind.MEMORY, 10))
    engine = pickle.loads(pickle.dumps(EngineError("no", place="d.lp:2", remedy="go")))
    assert (str(engine), engine.what, engine.place, engine.remedy) == ("d.lp:2: no; go", "no", "d.lp:2", "go")
