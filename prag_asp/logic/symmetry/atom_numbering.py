"""Numbers for the atoms of a ground step: atoms with the same meaning have the same number.

A named atom is identified by its name. An unnamed atom is identified by its rules, in terms of the numbers of the atoms
that they read. A rule that only copies another unnamed atom is replaced by the rules of that atom, so that chains of
copies do not matter. The atoms of a strongly connected component are compared together: their rules are unfolded until
unfolding them once more distinguishes no further atoms (partition refinement, Paige and Tarjan 1987), and an atom is
identified by its unfolding together with the unfoldings of the whole component. Two atoms with the same number then
have the same rules in terms of numbers, and hence the same truth value, because they are equal at each stage of the
least model of positive rules. Atoms that depend on themselves through a negation, and chosen atoms, have no least model
and are identified by themselves.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import cached_property
from typing import NamedTuple

import clingo
import numpy as np
from numpy.typing import NDArray

from prag_asp.logic.ground.ground_step import GroundStep
from prag_asp.logic.ground.rules import Rule
from prag_asp.logic.symmetry.renaming import Shaped, Shapes, by_entity
from prag_asp.program.finite.components import components
from prag_asp.program.predicates import FINDING

SpelledLiteral = tuple[int, int, int]
"""The number of an atom, whether it is negated (1) or not (0), and its weight."""

SpelledBody = tuple[bool, int, frozenset[SpelledLiteral]]
"""Whether the head is a choice, the sum that the body must reach, and the body's literals."""

Key = Shaped | frozenset[SpelledBody] | int
"""The identity of an atom: its shape with its entities, its rules if it is unnamed, or otherwise the atom itself."""

MISSING = -1
INSIDE = 0
"""The placeholder for an atom of a component before its rules are unfolded."""

START, COMPONENT = 2**32, 2**33
"""Impossible sums that mark the bodies of rules for initial values, and of placeholders for atoms of a component."""


class SpelledRule(NamedTuple):
    """A rule in terms of atom numbers; `last` states whether it belongs to the check after the last step."""

    heads: frozenset[int]
    body: SpelledBody
    last: bool = False

    @property
    def is_plain(self) -> bool:
        """Whether the rule is neither a choice nor a sum."""
        choice, bound, literals = self.body
        return not choice and bound == len(literals) and all(weight == 1 for _, _, weight in literals)


class Atoms:
    """The numbered atoms of a ground step, and its rules."""

    def __init__(self, ground: GroundStep, entities: Mapping[clingo.Symbol, int]) -> None:
        shapes = Shapes(entities)
        self._numbers: dict[Key, int] = {}
        self._keys: list[Key] = []
        self.mentioned: list[frozenset[int]] = []
        self._with: dict[int, list[int]] = {entity: [] for entity in entities.values()}
        self._of_atom = {
            atom: self._named(shapes.of(symbol))
            for atom, symbol in ground.names.items()
            if not symbol.match(*FINDING)  # a condition may assign different numbers to interchangeable entities in it
        }
        step, facts = propagate_facts(ground.rules.get("step", ()))
        check, _ = propagate_facts(ground.rules.get("check", ()), facts)
        tagged = [*((rule, False) for rule in step), *((rule, True) for rule in check)]
        self._defining = definitions = self._definitions(rule for rule, _ in tagged)
        for component in components(definitions, lambda atom: _below(definitions[atom], definitions)):
            self._number_component(component, definitions)
        self.rules = {
            SpelledRule(frozenset(map(self.number, rule.heads)), self._body(rule), last)
            for rule, last in tagged
            if not (len(rule.heads) == 1 and rule.heads[0] in definitions)
        }
        start = (self._named(shapes.of(symbol)) for symbol in ground.initial)
        self.rules |= {SpelledRule(frozenset({atom}), (False, START, frozenset())) for atom in start}

    @cached_property
    def definitions(self) -> set[SpelledRule]:
        """The rules of the atoms that are identified by their rules."""
        rules = ((atom, rule) for atom, own in self._defining.items() for rule in own)
        return {SpelledRule(frozenset({self.number(atom)}), self._body(rule)) for atom, rule in rules}

    def number(self, atom: int) -> int:
        """Return the number of an atom of the ground step; an atom without rules is false."""
        if atom not in self._of_atom:
            self._of_atom[atom] = self._new(frozenset(), frozenset())
        return self._of_atom[atom]

    def shapes(self, rules: Iterable[SpelledRule]) -> dict[int, list[Shaped]]:
        """Return the named atoms of rules, keyed by the entities that they name."""
        inside = {atom for heads, (_, _, body), _ in rules for atom in (*heads, *(each for each, _, _ in body))}
        return by_entity(key for atom in sorted(inside) if isinstance(key := self._keys[atom], tuple))

    def has(self, shaped: Shaped) -> bool:
        """Return whether there is a named atom with the given shape and entities."""
        return shaped in self._numbers

    def named_atoms(self, atoms: Mapping[int, int]) -> Iterator[tuple[Shaped, int]]:
        """Yield the shapes and entities of the named atoms among the given ones, each with the value of its atom."""
        for number, mark in atoms.items():
            key = self._keys[number]
            if isinstance(key, tuple):
                yield key, mark

    def entities(self, rule: SpelledRule) -> frozenset[int]:
        """Return the entities that a rule mentions."""
        inside = (*rule.heads, *(atom for atom, _, _ in rule.body[2]))
        return frozenset().union(*map(self.mentioned.__getitem__, inside))

    def renamed(self, rule: SpelledRule, names: Mapping[int, int]) -> SpelledRule | None:
        """Return a rule with renamed entities, or None if one of its atoms has no image."""
        heads, (choice, bound, literals), last = rule
        moved: dict[int, int] = {}

        def image(atom: int) -> int:
            if atom not in moved:
                same = names.keys().isdisjoint(self.mentioned[atom])
                moved[atom] = atom if same else self._image(atom, names, image)
            return moved[atom]

        for atom in sorted({*heads, *(atom for atom, _, _ in literals)}):
            image(atom)
        if MISSING in moved.values():
            return None
        body = frozenset((moved[atom], sign, weight) for atom, sign, weight in literals)
        return SpelledRule(frozenset(moved[atom] for atom in heads), (choice, bound, body), last)

    def under(self, names: Mapping[int, int]) -> NDArray[np.int64]:
        """Return the number of each renamed atom, or `MISSING` if there is no such atom, shape (atoms,)."""
        renamed = np.arange(len(self._keys))
        for number in sorted({number for entity in names for number in self._with[entity]}):
            # rules mention only atoms with smaller numbers
            renamed[number] = self._image(number, names, lambda atom: int(renamed[atom]))
        return renamed

    def _image(self, atom: int, names: Mapping[int, int], image: Callable[[int], int]) -> int:
        """Return the number of a renamed atom, given the images of the atoms in its rules, or `MISSING`."""
        key = self._keys[atom]
        if isinstance(key, tuple):
            shape, entities = key
            key = shape, tuple(names.get(entity, entity) for entity in entities)
        elif isinstance(key, frozenset):
            key = frozenset(
                (choice, bound, frozenset((image(each), sign, weight) for each, sign, weight in literals))
                for choice, bound, literals in key
            )
        return self._numbers.get(key, MISSING)

    def _definitions(self, rules: Iterable[Rule]) -> dict[int, list[Rule]]:
        """Return the rules of unnamed atoms that are identified by rules; number the other unnamed atoms."""
        definitions: dict[int, list[Rule]] = {}
        for rule in rules:
            for head in rule.heads:
                if head in self._of_atom:
                    continue
                if rule.choice or len(rule.heads) > 1:
                    self._of_atom[head] = self._new(-head, frozenset())
                else:
                    definitions.setdefault(head, []).append(rule)
        definitions = {atom: own for atom, own in definitions.items() if atom not in self._of_atom}
        for component in list(components(definitions, lambda atom: _below(definitions[atom], definitions))):
            read = {literal for atom in component for rule in definitions[atom] for literal in rule.body}
            if any(-atom in read for atom in component):
                for atom in component:
                    self._of_atom[atom] = self._new(-atom, frozenset())
                    del definitions[atom]
        return dict(_passed_on(definitions))

    def _number_component(self, component: list[int], definitions: Mapping[int, list[Rule]]) -> None:
        """Assign numbers to the atoms of a component, which may be a single atom."""
        if len(component) == 1 and component[0] not in _below(definitions[component[0]], definitions):
            self._of_atom[component[0]] = self._number_by_rules(definitions[component[0]])
            return
        inside = self._new(INSIDE, frozenset())
        self._of_atom.update(dict.fromkeys(component, inside))
        classes = 1
        while True:
            finer = {atom: self._number_by_rules(definitions[atom]) for atom in component}
            self._of_atom.update(finer)
            if len(set(finer.values())) == classes:
                break
            classes = len(set(finer.values()))
        whole = self._defined(frozenset({(False, COMPONENT, frozenset((each, 0, 1) for each in finer.values()))}))
        for atom, own in finer.items():
            key = frozenset({(False, COMPONENT, frozenset({(own, 0, 1), (whole, 0, 2)}))})
            self._of_atom[atom] = self._defined(key)

    def _number_by_rules(self, rules: Iterable[Rule]) -> int:
        """Return the number of an unnamed atom, given the numbers of the atoms that its rules read."""
        return self._defined(frozenset(map(self._body, rules)))

    def _body(self, rule: Rule) -> SpelledBody:
        """Return the body of a rule in terms of atom numbers, each literal once."""
        if not rule.weights:
            plain = frozenset((self.number(abs(literal)), int(literal < 0), 1) for literal in rule.body)
            return rule.choice, len(plain), plain
        counted: dict[tuple[int, int], int] = {}
        for literal, weight in zip(rule.body, rule.weights, strict=True):
            key = (self.number(abs(literal)), int(literal < 0))
            counted[key] = counted.get(key, 0) + weight
        literals = frozenset((atom, sign, weight) for (atom, sign), weight in counted.items())
        return rule.choice, rule.bound, literals

    def _named(self, key: Shaped) -> int:
        return self._new(key, frozenset(key[1]))

    def _defined(self, key: frozenset[SpelledBody]) -> int:
        inside = {atom for _, _, literals in key for atom, _, _ in literals}
        return self._new(key, frozenset(entity for atom in inside for entity in self.mentioned[atom]))

    def _new(self, key: Key, mentioned: frozenset[int]) -> int:
        if key not in self._numbers:
            number = self._numbers[key] = len(self._keys)
            self._keys.append(key)
            self.mentioned.append(mentioned)
            for entity in mentioned:
                self._with[entity].append(number)
        return self._numbers[key]


def propagate_facts(rules: Sequence[Rule], facts: Iterable[int] = ()) -> tuple[list[Rule], set[int]]:
    """Return equivalent rules without facts in their bodies, and all facts, including the given `facts`.

    clingo leaves facts as literals in the rules of recursive predicates; which facts it leaves depends on its order of
    atoms.
    """
    derived = {*facts, *(rule.heads[0] for rule in rules if _states(rule))}
    remaining = dict(enumerate(rules))
    reading: dict[int, list[int]] = {}
    for number, rule in remaining.items():
        for literal in rule.body:
            reading.setdefault(abs(literal), []).append(number)
    waiting = deque(derived)
    while waiting:
        fact = waiting.popleft()
        for number in reading.get(fact, ()):
            if number not in remaining:
                continue
            rest = _simplified(remaining.pop(number), fact)
            if rest is not None:
                remaining[number] = rest
                if _states(rest) and rest.heads[0] not in derived:
                    derived.add(rest.heads[0])
                    waiting.append(rest.heads[0])
    simplified: list[Rule] = []
    stated = set[int]()
    for _, rule in sorted(remaining.items()):  # each known fact is stated once and not derived again
        if len(rule.heads) != 1 or rule.choice or rule.heads[0] not in derived:
            simplified.append(rule)
        elif _states(rule) and rule.heads[0] not in stated:
            stated.add(rule.heads[0])
            simplified.append(rule)
    return simplified, derived


def _states(rule: Rule) -> bool:
    """Return whether a rule is a fact."""
    return not rule.body and not rule.choice and len(rule.heads) == 1 and rule.bound <= 0


def _simplified(rule: Rule, fact: int) -> Rule | None:
    """Return a rule simplified by a fact, or None if the fact makes its body false."""
    if not rule.weights:
        if -fact in rule.body:
            return None
        return Rule(rule.heads, tuple(literal for literal in rule.body if literal != fact), rule.choice)
    rest = [pair for pair in zip(rule.body, rule.weights, strict=True) if abs(pair[0]) != fact]
    bound = rule.bound - sum(weight for literal, weight in zip(rule.body, rule.weights, strict=True) if literal == fact)
    if bound <= 0:
        return Rule(rule.heads, (), rule.choice)
    if sum(weight for _, weight in rest) < bound:
        return None
    return Rule(rule.heads, tuple(each for each, _ in rest), rule.choice, bound, tuple(each for _, each in rest))


def _below(rules: Iterable[Rule], among: Mapping[int, object]) -> list[int]:
    """Return the atoms of `among` that the rules read."""
    return [abs(literal) for rule in rules for literal in rule.body if abs(literal) in among]


def _passed_on(rules: Mapping[int, list[Rule]]) -> Iterator[tuple[int, list[Rule]]]:
    """Yield each atom with its rules; a rule that only copies another atom is replaced by the rules of that atom.

    Rules that read their own head derive nothing and are dropped.
    """
    passes = {atom: [rule.body[0] for rule in own if _passes(rule, rules)] for atom, own in rules.items()}
    solid = {atom: [rule for rule in own if not _passes(rule, rules)] for atom, own in rules.items()}
    for atom in rules:
        reached = {atom: None}
        waiting = [atom]
        while waiting:
            for below in passes[waiting.pop()]:
                if below not in reached:
                    reached[below] = None
                    waiting.append(below)
        derived_by = (rule for below in reached for rule in solid[below])
        yield atom, [rule for rule in derived_by if rule.weights or atom not in rule.body]


def _passes(rule: Rule, among: Mapping[int, object]) -> bool:
    """Return whether a rule only copies an atom of `among`."""
    return len(rule.body) == 1 and not rule.weights and rule.body[0] in among
