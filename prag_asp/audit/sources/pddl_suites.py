"""PDDL problems: the problem files in a folder, each with the domain that it names."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from functools import cache
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING

from prag_asp.atom import Atom
from prag_asp.audit.audited_problem import AuditedProblem
from prag_asp.audit.sources.problem_source import FailedRead
from prag_asp.bddl.ground_goals import FactValue, GroundFormula, every, some
from prag_asp.bddl.ground_problems import GroundProblem
from prag_asp.domain.load import Domain, load_domain
from prag_asp.errors import DomainError
from prag_asp.pddl.definitions import DomainFile, ProblemFile
from prag_asp.pddl.formulas import Equality, Formula, Junction, Literal, Quantified, Variable
from prag_asp.pddl.reading.file_reader import read_files
from prag_asp.pddl.translate import Translation
from prag_asp.program.paths import PDDL
from prag_asp.program.sources import read_text

if TYPE_CHECKING:
    import clingo

DOMAIN_NAME = re.compile(r"\(\s*define\s*\(\s*domain\s+([^\s()]+)", re.IGNORECASE)
"""The pattern of the head of a domain, including its name."""

PROBLEM_DOMAIN = re.compile(r"\(\s*:domain\s+([^\s()]+)", re.IGNORECASE)
"""The pattern of the domain's name in a problem."""


def recognizes(folder: Path) -> bool:
    """Return whether a folder has PDDL files."""
    return next(folder.rglob(f"*{PDDL}"), None) is not None


def read(folders: Mapping[str, Path]) -> Iterator[AuditedProblem | FailedRead]:
    """Yield the problems in folders; the domain of a problem is searched for in its folder, then in the whole suite."""
    for suite, folder in folders.items():
        domains: dict[str, list[Path]] = {}
        problems: list[tuple[Path, str]] = []
        for path in sorted(folder.rglob(f"*{PDDL}")):
            try:
                text = re.sub(r";[^\n]*", "", read_text(path))
            except DomainError as error:
                yield _failed(suite, error)
                continue
            defined, used = DOMAIN_NAME.search(text), PROBLEM_DOMAIN.search(text)
            if defined is not None:
                domains.setdefault(defined[1].lower(), []).append(path)
            if used is not None:
                problems.append((path, used[1].lower()))
        for path, name in problems:
            found = domains.get(name, [])
            found = [each for each in found if each.parent == path.parent] or found
            if not found:
                yield FailedRead(suite, f"{path}:1", f"no file of the suite defines the domain {name}; add it")
                continue
            try:
                yield _audited(suite, str(path.relative_to(folder).with_suffix("")), found[0], path)
            except DomainError as error:
                yield _failed(suite, error)


def _failed(suite: str, error: DomainError) -> FailedRead:
    place, _, text = error.lines[0].partition(": ")
    return FailedRead(suite, place, text)


def _audited(suite: str, label: str, domain_path: Path, path: Path) -> AuditedProblem:
    domain, problem, _ = read_files(domain_path, path)
    facts = [
        FactValue(Atom(each.predicate, tuple(map(str, each.terms))))
        for each in problem.initial
        if each.predicate in domain.predicates
    ]
    ground = GroundProblem(problem.name, problem.objects, tuple(dict.fromkeys(facts)), ground_formula(domain, problem))

    def load() -> Domain:
        return load_domain(domain_path, path)

    @cache
    def given_names() -> tuple[dict[str, str], dict[str, str]]:
        words = Translation(domain, problem).words
        names = words.predicates.items(), words.objects.items()
        return {ours: given for given, ours in names[0]}, {ours: given for given, ours in names[1]}

    def own_fact(fluent: clingo.Symbol) -> Atom:
        predicates, objects = given_names()
        terms = (str(each) for each in fluent.arguments)
        return Atom(predicates.get(fluent.name, fluent.name), tuple(objects.get(each, each) for each in terms))

    return AuditedProblem(suite, label, f"{path}:1", ground, load, own_fact)


def ground_formula(domain: DomainFile, problem: ProblemFile) -> GroundFormula:
    """Return the goal of a problem, ground over its objects.

    Raises:
        DomainError: the goal compares numbers.
    """
    above = {name: domain.above(kind) for name, kind in problem.objects.items()}

    def ground(formula: Formula, scope: Mapping[Variable, str]) -> GroundFormula:
        if isinstance(formula, Junction):
            return (every if formula.every else some)(*(ground(part, scope) for part in formula.parts))
        if isinstance(formula, Quantified):
            members = [
                [name for name, kinds in above.items() if kinds.intersection(variable.types)]
                for variable in formula.variables
            ]
            scopes = [{**scope, **dict(zip(formula.variables, chosen, strict=True))} for chosen in product(*members)]
            return (every if formula.every else some)(*(ground(formula.part, each) for each in scopes))
        if isinstance(formula, Literal):
            return FactValue(
                Atom(formula.predicate, tuple(_value(each, scope) for each in formula.terms)), formula.positive
            )
        if isinstance(formula, Equality):
            equal = _value(formula.left, scope) == _value(formula.right, scope)
            return every() if equal == formula.positive else some()
        raise DomainError(f"{problem.name}:{formula.line}: goals that compare numbers are not audited; remove it")

    return ground(problem.goal, {})


def _value(term: Variable | str, scope: Mapping[Variable, str]) -> str:
    return scope[term] if isinstance(term, Variable) else str(term)
