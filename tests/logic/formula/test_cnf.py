"""The clauses of a program have exactly one model for each of its answer sets."""

from __future__ import annotations

import itertools
import re
import weakref
from collections import Counter

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from prag_asp import EngineError, TaskSpace, load_domain
from prag_asp.logic.domain_logic import DomainLogic
from prag_asp.logic.formula.clark_completion import complete
from prag_asp.logic.formula.clause_builder import TRUE, ClauseBuilder
from prag_asp.logic.formula.cnf import dimacs, plan_cnf
from prag_asp.logic.formula.solver import Solver
from prag_asp.logic.ground.program import whole_program
from prag_asp.logic.ground.rules import Rule
from prag_asp.program.finite.components import components
from prag_asp.program.predicates import STEP_NAME
from tests.chance import examples
from tests.domains import domain_of

ATOMS = 5


def models(clauses: list[tuple[int, ...]], variables: int) -> list[list[int]]:
    """Return all models, each variable told apart."""
    found = []
    with Solver(variables, clauses) as solver:
        while solver.satisfiable():
            model = solver.model()
            assert len(model) == variables
            found.append(model)
            solver.add([-literal for literal in model])
    return found


def is_answer_set(rules: list[Rule], true: frozenset[int]) -> bool:
    """Tell whether a set of atoms is a model, and the least model of its reduct."""

    def reached(rule: Rule, positive: frozenset[int]) -> bool:
        weights = rule.weights or (1,) * len(rule.body)
        bound = rule.bound if rule.weights else len(rule.body)
        holds = ((literal in positive) if literal > 0 else (-literal not in true) for literal in rule.body)
        return sum(weight for weight, each in zip(weights, holds, strict=True) if each) >= bound

    for rule in rules:
        if reached(rule, true) and not rule.choice and not true & set(rule.heads):
            return False
    least: frozenset[int] = frozenset()
    while True:
        heads = (set(rule.heads) & true if rule.choice else set(rule.heads) for rule in rules if reached(rule, least))
        more = least.union(*heads)
        if more == least:
            return least == true
        least = more


def answer_sets(rules: list[Rule]) -> set[frozenset[int]]:
    subsets = itertools.chain.from_iterable(itertools.combinations(range(1, ATOMS + 1), k) for k in range(ATOMS + 1))
    return {subset for subset in map(frozenset, subsets) if is_answer_set(rules, subset)}


def check_rules(rules: list[Rule]) -> None:
    completion = complete(rules)
    found = models(completion.clauses.clauses, completion.clauses.variables)
    sets = [
        frozenset(atom for atom, literal in completion.values.items() if model[abs(literal) - 1] == literal)
        for model in found
    ]
    assert Counter(sets) == Counter(answer_sets(rules))


LITERAL = st.integers(1, ATOMS).flatmap(lambda atom: st.sampled_from([atom, atom, -atom]))


@st.composite
def rules(draw: st.DrawFn) -> Rule:
    """Draw a normal rule, a choice or a constraint, with a conjunction or a sum as its body."""
    body = tuple(draw(st.lists(LITERAL, max_size=3)))
    choice = draw(st.integers(0, 3)) == 0
    heads = tuple(draw(st.lists(st.integers(1, ATOMS), min_size=1, max_size=2 if choice else 1, unique=True)))
    if not choice and draw(st.integers(0, 5)) == 0:
        heads = ()
    if body and draw(st.integers(0, 2)) == 0:
        weights = tuple(draw(st.integers(1, 3)) for _ in body)
        return Rule(heads, body, choice, draw(st.integers(1, sum(weights) + 1)), weights)
    return Rule(heads, body, choice)


@settings(max_examples=examples(250))
@given(st.lists(rules(), max_size=12))
def test_random_programs_have_one_model_for_each_answer_set(program: list[Rule]) -> None:
    check_rules(program)


@pytest.mark.parametrize("size", [2, 3, 4, 5])
def test_a_ring_of_atoms_does_not_hold_itself_up(size: int) -> None:
    ring = [Rule((atom % size + 1,), (atom,)) for atom in range(1, size + 1)]
    assert answer_sets(ring) == {frozenset()}
    check_rules(ring)
    check_rules([*ring, Rule((1,), (), choice=True)])
    check_rules([*ring, Rule((1,), (-2,))])


def test_a_ring_that_each_member_may_begin_counts_once_whoever_begins() -> None:
    ring = [Rule((1,), (2,)), Rule((2,), (3,)), Rule((3,), (1,)), Rule((1,), (4,)), Rule((3,), (5,))]
    program = [*ring, Rule((4, 5), (), choice=True)]
    assert len(answer_sets(program)) == 4
    check_rules(program)


def test_an_atom_that_was_not_chosen_begins_nothing() -> None:
    ring = [Rule((2,), (3,)), Rule((3,), (2,)), Rule((2,), (1,))]
    program = [*ring, Rule((1,), (), choice=True), Rule((1,), (3,), choice=True)]
    assert answer_sets(program) == {frozenset(), frozenset({1, 2, 3})}
    check_rules(program)


@settings(max_examples=examples(120))
@given(st.lists(st.tuples(st.integers(1, 4), st.integers(1, 5), st.booleans()), max_size=7), st.integers(-1, 20))
def test_a_sum_is_a_function_of_its_literals(terms: list[tuple[int, int, bool]], bound: int) -> None:
    clauses = ClauseBuilder()
    inputs = [clauses.fresh() for _ in range(4)]
    literals = [inputs[number - 1] * (1 if positive else -1) for number, _, positive in terms]
    output = clauses.at_least(bound, literals, [weight for _, weight, _ in terms])
    found = models(clauses.clauses, clauses.variables)
    assert len(found) == 2 ** len(inputs)
    for model in found:
        total = sum(weight for literal, (_, weight, _) in zip(literals, terms, strict=True) if literal in model)
        assert (output in model) == (total >= bound)


def test_constants_leave_gates_without_variables() -> None:
    clauses = ClauseBuilder()
    one = clauses.fresh()
    assert clauses.all_of([]) == clauses.any_of([one, TRUE]) == clauses.any_of([one, -one]) == TRUE
    assert clauses.any_of([]) == clauses.all_of([one, -TRUE]) == clauses.at_least(3, [one], [2]) == -TRUE
    assert clauses.all_of([one, TRUE, one]) == clauses.at_least(1, [one, -TRUE], [1, 7]) == one
    assert (clauses.variables, clauses.clauses) == (2, [(TRUE,)])


def test_no_clause_is_ever_empty() -> None:
    completion = complete([Rule((), ())])
    assert all(completion.clauses.clauses)
    assert models(completion.clauses.clauses, 1) == []


@settings(max_examples=examples(120))
@given(st.dictionaries(st.integers(0, 6), st.lists(st.integers(0, 6), max_size=4), max_size=7))
def test_components_are_the_classes_of_mutual_reach_in_order_of_dependency(graph: dict[int, list[int]]) -> None:
    reach = {(a, a) for a in graph} | {(a, b) for a in graph for b in graph[a] if b in graph}
    for _ in graph:
        reach |= {(a, d) for a, b in reach for c, d in reach if b == c}
    found = [frozenset(component) for component in components(graph, lambda a: (b for b in graph[a] if b in graph))]
    assert set(found) == {frozenset(b for b in graph if (a, b) in reach and (b, a) in reach) for a in graph}
    assert sum(map(len, found)) == len(graph)
    place = {node: number for number, component in enumerate(found) for node in component}
    assert all(place[b] <= place[a] for a, b in reach)


LINES = "fluent(f). action(a). action(b). postcondition(a,f,true). postcondition(b,f,false)."
REFUSED = [
    ("x(t) ; y(t).", "disjunction"),
    ("#external x(t). [true]", "external"),
    ("#external x(t). [free]", "external"),
    ("#minimize { 1 : occurs(a,t) }.", "minimizes"),
    ("#edge (f,a) : occurs(a,t).", "acyclic"),
    ("#theory none { term { - : 0, unary }; &none/0 : term, any }. &none { } :- occurs(a,t).", "theory"),
]


@pytest.mark.parametrize(("rule", "reason"), REFUSED)
def test_what_has_no_counterpart_in_clauses_is_refused_with_its_name(rule: str, reason: str) -> None:
    domain = domain_of(f"{LINES} #program step(t). {rule}")
    with pytest.raises(EngineError, match=reason):
        plan_cnf(whole_program(domain), 2)


def test_an_external_atom_that_is_false_is_just_false() -> None:
    domain = domain_of(f"{LINES} #program step(t). #external x(t). :- not x(t), occurs(a,t).")
    cnf = plan_cnf(whole_program(domain), 3)
    assert len(models(list(cnf.clauses), cnf.variables)) == 1


@pytest.mark.parametrize(("name", "length", "plans"), [("blocks", 3, 52), ("hanoi", 4, 46), ("prag", 2, 356)])
def test_dimacs_says_how_many_plans_there_are_and_what_they_are(name: str, length: int, plans: int) -> None:
    lines = list(dimacs(plan_cnf(DomainLogic(load_domain(name)).program, length), ["a comment"]))
    assert lines[0] == "c a comment"
    assert words_of(lines, length) == plans


def test_a_formula_in_use_is_made_once_and_goes_with_its_last_user() -> None:
    domain = domain_of(LINES)
    plans = plan_cnf(whole_program(domain), 2)
    skeletons = plan_cnf(whole_program(domain), 2, STEP_NAME)
    assert plan_cnf(whole_program(domain), 2) is plans
    assert skeletons.clauses is plans.clauses
    assert skeletons.shown != plans.shown
    assert plan_cnf(whole_program(domain), 1) is not plans
    assert plan_cnf(whole_program(domain_of(f"{LINES} class(more).")), 2) is not plans
    gone = weakref.ref(plans)
    del plans
    assert plan_cnf(whole_program(domain), 2) is gone()  # the formula of skeletons is in use
    del skeletons
    assert gone() is None


@pytest.mark.parametrize("condition", ["uses apple", "has at least 1 grasp", "loop-free", "ends holding(panda,can_1)"])
def test_the_formula_of_a_space_has_its_condition(condition: str) -> None:
    whole = TaskSpace(load_domain("prag"), 2)
    space = whole.where(condition)
    lines = list(space.dimacs())
    assert lines[0] == f"c the tasks of prag of length 2, where {condition}, by prag_asp"
    assert 0 < words_of(lines, 2) == space.count() < whole.count("plan")


def words_of(lines: list[str], length: int) -> int:
    """Return how many words the text of a formula has, each a model once projected on what is shown."""
    (header,) = (line.split() for line in lines if line.startswith("p "))
    (shown,) = (list(map(int, line.split()[3:])) for line in lines if line.startswith("c p show "))
    names = {int(found[1]): found[2] for line in lines if (found := re.fullmatch(r"c (\d+) (\S+)", line))}
    clauses = [tuple(map(int, line.split())) for line in lines if line[0] not in "cp"]
    variables = max(abs(literal) for clause in clauses for literal in clause)
    assert header == ["p", "cnf", str(variables), str(len(clauses))]
    assert shown.pop() == 0 and all(clause[-1] == 0 and 0 not in clause[:-1] for clause in clauses)
    found = models([clause[:-1] for clause in clauses], variables)
    words = {tuple(sorted(names[v] for v in shown if v in model)) for model in map(set, found)}
    assert len(found) == len(words)
    assert all(len(word) == length and all(atom.startswith("occurs(") for atom in word) for word in words)
    return len(words)
