"""A mere name means all actions of that name, wherever words begin with it, and a plan is made of actions."""

from __future__ import annotations

from itertools import product
from pathlib import Path

import pytest

from prag_asp import QueryError, TaskSpace
from tests.commands import ok, run
from tests.domains import domain_of

ACTIONS = ("p", "q", "p(x)", "p(y)")
TEXT = "fluent(f). initially(f,true). class(c). entity(x,c). entity(y,c). action(p). action(q)."
TEXT += " action(p(E)) :- entity(E,c)."
DISTINCT = "precondition(p(x),f,true). precondition(q,f,true). postcondition(p(x),f,true)."


@pytest.mark.parametrize("engine", ["automaton", "clingo", "sat"])
def test_a_name_that_is_an_action_too_means_all_of_its_name_in_prefixes_and_conditions(engine: str) -> None:
    space = TaskSpace(domain_of(TEXT + DISTINCT), 2, engine=engine)
    begun = [word for word in product(ACTIONS, repeat=2) if word[0] != "q"]
    assert space.count("plan", prefix=["p"]) == len(begun) == 12
    assert list(space.enumerate("plan", prefix=["p"])) == begun
    assert list(space.where("begins p").enumerate("plan")) == begun
    assert space.count("plan", prefix=["p(x)", "p"]) == space.where("begins p(x), p").count("plan") == 3
    assert space.count("plan", prefix=["q", "q"]) == 1
    assert space.count("task", prefix=["p"]) == space.where("begins p").count("task")
    assert space.count("skeleton", prefix=["p"]) == space.where("begins p").count("skeleton") == 2


def test_after_a_name_an_interchangeable_entity_is_refused_and_after_an_action_it_is_not() -> None:
    space = TaskSpace(domain_of(TEXT), 2)
    assert space.count("task", prefix=["q", "p(y)"]) == 1
    with pytest.raises(QueryError, match=r"^p\(x\) names the interchangeable x, but follows an action name"):
        space.count("task", prefix=["p", "p(x)"])
    with pytest.raises(QueryError, match=r"^no action 'p\(z\)', or it can never occur; did you mean"):
        space.count("task", prefix=["p(z)"])
    with pytest.raises(QueryError, match=r"^no action 'p\(99999999999\)'"):
        space.index(["p(99999999999)", "q"])


def test_a_plan_that_is_explained_or_ranked_is_made_of_actions(tmp_path: Path) -> None:
    file = tmp_path / "names.lp"
    file.write_text(TEXT + DISTINCT + "\n#program step(t). :- occurs(p,t), occurs(q,t-1).\n", encoding="utf-8")
    assert ok("explain", str(file), "p", "p(x)") == "a plan of names\n"
    assert run("explain", str(file), "q p").stdout.startswith("step 2, p, cannot follow:\n")
    assert ok("task", str(file), "--length", "2", "--rank-of", "p p(x)") == "2\n"


@pytest.mark.parametrize("parameter", ["k", "now", "_s"])
@pytest.mark.parametrize("engine", ["automaton", "clingo", "sat"])
def test_the_parameter_of_a_step_may_have_any_name(engine: str, parameter: str) -> None:
    rules = (
        "#program step({t}). n(X+1,{t}) :- n(X,{t}-1), occurs(p,{t}), X < 2.\n"
        "n(X,{t}) :- n(X,{t}-1), not occurs(p,{t}).\n"
        ":- occurs(q,{t}), n(2,{t}-1). #program base. n(0,0). #program check({t}). :- n(0,{t})."
    )
    given, usual = (
        TaskSpace(domain_of(TEXT + DISTINCT + rules.format(t=name)), 4, engine=engine) for name in (parameter, "t")
    )
    assert not given.engines.model.obstacles
    for level in ("plan", "task", "skeleton"):
        assert given.count(level) == usual.count(level) > 0
    assert list(given.enumerate("plan")) == list(usual.enumerate("plan"))
