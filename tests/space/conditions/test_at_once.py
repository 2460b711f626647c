"""What is known at once is answered at once, and what takes too much is told."""

from __future__ import annotations

import pytest

from prag_asp import QueryError, TaskSpace, load_domain
from prag_asp.logic.domain_logic import DomainLogic
from tests.domains import domain_of

LATE = ["after 100000000: open(panda)", "has at least 4 grasp", "begins grasp, grasp, grasp, grasp"]


@pytest.mark.parametrize("words", LATE)
def test_a_condition_that_needs_more_actions_is_answered_without_grounding(
    words: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    space = TaskSpace(load_domain("prag"), 3).where(words)

    def never(*_: object) -> None:
        raise AssertionError("something was ground")

    monkeypatch.setattr(DomainLogic, "ground", property(never))
    for level in ("plan", "task", "skeleton"):
        assert space.count(level) == 0  # type: ignore[arg-type]
        assert not list(space.enumerate(level))  # type: ignore[arg-type]
    assert ("drop(panda)",) * 3 not in space
    with pytest.raises(QueryError, match=r"^there is no task of length 3 to sample"):
        space.sample(1, seed=1)
    with pytest.raises(IndexError):
        space[0]


SWITCH = """
fluent(f). initially(f,false). action(on). action(off). action(wait).
precondition(on,f,false). postcondition(on,f,true). precondition(off,f,true). postcondition(off,f,false).
"""


@pytest.mark.parametrize("engine", ["automaton", "clingo", "sat"])
def test_a_clock_is_right_up_to_its_length_and_beyond(engine: str) -> None:
    space = TaskSpace(domain_of(SWITCH), 3, engine=engine)
    everything = set(space.enumerate("plan"))
    for steps in range(5):
        lit = {word for word in everything if word[:steps].count("on") > word[:steps].count("off") and steps <= 3}
        assert set(space.where(f"after {steps}: f").enumerate("plan")) == lit


def test_an_expression_that_needs_too_many_states_is_told_in_one_line() -> None:
    with pytest.raises(QueryError, match=r"^an expression needs an automaton of more than 20,000 states; ask for less"):
        TaskSpace(load_domain("prag"), 3).where(f"matches .* grasp {'. ' * 18}")
    assert TaskSpace(load_domain("prag"), 9).where(f"matches .* grasp {'. ' * 5}").count("skeleton") > 0


@pytest.mark.parametrize("number", ["1e999999999", "1e-999999999", "1/1e999999999"])
def test_a_weight_out_of_range_is_told_in_one_line(number: str) -> None:
    with pytest.raises(
        QueryError, match=rf"^weight of 'grasp': {number} is out of range; write a number up to 1e1000$"
    ):
        TaskSpace(load_domain("prag"), 3).sample(1, seed=1, weights={"grasp": number})


@pytest.mark.parametrize(
    "words", ["after 99999999999: open(panda)", "has at least 99999999999 grasp", "uses 99999999999 apple"]
)
def test_a_number_of_a_condition_that_no_program_can_hold_is_told(words: str) -> None:
    with pytest.raises(
        QueryError, match=r"^condition '.*': the number 99999999999 is out of range: write numbers from"
    ):
        TaskSpace(load_domain("prag"), 3).where(words)
