"""Imported problems of BDDL have just the plans that a forward search over their facts finds."""

from __future__ import annotations

import random
from collections.abc import Iterator, Mapping
from itertools import product
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis.strategies import integers

from prag_asp import DomainError, TaskSpace, load_domain
from prag_asp.bddl import BddlFact, BddlFormula, BddlProblem, Connective, Quantifier, bddl_text, read_suite
from tests.bddl.problems import CAMP, TIDY
from tests.chance import examples
from tests.commands import run

State = frozenset[tuple[str, ...]]
OBJECTS = {"mug_1": "mug", "mug_2": "mug", "box_1": "box"}
FIXTURES = {"table": "table", "stove_1": "stove"}


def true(formula: BddlFormula, state: State, members: Mapping[str, list[str]], scope: Mapping[str, str]) -> bool:
    """Return whether a formula is true, by its definition."""
    if isinstance(formula, BddlFact):
        return (formula.predicate, *(scope.get(term[1:], term) for term in formula.terms)) in state
    if isinstance(formula, Connective):
        values = [true(part, state, members, scope) for part in formula.parts]
        meaning = {"and": all(values), "or": any(values)}
        return meaning[formula.kind] if formula.kind in meaning else not values[0] or (values[-1] and len(values) == 2)
    names = [name for name, _ in formula.variables]
    values_of = {
        chosen: true(formula.part, state, members, {**scope, **dict(zip(names, chosen, strict=True))})
        for chosen in product(*(members.get(kind, []) for _, kind in formula.variables))
    }
    if formula.kind in ("forall", "exists"):
        return (all if formula.kind == "forall" else any)(values_of.values())
    if formula.kind == "forn":
        return sum(values_of.values()) == formula.number
    found = [pair for pair, value in values_of.items() if value and pair[0] != pair[1]]
    number = formula.number
    if number is None:
        number = min(len(members.get(kind, [])) for _, kind in formula.variables)
    return len({one for one, _ in found}) >= number and len({other for _, other in found}) >= number


def steps(state: State) -> Iterator[State]:
    """Yield what each possible action makes of a state: one hand, open boxes, and nothing on what is carried."""
    held = next((fact[1] for fact in state if fact[0] == "holding"), None)
    places = {fact[1]: fact for fact in state if fact[0] in ("on", "in")}

    def is_open(place: str) -> bool:
        return place != "box_1" or ("open", "box_1") in state

    if held:
        for place in ("table", "stove_1", "mug_1", "mug_2"):
            if place != held:
                yield state - {("holding", held)} | {("on", held, place)}
        if held != "box_1" and is_open("box_1"):
            yield state - {("holding", held)} | {("in", held, "box_1")}
        return
    for name, fact in places.items():
        if name not in {each[2] for each in places.values()} and (fact[0] == "on" or is_open(fact[2])):
            yield state - {fact} | {("holding", name)}
    for switch in (("open", "box_1"), ("turnon", "stove_1")):
        yield state ^ {switch}


def count(problem: BddlProblem, length: int) -> list[int]:
    """Return the numbers of plans up to a length, by going through all sequences of actions."""
    members: dict[str, list[str]] = {}
    for name, kind in problem.classes.items():
        members.setdefault(kind, []).append(name)
    states, counts = [frozenset((fact.predicate, *fact.terms) for fact, value in problem.initial if value)], []
    for _ in range(length + 1):
        counts.append(sum(true(problem.goal, state, members, {}) for state in states))
        states = [after for state in states for after in steps(state)]
    return counts


def random_problem(seed: int) -> BddlProblem:
    """Return a problem with two mugs, a box with a lid, a table and a stove, in which every relation occurs."""
    chance = random.Random(seed)
    places = [("on", "table"), ("on", "stove_1"), ("in", "box_1"), ("on", "mug_2")]
    box = chance.choice(places[:2])
    first = chance.choice(places)
    second = chance.choice(places[:3])
    initial = [("mug_1", *first), ("mug_2", *second), ("box_1", *box)]
    facts = [(BddlFact(relation, (name, place)), True) for name, relation, place in initial]
    facts += [(BddlFact(*each), chance.random() < 0.5) for each in (("open", ("box_1",)), ("turnon", ("stove_1",)))]

    def formula(depth: int, scope: tuple[str, ...] = ()) -> BddlFormula:
        kind = chance.choice(["fact", "and", "or", "not", "imply", "forall", "exists", "forn", "forpairs", "fornpairs"])
        if kind == "fact" or not depth:
            if chance.random() < 0.25:
                return chance.choice([BddlFact("open", ("box_1",)), BddlFact("turnon", ("stove_1",))])
            relation, place = chance.choice(places)
            names = [
                name for name in ("mug_1", "mug_2", "box_1") if name != place and (name, place) != ("box_1", "mug_2")
            ]
            return BddlFact(relation, (chance.choice([*names, *(f"?{each}" for each in scope)]), place))
        if kind in ("and", "or", "not", "imply"):
            size = {"not": 1, "imply": 2}.get(kind) or chance.randrange(3)
            return Connective(kind, tuple(formula(depth - 1, scope) for _ in range(size)))
        variables = (
            [(f"x{depth}", "mug")] if kind[3:] != "pairs" and "pairs" not in kind else [("a", "mug"), ("b", "box")]
        )
        part = formula(depth - 1, (*scope, variables[0][0]))
        number = {"forn": chance.randrange(3), "fornpairs": chance.randrange(1, 3)}.get(kind)
        return Quantifier(kind, tuple(variables), part, number)

    shown = [BddlFact(relation, ("mug_1", place)) for relation, place in places]
    every = [*shown, BddlFact("on", ("box_1", "table")), BddlFact("open", ("box_1",)), BddlFact("turnon", ("stove_1",))]
    harmless = Connective("or", (Connective("and", ()), *every))
    goal = Connective("and", (formula(3), harmless))
    return BddlProblem("random", "robosuite", "", OBJECTS, FIXTURES, (), (), tuple(facts), goal)


@settings(max_examples=examples(8))
@given(seed=integers(0, 10**6))
def test_imported_problems_have_the_plans_of_a_forward_search(seed: int, folder: Path) -> None:
    problem = random_problem(seed)
    path = folder / "random.bddl"
    path.write_text(bddl_text(problem))
    texts = read_suite(path).files()
    for name, text in texts.items():
        (folder / name).write_text(text)
    space = TaskSpace(load_domain(folder), range(4))
    assert [space.at(length).count("plan") for length in range(4)] == count(problem, 3)


def test_a_folder_becomes_one_domain_whose_problems_a_constant_selects(tmp_path: Path) -> None:
    (tmp_path / "suite").mkdir()
    (tmp_path / "suite" / "Tidy it.bddl").write_text(TIDY)
    (tmp_path / "suite" / "other.bddl").write_text(TIDY.replace("(And (In mug_1 white_drawer_1_top_region) ", "(And "))
    done = run("import", "suite", "-o", "new", cwd=tmp_path)
    assert (done.returncode, done.stdout) == (0, "tidy_it\nother\n")
    counts = {
        name: [
            TaskSpace(load_domain(tmp_path / "new", constants={"problem": name}), length).count() for length in range(4)
        ]
        for name in ("tidy_it", "other")
    }
    assert counts == {"tidy_it": [0, 0, 0, 1], "other": [0, 1, 3, 16]}
    shown = run("sample", "new", "-n", "3", "--count", "1", "--seed", "1", "--where", "uses mug", cwd=tmp_path)
    assert "put_in(mug_1,white_drawer_1_top_region) close(white_drawer_1_top_region)" in shown.stdout
    assert load_domain(tmp_path / "new").warnings == ()
    explained = run("explain", "new", "pick_up(mug_1,kitchen_table_right_region)", cwd=tmp_path)
    assert "it needs on(mug_1,kitchen_table_right_region) to be true" in explained.stdout


def test_names_of_behavior_become_names_of_the_program(tmp_path: Path) -> None:
    (tmp_path / "camp.bddl").write_text(CAMP)
    assert run("import", "camp.bddl", "-o", "camp", cwd=tmp_path).returncode == 0
    space = TaskSpace(load_domain(tmp_path / "camp"), 8)
    (task,) = space.sample(1, seed=0)
    assert [action.name for action in task.actions].count("put_in") >= 2
    assert task.entities["bottle_n_01_1"] == "bottle_n_01"


def test_furniture_moves_only_where_the_goal_places_it(tmp_path: Path) -> None:
    path = tmp_path / "camp.bddl"
    path.write_text(CAMP)
    (camp,) = read_suite(path).problems.values()
    assert camp.movable == {"bottle.n.01_1", "bottle.n.01_2", "crate.n.02_1", "crate.n.02_2"}
    path.write_text(CAMP.replace("(inroom floor.n.01_1", "(inroom crate.n.02_1 garage) (inroom bottle.n.01_1"))
    (camp,) = read_suite(path).problems.values()
    assert "crate.n.02_1" in camp.movable


@pytest.mark.parametrize("fact", ["(toggled_on crate.n.02_1)", "(cooked bottle.n.01_1)", "(open crate.n.02_1)"])
def test_a_problem_with_few_predicates_has_no_warnings(fact: str, tmp_path: Path) -> None:
    objects = "(:objects bottle.n.01_1 - bottle.n.01 crate.n.02_1 - crate.n.02)"
    text = (
        f"(define (problem p) (:domain omnigibson) {objects} (:init (ontop bottle.n.01_1 crate.n.02_1)) (:goal {fact}))"
    )
    (tmp_path / "p.bddl").write_text(text)
    assert run("import", "p.bddl", "-o", "new", cwd=tmp_path).returncode == 0
    domain = load_domain(tmp_path / "new")
    assert (domain.warnings, TaskSpace(domain, 1).count()) == ((), 1)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("(define (problem p) (:goal (on a b)))", "one.bddl:1: a is not an object, fixture or region"),
        (TIDY.replace("(On mug_2 ", "(On mug_3 "), "one.bddl:33: mug_3 is not an object"),
    ],
)
def test_what_a_problem_does_not_declare_is_refused_with_its_line(text: str, message: str, tmp_path: Path) -> None:
    (tmp_path / "one.bddl").write_text(text)
    with pytest.raises(DomainError, match=message):
        read_suite(tmp_path)


def test_all_mistakes_of_a_folder_are_named(tmp_path: Path) -> None:
    for name in ("a.bddl", "b.bddl"):
        (tmp_path / name).write_text("(define (problem p))")
    with pytest.raises(DomainError) as caught:
        read_suite(tmp_path)
    assert len(caught.value.lines) == 2
    (tmp_path / "empty").mkdir()
    with pytest.raises(DomainError, match=r"no file in this folder ends in \.bddl"):
        read_suite(tmp_path / "empty")
