"""Rules that change a fluent without a value: it is unknown, which rules of a step may not read."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from prag_asp import DomainError, load_domain
from tests.chance import examples
from tests.spaces import with_engines

FLUENTS, ACTIONS = ("f", "g"), ("a", "b")
BASE = "fluent((f; g)). action((a; b)). initially((f; g), false).\n"
UNREAD = "which <text>:{} changes, though no rule may give it a value"

Effect = tuple[str, str, bool | None, tuple[str, bool] | None]
"""An action, the fluent that it changes, its value if it gets one, and a value that the state before has."""

State = tuple[bool, ...]


def spelled(effects: list[Effect], needs: list[tuple[str, str, bool]]) -> str:
    """Return the domain with effects by rules, and with the preconditions of actions."""
    lines = [BASE, *(f"precondition({a},{f},{str(v).lower()})." for a, f, v in needs), "#program step(t)."]
    for action, fluent, value, read in effects:
        body = f"occurs({action},t)" + (f", holds({read[0]},{str(read[1]).lower()},t-1)" if read else "")
        lines.append(f"changed({fluent},t) :- {body}.")
        if value is not None:
            lines.append(f"holds({fluent},{str(value).lower()},t) :- {body}.")
    return "\n".join(lines)


def successors(state: State, action: str, effects: list[Effect]) -> Iterator[State]:
    """Yield the complete states after an action: a fluent that changes without a value has either."""
    fired = [e for e in effects if e[0] == action and (e[3] is None or state[FLUENTS.index(e[3][0])] == e[3][1])]
    choices = []
    for place, fluent in enumerate(FLUENTS):
        changes = [value for _, changed, value, _ in fired if changed == fluent]
        values = {value for value in changes if value is not None}
        choices.append([True, False] if changes and not values else values if changes else {state[place]})
        if len(values) == 2:
            return
    yield from product(*choices)


def count(length: int, effects: list[Effect], needs: list[tuple[str, str, bool]]) -> int:
    """Count plans by the complete states that each may lead to."""
    plans = 0
    for plan in product(ACTIONS, repeat=length):
        states: set[State] = {(False, False)}
        for action in plan:
            wanted = [(FLUENTS.index(fluent), value) for each, fluent, value in needs if each == action]
            able = (state for state in states if all(state[place] == value for place, value in wanted))
            states = {after for state in able for after in successors(state, action, effects)}
        plans += bool(states)
    return plans


@settings(max_examples=examples(10))
@given(
    st.lists(
        st.tuples(
            st.sampled_from(ACTIONS),
            st.sampled_from(FLUENTS),
            st.sampled_from([True, False, None]),
            st.none() | st.tuples(st.sampled_from(FLUENTS), st.booleans()),
        ),
        min_size=1,
        max_size=4,
    ),
    st.lists(st.tuples(st.sampled_from(ACTIONS), st.sampled_from(FLUENTS), st.booleans()), max_size=2),
)
def test_complete_states_decide_what_is_accepted(effects: list[Effect], needs: list[tuple[str, str, bool]]) -> None:
    try:
        domain = load_domain(text=spelled(effects, needs))
    except DomainError as error:
        assert "changes, though no rule may give it a value" in str(error)
        assert any(value is None for _, _, value, _ in effects) and any(read for *_, read in effects)
        return
    counts = [count(length, effects, needs) for length in range(4)]
    for space in with_engines(domain, "automaton", "symbolic", "clingo", "sat"):
        assert [space.at(length).count("plan") for length in range(4)] == counts


@pytest.mark.parametrize(
    ("rules", "read"),
    [
        ("changed(f,t) :- occurs(a,t).\n:- occurs(b,t), not holds(f,true,t-1).", "f"),
        ("changed(F,t) :- occurs(a,t), fluent(F).\n:- occurs(b,t), holds(g,true,t-1).", "g"),
        ("changed(f,t) :- occurs(a,t).\nholds(f,true,t) :- occurs(a,t), holds(g,true,t-1).", None),
        ("changed(f,t) :- occurs(a,t).\n#program check(t).\n:- holds(f,true,t).", "f"),
        # f is unknown after a, so g may be unknown after b.
        ("changed(f,t) :- occurs(a,t).\nchanged(g,t) :- occurs(b,t), holds(f,true,t-1).\n"
         "holds(g,true,t) :- occurs(b,t), holds(f,true,t-1), holds(f,true,t).", "f"),
    ],
)  # fmt: skip
def test_what_is_left_without_a_value_is_not_read(rules: str, read: str | None) -> None:
    text = f"{BASE}#program step(t).\n{rules}\n"
    if read is None:
        assert load_domain(text=text).facts.fluents
        return
    with pytest.raises(DomainError) as caught:
        load_domain(text=text)
    assert f"reads {read}, {UNREAD.format(3)}" in str(caught.value)


@pytest.mark.parametrize(
    ("rules", "counts"),
    [
        # a toggles f, and b needs it: the number of a before each b is odd.
        ("flips(true,false). flips(false,true).\n#program step(t).\nchanged(f,t) :- occurs(a,t).\n"
         "holds(f,W,t) :- occurs(a,t), holds(f,V,t-1), flips(V,W).\n:- occurs(b,t), holds(f,false,t-1).",
         [1, 1, 2, 3, 5]),
        ("#program step(t).\nchanged(f,t) :- occurs(a,t).\nholds(f,true,t) :- occurs(a,t), holds(f,false,t-1).\n"
         "holds(f,false,t) :- occurs(a,t), not holds(f,false,t-1).\n:- occurs(b,t), not holds(f,true,t-1).",
         [1, 1, 2, 3, 5]),
        # A predicate that is carried along gives the value: it is true of 0 or of 1 at every step.
        ("mode(0,0).\n#program step(t).\nmode(1-M,t) :- mode(M,t-1).\nchanged(f,t) :- occurs(a,t).\n"
         "holds(f,true,t) :- occurs(a,t), mode(0,t-1).\nholds(f,false,t) :- occurs(a,t), mode(1,t-1).\n"
         ":- occurs(b,t), holds(f,false,t-1).",
         [1, 1, 2, 3, 6]),
    ],
)  # fmt: skip
def test_rules_that_give_a_value_in_every_case_may_be_read(rules: str, counts: list[int]) -> None:
    for space in with_engines(load_domain(text=BASE + rules), "automaton", "symbolic", "clingo", "sat"):
        assert [space.at(length).count("plan") for length in range(5)] == counts
