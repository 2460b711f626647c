"""How messages guess at what a name was meant to be, and which names are held for mistakes."""

from __future__ import annotations

import pytest

from prag_asp.wording import did_you_mean, is_misspelt, nearest, unknown

KNOWN = ["action", "fluent", "precondition", "holding", "cube_1", "cube_12"]


@pytest.mark.parametrize(
    ("name", "near"),
    [
        ("acton", "action"),
        ("precond", "precondition"),
        ("holdng", "holding"),
        ("cube1", "cube_1"),
        ("cube_2", "cube_12"),
    ],
)
def test_the_nearest_name_is_meant(name: str, near: str) -> None:
    assert nearest(name, KNOWN) == near
    assert did_you_mean(name, KNOWN) == f"did you mean {near}?"


@pytest.mark.parametrize("name", ["robot", "x", "", "goal"])
def test_a_name_like_no_other_means_none(name: str) -> None:
    assert nearest(name, KNOWN) is None
    assert did_you_mean(name, KNOWN, "declare it") == "declare it"
    assert did_you_mean(name, KNOWN[:2]) == "known are action, fluent"
    assert not is_misspelt(name, KNOWN)


def test_a_name_is_never_taken_for_itself() -> None:
    assert nearest("holding", ["holding"]) is None


@pytest.mark.parametrize("name", ["acton", "precond", "holdng", "cube1", "fleunt"])
def test_a_slip_is_a_misspelling(name: str) -> None:
    assert is_misspelt(name, KNOWN)


@pytest.mark.parametrize("name", ["action_cost", "state_fluent", "cube_2", "cube_13", "holding_2"])
def test_another_number_and_another_word_make_names_of_their_own(name: str) -> None:
    assert nearest(name, KNOWN) is not None
    assert not is_misspelt(name, KNOWN)


def test_of_many_known_names_some_are_told() -> None:
    assert unknown("xy", list("jihgfedcba"), "action") == "no action 'xy'; there are a, b, c, d, e, f, g, h ..."
    assert unknown("go", [], "action") == "no action 'go'; there are none"


def test_an_action_whose_likes_are_known_may_be_one_that_never_occurs() -> None:
    assert (
        unknown("go(c)", ["go(a)", "gone"], "action") == "no action 'go(c)', or it can never occur; did you mean go(a)?"
    )
    assert unknown("go(c)", ["gone(a)"], "action") == "no action 'go(c)'; did you mean gone(a)?"
