"""How messages guess at what a name was meant to be, and which names are held for mistakes."""

from __future__ import annotations

import pytest

from prag_asp.wording import did_you_mean, is_misspelt, nearest, unknown

KNOWN = ["action", "fluent", "precondition", "holding", "cube_1", "cube_12"]


@pytest.mark.parametrize(
    ("name", "near", "misspelt"),
    [
        ("acton", "action", True),
        ("precond", "precondition", True),
        ("holdng", "holding", True),
        ("cube1", "cube_1", True),
        ("fleunt", "fluent", True),
        # Another number or another word makes a name of its own.
        ("action_cost", "action", False),
        ("state_fluent", "fluent", False),
        ("cube_2", "cube_12", False),
        ("cube_13", "cube_1", False),
        ("holding_2", "holding", False),
    ],
)
def test_the_nearest_name_is_meant_and_a_slip_is_a_misspelling(name: str, near: str, misspelt: bool) -> None:
    assert nearest(name, KNOWN) == near
    assert did_you_mean(name, KNOWN) == f"did you mean {near}?"
    assert is_misspelt(name, KNOWN) == misspelt


@pytest.mark.parametrize("name", ["robot", "x", "", "goal"])
def test_a_name_like_no_other_means_none(name: str) -> None:
    assert nearest(name, KNOWN) is None
    assert did_you_mean(name, KNOWN, "declare it") == "declare it"
    assert did_you_mean(name, KNOWN[:2]) == "known are action, fluent"
    assert not is_misspelt(name, KNOWN)


def test_a_name_is_never_taken_for_itself() -> None:
    assert nearest("holding", ["holding"]) is None


def test_of_many_known_names_some_are_told() -> None:
    assert unknown("xy", list("jihgfedcba"), "action") == "no action 'xy'; there are a, b, c, d, e, f, g, h ..."
    assert unknown("go", [], "action") == "no action 'go'; there are none"


def test_an_action_whose_likes_are_known_may_be_one_that_never_occurs() -> None:
    assert (
        unknown("go(c)", ["go(a)", "gone"], "action") == "no action 'go(c)', or it can never occur; did you mean go(a)?"
    )
    assert unknown("go(c)", ["gone(a)"], "action") == "no action 'go(c)'; did you mean gone(a)?"
