"""The engines sat and sharp agree with the definition, with hand-made counts and with the known ones."""

from __future__ import annotations

import itertools
import sys
import time
from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction
from itertools import islice
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from prag_asp import EngineError, QueryError, TaskSpace, load_domain
from prag_asp.space.engines import LEVELS
from tests.brute_force import Toy, term
from tests.chance import Chance, examples
from tests.domains import domain_of
from tests.ganak import CountModels, counting_by, one_process
from tests.processes import gone, interrupt, interruptible, until_it_works, workers
from tests.space.engines.test_engines import BEYOND, TWO
from tests.space.test_known_counts import COUNTS
from tests.strategies import toys

COUNTED = [
    ("blocks", "plan", 4),
    ("blocks", "task", 5),
    ("hanoi", "skeleton", 3),
    ("hanoi", "plan", 7),
    ("prag", "task", 2),
]

needs_ganak = pytest.mark.skipif("not __import__('importlib.util').util.find_spec('pyganak')", reason="no pyganak")
ROWS = {row[:4]: row[4] for row in COUNTS}


@pytest.fixture(scope="module")
def ganak() -> Iterator[CountModels]:
    with one_process() as count_models:
        yield count_models


@needs_ganak
@pytest.mark.parametrize(("domain", "level", "length"), COUNTED)
def test_sharp_meets_the_known_count(domain: str, level: Any, length: int) -> None:
    space = TaskSpace(load_domain(domain), length, engine="sharp")
    assert space.count(level) == ROWS[domain, level, length, ()]


@needs_ganak
def test_sharp_counts_what_is_too_much_to_enumerate() -> None:
    """Two toggles at each of 40 steps: 2 ** 40 plans, of which 2 ** 39 begin with a."""
    space = TaskSpace(domain_of(TWO), 40, engine="sharp")
    assert space.count("plan") == 2**40
    assert space.count("plan", ["a"]) == 2**39


@needs_ganak
@pytest.mark.slow
@settings(max_examples=examples(12), suppress_health_check=list(HealthCheck))
@given(st.booleans().flatmap(lambda closed: toys(closed=closed)), st.data())
def test_sharp_agrees_with_brute_force_at_every_level(ganak: CountModels, toy: Toy, data: st.DataObject) -> None:
    with counting_by(ganak):
        check_sharp(toy, data)


def check_sharp(toy: Toy, data: st.DataObject) -> None:
    space = TaskSpace(domain_of(toy.text(), "at_most"), 3, engine="sharp")
    expected = sorted(tuple(term(toy, i) for i in plan) for plan in toy.plans(3))
    names = {tuple(action.partition("(")[0] for action in plan) for plan in expected}
    assert [space.count(level) for level in LEVELS] == [len(expected), len(expected), len(names)]
    first = data.draw(st.sampled_from(sorted({action.name for action in toy.actions})))
    assert space.count("plan", [first]) == sum(plan[0].startswith(f"{first}(") for plan in expected)
    if expected:
        rank = data.draw(st.integers(0, len(expected) - 1))
        assert tuple(map(str, space[rank].actions)) == expected[rank]
        assert space.index(space[rank]) == rank


@pytest.mark.parametrize("engine", ["sat", pytest.param("sharp", marks=needs_ganak)])
@pytest.mark.parametrize(("rules", "plans"), [(rules, plans) for rules, _, plans in BEYOND if ";" not in rules])
def test_steps_that_are_no_function_are_counted(engine: str, rules: str, plans: int) -> None:
    assert TaskSpace(domain_of(TWO + rules), 3, engine=engine).count("plan") == plans


def test_a_disjunction_is_refused() -> None:
    with pytest.raises(EngineError, match=r"disjunction as its head.*choose the engine clingo"):
        TaskSpace(domain_of(TWO + "x(t) ; y(t)."), 2, engine="sat").count("plan")


LOOPS = [
    # x and y hold each other up, but only a begins it: b cannot break them in a step of its own.
    ("x(t) :- y(t). y(t) :- x(t). x(t) :- occurs(a,t). :- x(t), occurs(b,t).", lambda word: True),
    ("x(t) :- y(t). y(t) :- x(t). x(t) :- occurs(a,t). :- not x(t).", lambda word: "b" not in word),
    # A choice within the loop that nothing begins.
    ("{ x(t) } :- y(t). y(t) :- x(t). :- not x(t), occurs(a,t).", lambda word: "a" not in word),
    # A choice that may begin the loop, or not: hidden twice, projected once.
    ("{ x(t) }. y(t) :- x(t). x(t) :- y(t), occurs(b,t). :- not y(t), occurs(a,t).", lambda word: True),
    # Sums within the loop: two of three are needed, and a is one.
    (
        "x(t) :- #sum { 1,1 : y(t); 1,2 : z(t); 1,3 : occurs(a,t) } >= 2. y(t) :- x(t). z(t) :- y(t)."
        "z(t) :- occurs(a,t). :- not y(t), occurs(a,t). :- y(t), occurs(b,t).",
        lambda word: True,
    ),
    (
        "x(t) :- #sum { 1,1 : y(t); 1,2 : z(t); 1,3 : occurs(a,t) } >= 2. y(t) :- x(t). z(t) :- y(t). :- not y(t).",
        lambda word: not word,
    ),
    # The loop reaches over steps, and back by way of the same step.
    (
        "x(t) :- x(t-1), not occurs(b,t). x(t) :- y(t). y(t) :- x(t), not occurs(b,t). x(t) :- occurs(a,t)."
        ":- y(t), t > 2.",
        lambda word: word[2] == "b",
    ),
]  # fmt: skip


@pytest.mark.parametrize("engine", ["clingo", "sat", pytest.param("sharp", marks=needs_ganak)])
@pytest.mark.parametrize(("rules", "valid"), LOOPS)
def test_rules_that_go_around_hold_nothing_up(engine: str, rules: str, valid: Any) -> None:
    space = TaskSpace(domain_of(TWO + rules), 3, engine=engine)
    expected = [word for word in itertools.product("ab", repeat=3) if valid(word)]
    assert space.count("plan") == space.count("skeleton") == len(expected)
    assert list(space.enumerate("plan")) == expected


REACH = """
node(1..4). link(1,2). link(2,3). link(3,4). link(4,1). link(1,3).
fluent(on(X,Y))                          :- link(X,Y).
initially(on(X,Y),true)                  :- link(X,Y).
action(cut(X,Y))                         :- link(X,Y).
precondition(cut(X,Y),on(X,Y),true)      :- link(X,Y).
postcondition(cut(X,Y),on(X,Y),false)    :- link(X,Y).
#program step(t).
reach(X,Y,t) :- link(X,Y), holds(on(X,Y),true,t).
reach(Y,X,t) :- reach(X,Y,t).
reach(X,Z,t) :- reach(X,Y,t), reach(Y,Z,t).
:- node(X), node(Y), X != Y, not reach(X,Y,t).
"""


@pytest.mark.parametrize("engine", ["sat", pytest.param("sharp", marks=needs_ganak)])
def test_connectivity_by_rules_that_go_around_is_that_of_the_graph(engine: str) -> None:
    """Cut links of a graph one by one while it stays connected; counted here by merging the ends of what is left."""
    links = [(1, 2), (2, 3), (3, 4), (4, 1), (1, 3)]

    def connected(left: set[tuple[int, int]]) -> bool:
        group = {node: node for node in range(1, 5)}
        for x, y in left:
            group = {node: group[x] if of == group[y] else of for node, of in group.items()}
        return len(set(group.values())) == 1

    expected = [
        tuple(f"cut({x},{y})" for x, y in cut)
        for cut in itertools.permutations(sorted(links), 2)
        if all(connected(set(links) - set(cut[: k + 1])) for k in range(2))
    ]
    space = TaskSpace(domain_of(REACH), 2, engine=engine)
    assert space.count("plan") == len(expected) == 16
    assert sorted(space.enumerate("plan")) == sorted(expected)
    assert space.at(3).count("plan") == 0


@pytest.mark.parametrize("engine", ["automaton", "clingo", "sat", pytest.param("sharp", marks=needs_ganak)])
def test_the_edges_of_counting_are_the_same(engine: str) -> None:
    empty = TaskSpace(domain_of("fluent(f)."), 0, engine=engine)
    assert [empty.at(n).count(by) for n in (0, 1, 5) for by in LEVELS] == [1, 1, 1] + [0] * 6
    assert list(empty.enumerate("plan")) == [()]
    broken = domain_of(TWO + "#program base. initially(f,true). implies(f,g). fluent(g). initially(g,false).")
    assert [TaskSpace(broken, n, engine=engine).count("plan") for n in (0, 1, 3)] == [0, 0, 0]
    assert TaskSpace(domain_of(TWO), 1, engine=engine).count("plan", ["a", "a"]) == 0
    single = TaskSpace(domain_of("fluent(f). action(a)."), 3, engine=engine)
    assert single.count("plan") == 1 and list(single.enumerate("plan")) == [("a", "a", "a")]
    with pytest.raises(QueryError, match=r"no plan (or task of this|of) length"):
        next(TaskSpace(broken, 1, engine=engine).sampling(by="plan").draws(seed=0))


def test_two_lengths_of_one_space_can_be_enumerated_in_turns() -> None:
    space = TaskSpace(domain_of(TWO), 2, engine="sat")
    pairs = list(zip(space.enumerate("plan"), space.at(3).enumerate("plan"), strict=False))
    assert [first for first, _ in pairs] == list(itertools.product("ab", repeat=2))
    assert [second for _, second in pairs] == list(islice(itertools.product("ab", repeat=3), 4))


def test_sat_draws_by_weight_with_the_probability_that_it_tells(chance: Chance) -> None:
    space = TaskSpace(domain_of(TWO), 2, engine="sat")
    draws = islice(space.sampling(weights={"a": 3}, by="plan").draws(seed=chance.seed(3)), 3200)
    drawn = [draw.word for draw in draws if draw.probability == Fraction(3) ** draw.word.count("a") / 16]
    assert len(drawn) == 3200
    for word in itertools.product("ab", repeat=2):
        expected = 3200 * 3 ** word.count("a") / 16
        assert abs(drawn.count(word) - expected) < 5 * expected**0.5


@needs_ganak
def test_sharp_draws_different_words_by_their_ranks(ganak: CountModels, chance: Chance) -> None:
    with counting_by(ganak):
        space = TaskSpace(domain_of(TWO), 40, engine="sharp")
        drawn = space.sample(2, seed=chance.seed(5), weights={}, distinct=True)
        assert len({str(task) for task in drawn}) == 2
        assert [space[space.index(task)] for task in drawn] == [replace(task, log_probability=None) for task in drawn]


@pytest.mark.parametrize("engine", ["sat", pytest.param("sharp", marks=needs_ganak)])
def test_an_interrupt_ends_a_count_at_once_and_leaves_no_process(engine: str, tmp_path: Path) -> None:
    command = [sys.executable, "-c", "from prag_asp.cli import main; main()"]
    command += ["count", "tabletop", "--length", "30", "--engine", engine]
    with interruptible(command, tmp_path) as process:
        until_it_works(process)
        until = time.monotonic() + 300
        while engine == "sharp" and not workers(process.pid) and time.monotonic() < until:
            time.sleep(0.05)
        mates = workers(process.pid)
        assert process.poll() is None
        assert len(mates) == (engine == "sharp")
        begun = time.monotonic()
        assert interrupt(process).strip() == "interrupted"
        assert time.monotonic() - begun < 60
        assert process.returncode == 130
    assert gone(mates)


@needs_ganak
def test_the_same_seed_draws_the_same_words_with_every_engine_that_searches(chance: Chance) -> None:
    domain = load_domain("hanoi")
    spaces = [TaskSpace(domain, 4, engine=engine) for engine in ("clingo", "sat", "sharp")]
    uniform = [list(islice(space.sampling(weights={}, by="task").draws(seed=chance.seed(9)), 5)) for space in spaces]
    weighed = [
        list(islice(space.sampling(weights={"move": "1/3"}).draws(seed=chance.seed(9)), 5)) for space in spaces[:2]
    ]
    assert uniform[0] == uniform[1] == uniform[2]
    assert weighed[0] == weighed[1]
