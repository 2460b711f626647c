"""Generalise proofs about single entities to rules about their classes.

A proof may be generalised as long as all instances of the rule are proved for the same reason; instances that the
domain excludes anyway do not matter.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import chain, combinations, product
from operator import contains
from typing import NamedTuple

from prag_asp.atom import Atom, atom_of
from prag_asp.physics.predicates.predicate import words
from prag_asp.physics.proofs.learned_exclusions import Fluents, Proofs
from prag_asp.program.facts import Facts

VARIABLES = "XYZVWUTSRQ"
LINE = 120
ANYTHING = ""
"""The kind that stands for all entities; other kinds are entities or classes."""

Shape = tuple[tuple[str, tuple[str, ...]], ...]
"""The fluents of a proof with variables in place of entities: the name and the arguments of each."""

Entities = tuple[str, ...]
"""The entities that stand for the variables of a shape, all distinct."""


@dataclass(frozen=True)
class ExclusionRule:
    """A rule that excludes fluents; `kinds` holds an entity, a class or `ANYTHING` for each variable.

    `different` contains the pairs of variables that must stand for different entities, and `proofs` contains the proofs
    that the rule covers.
    """

    shape: Shape
    kinds: tuple[str, ...]
    entities: frozenset[str]
    different: tuple[tuple[str, str], ...]
    reason: str
    proofs: tuple[Fluents, ...]

    def __str__(self) -> str:
        named = {VARIABLES[i]: kind for i, kind in enumerate(self.kinds) if kind in self.entities}
        atoms = [str(Atom(name, tuple(named.get(a, a) for a in arguments))) for name, arguments in self.shape]
        classes = [f"is_a({VARIABLES[i]},{k})" for i, k in enumerate(self.kinds) if k and k not in self.entities]
        apart = [f"{named.get(one, one)} != {named.get(two, two)}" for one, two in self.different]
        body = [*(f"fluent({atom})" for atom in atoms), *classes, *apart]
        head = f"impossible({atoms[0]}, {atoms[-1]})"
        if len(named) == len(self.kinds):
            return f"{head}."
        rule = f"{head} :- {', '.join(body)}."
        return rule if len(rule) <= LINE else rule.replace(" :- ", " :-\n    ")


class _InstanceTable(NamedTuple):
    """All instances of a shape among the fluents of a domain: their entities, proofs and reasons."""

    proofs: dict[Entities, Fluents]
    reasons: dict[Entities, str | None]
    possible: set[Entities]


def rules(proofs: Proofs, stated: Facts) -> list[ExclusionRule]:
    """Return rules that together cover each proof once, and nothing else, in the order of their first proofs."""
    folding = _Folding(proofs, stated)
    result: list[ExclusionRule] = []
    covered = set[Fluents]()
    for fluents, reason in proofs.items():
        if reason is not None and fluents not in covered:
            result.append(folding.rule(fluents, reason))
            covered.update(result[-1].proofs)
    return result


def text_of(rules: Iterable[ExclusionRule], name: str) -> str:
    """Return rules as a logic program, each with its reason."""
    found = list(rules)
    legend = " impossible(F,G): F and G never hold together; impossible(F,F): F never holds." if found else ""
    lines = [
        f"% Facts that are proved impossible in the scene of {name}. Written by prag-asp learn; run it again",
        f"% when the scene changes.{legend}",
    ]
    for rule in found:
        lines += ["", f"% {rule.reason}", str(rule)]
    return "\n".join([*lines, ""])


class _Folding:
    """A generaliser of the proofs of a domain to rules."""

    def __init__(self, proofs: Proofs, stated: Facts):
        self._proofs = proofs
        self._entities = frozenset(map(str, stated.entities))
        self._members: dict[str, set[str]] = {ANYTHING: set(self._entities)}
        for entity, kind in sorted(stated.memberships):
            self._members.setdefault(str(kind), set()).add(str(entity))
        self._fluents = list(map(atom_of, stated.fluents))

    def rule(self, fluents: Fluents, reason: str) -> ExclusionRule:
        """Generalise a proof to the most general rule of which all instances are proved for the same reason."""
        shape, entities = self._abstract(fluents)
        table = self._tables[shape]
        reason_pattern = _in_variables(reason, entities)
        masked = _kind(reason_pattern)
        proved = {
            instance
            for instance, why in table.reasons.items()
            if why is None or _kind(_in_variables(why, instance)) == masked
        }
        options = []  # the possible kinds of each variable, the most general first, the entity itself last
        for entity in entities:
            classes = [kind for kind, members in self._members.items() if kind != ANYTHING and entity in members]
            options.append([ANYTHING, *sorted(classes, key=lambda kind: -len(self._members[kind])), entity])
        best: tuple[int, tuple[str, ...], list[Entities]] = (-1, (), [])
        for kinds in product(*options):
            ranges = [{*self._members.get(kind, ()), kind} for kind in kinds]
            instances = [each for each in table.possible if all(map(contains, ranges, each))]
            if len(instances) > best[0] and proved.issuperset(instances):
                best = (len(instances), kinds, instances)
        _, kinds, instances = best
        covered = tuple(table.proofs[each] for each in sorted(instances) if table.reasons[each] is not None)
        return ExclusionRule(shape, kinds, self._entities, self._different(shape, kinds), reason_pattern, covered)

    def _abstract(self, fluents: Sequence[Atom]) -> tuple[Shape, Entities]:
        """Return the shape of fluents, and the entities in it."""
        entities: list[str] = []
        shape = []
        for fluent in fluents:
            arguments = []
            for argument in fluent.arguments:
                if argument in self._entities and argument not in entities:
                    entities.append(argument)
                arguments.append(VARIABLES[entities.index(argument)] if argument in entities else argument)
            shape.append((fluent.name, tuple(arguments)))
        return tuple(shape), tuple(entities)

    @cached_property
    def _tables(self) -> Mapping[Shape, _InstanceTable]:
        """The instances of the shapes of all proofs, with pairs in both orders."""
        shapes = {self._abstract(fluents)[0] for fluents, reason in self._proofs.items() if reason is not None}
        tables = {shape: _InstanceTable({}, {}, set()) for shape in shapes}
        sizes = {len(shape) for shape in shapes}  # the first fluent, the second, or both
        for fluents in chain.from_iterable(combinations(self._fluents, size) for size in sorted(sizes)):
            for ordered in (fluents, fluents[::-1]) if len(fluents) > 1 else (fluents,):
                shape, entities = self._abstract(ordered)
                table = tables.get(shape)
                if table is not None:
                    table.possible.add(entities)
                    if fluents in self._proofs:
                        table.reasons[entities], table.proofs[entities] = self._proofs[fluents], fluents
                    elif any((fluent,) in self._proofs for fluent in fluents):
                        table.reasons[entities] = None
        return tables

    def _different(self, shape: Shape, kinds: Sequence[str]) -> tuple[tuple[str, str], ...]:
        """Return the pairs of variables that need an inequality, because both could stand for the same entity."""
        ranges = {VARIABLES[i]: self._members.get(kind, {kind}) for i, kind in enumerate(kinds)}
        for name, arguments in shape:
            for i, argument in enumerate(arguments):
                if argument in ranges:
                    occurring = {fluent.arguments[i] for fluent in self._fluents if fluent.name == name}
                    ranges[argument] = ranges[argument] & occurring
        return tuple(
            (one, two)
            for one, two in combinations(ranges, 2)
            if any(self._could_be(shape, one, two, entity) for entity in ranges[one] & ranges[two])
        )

    def _could_be(self, shape: Shape, one: str, two: str, entity: str) -> bool:
        """Return whether fluents of a shape can have the same entity for two of its variables."""
        both = [(name, arguments) for name, arguments in shape if one in arguments and two in arguments]
        return all(
            any(
                fluent.name == name
                and all(fluent.arguments[i] == entity for i, a in enumerate(arguments) if a in (one, two))
                for fluent in self._fluents
            )
            for name, arguments in both
        )


def _in_variables(reason: str, entities: Entities) -> str:
    """Return a reason with variables in place of the names of entities."""
    variables = {words(entity): variable for variable, entity in zip(VARIABLES, entities, strict=False)}
    names = sorted(map(re.escape, variables), key=len, reverse=True)  # cube 2 before cube
    return re.sub(rf"\b({'|'.join(names)})\b", lambda match: variables[match[0]], reason) if names else reason


def _kind(reason: str) -> str:
    """Return a reason with all variables masked, because it may begin at any entity of a cycle."""
    return re.sub(rf"\b[{VARIABLES}]\b", "_", reason)
