"""Random files that combine what other people's files do, beside plain ones with the same plans.

Each has names with marks, requirements that nothing uses, a parent of either type, a predicate declared twice, costs
that no condition reads, constants below 0 that are compared, schemas of one name, an object of the problem in the
domain, nested effects and a durative action; some are in one file.
"""

from __future__ import annotations

from pathlib import Path
from random import Random

from hypothesis import given, settings
from hypothesis.strategies import integers

from prag_asp import load_domain
from tests.chance import examples
from tests.pddl.forward import Search
from tests.pddl.imports import counts

MARKS = ("", "1", "_", "0-", "x.", "q@", "z+", "k/", "v'", "n#")
REQUIREMENTS = (":strips", ":durative-actions", ":preferences", ":foo", ":negative_preconditions", ":time", ":adl")
OBJECTS = ("u", "v", "w")
VARIABLES = ("?x", "?y")


def atom(draw: Random, mark: str, terms: tuple[str, ...]) -> str:
    name, arity = draw.choice([("p", 1), ("q", 2), ("s", 0)])
    return f"({mark}{name}{''.join(f' {draw.choice(terms)}' for _ in range(arity))})"


def literal(draw: Random, mark: str, terms: tuple[str, ...]) -> str:
    found = atom(draw, mark, terms)
    return draw.choice([found, f"(not {found})"])


def comparison(draw: Random) -> str:
    """Return a comparison of constants, some of them negative."""
    one, other = (draw.choice(["(size ?x)", "(size ?y)", "-1", "-2.5", "(- (size ?x))", "0"]) for _ in "12")
    return f"({draw.choice(['<', '<=', '>', '>=', '='])} {one} {other})"


def nested(draw: Random, mark: str, depth: int) -> str:
    """Return an effect with ``and``, ``when`` and ``forall`` in each other, and costs of any name."""
    kind = draw.choice(["and", "when", "forall", "cost", "literal"]) if depth else "literal"
    if kind == "and":
        return f"(and {nested(draw, mark, depth - 1)} {nested(draw, mark, depth - 1)})"
    if kind == "when":
        return f"(when {literal(draw, mark, (*VARIABLES, 'u'))} {nested(draw, mark, depth - 1)})"
    if kind == "forall":
        return f"(forall (?y - {mark}thing) {nested(draw, mark, depth - 1)})"
    if kind == "cost":
        return f"({draw.choice(['increase', 'decrease', 'assign'])} (spent ?x) {draw.choice(['-3', '(size ?x)', '1'])})"
    return literal(draw, mark, (*VARIABLES, "u"))


def timed(draw: Random, mark: str) -> tuple[str, str]:
    """Return a durative action and the same without time; what holds over all is not changed at the start."""
    before, steady = literal(draw, mark, VARIABLES), draw.choice(["(r ?x)", "(not (r ?y))"])
    changed = draw.sample([f"({mark}p ?x)", f"({mark}q ?x ?x)", f"({mark}s)"], 3)
    start = {each: draw.random() < 0.5 for each in changed[:2]}
    end = {each: draw.random() < 0.5 for each in changed[1:]}

    def spelled(values: dict[str, bool]) -> list[str]:
        return [each if value else f"(not {each})" for each, value in values.items()]

    head = f"{mark}act :parameters (?x ?y - {mark}thing)"
    effects = [*(f"(at start {each})" for each in spelled(start)), *(f"(at end {each})" for each in spelled(end))]
    draw.shuffle(effects)
    slow = f"""(:durative-action {head} :duration (<= ?duration {draw.choice(["2", "(size ?x)"])})
     :condition (and (over all {steady}) (at start {before})) :effect (and {" ".join(effects)}))"""
    fast = f"(:action {head} :precondition (and {steady} {before}) :effect (and {' '.join(spelled(start | end))}))"
    return slow, fast


def files(draw: Random) -> tuple[str, str, str]:
    """Return a domain, a plain one for the search, and a problem."""
    mark = draw.choice(MARKS)
    slow, fast = timed(draw, mark)
    twice = f"({mark}q ?a ?b - {mark}thing)"
    actions = "\n".join(
        f"""(:action {mark}go :parameters (?x ?y - {draw.choice([f"{mark}thing", f"{mark}cup", f"{mark}pot"])})
         :precondition (and {comparison(draw)} {literal(draw, mark, (*VARIABLES, "v"))})
         :effect {nested(draw, mark, 3)})"""
        for _ in range(draw.randint(2, 3))
    )
    head = f"""(define (domain {mark}d) (:requirements {" ".join(draw.sample(REQUIREMENTS, 3))})
     (:types {mark}cup {mark}lid - {mark}thing {mark}pot - (either {mark}cup {mark}lid))
     (:predicates ({mark}p ?a) {twice} (r ?a) ({mark}s) {twice}) (:functions (size ?a) (spent ?a) - number)"""
    kinds = [f"{mark}{each}" for each in ("cup", "lid", "pot")]
    objects = " ".join(f"{name} - {draw.choice(kinds)}" for name in OBJECTS)
    facts = " ".join(
        {atom(draw, mark, OBJECTS) for _ in range(4)} | {f"(r {name})" for name in draw.sample(OBJECTS, 2)}
    )
    sizes = " ".join(f"(= (size {name}) {draw.choice(['-1', '2', '-2.5'])})" for name in OBJECTS)
    problem = f"""(define (problem e) (:domain {mark}d) (:objects {objects}) (:init {facts} {sizes})
     (:goal {literal(draw, mark, OBJECTS)}))"""
    return f"{head} {slow} {actions})", f"{head} {fast} {actions})", problem


@settings(max_examples=examples(10))
@given(seed=integers(0, 10**6))
def test_files_of_all_dialects_have_the_plans_of_plain_ones(seed: int, folder: Path) -> None:
    draw = Random(seed)
    domain, plain, problem = files(draw)
    both = folder / "both.pddl"
    both.write_text(f"{problem}\n{domain}" if draw.random() < 0.5 else f"{domain}\n{problem}")
    assert counts(load_domain(both, untimed=True), 3) == Search(plain, problem).count(3), f"{domain}\n{problem}"
