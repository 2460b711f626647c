"""Write problems as BDDL."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from prag_asp.bddl.bddl_problem import BddlFact, BddlFormula, BddlProblem, Connective, Region

SYNTAX = str.maketrans("();", "[],")
"""The replacements for characters of a sentence that are syntax in BDDL."""


def bddl_text(problem: BddlProblem) -> str:
    """Return a problem as a text from which `parse_bddl` reads the same problem.

    In the instruction, parentheses become brackets, and semicolons become commas.
    """
    initial = [fact_text(fact) if value else f"(not {fact_text(fact)})" for fact, value in problem.initial]
    language = " ".join(problem.language.translate(SYNTAX).replace("//", "/ /").split())
    sections: list[tuple[str, Iterable[str]]] = [
        (":regions", map(_region, problem.regions)),
        (":fixtures", _typed(problem.fixtures)),
        (":objects", _typed(problem.objects)),
        (":obj_of_interest", problem.interest),
        (":init", initial),
        (":goal", [formula_text(problem.goal)]),
    ]
    lines = [f"(define (problem {problem.name})", f"  (:domain {problem.domain})", f"  (:language {language})"]
    for head, items in sections:
        lines += [f"  ({head}", *(f"    {item}" for item in items), "  )"]
    return "\n".join([*lines, ")"]) + "\n"


def formula_text(formula: BddlFormula) -> str:
    """Return a formula as BDDL."""
    if isinstance(formula, BddlFact):
        return fact_text(formula)
    if isinstance(formula, Connective):
        return f"({' '.join([formula.kind, *map(formula_text, formula.parts)])})"
    variables = [f"?{name} - {of_class}" for name, of_class in formula.variables]
    lists = [f"({each})" for each in variables] if formula.kind.endswith("pairs") else [f"({' '.join(variables)})"]
    number = [] if formula.number is None else [f"({formula.number})"]
    return f"({' '.join([formula.kind, *number, *lists, formula_text(formula.part)])})"


def fact_text(fact: BddlFact) -> str:
    """Return a fact as BDDL."""
    return f"({' '.join((fact.predicate, *fact.terms))})"


def _typed(classes: Mapping[str, str]) -> Iterator[str]:
    """Yield one line for each class, because LIBERO reads only the last line of a class."""
    for of_class in dict.fromkeys(classes.values()):
        yield f"{' '.join(name for name, each in classes.items() if each == of_class)} - {of_class}"


def _region(region: Region) -> str:
    parts = [f"(:target {region.target})"]
    if region.ranges:
        rows = " ".join(f"({' '.join(map(repr, each))})" for each in region.ranges)
        parts.append(f"(:ranges ({rows}))")
    if region.yaw is not None:
        parts.append(f"(:yaw_rotation (({region.yaw[0]!r} {region.yaw[1]!r})))")
    return f"({' '.join([region.name, *parts])})"
