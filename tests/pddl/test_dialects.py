"""Files as others write them: nested effects, names of all kinds, numbers, and what is declared and not used."""

from __future__ import annotations

import random
from itertools import product
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis.strategies import integers

from prag_asp import DomainError, load_domain
from prag_asp.pddl import read
from tests.chance import examples
from tests.pddl.forward import Search
from tests.pddl.imports import check_plans, counts, searched, written

SWITCHES = """(define (domain switches) (:requirements :adl) (:types lamp)
 (:predicates (on ?x - lamp) (wire ?x ?y - lamp) (power))
 (:action press :parameters (?x - lamp) :precondition (or (power) (not (on ?x))) :effect {0})
 (:action flip :parameters (?x ?y - lamp) :precondition (wire ?x ?y) :effect {1}))"""
LAMPS = """(define (problem p) (:domain switches) (:objects a b - lamp)
 (:init (wire a b) (wire b a) (on a)) (:goal (and (on b) (not (power)))))"""


def effect(draw: random.Random, variables: list[str], depth: int) -> str:
    """Return a random effect, with ``and``, ``when`` and ``forall`` nested in each other."""
    kind = draw.choice(["and", "when", "forall", "atom"] if depth else ["atom"])
    if kind == "and":
        return f"(and {' '.join(effect(draw, variables, depth - 1) for _ in range(draw.randint(0, 3)))})"
    if kind == "when":
        return f"(when {condition(draw, variables, 2)} {effect(draw, variables, depth - 1)})"
    if kind == "forall":
        new = f"?v{len(variables)}"
        return f"(forall ({new} - lamp) {effect(draw, [*variables, new], depth - 1)})"
    atom = draw.choice(["(power)", f"(on {draw.choice(variables)})", f"(on {draw.choice(variables)})"])
    return draw.choice([atom, f"(not {atom})"])


def condition(draw: random.Random, variables: list[str], depth: int) -> str:
    kind = draw.choice(["and", "or", "not", "forall", "atom"] if depth else ["atom"])
    if kind in ("and", "or"):
        return f"({kind} {' '.join(condition(draw, variables, depth - 1) for _ in range(draw.randint(0, 2)))})"
    if kind == "not":
        return f"(not {condition(draw, variables, depth - 1)})"
    if kind == "forall":
        new = f"?w{len(variables)}"
        return f"(forall ({new} - lamp) {condition(draw, [*variables, new], depth - 1)})"
    one, other = draw.choice(variables), draw.choice(variables)
    return draw.choice(["(power)", f"(on {one})", f"(wire {one} {other})", f"(= {one} {other})"])


@settings(max_examples=examples(25))
@given(seed=integers(0, 10**6))
def test_effects_nested_at_will_have_the_plans_of_a_forward_search(seed: int, folder: Path) -> None:
    draw = random.Random(seed)
    effects = (effect(draw, ["?x"], 3), effect(draw, ["?x", "?y"], 3))
    check_plans(folder, SWITCHES.format(*effects), LAMPS, automaton=3)


@pytest.mark.parametrize(
    "name",
    ["1", "1st", "_x", "a.b", "a@b", "a+b", "a|b", "a/b", "a:b", "a'", "a#1", "0-0", "x_", "-1x", "not", "t", "été"],
)
def test_names_of_all_kinds_are_names(name: str, tmp_path: Path) -> None:
    if name == "-1x":
        name = "x-1"
    domain = f"""(define (domain {name}) (:types {name}) (:predicates (p{name} ?{name} - {name}) (q-{name} ?x ?y))
     (:action {name} :parameters (?{name} ?y - {name})
      :precondition (and (p{name} ?{name}) (q-{name} ?{name} ?y))
      :effect (and (p{name} ?y) (not (p{name} ?{name})))))"""
    problem = f"""(define (problem {name}) (:domain {name}) (:objects {name} 2{name} - {name})
     (:init (p{name} {name}) (q-{name} {name} 2{name}) (q-{name} 2{name} {name})) (:goal (p{name} 2{name})))"""
    loaded = check_plans(tmp_path, domain, problem, automaton=3)
    assert counts(loaded, 3) == [0, 1, 0, 1]
    found = read(tmp_path / "domain.pddl", tmp_path / "problem.pddl")
    steps = {found.step(each.name, [str(term) for term in each.arguments]) for each in loaded.facts.actions}
    assert steps == {f"({name} {name} 2{name})", f"({name} 2{name} {name})"}


def test_a_name_is_kept_apart_from_one_that_looks_alike(tmp_path: Path) -> None:
    domain = "(define (domain d) (:predicates (p ?x)) (:action a :parameters (?x) :effect (p ?x)))"
    problem = "(define (problem e) (:domain d) (:objects a.b a_b a-b a@b) (:init) (:goal (and (p a.b) (not (p a_b)))))"
    check_plans(tmp_path, domain, problem, automaton=3)


SIZES = """(define (domain d) (:types ring) (:predicates (on ?x ?y - ring) (free ?x) (flag))
 (:functions (size ?x) (slack) (far ?x ?y) (steps) (total-cost)) {}
 (:action put :parameters (?x ?y - ring) :precondition (and (free ?x) (free ?y) {})
  :effect (and (on ?x ?y) (not (free ?y)) (increase (steps) 1) (assign (slack2) (size ?x)))))"""
RINGS = """(define (problem e) (:domain d) (:objects a b c - ring)
 (:init (free a) (free b) (free c) (= (size a) 1) (= (size b) 2.5) (= (size c) -3) (= (slack) 0.5) (= (steps) 0)
  (= (far a b) 2) (= (far b c) 3)) (:goal {}))"""


@pytest.mark.parametrize(
    "condition",
    [
        "(< (size ?x) (size ?y))",
        "(not (< (size ?x) (size ?y)))",
        "(>= (size ?x) (slack))",
        "(= (size ?x) 2.5)",
        "(not (= (size ?x) -3))",
        "(> (+ (size ?x) (slack)) (* 2 (size ?y)))",
        "(< (far ?x ?y) 3)",
        "(or (flag) (<= (far ?x ?y) (size ?y)))",
        "(forall (?z - ring) (or (= ?z ?x) (> (size ?z) (size ?x))))",
        "(exists (?z - ring) (and (> (size ?z) (size ?x)) (not (= ?z ?y))))",
        "(< 1 2)",
        "(< (slack) 0)",
    ],
)
def test_numbers_that_no_action_changes_are_compared(condition: str, tmp_path: Path) -> None:
    domain = SIZES.format("", condition).replace("(slack)", "(slack) (slack2)", 1)
    for goal in ("(and)", "(exists (?x ?y) (and (on ?x ?y) (> (size ?x) (size ?y))))"):
        loaded = check_plans(tmp_path, domain, RINGS.format(goal), automaton=3, clingo=2)
        assert [each.text.split(",")[0] for each in loaded.warnings if each.name == "ignored"] == [
            "no condition reads the function steps",
            "no condition reads the function slack2",
        ]


PLAIN = """(define (domain d) (:requirements {}) (:types room) (:predicates (in ?m - room) (door ?a ?b - room) {})
 (:action go :parameters (?a ?b - {}) :precondition (and (in ?a) (door ?a ?b)) :effect (and (in ?b) (not (in ?a)))))"""
ROOMS = """(define (problem e) (:domain d) (:objects hall bath - room)
 (:init (in hall) (door hall bath) (door bath hall))
 (:goal (in bath)))"""


@pytest.mark.parametrize(
    ("requirement", "predicate", "kind", "warning"),
    [
        (":strips :typing", "", "room", None),
        (":durative-actions", "", "room", "the requirement :durative-actions is ignored"),
        (":negative_preconditions", "", "room", "the requirement :negative_preconditions is ignored"),
        (":strips", "(in ?m - room)", "room", "the predicate in is declared twice in the same way"),
        (":strips", "", "(either room zzz)", "the type zzz is not declared"),
    ],
)
def test_what_is_declared_otherwise_than_needed_is_read_with_a_warning(
    requirement: str, predicate: str, kind: str, warning: str | None, tmp_path: Path
) -> None:
    loaded = load_domain(*written(tmp_path, PLAIN.format(requirement, predicate, kind), ROOMS))
    assert counts(loaded, 3) == [0, 1, 0, 1]
    texts = [each.text for each in loaded.warnings if each.name in ("ignored", "no-effect", "undeclared")]
    assert [text.split(";")[0] for text in texts] == ([warning] if warning else [])
    if warning:
        with pytest.raises(DomainError, match=warning):
            load_domain(tmp_path / "domain.pddl", tmp_path / "problem.pddl", strict=True)


def test_a_predicate_of_another_signature_is_no_second_declaration(tmp_path: Path) -> None:
    with pytest.raises(DomainError, match="the predicate in is declared twice; remove one, or rename it"):
        read(*written(tmp_path, PLAIN.format(":strips", "(in ?m)", "room"), ROOMS))


def test_an_object_of_the_problem_may_be_named_in_the_domain(tmp_path: Path) -> None:
    domain = """(define (domain d) (:types tool nut) (:predicates (have ?t - tool) (loose ?n - nut))
     (:action take :parameters (?t - tool) :effect (have ?t))
     (:action turn :parameters (?n - nut) :precondition (have spanner) :effect (loose ?n)))"""
    problem = "(define (problem e) (:domain d) (:objects spanner jack - tool n - nut) (:init) (:goal (loose n)))"
    check_plans(tmp_path, domain, problem, automaton=4)


def test_schemas_that_share_a_name_are_all_actions(tmp_path: Path) -> None:
    domain = """(define (domain d) (:predicates (p ?x) (q ?x)) (:action go :parameters (?x) :effect (p ?x))
     (:action go :parameters (?x) :precondition (p ?x) :effect (q ?x)) (:action go-2 :parameters () :effect (p a)))"""
    problem = "(define (problem e) (:domain d) (:objects a b) (:init) (:goal (q a)))"
    loaded = load_domain(*written(tmp_path, domain, problem))
    assert counts(loaded, 3) == searched(domain, problem, 3)
    found = read(tmp_path / "domain.pddl", tmp_path / "problem.pddl")
    assert [found.step(name, ["a"] if name != "go_2" else []) for name in found.actions] == [
        "(go a)", "(go a)", "(go-2)"
    ]  # fmt: skip


def test_a_domain_without_predicates_declares_them_by_use(tmp_path: Path) -> None:
    domain = "(define (domain d) (:action a :parameters (?x) :precondition (p ?x) :effect (q ?x)))"
    problem = "(define (problem e) (:domain d) (:objects o) (:init (p o)) (:goal (q o)))"
    loaded = check_plans(tmp_path, domain, problem, automaton=2)
    assert [each.name for each in loaded.warnings] == ["undeclared", "undeclared"]


def test_an_object_may_be_of_either_type(tmp_path: Path) -> None:
    domain = """(define (domain d) (:types cup lid - thing pot - (either cup lid)) (:predicates (p ?x) (q ?x))
     (:action fill :parameters (?c - cup) :effect (p ?c)) (:action close :parameters (?l - lid) :effect (q ?l)))"""
    problem = """(define (problem e) (:domain d) (:objects c - cup x - (either cup lid) y -pot) (:init)
     (:goal (and (p x) (q x))))"""
    loaded = load_domain(*written(tmp_path, domain, problem))
    assert sorted(map(str, loaded.facts.actions)) == ["close(x)", "close(y)", "fill(c)", "fill(x)", "fill(y)"]


def test_a_domain_and_its_problem_may_share_a_file(tmp_path: Path) -> None:
    both = tmp_path / "both.pddl"
    both.write_text(f"{PLAIN.format(':strips', '', 'room')}\n{ROOMS}")
    assert counts(load_domain(both), 3) == counts(load_domain(both, both), 3) == [0, 1, 0, 1]


TIMED = """(define (domain d) (:types match fuse)
 (:predicates (light ?m - match) (lit) (used ?m - match) (mended ?f - fuse) (hand) (at-wall ?f))
 (:functions (length ?m))
 (:durative-action strike :parameters (?m - match) :duration (<= ?duration (length ?m))
  :condition (and (at start (not (used ?m))) (over all (light ?m)))
  :effect (and (at start (used ?m)) (at start (light ?m)) (at start (lit)) (at end (not (light ?m))) (at end (lit))))
 (:durative-action mend :parameters (?f ?g - fuse) :duration (= ?duration 2)
  :condition (and (at start (hand)) (over all (lit)) (at end (not (hand))))
  :effect (and (at start (not (hand))) (at start (at-wall ?f)) (at end (not (at-wall ?g))) (at end (hand))
   (at end (mended ?f)) (at end (when (at-wall ?g) (mended ?g))))))"""
AT_ONCE = """(define (domain d) (:types match fuse)
 (:predicates (light ?m - match) (lit) (used ?m - match) (mended ?f - fuse) (hand) (at-wall ?f))
 (:action strike :parameters (?m - match) :precondition (not (used ?m))
  :effect (and (used ?m) (lit) (not (light ?m))))
 (:action mend :parameters (?f ?g - fuse) :precondition (and (hand) (lit))
  :effect (and (when (not (= ?f ?g)) (at-wall ?f)) (not (at-wall ?g)) (mended ?f)
   (when (or (= ?f ?g) (at-wall ?g)) (mended ?g)))))"""
FUSES = """(define (problem e) (:domain d) (:objects m n - match f g - fuse) (:init (hand) (at-wall g))
 (:goal (and {} (mended f) (not (light m)))))"""


@pytest.mark.parametrize("goal", ["(at-wall f)", "(mended g)", "(not (at-wall f))", "(hand)"])
def test_untimed_actions_do_what_they_do_from_start_to_end(goal: str, tmp_path: Path) -> None:
    problem = FUSES.format(goal)
    loaded = load_domain(*written(tmp_path, TIMED, problem), untimed=True)
    assert counts(loaded, 4) == Search(AT_ONCE, problem).count(4)
    assert any("read as instantaneous ones" in each.text for each in loaded.warnings)
    with pytest.raises(DomainError, match=r"domain.pddl:4: :durative-action: .*; give --untimed to import it"):
        read(tmp_path / "domain.pddl", tmp_path / "problem.pddl")


def test_preferences_and_the_name_of_the_domain_are_ignored_with_a_warning(tmp_path: Path) -> None:
    soft = "(preference far (sometime (in hall)))"
    domain = PLAIN.format(":strips", "", "room").replace(
        ":precondition (and", ":precondition (and (preference (in bath)) (forall (?r - room) (preference x (in ?r)))"
    )
    problem = ROOMS.replace("(:goal (in bath))", f"(:constraints (and {soft} {soft})) (:goal (and (in bath) {soft}))")
    loaded = load_domain(*written(tmp_path, domain, problem.replace("(:domain d)", "(:domain dd)")))
    assert counts(loaded, 3) == Search(PLAIN.format(":strips", "", "room"), ROOMS).count(3) == [0, 1, 0, 1]
    texts = [each.text for each in loaded.warnings]
    assert texts.count("preferences are ignored: plans need not meet them") == 5
    assert [each for each in texts if "problem of" in each] == [
        "this is a problem of dd, not of d; give the domain that it belongs to, or fix the name"
    ]


def test_names_of_objects_may_begin_with_a_sign(folder: Path) -> None:
    domain = """(define (domain walk) (:requirements :strips :typing) (:types spot)
 (:predicates (at ?x - spot) (next ?a ?b - spot))
 (:action go :parameters (?a ?b -spot) :precondition (and (at ?a) (next ?a ?b)) :effect (and (not (at ?a)) (at ?b))))"""
    problem = """(define (problem p) (:domain walk) (:objects -a +1 -1 c -b - spot d -spot)
 (:init (at -a) (next -a +1) (next +1 -1) (next -1 -a) (next -1 c) (next c -b) (next -b d) (next d -a))
 (:goal (at -b)))"""
    plain = {"-a": "minus_a", "+1": "plus_1", "-1": "minus_1", "-b": "minus_b", "-spot": "- spot"}
    texts = [text.replace("(", " ( ").replace(")", " ) ").split() for text in (domain, problem)]
    expected = searched(*(" ".join(plain.get(word, word) for word in text) for text in texts), 10)
    assert counts(load_domain(*written(folder, domain, problem)), 10) == expected
    assert sum(expected)


def test_an_effect_at_the_end_may_have_a_condition_at_the_start(tmp_path: Path) -> None:
    """The condition is read before the effects at the start, even if these change what it reads."""
    timed = """(define (domain d) (:predicates (full) (lamp) (warm) (cold) (on))
 (:durative-action burn :parameters () :duration (= ?duration 3) :condition (at start (on))
  :effect (and (at start (not (full))) (at start (lamp)) (when (at start (full)) (at end (warm)))
   (when (and (at start (not (full))) (over all (lamp)) (at end (not (full)))) (at end (cold)))
   (when (and (at start (lamp)) (at end (lamp))) (at end (not (lamp))))))
 (:durative-action switch :parameters () :duration (= ?duration 1) :condition (at start (not (on)))
  :effect (at end (on))))"""
    plain = """(define (domain d) (:predicates (full) (lamp) (warm) (cold) (on))
 (:action burn :parameters () :precondition (on)
  :effect (and (not (full)) (when (not (lamp)) (lamp)) (when (full) (warm)) (when (not (full)) (cold))
   (when (lamp) (not (lamp)))))
 (:action switch :parameters () :precondition (not (on)) :effect (on)))"""
    for facts, goal in product(["", "(full)", "(lamp)", "(full) (lamp) (on)"], ["(warm)", "(cold)", "(lamp)"]):
        problem = f"(define (problem e) (:domain d) (:init {facts}) (:goal {goal}))"
        loaded = load_domain(*written(tmp_path, timed, problem), untimed=True)
        assert counts(loaded, 4) == Search(plain, problem).count(4)


@pytest.mark.parametrize(
    ("effect", "text"),
    [
        (
            "(when (at end (p)) (at start (q)))",
            "an effect at the start has a condition over all or at the end, which is ",
        ),
        (
            "(at end (when (at start (p)) (q)))",
            r"\(at start \.\.\.\) is not expected inside \(at end \.\.\.\); give the ",
        ),
        (
            "(at end (when (p) (at end (q))))",
            r"\(at end \.\.\.\) is not expected inside \(at end \.\.\.\); give the ef",
        ),
    ],
)
def test_effects_whose_times_contradict_each_other_are_refused(effect: str, text: str, tmp_path: Path) -> None:
    domain = f"""(define (domain d) (:predicates (p) (q))
 (:durative-action go :parameters () :duration (= ?duration 3) :condition (at start (p))
  :effect {effect}))"""
    with pytest.raises(DomainError, match=f"domain.pddl:3: {text}"):
        load_domain(
            *written(tmp_path, domain, "(define (problem e) (:domain d) (:init (p)) (:goal (q)))"), untimed=True
        )
