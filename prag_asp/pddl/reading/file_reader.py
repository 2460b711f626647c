"""The reader of a PDDL domain and its problem, which checks both against the declarations."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from pathlib import Path

from prag_asp.pddl.definitions import DomainFile, ProblemFile
from prag_asp.pddl.reading.bounded_numbers import bounded, read_functions
from prag_asp.pddl.reading.comparisons import settled
from prag_asp.pddl.reading.domain_reader import DomainReader
from prag_asp.pddl.reading.pddl_source import PddlSource
from prag_asp.pddl.reading.problem_reader import ProblemReader
from prag_asp.pddl.reading.scopes import TOTAL
from prag_asp.pddl.syntax.sections import parse
from prag_asp.program.problem import Problem


def read_files(
    domain: Path, problem: Path, *, untimed: bool = False
) -> tuple[DomainFile, ProblemFile, tuple[Problem, ...]]:
    """Read a domain and its problem, and return them with warnings about ignored or undeclared parts.

    In the result, comparisons of numbers are replaced by literals of static predicates. With `untimed`, durative
    actions are read as instantaneous ones.

    Raises:
        DomainError: a file is not PDDL, or uses something undeclared or unsupported.
    """
    first, second = parse(domain, "domain"), parse(problem, "problem")
    sources = PddlSource(domain), PddlSource(problem)
    domain_reader, problem_reader = DomainReader(sources[0], first), ProblemReader(sources[1], second, untimed=untimed)
    domain_reader.declarations()
    problem_reader.read_objects(first.name, domain_reader.declared.types, domain_reader.objects)
    definition = domain_reader.domain(untimed=untimed)
    derived = frozenset(each.predicate for each in definition.derived)
    instance = problem_reader.problem(domain_reader.declared, derived)
    for line, text in _ignored(definition, read_functions(definition, instance)):
        sources[0].warn(line, text, "ignored")
    definition, instance = settled(*sources, *bounded(*sources, definition, instance))
    return definition, instance, (*sources[0].warnings, *sources[1].warnings)


def _ignored(domain: DomainFile, read: Collection[str]) -> Iterator[tuple[int, str]]:
    """Yield the functions that actions change but no condition reads, each once, except the costs of actions."""
    changed = [effect for action in domain.actions for effect in action.numeric]
    for name in dict.fromkeys(each.function.function for each in changed):
        if name not in read and name != TOTAL:
            line = next(each.line for each in changed if each.function.function == name)
            yield line, f"no condition reads the function {name}, so its changes are ignored; plans do not depend on it"
