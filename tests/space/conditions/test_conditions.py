"""Conditions: both engines agree with what the words mean, on random domains and with the tasks themselves."""

from __future__ import annotations

import itertools
import re
from dataclasses import replace

import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from prag_asp import Condition, QueryError, TaskSpace, load_domain
from tests.brute_force import Action, Toy, agrees, term
from tests.chance import Chance, examples
from tests.conditions import clauses, runs
from tests.domains import domain_of
from tests.spaces import with_engine
from tests.strategies import toys

LENGTH = 3
ENGINES = ("automaton", "clingo")


@settings(max_examples=examples(40), suppress_health_check=list(HealthCheck))
@given(st.one_of(toys(closed=False), toys(closed=True)))
def test_nontrivial_and_loop_free_tasks_are_those_whose_told_states_differ(toy: Toy) -> None:
    domain = domain_of(toy.text(), "at_most")
    space = TaskSpace(domain, LENGTH)
    nontrivial, loop_free = set(), set()
    for task in space.tasks_of_plans(space.enumerate("plan")):
        states = [frozenset(state.items()) for state in (task.initial, *task.states)]
        if states[0] != states[-1]:
            nontrivial.add(str(task))
        if len(set(states)) == len(states):
            loop_free.add(str(task))
    told_apart = space.where("nontrivial")
    for engine in ENGINES:
        assert {" ".join(word) for word in with_engine(told_apart, engine).enumerate("plan")} == nontrivial
    assert {" ".join(word) for word in space.where("loop-free").enumerate("plan")} == loop_free


NEVER = Toy(2, (Action("a", {}, {0: False}),), exclusive=((0, 0),))
NEVER_BY_TWO = Toy(4, (Action("a", {}, {0: None, 3: True}),), exclusive=((1, 2),), implies=((0, 1), (3, 0), (1, 2)))
"""Fluents that can never be true, which actions set."""
EQUAL = Toy(2, (Action("a", {}, {0: None}), Action("b", {}, {1: True})), implies=((0, 1), (1, 0)))
"""After a(0) b(1), f0 holds, so it held before b(1), so f1 did: it held at the start, and so did f0."""


@example(NEVER)
@example(NEVER_BY_TWO)
@example(EQUAL)
@settings(max_examples=examples(40), suppress_health_check=list(HealthCheck))
@given(st.one_of(toys(closed=False), toys(closed=True)))
def test_what_is_known_of_states_is_what_all_runs_share_so_nontrivial_and_loop_free_agree(toy: Toy) -> None:
    space = TaskSpace(domain_of(toy.text(), "at_most"), 2)
    known = replace(toy, impossible=())  # nothing is told of what is impossible
    nontrivial, loop_free = set(), set()
    numbers = {term(toy, i): i for i in range(len(toy.actions))}
    for task in space.tasks_of_plans(space.enumerate("plan")):
        plan = tuple(numbers[str(action)] for action in task.actions)
        executed = [states for states in runs(known, plan) if agrees(states[-1], toy.goal)]
        shared = [
            {f"f{f}": at[0][f] for f in range(toy.fluents) if len({state[f] for state in at}) == 1}
            for at in zip(*executed, strict=True)
        ]
        assert [{str(f): v for f, v in told.items()} for told in (task.initial, *task.states)] == shared
        if shared[0] != shared[-1]:
            nontrivial.add(tuple(map(str, task.actions)))
        if all(one != other for one, other in itertools.combinations(shared, 2)):
            loop_free.add(tuple(map(str, task.actions)))
    assert set(space.where("nontrivial").enumerate("plan")) == nontrivial
    assert set(space.where("loop-free").enumerate("plan")) == loop_free


@settings(max_examples=examples(100))
@given(toys(closed=False), st.data())
def test_a_condition_and_its_words_are_inverse(toy: Toy, data: st.DataObject) -> None:
    condition = Condition.parse(*(clause.words for clause in data.draw(st.lists(clauses(toy), max_size=4))))
    assert Condition.parse(str(condition)) == condition


def test_conditions_of_a_goal_and_a_start_show_in_the_task() -> None:
    space = TaskSpace(load_domain("prag"), 3).where("ends holding(panda,can_1)", "starts open(panda)")
    task = space[0]
    assert {str(fluent): value for fluent, value in task.goal.items()} == {"holding(panda,can_1)": True}
    assert "open(panda)" in map(str, task.initial)


def test_a_space_with_a_condition_is_ranked_and_drawn_as_any_other(chance: Chance) -> None:
    space = TaskSpace(load_domain("prag"), 4).where("uses apple", "matches .* grasp .*")
    tasks = list(space)
    assert len(tasks) == space.count() > 100
    assert [space.index(task) for task in tasks[::37]] == list(range(0, len(tasks), 37))
    assert all("grasp" in task.skeleton for task in space.sample(50, seed=chance.seed(1)))
    every = space.sample(len(tasks), seed=chance.seed(1), weights={}, distinct=True)
    assert set(map(str, every)) == set(map(str, tasks))


@pytest.mark.parametrize("engine", ["automaton", "clingo", "sat"])
def test_where_no_step_is_left_the_plan_without_one_satisfies_all_conditions(engine: str) -> None:
    """The first condition has no plan but the empty one, which is none of the second."""
    space = TaskSpace(domain_of("class(c). entity(x,c). fluent(p). action(a)."), 0, engine=engine)
    assert space.where("not matches .* a").count() == 1
    assert space.where("not matches .* a", "matches a .*").count() == 0


@pytest.mark.parametrize("words", ["a?", "a? b", "a{2}", "a{1,2} b", "a+ b?", "(a | b)? a{1,}", "(a b?)* b"])
def test_repetitions_of_names_are_those_of_regular_expressions(words: str) -> None:
    expression = re.compile(words.replace(" ", ""))
    space = TaskSpace(domain_of("fluent(f). action(a; b)."), "0..4").where(f"matches {words}")
    sequences = (sequence for length in range(5) for sequence in itertools.product("ab", repeat=length))
    assert list(space.enumerate("skeleton")) == [each for each in sequences if expression.fullmatch("".join(each))]


@pytest.mark.parametrize("engine", ENGINES)
def test_a_condition_that_no_word_meets_leaves_nothing_of_any_length(engine: str) -> None:
    domain = domain_of("action(a). action(b).", "at_most")
    space = TaskSpace(domain, 0, engine=engine).where("not matches (a | b)*")
    assert [space.at(length).count() for length in range(3)] == [0, 0, 0]


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("never", [":- not miracle.", ":- not occurs(_,t). :- occurs(_,t)."])
def test_a_goal_judges_the_start_where_no_step_is_possible(engine: str, never: str) -> None:
    text = f"fluent(done). action(a). initially(done,{{}}). goal(done,true).\n#program step(t). {never}"
    for value, plans in (("true", 1), ("false", 0)):
        space = TaskSpace(domain_of(text.format(value), "at_most"), 0, engine=engine)
        assert [space.at(length).count("plan") for length in range(3)] == [plans, 0, 0]


@pytest.mark.parametrize("engine", (*ENGINES, "sat"))
def test_choices_of_several_ends_are_made_together(engine: str) -> None:
    bowl, straight = "located(can_1,bowl_1)", "rotated(can_1,straight)"
    space = TaskSpace(load_domain("prag"), 2, engine=engine)
    apart = [f"ends {bowl} or {straight}", f"ends not {bowl} or {straight}"]
    assert space.where(*apart).count("plan") == space.where(f"ends {straight}").count("plan") > 0
    assert space.where(*apart, f"ends not {straight}").count("plan") == 0


@pytest.mark.parametrize("engine", (*ENGINES, "sat"))
def test_what_is_impossible_is_so_in_every_choice_of_an_end(engine: str) -> None:
    text = (
        "fluent((a;b;c;d)). initially(c,true). impossible(a,c). impossible(b,c). impossible(b,b). action(noop). "
        "action(set). postcondition(set,d,true)."
    )
    space = TaskSpace(domain_of(text, "at_most"), 2, engine=engine)
    for formula, plans in (("a", 0), ("a or b", 0), ("(a and d) or (a and not d)", 0), ("a or d", 4), ("a or c", 4)):
        assert space.where(f"ends {formula}").count("plan") == plans, formula


@pytest.mark.parametrize("engine", ENGINES)
def test_what_every_case_of_a_formula_says_is_known_however_it_is_written(engine: str) -> None:
    text = "fluent((f;g;h)). action((a;b)). postcondition(a,f,unknown). implies(g,h)."
    space = TaskSpace(domain_of(text, "at_most"), 2, engine=engine)
    plain, cases = space.where("ends f"), space.where("ends (f and g) or (f and not g)")
    assert plain[0].goal == cases[0].goal
    assert plain.where("nontrivial").count() == cases.where("nontrivial").count() == 3
    told = space.where("ends (f and g) or (f and h)")
    assert {str(fluent): value for fluent, value in told[0].goal.items()} == {"f": True, "h": True}


@pytest.mark.parametrize("engine", (*ENGINES, "sat"))
def test_what_is_achieved_is_not_so_from_the_start(engine: str) -> None:
    text = """
        fluent((f;g)). action((hide;set;wait)). implies(f,g). goal(f,true).
        postcondition(hide,f,unknown). postcondition(set,g,true). postcondition(set,f,true).
    """
    space = TaskSpace(domain_of(text, "at_most"), 2, engine=engine)
    # After `hide`, f holds if it does at the end, so g does, which was not changed: it held at the start.
    words = {" ".join(word) for word in space.where("achieves g").enumerate("plan")}
    assert words == {"hide set", "set hide", "set set", "set wait", "wait set"}
    assert space.where("achieves f and g").count("plan") == space.where("achieves f").count("plan") == 8
    assert space.where("achieves f or not f").count("plan") == space.where("achieves g and not g").count("plan") == 0
    assert space.at(0).where("achieves f").count("plan") == 0


@pytest.mark.parametrize("engine", (*ENGINES, "sat"))
def test_nothing_impossible_is_missing_at_the_start(engine: str) -> None:
    text = "fluent((f;g)). action((a;b)). postcondition(a,f,true). postcondition(b,g,true). impossible(f,g)."
    space = TaskSpace(domain_of(text, "at_most"), 2, engine=engine)
    for formula, plans in (("not f or not g", 0), ("f or g", 2), ("f", 1)):
        assert space.where(f"achieves {formula}").count("plan") == plans, formula


def test_few_of_the_tasks_that_end_so_make_it_so() -> None:
    space = TaskSpace(load_domain("tabletop"), 4)
    assert [space.where(f"{word} inside(can_1,bin_1)").count() for word in ("ends", "achieves")] == [80620, 2306]


def test_what_has_too_many_cases_to_be_told_at_the_start_is_refused() -> None:
    domain = domain_of("fluent(f(0..19)). action(a).", "at_most")
    cases = " and ".join(f"(f({i}) or f({i + 1}))" for i in range(0, 20, 2))
    with pytest.raises(QueryError, match="more than 400 cases"):
        TaskSpace(domain, 1).where(f"achieves {cases}").count()


def test_entities_that_a_condition_tells_apart_are_not_interchangeable() -> None:
    space = TaskSpace(load_domain("prag"), 1)
    assert space.where("uses apple").count("plan") == 2 * space.where("uses apple").count()
    one = space.where("uses apple_2")
    assert one.count("plan") == one.count() == space.where("uses apple").count()


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ("hass grasp", "no condition 'hass'; did you mean has?"),
        ("has", "write it like 'has at least 2 grasp'"),
        ("nontrivial please", "write it like 'nontrivial'"),
        ("has at least 2 gasp", "no action 'gasp'; did you mean grasp?"),
        ("has grasp>dorp", "no action 'dorp'; did you mean drop?"),
        ("has grasp(panda)", "no action 'grasp(panda)'"),
        ("uses banana", "no entity or class 'banana'"),
        ("avoids appel", "no entity or class 'appel'; did you mean apple?"),
        ("matches (grasp", "a parenthesis is not closed"),
        ("matches * grasp", "nothing precedes '*'"),
        ("matches grasp & drop", "'&' cannot occur in one"),
        ("matches grasp{5,2}", "{m,n} needs m <= n <= 1000"),
        ("matches gasp", "no action 'gasp'; did you mean grasp?"),
        ("starts holding(panda,can_1) or open(panda)", "write fluents that hold together"),
        ("after 2 holding(panda,can_1)", "write it like 'after 2: holding(panda,can_1)'"),
        ("ends holding(panda)", "no fluent 'holding(panda)'"),
        ("ends open(panda) and", "it ends too early"),
        ("ends open(panda) open(panda)", "unexpected 'open'"),
        ("part 3-30 of 20 by seed 1", "write it like 'part 0-79 of 100 by seed 7'"),
        ("begins grasp,,drop", "is not a list of terms"),
    ],
)
def test_a_wrong_condition_is_told_in_one_line(words: str, told: str) -> None:
    with pytest.raises(QueryError) as caught:
        TaskSpace(load_domain("prag"), 3).where(words)
    assert told in str(caught.value)
    assert "\n" not in str(caught.value)


def test_long_expressions_are_read_and_those_that_are_too_deep_told() -> None:
    space = TaskSpace(load_domain("prag"), 2)
    assert space.where("matches .{600} | grasp drop").count("skeleton") == space.where("matches grasp drop").count(
        "skeleton"
    )
    for words in (
        f"matches {'(' * 3000}grasp{')' * 3000}",
        f"ends {'not ' * 3000}open(panda)",
        f"after 1: {'not ' * 3000}open(panda)",
    ):
        with pytest.raises(QueryError, match="is nested too deep, or too long; write it shorter"):
            space.where(words).count()
