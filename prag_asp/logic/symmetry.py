"""Interchangeable entities, found on the ground program.

Two entities of one class are interchangeable where swapping their names maps the ground rules of the step, the final
check and the initial values onto themselves. Such swaps generate all permutations of a group of entities.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Mapping

import clingo

from prag_asp.domain.facts import Facts
from prag_asp.logic.ground import GroundStep, Rule

Term = Hashable
"""A symbol as nested tuples of names."""

Spelled = tuple[Hashable, ...]
"""A rule whose atoms are numbers of a `_Spelling`."""


def interchangeable(facts: Facts, ground: GroundStep) -> list[tuple[clingo.Symbol, ...]]:
    """Return the groups of two or more interchangeable entities, each in clingo's order of terms."""
    terms = {entity: _term(entity) for entity in sorted(facts.entities)}
    by_class: dict[str, list[clingo.Symbol]] = {}
    for entity in terms:
        by_class.setdefault(facts.entities[entity], []).append(entity)
    classes = [members for members in by_class.values() if len(members) > 1]
    spelling = _Spelling(ground, {terms[entity] for members in classes for entity in members})
    rules = frozenset(spelling.rules)
    index: dict[Term, list[Spelled]] = {}
    for rule in rules:
        for mate in spelling.mates_of(rule):
            index.setdefault(mate, []).append(rule)
    groups: list[list[clingo.Symbol]] = []
    for members in classes:
        found: list[list[clingo.Symbol]] = []
        for entity in members:
            for group in found:
                first, second = terms[group[0]], terms[entity]
                swap = spelling.swapping(first, second)
                if all(swap.rule(rule) in rules for mate in (first, second) for rule in index.get(mate, ())):
                    group.append(entity)
                    break
            else:
                found.append([entity])
        groups += [group for group in found if len(group) > 1]
    return [tuple(group) for group in groups]


class _Spelling:
    """The rules of a ground step with a number for each atom; an unnamed atom is what its rules say it is."""

    def __init__(self, ground: GroundStep, mates: set[Term]) -> None:
        self.numbers: dict[Term, int] = {}
        self.terms: list[Term] = []
        self._mates = mates
        self._mentioned: list[frozenset[Term]] = []
        self._atoms = {atom: self._number(_term(symbol), ()) for atom, symbol in ground.names.items()}
        self._definitions: dict[int, list[Rule]] = {}
        kept = []
        for part in ("step", "check"):
            for rule in ground.rules.get(part, ()):
                if len(rule.heads) == 1 and rule.heads[0] not in ground.names:
                    self._definitions.setdefault(rule.heads[0], []).append(rule)
                else:
                    kept.append(rule)
        self.rules: list[Spelled] = [
            (frozenset(map(self._atom, rule.heads)), *self._body(rule)) for rule in kept
        ]  # fmt: skip
        initial = frozenset(self._number(_term(symbol), ()) for symbol in ground.initial)
        self.rules += [(frozenset({atom}), "start", 0, frozenset[object]()) for atom in initial]

    def mates_of(self, rule: Spelled) -> set[Term]:
        heads, _, _, body = rule
        assert isinstance(heads, frozenset) and isinstance(body, frozenset)
        atoms = (*heads, *(atom for (_, atom), _ in body))
        return {mate for atom in atoms for mate in self._mentioned[atom]}

    def swapping(self, first: Term, second: Term) -> _Swap:
        return _Swap(self, first, second)

    def _number(self, term: Term, inside: Iterable[int]) -> int:
        if term not in self.numbers:
            self.numbers[term] = len(self.terms)
            self.terms.append(term)
            below = {mate for atom in inside for mate in self._mentioned[atom]}
            self._mentioned.append(frozenset(below | (_subterms(term) & self._mates if not inside else set())))
        return self.numbers[term]

    def _atom(self, atom: int) -> int:
        if atom not in self._atoms:
            self._atoms[atom] = self._number(("unnamed", atom), ())  # where it is defined by way of itself
            bodies = frozenset(self._body(rule) for rule in self._definitions.get(atom, ()))
            inside = [below for _, _, body in bodies for (_, below), _ in body]
            self._atoms[atom] = self._number(("defined", bodies), inside)
        return self._atoms[atom]

    def _body(self, rule: Rule) -> tuple[bool, int, frozenset[tuple[tuple[bool, int], int]]]:
        weights = rule.weights or (1,) * len(rule.body)
        counted: dict[tuple[bool, int], int] = {}
        for literal, weight in zip(rule.body, weights, strict=True):
            key = (literal > 0, self._atom(abs(literal)))
            counted[key] = counted.get(key, 0) + weight
        return rule.choice, rule.bound if rule.weights else len(rule.body), frozenset(counted.items())


class _Swap:
    """The swap of two entities as a map on the numbers of a spelling; -1 is an atom that does not exist."""

    def __init__(self, spelling: _Spelling, first: Term, second: Term) -> None:
        self._spelling = spelling
        self._names: dict[Term, Term] = {first: second, second: first}
        self._cache: dict[int, int] = {}

    def rule(self, rule: Spelled) -> Spelled:
        heads, kind, bound, body = rule
        assert isinstance(heads, frozenset)
        return (frozenset(map(self._atom, heads)), kind, bound, self._literals(body))

    def _literals(self, body: Hashable) -> frozenset[object]:
        assert isinstance(body, frozenset)
        return frozenset(((positive, self._atom(atom)), weight) for (positive, atom), weight in body)

    def _atom(self, number: int) -> int:
        if number not in self._cache:
            term = self._spelling.terms[number]
            if isinstance(term, tuple) and term[0] == "defined" and isinstance(term[1], frozenset):
                bodies = frozenset((kind, bound, self._literals(body)) for kind, bound, body in term[1])
                renamed: Term = ("defined", bodies)
            else:
                renamed = _renamed(term, self._names)
            self._cache[number] = self._spelling.numbers.get(renamed, -1)
        return self._cache[number]


def _term(symbol: clingo.Symbol) -> Term:
    if symbol.type == clingo.SymbolType.Function:
        return (symbol.name, symbol.positive, *map(_term, symbol.arguments))
    return (str(symbol),)


def _renamed(term: Term, names: Mapping[Term, Term]) -> Term:
    if not isinstance(term, tuple):
        return term
    return names[term] if term in names else tuple(_renamed(part, names) for part in term)


def _subterms(term: Term) -> set[Term]:
    below = (found for part in term for found in _subterms(part)) if isinstance(term, tuple) else ()
    return {term, *below}
