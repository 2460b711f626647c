"""Ground actions that are alike up to their arguments as one action with parameters."""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Mapping, Sequence
from typing import NamedTuple

import clingo

FEW = 4
"""Most schemas that the actions of one name become."""

Literal = tuple[str, tuple[str, ...], bool]
"""A predicate, its terms, and whether it is asserted; a term is the name of an object or a variable."""

Clause = tuple[Literal, ...]


class PddlCase(NamedTuple):
    """A case of an action in the names of PDDL: the precondition, its clauses, and conditional effects."""

    precondition: Clause
    clauses: tuple[Clause, ...]
    effects: tuple[tuple[Clause, Literal], ...]

    @property
    def key(self) -> Hashable:
        """A value that is the same for cases that differ in the order alone."""
        after = frozenset((frozenset(where), effect) for where, effect in self.effects)
        return frozenset(self.precondition), frozenset(map(frozenset, self.clauses)), after

    @property
    def conditions(self) -> Iterator[Literal]:
        """All literals of preconditions and of conditions of effects."""
        yield from self.precondition
        for clause in (*self.clauses, *(where for where, _ in self.effects)):
            yield from clause

    def rename(self, names: Mapping[str, str]) -> PddlCase:
        """Return a case with other terms."""

        def literal(old: Literal) -> Literal:
            return old[0], tuple(names.get(term, term) for term in old[1]), old[2]

        def clause(literals: Clause) -> Clause:
            return tuple(map(literal, literals))

        after = ((clause(where), literal(effect)) for where, effect in self.effects)
        return PddlCase(clause(self.precondition), tuple(map(clause, self.clauses)), tuple(after))


class Instance(NamedTuple):
    """A ground action: the objects that stand for its arguments, and its cases."""

    term: clingo.Symbol
    arguments: tuple[str, ...]
    cases: tuple[PddlCase, ...]


def variable(number: int) -> str:
    """Return the name of a parameter."""
    return f"?x{number + 1}"


def group_alike(instances: Sequence[Instance]) -> list[list[Instance]]:
    """Return actions in groups: one if they are alike, else those that are the same with variables for arguments.

    Where that makes many groups, whose numbers would say nothing to a reader, each action is one of its own.
    """
    if lift(instances) is not None:
        return [list(instances)]
    groups: dict[Hashable, list[Instance]] = {}
    for each in instances:
        pattern = tuple(each.arguments.index(argument) for argument in each.arguments)
        own = each._replace(arguments=tuple(dict.fromkeys(each.arguments)))
        form = tuple(case.key for case in _with_variables(own))
        groups.setdefault((pattern, frozenset(form)), []).append(own)
    return list(groups.values()) if len(groups) <= FEW else [[each] for each in instances]


def _with_variables(instance: Instance) -> tuple[PddlCase, ...]:
    names = {argument: variable(number) for number, argument in enumerate(instance.arguments)}
    return tuple(case.rename(names) for case in instance.cases)


def lift(instances: Sequence[Instance]) -> tuple[PddlCase, ...] | None:
    """Return the cases with variables that all of some actions have, None where there are none."""
    arity = len(instances[0].arguments)
    model = next((each for each in instances if len(set(each.arguments)) == arity), None)
    if model is None:
        return None
    found, names = _with_variables(model), [*map(variable, range(arity))]
    for each in instances:
        images = [case.rename(dict(zip(names, each.arguments, strict=True))) for case in found]
        if {case.key for case in images} != {case.key for case in each.cases} or any(map(_collapsed, images)):
            return None
    return found


def _collapsed(case: PddlCase) -> bool:
    """Return whether two effects have become one: a variable stands for the same object as another."""
    return len(set(case.effects)) < len(case.effects)
