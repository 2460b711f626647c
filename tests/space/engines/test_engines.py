"""What the automaton cannot express it refuses, with the reason, and clingo takes over."""

from __future__ import annotations

import itertools
from dataclasses import replace
from typing import Any

import pytest

from prag_asp import EngineError, QueryError, TaskSpace
from prag_asp.logic.domain_logic import DomainLogic
from prag_asp.processes.progress_events import Note
from prag_asp.program.sources import Program
from prag_asp.space.engines import ENGINES, Engine, clingo_engine, engine_class, select
from tests.domains import domain_of

TWO = """
fluent(f). action(a). action(b). postcondition(a,f,true). postcondition(b,f,false). initially(f,false).
#program step(t).
"""

BEYOND = [
    (":- occurs(A,t), occurs(A,t-2), t > 2.", "other than t and t-1", 4),
    (":- occurs(a,t), t > 2.", "number of the step", 4),
    (":- occurs(a,t), t \\ 2 = 0.", "number of the step", 4),
    ("{ coin(t) }. :- not coin(t), occurs(a,t).", r"chooses more than its action: coin\(t\)", 8),
    ("seen(t) :- holds(f,true,T), T < t. :- seen(t), occurs(b,t).", "other than t and t-1", 4),
    ("x(t) :- not y(t). y(t) :- not x(t). :- y(t), occurs(b,t).", "negation", 8),
    ("x(t) ; y(t). :- y(t), occurs(b,t).", "disjunction", 8),
]


@pytest.mark.parametrize(("rules", "reason", "plans"), BEYOND)
def test_a_step_that_is_no_function_is_refused_by_the_automaton_and_counted_by_clingo(
    rules: str, reason: str, plans: int
) -> None:
    domain = domain_of(TWO + rules)
    with pytest.raises(EngineError, match=reason):
        TaskSpace(domain, 3, engine="automaton").count("plan")
    auto, clingo = (TaskSpace(domain, 3, engine=engine) for engine in ("auto", "clingo"))
    assert auto.count("plan") == clingo.count("plan") == len(list(auto.enumerate("plan")))
    assert auto.count("plan") == plans
    task = next(iter(auto))
    assert task in auto and len(task.states) == 3


def test_a_rule_across_three_steps_is_kept() -> None:
    words = list(TaskSpace(domain_of(TWO + BEYOND[0][0]), 3).enumerate("plan"))
    assert words == [("a", "a", "b"), ("a", "b", "b"), ("b", "a", "a"), ("b", "b", "a")]


CARRIED = [
    ("parity(0).", "parity(1-P,t) :- parity(P,t-1).", ":- parity(1,t-1), occurs(a,t)."),
    ("", "armed(t) :- occurs(a,t). armed(t) :- armed(t-1), not occurs(b,t).", ":- armed(t-1), occurs(a,t)."),
    ("", "n(1,t) :- occurs(a,t), not n(1,t-1). n(2,t) :- n(1,t-1). n(2,t) :- n(2,t-1).", ":- n(2,t), occurs(a,t)."),
    ("", "", ":- #sum { 2 : occurs(a,t-1); 1 : holds(f,true,t); 1 : occurs(b,t) } > 2."),
    ("", "", ":- #sum { 2 : not occurs(a,t); 1 : holds(f,true,t-1); 1,b : occurs(b,t) } > 3."),
    ("", "more(t) :- 1 { holds(F,true,t-1) : fluent(F) } 1.", ":- more(t), occurs(a,t)."),
]


@pytest.mark.parametrize(("base", "define", "test"), CARRIED)
def test_an_author_extends_the_state_by_writing_a_rule(base: str, define: str, test: str) -> None:
    text = TWO + define + test + "\n#program base.\n" + base.replace("parity(0)", "parity(0,0)")
    domain = domain_of(text)
    automaton, clingo, sat = (TaskSpace(domain, 0, engine=engine) for engine in ("automaton", "clingo", "sat"))
    for length in range(7):
        for level in ("plan", "skeleton"):
            assert automaton.at(length).count(level) == clingo.at(length).count(level)
    assert automaton.at(6).count("plan") < 2**6
    assert list(sat.at(5).enumerate("plan")) == list(clingo.at(5).enumerate("plan"))


def test_a_rule_that_limits_which_actions_may_occur_is_evaluated() -> None:
    domain = domain_of(
        "fluent(f). action(a). action(b). postcondition(a,f,true). initially(f,false). postcondition(b,f,false)."
        "#program step(t). occurs(a,t) :- holds(f,false,t-1)."
    )
    for length in range(5):
        counts = {TaskSpace(domain, length, engine=e).count("plan") for e in ("automaton", "clingo")}
        assert len(counts) == 1


def test_words_are_found_where_other_encodings_let_a_step_have_no_action() -> None:
    domain = domain_of("fluent(f). action(a; b). precondition(b,f,true). exclusive(f,f).")
    texts = (each.text.replace("1 { occurs(A,t)", "{ occurs(A,t)") for each in domain.program.sources)
    sources = (replace(each, text=text) for each, text in zip(domain.program.sources, texts, strict=True))
    lax = replace(domain, program=Program(tuple(sources)))
    assert list(TaskSpace(lax, 1, engine="clingo").enumerate("plan")) == [("a",)]
    assert TaskSpace(lax, 1, engine="clingo").count("plan") == 2


@pytest.mark.parametrize("first", [0, 235])
def test_clingo_finds_its_first_word_at_once_and_all_by_about_one_search_for_each_letter_that_follows(
    first: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of 250 actions, in order of their names, those up to `first` are never possible."""
    searches = []

    def counted(self: clingo_engine._UnrolledPlans, *given: Any) -> set[int] | None:
        searches.append(given)
        return searched(self, *given)

    searched = clingo_engine._UnrolledPlans._true_literals
    monkeypatch.setattr(clingo_engine._UnrolledPlans, "_true_literals", counted)
    names = [f"a{number:03}" for number in range(250)]
    barred = [f"precondition({name},f,true)." for name in names[:first]]
    facts = " ".join([*(f"action({name})." for name in names), *barred])
    words = TaskSpace(domain_of(f"fluent(f). initially(f,false). {facts}"), 2, engine="clingo").enumerate("plan")
    left = names[first:]
    assert next(words) == (left[0],) * 2
    if first == 0:
        assert len(searches) == 2
    else:
        assert list(words) == [*itertools.product(left, repeat=2)][1:]
        assert len(searches) <= (1 + len(left)) * (len(left) + 1 + 5)


def test_an_unknown_engine_and_a_negative_length_are_refused() -> None:
    with pytest.raises(QueryError, match="no engine 'magic'; there are auto, automaton, clingo"):
        TaskSpace(domain_of(TWO), 1, engine="magic").count()
    with pytest.raises(QueryError, match="at least 0"):
        TaskSpace(domain_of(TWO), -1)


def test_loop_free_tasks_are_listed_to_sample_them_and_too_many_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    facts = "fluent(f;g). initially(f,false;g,false). action(a;b). postcondition(a,f,true;b,g,true)."
    loop_free = TaskSpace(domain_of(facts), 2).where("loop-free")
    monkeypatch.setattr(clingo_engine, "MOST_LISTED", 2)
    assert {" ".join(map(str, task.actions)) for task in loop_free.sample(9, seed=1)} == {"a b", "b a"}
    monkeypatch.setattr(clingo_engine, "MOST_LISTED", 1)
    refusal = "lists all words, and length 2 has more than 1 tasks; choose a smaller length"
    with pytest.raises(EngineError, match=refusal) as error:
        TaskSpace(domain_of(facts), 2).where("loop-free").sample(1, seed=1)
    assert len(error.value.lines) == 1


def test_a_note_says_early_that_all_tasks_are_listed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(clingo_engine, "REPORTED", 0.0)
    told: list[str] = []
    facts = "fluent(f;g). initially(f,false;g,false). action(a;b). postcondition(a,f,true;b,g,true)."
    TaskSpace(domain_of(facts), 2, progress=told.append).where("loop-free").sample(1, seed=1)
    (line,) = [words for words in told if isinstance(words, Note) and "lists all tasks" in words]
    assert "of length 2, at most 300,000" in line and "--time" in line
    assert "listing tasks of length 2: 1 of at most 300,000" in told


def test_progress_says_why_clingo_took_over() -> None:
    told: list[str] = []
    TaskSpace(domain_of(TWO + BEYOND[1][0]), 2, progress=told.append).count("plan")
    assert any("because" in words and "number of the step" in words for words in told)


@pytest.mark.parametrize("engine", ["automaton", "clingo", "sat"])
def test_an_action_without_arguments_is_told_from_a_name(engine: str) -> None:
    """The action a can never occur; a is also the name of an action that can."""
    domain = domain_of("fluent(f). action(a). action(a(1)). precondition(a,f,true). initially(f,false).")
    space = TaskSpace(domain, 2, engine=engine)
    assert list(space.enumerate("plan")) == [("a(1)", "a(1)")]
    assert ("a", "a(1)") not in space
    assert space.count("skeleton", ["a"]) == 1


FLAGS = """
flag(x,t) :- occurs(a,t).
flag(y,t) :- occurs(b,t), occurs(a,t-1).
"""


@pytest.mark.parametrize(
    ("base", "rules", "counts"),
    [
        ("flag(x,0).", ":- not flag(_,t-1).", [1, 2, 2, 4, 6]),
        ("", "#program check(t). :- not flag(_,t).", [0, 1, 3, 6, 12]),
        (
            "flag(z,0).",
            ":- not flag(_,t), occurs(b,t), occurs(b,t-1). #program check(t). :- not flag(_,t).",
            [1, 1, 3, 5, 8],
        ),
        ("flag(z,0).", "#program check(t). :- flag(z,t).", [0, 2, 4, 8, 16]),
    ],
)
@pytest.mark.parametrize("engine", ["automaton", "clingo", "sat"])
def test_unnamed_arguments_mean_what_they_mean_in_clingo(engine: str, base: str, rules: str, counts: list[int]) -> None:
    """What `not flag(_,t)` reads is an atom of clingo's own, defined piece by piece as parts are ground."""
    space = TaskSpace(domain_of(f"{TWO}\n#program base. {base}\n#program step(t). {FLAGS}{rules}"), 0, engine=engine)
    assert [space.at(length).count("plan") for length in range(5)] == counts


def test_every_engine_of_the_registry_answers_what_engines_answer() -> None:
    asked = {name for name, value in vars(Engine).items() if callable(value) and not name.startswith("_")}
    assert {"count", "words", "contains", "rank", "unrank", "weighed"} <= asked
    model = DomainLogic(domain_of(TWO))
    for name in ENGINES:
        engine = engine_class(name) if name == "sharp" else select(name, model, "plan")  # not everyone has a counter
        assert asked <= set(dir(engine)), name
