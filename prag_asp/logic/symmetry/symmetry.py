"""Interchangeable entities, found on the ground program.

Two entities of one class are interchangeable where swapping their names maps the ground rules of the step, the final
check and the initial values onto themselves. Such swaps generate all permutations of a group of entities.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import clingo
import numpy as np
from numpy.typing import NDArray

from prag_asp.logic.ground.ground import GroundStep, Rule
from prag_asp.logic.symmetry.renaming import Shaped, Shapes
from prag_asp.program.facts import Facts

SpelledLiteral = tuple[int, int, int]
"""An atom by its number, whether it is negated (1) or not (0), and its weight."""

SpelledBody = tuple[bool, int, frozenset[SpelledLiteral]]
"""Whether the head is a choice, the sum that the body has to reach, and its literals."""

Key = Shaped | frozenset[SpelledBody] | int
"""What an atom is: its shape with its entities; where it has no name, what its rules say; itself, where all fails."""

MISSING = -1
START = 2**32
"""The bound of the rules that state the initial values."""


def interchangeable(facts: Facts, ground: GroundStep) -> list[tuple[clingo.Symbol, ...]]:
    """Return the groups of two or more interchangeable entities, each in clingo's order of terms."""
    entities = sorted(facts.entities)
    by_class: dict[clingo.Symbol, list[int]] = {}
    for number, each in enumerate(entities):
        by_class.setdefault(facts.entities[each], []).append(number)
    classes = [members for members in by_class.values() if len(members) > 1]
    if not classes:
        return []
    atoms = _Atoms(ground, {entities[number]: number for members in classes for number in members})
    tables = _tables(atoms)
    groups: list[list[int]] = []
    for members in classes:
        found: list[list[int]] = []
        for entity in members:
            for group in found:
                swap = atoms.swap(group[0], entity)
                if all(table.kept_by(swap, group[0], entity) for table in tables):
                    group.append(entity)
                    break
            else:
                found.append([entity])
        groups += [group for group in found if len(group) > 1]
    return [tuple(entities[number] for number in group) for group in groups]


class _Atoms:
    """Numbers for the atoms of a ground step: atoms that mean the same have the same."""

    def __init__(self, ground: GroundStep, entities: Mapping[clingo.Symbol, int]) -> None:
        shapes = Shapes(entities)
        self._numbers: dict[Key, int] = {}
        self._keys: list[Key] = []
        self.mentioned: list[frozenset[int]] = []
        self._with: dict[int, list[int]] = {entity: [] for entity in entities.values()}
        self._of_atom = {atom: self._named(shapes.of(symbol)) for atom, symbol in ground.names.items()}
        self._rules: dict[int, list[Rule]] = {}
        self.rules: list[Rule] = []
        for rule in (rule for part in ("step", "check") for rule in ground.rules.get(part, ())):
            if len(rule.heads) == 1 and rule.heads[0] not in ground.names:
                self._rules.setdefault(rule.heads[0], []).append(rule)
            else:
                self.rules.append(rule)
        self.start = [self._named(shapes.of(symbol)) for symbol in ground.initial]

    def number(self, atom: int) -> int:
        """Return the number of an atom of the ground step."""
        if atom not in self._of_atom:
            # An atom that is defined by way of itself stays what it is there.
            self._of_atom[atom] = self._new(-atom - 1, frozenset())
            bodies = frozenset(self.body(rule) for rule in self._rules.get(atom, ()))
            inside = {below for _, _, literals in bodies for below, _, _ in literals}
            mentioned = frozenset(entity for below in inside for entity in self.mentioned[below])
            self._of_atom[atom] = self._new(bodies, mentioned)
        return self._of_atom[atom]

    def body(self, rule: Rule) -> SpelledBody:
        """Return the body of a rule in numbers, each literal once."""
        if not rule.weights:
            plain = frozenset((self.number(abs(literal)), int(literal < 0), 1) for literal in rule.body)
            return rule.choice, len(plain), plain
        counted: dict[tuple[int, int], int] = {}
        for literal, weight in zip(rule.body, rule.weights, strict=True):
            key = (self.number(abs(literal)), int(literal < 0))
            counted[key] = counted.get(key, 0) + weight
        literals = frozenset((atom, sign, weight) for (atom, sign), weight in counted.items())
        return rule.choice, rule.bound, literals

    def swap(self, first: int, second: int) -> NDArray[np.int64]:
        """Return the number of each atom under the swap of two entities, `MISSING` where there is no such atom."""
        swapped = np.arange(len(self._keys))
        names = {first: second, second: first}
        for number in sorted({*self._with[first], *self._with[second]}):
            swapped[number] = self._numbers.get(self._swapped(self._keys[number], names, swapped), MISSING)
        return swapped

    def _swapped(self, key: Key, names: Mapping[int, int], swapped: NDArray[np.int64]) -> Key:
        """Return what an atom is under a swap, which is known of the atoms with smaller numbers."""
        if isinstance(key, tuple):
            shape, entities = key
            return shape, tuple(names.get(entity, entity) for entity in entities)
        if isinstance(key, int):
            return key
        return frozenset(
            (choice, bound, frozenset((int(swapped[atom]), sign, weight) for atom, sign, weight in literals))
            for choice, bound, literals in key
        )

    def _named(self, key: Shaped) -> int:
        return self._new(key, frozenset(key[1]))

    def _new(self, key: Key, mentioned: frozenset[int]) -> int:
        if key not in self._numbers:
            number = self._numbers[key] = len(self._keys)
            self._keys.append(key)
            self.mentioned.append(mentioned)
            for entity in mentioned:
                self._with[entity].append(number)
        return self._numbers[key]


@dataclass(frozen=True)
class _Table:
    """Rules of one form, as rows: the numbers of the heads, then literals, then weights.

    A literal is twice the number of its atom, and 1 more where it is negated.

    `heads` and `literals` are the places in a row where they end. `having` are the rows that mention an entity.
    """

    rows: NDArray[np.int64]
    heads: int
    literals: int
    having: dict[int, list[int]]

    def kept_by(self, swap: NDArray[np.int64], first: int, second: int) -> bool:
        """Return whether the swap of two entities maps the rules onto themselves."""
        having = sorted({*self.having.get(first, ()), *self.having.get(second, ())})
        if not having:
            return True
        rows = self.rows[having]
        image = rows.copy()
        image[:, : self.heads] = swap[rows[:, : self.heads]]
        literals = rows[:, self.heads : self.literals]
        image[:, self.heads : self.literals] = 2 * swap[literals >> 1] + (literals & 1)
        return bool((image >= 0).all()) and np.array_equal(self._ordered(image), self._ordered(rows))

    def _ordered(self, rows: NDArray[np.int64]) -> NDArray[np.int64]:
        """Return rows in order, each with its heads and its literals in order."""
        inside = rows.copy()
        inside[:, : self.heads].sort(axis=1)
        order = np.argsort(inside[:, self.heads : self.literals], axis=1, kind="stable")
        for start in (self.heads, self.literals):
            part = inside[:, start : start + order.shape[1]]
            part[:] = np.take_along_axis(part, order, axis=1)
        ordered: NDArray[np.int64] = inside[np.lexsort(inside.T[::-1])]
        return ordered


def _tables(atoms: _Atoms) -> list[_Table]:
    """Return the rules of a ground step and its initial values, each once, by their form."""
    spelled: set[tuple[frozenset[int], SpelledBody]] = {
        (frozenset(map(atoms.number, rule.heads)), atoms.body(rule)) for rule in atoms.rules
    }
    spelled |= {(frozenset({atom}), (False, START, frozenset())) for atom in atoms.start}
    forms: dict[tuple[int, bool, int, int], list[tuple[frozenset[int], Sequence[SpelledLiteral]]]] = {}
    for heads, (choice, bound, literals) in spelled:
        form = (len(heads), choice, bound, len(literals))
        forms.setdefault(form, []).append((heads, sorted(literals)))
    return [_table(atoms, rules) for rules in forms.values()]


def _table(atoms: _Atoms, rules: Iterable[tuple[frozenset[int], Sequence[SpelledLiteral]]]) -> _Table:
    rows: list[list[int]] = []
    having: dict[int, list[int]] = {}
    heads: frozenset[int] = frozenset()
    literals: Sequence[SpelledLiteral] = ()
    for row, (heads, literals) in enumerate(rules):
        inside = [*heads, *(atom for atom, _, _ in literals)]
        rows.append([*heads, *(2 * atom + sign for atom, sign, _ in literals), *(weight for _, _, weight in literals)])
        for entity in {entity for atom in inside for entity in atoms.mentioned[atom]}:
            having.setdefault(entity, []).append(row)
    end = len(heads) + len(literals)
    return _Table(np.array(rows, dtype=np.int64), len(heads), end, having)
