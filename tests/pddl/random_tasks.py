"""Random small tasks of PDDL with all that is imported: nested formulas, quantifiers, conditional effects, rules."""

from __future__ import annotations

from random import Random

PREDICATES = {"p": 1, "q": 1, "r": 2, "s": 0, "k": 1, "l": 2}
"""The predicates with their numbers of arguments; k and l never change."""

TYPES = ("a", "b", "(either a b)", "object")


def random_task(seed: int) -> tuple[str, str]:
    draw = Random(seed)
    rules = draw.random() < 0.4
    actions = "\n".join(action(draw, number, rules) for number in range(draw.randint(1, 3)))
    derived = derivation(draw) if rules else ""
    predicates = " ".join(
        f"({name} {' '.join(f'?x{n}' for n in range(arity))})" for name, arity in {**PREDICATES, "d": 1}.items()
    )
    domain = f"""(define (domain x) (:requirements :adl :derived-predicates) (:types a b - c)
        (:constants h - a) (:predicates {predicates}) {derived}\n{actions}
        (:action go :parameters () :effect (s)))"""
    objects = ["h", "u", "v"]
    atoms = [f"({name} {' '.join(draw.choices(objects, k=arity))})" for name, arity in PREDICATES.items() for _ in "12"]
    initial = " ".join(draw.sample(atoms, draw.randint(2, len(atoms))))
    goal = formula(draw, [], 2, rules)
    return domain, f"(define (problem y) (:domain x) (:objects u - a v - b) (:init {initial}) (:goal {goal}))"


def derivation(draw: Random) -> str:
    return f"""(:derived (d ?x) {formula(draw, ["?x"], 1, False)})
        (:derived (d ?x) (exists (?y) (and (d ?y) {atom(draw, ["?x", "?y"], "rql")})))"""


def action(draw: Random, number: int, rules: bool) -> str:
    names = ["?x", "?y"][: draw.randint(0, 2)]
    parameters = " ".join(f"{name} - {draw.choice(TYPES)}" for name in names)
    changes = " ".join(effect(draw, names, 2, rules) for _ in range(draw.randint(0, 3)))
    before = formula(draw, names, 2, rules)
    return f"(:action act-{number} :parameters ({parameters}) :precondition {before} :effect (and {changes}))"


def formula(draw: Random, names: list[str], depth: int, rules: bool) -> str:
    kind = draw.choice(("and", "or", "not", "imply", "forall", "exists", "=", "atom", "atom")) if depth else "atom"
    if kind in ("and", "or"):
        return f"({kind} {' '.join(formula(draw, names, depth - 1, rules) for _ in range(draw.randint(0, 3)))})"
    if kind == "imply":
        return f"(imply {formula(draw, names, depth - 1, rules)} {formula(draw, names, depth - 1, rules)})"
    if kind == "not":
        return f"(not {formula(draw, names, depth - 1, rules)})"
    if kind in ("forall", "exists"):
        new = draw.choice(("?z", "?x"))
        return f"({kind} ({new} - {draw.choice(TYPES)}) {formula(draw, [*names, new], depth - 1, rules)})"
    if kind == "=":
        return f"(= {draw.choice([*names, 'h'])} {draw.choice([*names, 'h'])})"
    found = atom(draw, names, "pqrskld" if rules else "pqrskl")
    return found if draw.random() < 0.7 else f"(not {found})"


def effect(draw: Random, names: list[str], depth: int, rules: bool) -> str:
    kind = draw.choice(("forall", "when", "and", "atom", "atom")) if depth else "atom"
    if kind == "and":
        return f"(and {' '.join(effect(draw, names, depth - 1, rules) for _ in range(draw.randint(0, 2)))})"
    if kind == "forall":
        return f"(forall (?w - {draw.choice(TYPES)}) {effect(draw, [*names, '?w'], depth - 1, rules)})"
    if kind == "when":
        return f"(when {formula(draw, names, 1, rules)} {effect(draw, names, 0, rules)})"
    found = atom(draw, names, "pqrs")
    return found if draw.random() < 0.5 else f"(not {found})"


def atom(draw: Random, names: list[str], predicates: str) -> str:
    name = draw.choice(predicates)
    arity = {**PREDICATES, "d": 1}[name]
    return f"({name} {' '.join(draw.choices([*names, 'h', 'h'][: len(names) + 1], k=arity))})"
