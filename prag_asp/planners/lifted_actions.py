"""The lifting of ground actions that differ only in their arguments to actions with parameters."""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Mapping, Sequence
from typing import NamedTuple

import clingo

FEW = 4
"""The maximum number of schemas for the actions with one name."""

Literal = tuple[str, tuple[str, ...], bool]
"""A predicate, its terms, and whether it is asserted; a term is a variable or the name of an object."""

Clause = tuple[Literal, ...]


class PddlCase(NamedTuple):
    """A case of an action, written with PDDL names: the precondition, its clauses, and conditional effects."""

    precondition: Clause
    clauses: tuple[Clause, ...]
    effects: tuple[tuple[Clause, Literal], ...]

    @property
    def key(self) -> Hashable:
        """A key that is equal for cases that differ only in order."""
        after = frozenset((frozenset(where), effect) for where, effect in self.effects)
        return frozenset(self.precondition), frozenset(map(frozenset, self.clauses)), after

    @property
    def conditions(self) -> Iterator[Literal]:
        """All literals of preconditions and of conditions of effects."""
        yield from self.precondition
        for clause in (*self.clauses, *(where for where, _ in self.effects)):
            yield from clause

    def rename(self, names: Mapping[str, str]) -> PddlCase:
        """Return the case with its terms renamed."""

        def literal(old: Literal) -> Literal:
            return old[0], tuple(names.get(term, term) for term in old[1]), old[2]

        def clause(literals: Clause) -> Clause:
            return tuple(map(literal, literals))

        after = ((clause(where), literal(effect)) for where, effect in self.effects)
        return PddlCase(clause(self.precondition), tuple(map(clause, self.clauses)), tuple(after))


class Instance(NamedTuple):
    """A ground action: the objects of its arguments, and its cases."""

    term: clingo.Symbol
    arguments: tuple[str, ...]
    cases: tuple[PddlCase, ...]


def variable(number: int) -> str:
    """Return the name of a parameter."""
    return f"?x{number + 1}"


def group_alike(instances: Sequence[Instance]) -> list[list[Instance]]:
    """Return groups of actions: a single group if all have a common schema, otherwise groups with equal schemas.

    If there are more than `FEW` groups, numbered schemas would not help readers, so each action is a separate group.
    """
    if lift(instances) is not None:
        return [list(instances)]
    groups: dict[Hashable, list[Instance]] = {}
    for instance in instances:
        pattern = tuple(instance.arguments.index(argument) for argument in instance.arguments)
        own = instance._replace(arguments=tuple(dict.fromkeys(instance.arguments)))
        form = tuple(case.key for case in _with_variables(own))
        groups.setdefault((pattern, frozenset(form)), []).append(own)
    return list(groups.values()) if len(groups) <= FEW else [[instance] for instance in instances]


def _with_variables(instance: Instance) -> tuple[PddlCase, ...]:
    names = {argument: variable(number) for number, argument in enumerate(instance.arguments)}
    return tuple(case.rename(names) for case in instance.cases)


def lift(instances: Sequence[Instance]) -> tuple[PddlCase, ...] | None:
    """Return the cases that the given actions have in common, with variables, or None if they have no common schema."""
    arity = len(instances[0].arguments)
    model = next((instance for instance in instances if len(set(instance.arguments)) == arity), None)
    if model is None:
        return None
    cases, names = _with_variables(model), [*map(variable, range(arity))]
    for instance in instances:
        images = [case.rename(dict(zip(names, instance.arguments, strict=True))) for case in cases]
        # Two effects coincide if two variables stand for the same object.
        collapsed = any(len(set(case.effects)) < len(case.effects) for case in images)
        if collapsed or {case.key for case in images} != {case.key for case in instance.cases}:
            return None
    return cases
