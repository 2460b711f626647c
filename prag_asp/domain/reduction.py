"""Entities as needed: of those that are alike, no more are ground than a plan can name, and some that it does not name.

Which plans there are, and which tasks, is the same up to renaming with any more of them: docs/explanations/needed.md
has the proof, and what it takes is checked here, on the author's statements and on a program with few entities.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import chain
from math import perm, prod

import clingo

from prag_asp.domain.checking import check
from prag_asp.errors import DomainError
from prag_asp.lint import Checked, with_entities
from prag_asp.processes.progress_events import note
from prag_asp.program.facts import Facts, ground_later
from prag_asp.program.grounding import Grounder
from prag_asp.program.parse import parse_sources
from prag_asp.program.paths import data_folder
from prag_asp.program.reduction.alike_entities import Alike, find_alike
from prag_asp.program.reduction.authored_rules import derived, objection
from prag_asp.program.sources import Program, Source, encodings_folder, owned
from prag_asp.program.syntax import Signature, Statement

FEWEST = 16
"""Entities that are alike from which on it is asked how many are needed."""

MANY = 20_000
"""Fluents, actions, conditions, effects and invariants below which a program is ground whole: it answers anything."""

FIRST = 3
"""Entities of a group that are ground first, to see what rules and actions name."""

INVARIANTS = (("exclusive", 2), ("implies", 2), ("impossible", 2))

Group = tuple[clingo.Symbol, ...]
Like = Mapping[clingo.Symbol, clingo.Symbol]
"""Entities that are not ground, each with one that is, and is like it."""


@dataclass(frozen=True)
class Needs:
    """How many entities of a group are named together at most.

    By an action, by an invariant or a fluent, by a fluent, and by all facts that one rule reads.
    """

    action: int
    invariant: int
    fluent: int
    rule: int

    def of(self, length: int) -> int:
        """Return how many entities a program needs that has all plans of a length up to renaming."""
        return max(length * self.action + self.invariant, self.least)

    @property
    def least(self) -> int:
        """How many entities a program needs whose facts and symmetries are to be those of the whole one."""
        return max(self.rule, 2 * self.fluent + self.invariant, self.action + self.invariant)


@dataclass(frozen=True)
class Needed:
    """What is known of a program that has more entities of some groups than plans need.

    `groups` are those of which not all are ground in the least program, which is `checked`, each with its `needs`.
    `given` is the file of settings.
    """

    program: Program
    given: Source
    alike: Alike
    groups: tuple[Group, ...]
    needs: tuple[Needs, ...]
    checked: Checked

    @property
    def facts(self) -> Facts:
        """What the least program states."""
        return self.checked.facts

    @cached_property
    def with_all(self) -> Facts:
        """What the least program states, together with all entities of the whole one."""
        return with_entities(self.facts, self._like([needs.least for needs in self.needs]))

    def whole_facts(self) -> Facts:
        """Return what the whole program states, which is ground, and told of, when somebody first asks for it."""
        program, given = self.program, self.given
        groups = ", ".join(f"{len(group):,} like {group[0]}" for group in self.groups)

        def ground() -> Facts:
            note(f"note: all entities are ground ({groups}): this asks for more than a number of all plans or tasks")
            return check(program, given).facts

        return ground_later(ground)

    def sizes(self, length: int) -> tuple[int, ...]:
        """Return how many entities of each group plans of a length need."""
        pairs = zip(self.groups, self.needs, strict=True)
        return tuple(min(len(group), needs.of(length)) for group, needs in pairs)

    def fewer(self, length: int) -> tuple[Program, Facts] | None:
        """Return the program with the entities that plans of a length need, and what it states; None if it is all."""
        like = self._like(self.sizes(length))
        if not like:
            return None
        program = self.alike.without(like)
        return program, check(program, self.given, like).facts

    @property
    def size(self) -> int:
        """The number of fluents, actions, conditions, effects and invariants of the whole program."""
        facts = self.facts
        tables = (facts.preconditions, facts.postconditions)
        pairs = ((action, fluent) for table in tables for action, values in table.items() for fluent, _ in values)
        invariants = chain(facts.exclusive, facts.implies, facts.impossible)
        return self._total(chain(pairs, invariants)) + self.total((*facts.fluents, *facts.actions))

    def total(self, terms: Iterable[clingo.Symbol]) -> int:
        """Return how many terms the whole program has where the least one has some."""
        return self._total((term,) for term in terms)

    def _total(self, rows: Iterable[tuple[clingo.Symbol, ...]]) -> int:
        kept = [[entity for entity in group if entity in self.facts.entities] for group in self.groups]
        place = {entity: number for number, group in enumerate(kept) for entity in group}
        names: dict[clingo.Symbol, set[clingo.Symbol]] = {}
        found: dict[tuple[int, ...], int] = {}
        for row in rows:
            named: set[clingo.Symbol] = set()
            for term in row:
                named |= names.get(term) or names.setdefault(term, named_in(term, place))
            groups = [place[entity] for entity in named]
            key = tuple(map(groups.count, range(len(kept))))
            found[key] = found.get(key, 0) + 1
        return sum(
            number * prod(map(perm, map(len, self.groups), key)) // prod(map(perm, map(len, kept), key))
            for key, number in found.items()
        )

    def _like(self, sizes: Sequence[int]) -> dict[clingo.Symbol, clingo.Symbol]:
        return _like(self.groups, sizes, self.given)


def find_needed(program: Program, given: Source, *, fewest: int = FEWEST) -> Needed | str | None:
    """Return what is needed of the entities of a program, or why all are, or None where nothing of it is large.

    The least program has passed every check. So would the whole one: no check sees more than what a few entities name.

    Raises:
        DomainError: something is wrong with the least program.
    """
    statements, problems = parse_sources(owned(program))
    encodings = encodings_folder(program)
    if problems or encodings is None or not _may_have(statements, fewest):
        return None
    try:
        alike = find_alike(program, statements)
        groups = [group for group in alike.groups if len(group) >= fewest]
        if not groups:
            return None
        told = objection(statements)
        if encodings.resolve() != data_folder("encodings").resolve():
            told = f"{encodings}: these encodings are others than the shipped ones"
        found = {} if told else _measured(alike, groups, given, statements)
    except DomainError:
        return None  # the check of the whole program tells what is wrong
    if not found:
        return told or "a few facts name too many of them together"
    like = _like(found, [needs.least for needs in found.values()], given)
    checked = check(alike.without(like), given, like)
    if any(action in group for group in groups for action in checked.facts.declared_actions):
        return "an action has the name of one of them"
    needed = Needed(program, given, alike, tuple(found), tuple(found.values()), checked)
    return needed if needed.size >= MANY else None


def is_large(facts: Facts) -> bool:
    """Return whether a program states so much that it is worth telling why all of it is ground."""
    tables = (facts.preconditions, facts.postconditions)
    return sum(len(values) for table in tables for values in table.values()) >= MANY


def named_in(term: clingo.Symbol, entities: Collection[clingo.Symbol]) -> set[clingo.Symbol]:
    """Return the entities that a term names."""
    found: set[clingo.Symbol] = set()
    waiting = [term]
    while waiting:
        each = waiting.pop()
        if each in entities:
            found.add(each)
        elif each.type == clingo.SymbolType.Function:
            waiting += each.arguments
    return found


def _may_have(statements: Iterable[Statement], fewest: int) -> bool:
    """Return whether so many entities may be stated, without grounding their facts."""
    stated = 0
    for statement in statements:
        if statement.own and statement.is_rule and any(atom.name == "entity" for atom in statement.heads):
            text = statement.text
            stated += fewest if ".." in text else 1 + text.count(";")
    return stated >= fewest


def _like(groups: Iterable[Group], sizes: Iterable[int], given: Source) -> dict[clingo.Symbol, clingo.Symbol]:
    """Return the entities of groups that are left out where only so many are ground: none that settings name."""
    words = set(re.findall(r"\w+", given.text))
    like: dict[clingo.Symbol, clingo.Symbol] = {}
    for group, size in zip(groups, sizes, strict=True):
        named = {each for each in group if str(each) in (given.text if each.arguments else words)}
        ordered = sorted(group, key=lambda each: each not in named)
        like |= dict.fromkeys(ordered[max(size, len(named)) :], ordered[0])
    return like


def _measured(
    alike: Alike, groups: Iterable[Group], given: Source, statements: Sequence[Statement]
) -> dict[Group, Needs]:
    """Return what is needed of groups, of those that have more than that.

    The measures are those of the whole program once so many are ground as they tell to be needed: no rule then reads
    facts that the whole program has and this one, up to renaming, has not.
    """
    sizes = {group: min(FIRST, len(group)) for group in groups}
    while sizes:
        grounder = Grounder(alike.without(_like(sizes, sizes.values(), given)))
        grounder.ground([("base", [])])
        found = {group: _needs(grounder.control, group, statements) for group in sizes}
        if all(found[group].least <= size for group, size in sizes.items()):
            return found
        sizes = {group: max(sizes[group], found[group].least) for group in sizes if found[group].least < len(group)}
    return {}


def _needs(control: clingo.Control, group: Group, statements: Sequence[Statement]) -> Needs:
    members = set(group)

    def most(signature: Signature) -> int:
        atoms = control.symbolic_atoms.by_signature(*signature)
        return max((len(named_in(atom.symbol, members)) for atom in atoms), default=0)

    rules = [[atom.signature for atom in rule.body if not atom.negated] for rule in derived(statements)]
    by_predicate = {each: most(each) for each in {("fluent", 1), ("action", 1), *INVARIANTS, *chain(*rules)}}
    fluent = by_predicate["fluent", 1]
    return Needs(
        action=by_predicate["action", 1],
        invariant=max(fluent, *(by_predicate[each] for each in INVARIANTS)),
        fluent=fluent,
        rule=max((sum(map(by_predicate.__getitem__, rule)) for rule in rules), default=0),
    )
