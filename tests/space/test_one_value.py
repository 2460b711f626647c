"""Rules of the domain that set fluents: no step leaves a fluent both true and false."""

from __future__ import annotations

from itertools import product

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from prag_asp import TaskSpace, load_domain
from prag_asp.program.sources import ONE_VALUE
from tests.chance import examples
from tests.domains import domain_of
from tests.spaces import with_engines

FLUENTS, ACTIONS = ("f", "g"), ("a", "b")
BASE = """
fluent((f; g)). action((a; b)). initially((f; g), false).
"""
OPPOSED = """
fluent((f; g)). action((a; b)). initially((f; g), false). postcondition(a, f, true). postcondition(b, g, true).
#program step(t).
changed(f,t)     :- occurs(a,t), holds(g,true,t-1).
holds(f,false,t) :- occurs(a,t), holds(g,true,t-1).
"""
ENGINES = ("automaton", "symbolic", "clingo", "sat", "sharp")

Effect = tuple[str, str, bool, bool, bool]
"""An action, the fluent it sets, to which value, whether the value before is dropped, and what g has to be before."""


def effects() -> st.SearchStrategy[list[Effect]]:
    """Draw conditional effects, of which some oppose each other and some leave the value before."""
    values = st.booleans()
    return st.lists(st.tuples(st.sampled_from(ACTIONS), st.sampled_from(FLUENTS), values, values, values), max_size=5)


def spelled(found: list[Effect]) -> str:
    """Return the domain with such effects."""
    rules = []
    for action, fluent, value, drops, before in found:
        body = f"occurs({action},t), holds(g,{str(before).lower()},t-1)."
        rules.append(f"holds({fluent},{str(value).lower()},t) :- {body}")
        rules += [f"changed({fluent},t) :- {body}"] * drops
    return "\n".join([BASE, "#program step(t).", *rules])


def is_plan(plan: tuple[str, ...], found: list[Effect]) -> bool:
    """Tell by following its steps whether a plan has one value for each fluent throughout."""
    state = dict.fromkeys(FLUENTS, False)
    for action in plan:
        fired = [each for each in found if each[0] == action and each[4] == state["g"]]
        dropped = {fluent for _, fluent, _, drops, _ in fired if drops}
        after = {(fluent, value) for fluent, value in state.items() if fluent not in dropped}
        after |= {(fluent, value) for _, fluent, value, _, _ in fired}
        if len(after) != len(FLUENTS):
            return False
        state = dict(after)
    return True


@pytest.mark.parametrize("engine", ENGINES)
def test_an_effect_that_a_rule_opposes_is_no_step(engine: str) -> None:
    """After b, the rule says false where the postcondition says true."""
    space = TaskSpace(load_domain(text=OPPOSED), 2, engine=engine)
    assert space.count() == 3
    assert space.at(3).count() == 4


@settings(max_examples=examples(30))
@given(effects())
def test_engines_leave_out_what_would_have_two_values(found: list[Effect]) -> None:
    """By brute force over all plans; the engine sharp compiles the rules that sat solves."""
    counts = [sum(is_plan(plan, found) for plan in product(ACTIONS, repeat=length)) for length in range(4)]
    for space in with_engines(domain_of(spelled(found)), *ENGINES[:4]):
        assert [space.at(length).count("plan") for length in range(4)] == counts


def test_only_rules_that_set_fluents_bring_the_constraint() -> None:
    """What is merely read, or said in a comment, leaves the program as it is."""
    reading = "#program step(t).\n:- occurs(a,t), holds(f,true,t-1).  % holds(f,true,t) :- occurs(a,t)."
    assert not _constrained(BASE + reading)
    assert all(map(_constrained, (OPPOSED, BASE + "#program step(t). holds(g,true,t):-occurs(a,t),holds(f,true,t-1).")))


def _constrained(text: str) -> bool:
    return any(source.path.name == ONE_VALUE for source in load_domain(text=text).program.sources)
