"""The small-model reduction of a domain: how many entities plans need, and the program with only these entities."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import chain
from math import perm, prod

import clingo

from prag_asp.errors import DomainError
from prag_asp.lint import Checked, check, with_entities
from prag_asp.processes.progress_events import note
from prag_asp.program.facts import Facts, ground_later
from prag_asp.program.grounding import Grounder
from prag_asp.program.parse import parse_sources
from prag_asp.program.paths import data_folder
from prag_asp.program.sources import Program, Source, encodings_folder, owned
from prag_asp.program.syntax import Signature, Statement
from prag_asp.reduction.alike_entities import AlikeEntities, find_alike
from prag_asp.reduction.applicability import deriving_rules, objection

FEWEST = 16
"""The minimum size of a group of alike entities for which there is a reduction."""

MANY = 20_000
"""The minimum number of fluents, actions, conditions, effects and invariants for which there is a reduction.

A smaller program is grounded completely, because the complete program answers every query.
"""

FIRST = 3
"""The number of entities in each group in the first program for which `EntityBound` is measured."""

INVARIANTS = (("exclusive", 2), ("implies", 2), ("impossible", 2))

Group = tuple[clingo.Symbol, ...]
Representatives = Mapping[clingo.Symbol, clingo.Symbol]
"""A ground entity of the same group for each entity that is not ground."""


@dataclass(frozen=True)
class EntityBound:
    """The largest numbers of entities from the same group that are named together.

    `action` is the largest number in one action, `invariant` in one invariant or fluent, `fluent` in one fluent, and
    `rule` in all facts that one rule reads.
    """

    action: int
    invariant: int
    fluent: int
    rule: int

    def needed(self, length: int) -> int:
        """Return the number of entities that a program needs to have all plans of a given length up to renaming."""
        return max(length * self.action + self.invariant, self.least)

    @property
    def least(self) -> int:
        """The number of entities that a program needs to have the facts and symmetries of the whole up to renaming."""
        return max(self.rule, 2 * self.fluent + self.invariant, self.action + self.invariant)


@dataclass(frozen=True)
class Reduction:
    """The small-model reduction of a program.

    The smallest program has only as many entities of each group as its facts and symmetries need. `groups` are the
    groups with entities that it does not ground, each with its entry in `bounds`. `checked` is the smallest program
    after it has been checked, and `settings` is the settings file.
    """

    program: Program
    settings: Source
    alike: AlikeEntities
    groups: tuple[Group, ...]
    bounds: tuple[EntityBound, ...]
    checked: Checked

    @property
    def facts(self) -> Facts:
        """The facts of the smallest program."""
        return self.checked.facts

    @cached_property
    def facts_with_all_entities(self) -> Facts:
        """The facts of the smallest program, extended by all entities of the whole program."""
        return with_entities(self.facts, self._representatives([bound.least for bound in self.bounds]))

    def whole_facts(self) -> Facts:
        """Return the facts of the whole program, which is grounded on first use, with a note to the user."""
        program, settings = self.program, self.settings
        groups = ", ".join(f"{len(group):,} like {group[0]}" for group in self.groups)

        def ground() -> Facts:
            note(f"note: all entities are ground ({groups}): this needs more than a count of all plans or tasks")
            return check(program, settings).facts

        return ground_later(ground)

    def sizes(self, length: int) -> tuple[int, ...]:
        """Return how many entities of each group plans of a given length need."""
        pairs = zip(self.groups, self.bounds, strict=True)
        return tuple(min(len(group), bound.needed(length)) for group, bound in pairs)

    def reduced(self, length: int) -> tuple[Program, Facts] | None:
        """Return the reduced program for plans of a given length, and its facts, or None if plans need all entities."""
        representatives = self._representatives(self.sizes(length))
        if not representatives:
            return None
        program = self.alike.without(representatives)
        return program, check(program, self.settings, representatives).facts

    @property
    def size(self) -> int:
        """The number of fluents, actions, conditions, effects and invariants in the whole program."""
        facts = self.facts
        tables = (facts.preconditions, facts.postconditions)
        pairs = ((action, fluent) for table in tables for action, values in table.items() for fluent, _ in values)
        invariants = chain(facts.exclusive, facts.implies, facts.impossible)
        return self._total(chain(pairs, invariants)) + self.total((*facts.fluents, *facts.actions))

    def total(self, terms: Iterable[clingo.Symbol]) -> int:
        """Return the number of terms of the whole program that correspond to given terms of the smallest program."""
        return self._total((term,) for term in terms)

    def _total(self, rows: Iterable[tuple[clingo.Symbol, ...]]) -> int:
        ground = [[entity for entity in group if entity in self.facts.entities] for group in self.groups]
        place = {entity: number for number, group in enumerate(ground) for entity in group}
        names: dict[clingo.Symbol, set[clingo.Symbol]] = {}
        numbers: dict[tuple[int, ...], int] = {}
        for row in rows:
            named: set[clingo.Symbol] = set()
            for term in row:
                named |= names.get(term) or names.setdefault(term, named_in(term, place))
            groups = [place[entity] for entity in named]
            key = tuple(map(groups.count, range(len(ground))))
            numbers[key] = numbers.get(key, 0) + 1
        return sum(
            number * prod(map(perm, map(len, self.groups), key)) // prod(map(perm, map(len, ground), key))
            for key, number in numbers.items()
        )

    def _representatives(self, sizes: Sequence[int]) -> Representatives:
        return _representatives(self.groups, sizes, self.settings)


def find_reduction(program: Program, settings: Source, *, fewest: int = FEWEST) -> Reduction | str | None:
    """Return the reduction of a program, or the reason why it does not apply, or None for a small program.

    The smallest program has passed every check. The whole program would pass as well, because the checks depend only
    on facts that name few entities together.

    Raises:
        DomainError: the smallest program is invalid.
    """
    statements, problems = parse_sources(owned(program))
    encodings = encodings_folder(program)
    # the number of entities, if it is known without grounding, because an interval may contain any number
    stated = 0
    for each in statements:
        if each.own and each.is_rule and any(atom.name == "entity" for atom in each.heads):
            stated += fewest if ".." in each.text else 1 + each.text.count(";")
    if problems or encodings is None or stated < fewest:
        return None
    try:
        alike = find_alike(program, statements)
        groups = [group for group in alike.groups if len(group) >= fewest]
        if not groups:
            return None
        reason = objection(statements)
        if encodings.resolve() != data_folder("encodings").resolve():
            reason = f"{encodings}: these encodings differ from the shipped ones"
        bounds = {} if reason else _bounds(alike, groups, settings, statements)
    except DomainError:
        return None  # the check of the whole program raises the same error
    if not bounds:
        return reason or "a few facts name too many of them together"
    representatives = _representatives(bounds, [bound.least for bound in bounds.values()], settings)
    checked = check(alike.without(representatives), settings, representatives)
    if any(action in group for group in groups for action in checked.facts.declared_actions):
        return "an action has the name of one of them"
    reduction = Reduction(program, settings, alike, tuple(bounds), tuple(bounds.values()), checked)
    return reduction if reduction.size >= MANY else None


def is_large(facts: Facts) -> bool:
    """Return whether a program is so large that the user gets a note on why it is not reduced."""
    tables = (facts.preconditions, facts.postconditions)
    return sum(len(values) for table in tables for values in table.values()) >= MANY


def named_in(term: clingo.Symbol, entities: Collection[clingo.Symbol]) -> set[clingo.Symbol]:
    """Return the entities in a term."""
    named: set[clingo.Symbol] = set()
    waiting = [term]
    while waiting:
        each = waiting.pop()
        if each in entities:
            named.add(each)
        elif each.type == clingo.SymbolType.Function:
            waiting += each.arguments
    return named


def _representatives(groups: Iterable[Group], sizes: Iterable[int], settings: Source) -> Representatives:
    """Return the entities to drop, with representatives, so that each group has a given size.

    Entities that the settings name are kept.
    """
    words = set(re.findall(r"\w+", settings.text))
    representatives: dict[clingo.Symbol, clingo.Symbol] = {}
    for group, size in zip(groups, sizes, strict=True):
        named = {each for each in group if str(each) in (settings.text if each.arguments else words)}
        ordered = sorted(group, key=lambda each: each not in named)
        representatives |= dict.fromkeys(ordered[max(size, len(named)) :], ordered[0])
    return representatives


def _bounds(
    alike: AlikeEntities, groups: Iterable[Group], settings: Source, statements: Sequence[Statement]
) -> dict[Group, EntityBound]:
    """Return the bounds of the groups that have more entities than their bounds require.

    A measured bound is also the bound of the whole program if the measured program has `least` entities of each group,
    because it then has, up to renaming, all facts of the whole program that a rule reads.
    """
    rules = [[atom.signature for atom in rule.body if not atom.negated] for rule in deriving_rules(statements)]
    predicates = {("fluent", 1), ("action", 1), *INVARIANTS, *chain(*rules)}
    sizes = {group: min(FIRST, len(group)) for group in groups}
    while sizes:
        grounder = Grounder(alike.without(_representatives(sizes, sizes.values(), settings)))
        grounder.ground([("base", [])])
        bounds: dict[Group, EntityBound] = {}
        for group in sizes:
            members = set(group)
            most: dict[Signature, int] = {}  # the largest number of entities that one atom names, by predicate
            for each in predicates:
                atoms = grounder.control.symbolic_atoms.by_signature(*each)
                most[each] = max((len(named_in(atom.symbol, members)) for atom in atoms), default=0)
            fluent = most["fluent", 1]
            invariant = max(fluent, *(most[each] for each in INVARIANTS))
            rule = max((sum(map(most.__getitem__, body)) for body in rules), default=0)
            bounds[group] = EntityBound(most["action", 1], invariant, fluent, rule)
        if all(bounds[group].least <= size for group, size in sizes.items()):
            return bounds
        sizes = {group: max(sizes[group], bounds[group].least) for group in sizes if bounds[group].least < len(group)}
    return {}
