"""Interchangeable entities, found on the ground program.

Two entities of one class are interchangeable where swapping their names maps the ground rules of the step, the final
check and the initial values onto themselves, up to rules that the others entail. Such swaps generate all permutations
of a group of entities.

A swap is its own inverse: where the rules entail their image, the image entails them as well, and both have the same
answer sets.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations

import clingo
import numpy as np
from numpy.typing import NDArray

from prag_asp.logic.ground.ground import GroundStep
from prag_asp.logic.symmetry.atoms import Atoms, SpelledRule
from prag_asp.logic.symmetry.entailment import Consequences
from prag_asp.logic.symmetry.renaming import Shaped, Shapes
from prag_asp.program.facts import Facts


def interchangeable(facts: Facts, ground: GroundStep) -> list[tuple[clingo.Symbol, ...]]:
    """Return the groups of two or more interchangeable entities, each in clingo's order of terms."""
    entities = sorted(facts.entities)
    by_class: dict[clingo.Symbol, list[int]] = {}
    for number, each in enumerate(entities):
        by_class.setdefault(facts.entities[each], []).append(number)
    classes = [members for members in by_class.values() if len(members) > 1]
    if not classes:
        return []
    rules = _Rules(Atoms(ground, {entities[number]: number for members in classes for number in members}))
    groups: list[list[int]] = []
    for members in classes:
        found: list[list[int]] = []
        for entity in members:
            for group in found:
                if rules.kept_by(group[0], entity):
                    group.append(entity)
                    break
            else:
                found.append([entity])
        groups += [group for group in found if len(group) > 1]
    return [tuple(entities[number] for number in group) for group in groups]


def may_interchange(facts: Facts) -> bool:
    """Return whether there are entities whose swap maps the actions onto themselves; `interchangeable` ones are some.

    A step has an atom for each action, so that no others need to be looked for on the ground program.
    """
    names_of_classes = list(facts.entities.values())
    shapes = Shapes({entity: number for number, entity in enumerate(facts.entities)})
    actions = {shapes.of(action) for action in facts.actions}
    naming: dict[int, list[Shaped]] = {}
    for action in actions:
        for entity in set(action[1]):
            naming.setdefault(entity, []).append(action)

    def told(entity: int) -> object:
        """Return what a swap leaves as it is: the actions that name an entity, but for others of its class in them."""
        own = names_of_classes[entity]
        patterns = Counter(
            (shape, tuple(-1 if each == entity else -2 if names_of_classes[each] == own else each for each in inside))
            for shape, inside in naming.get(entity, ())
        )
        return own, frozenset(patterns.items())

    def kept(first: int, second: int) -> bool:
        names = {first: second, second: first}
        return all(
            (shape, tuple(names.get(each, each) for each in inside)) in actions
            for entity in (first, second)
            for shape, inside in naming.get(entity, ())
        )

    alike: dict[object, list[int]] = {}
    for entity in range(len(names_of_classes)):
        alike.setdefault(told(entity), []).append(entity)
    return any(kept(*pair) for members in alike.values() for pair in combinations(members, 2))


@dataclass(frozen=True)
class _Rules:
    """The rules of a ground step and its initial values."""

    atoms: Atoms

    def kept_by(self, first: int, second: int) -> bool:
        """Return whether the swap of two entities maps the rules onto themselves, up to those that others entail."""
        if not self._may_keep(first, second):
            return False
        swap = self.atoms.swap(first, second)
        for table in self._tables:
            for rule in table.missing(swap, first, second):
                if rule is None or not self._consequences(rule.last).has(rule):
                    return False
        return True

    def _may_keep(self, first: int, second: int) -> bool:
        """Return whether the swap of two entities maps the atoms that rules mention by name onto atoms.

        Most pairs differ in the first of them already, and cost nothing more.
        """
        names = {first: second, second: first}
        return all(
            self.atoms.has((shape, tuple(names.get(each, each) for each in inside)))
            for entity in (first, second)
            for shape, inside in self._shapes.get(entity, ())
        )

    @cached_property
    def _shapes(self) -> dict[int, list[Shaped]]:
        return self.atoms.shapes(self._deriving)

    @cached_property
    def _deriving(self) -> list[SpelledRule]:
        """The rules, each once, but for those that derive nothing since they need their own head."""
        return [
            rule
            for rule in self.atoms.rules
            if not (rule.is_plain and any((head, 0, 1) in rule.body[2] for head in rule.heads))
        ]

    @cached_property
    def _tables(self) -> list[_Table]:
        """The rules by their form."""
        forms: dict[tuple[int, bool, bool, int, int], list[SpelledRule]] = {}
        for rule in self._deriving:
            heads, (choice, bound, literals), last = rule
            forms.setdefault((len(heads), last, choice, bound, len(literals)), []).append(rule)
        return [_table(self.atoms, rules) for rules in forms.values()]

    def _consequences(self, last: bool) -> Consequences:
        """Return what follows in every step, or in the last one."""
        return self._of_the_last if last else self._of_every

    @cached_property
    def _of_every(self) -> Consequences:
        return Consequences((*(rule for rule in self.atoms.rules if not rule.last), *self.atoms.definitions))

    @cached_property
    def _of_the_last(self) -> Consequences:
        return Consequences((*self.atoms.rules, *self.atoms.definitions))


@dataclass(frozen=True)
class _Table:
    """Rules of one form, as rows: the numbers of the heads, then literals, then weights.

    A literal is twice the number of its atom, and 1 more where it is negated.

    `heads` and `literals` are the places in a row where they end; `choice`, `bound` and `last` are those of all rules.
    `having` are the rows that mention an entity.
    """

    rows: NDArray[np.int64]
    heads: int
    literals: int
    choice: bool
    bound: int
    last: bool
    having: dict[int, list[int]]

    def missing(self, swap: NDArray[np.int64], first: int, second: int) -> Iterator[SpelledRule | None]:
        """Yield the images of rules under the swap of two entities that are none of the rules.

        None stands for an image that has an atom that is none of the program.
        """
        having = sorted({*self.having.get(first, ()), *self.having.get(second, ())})
        if not having:
            return
        rows = self.rows[having]
        image = rows.copy()
        image[:, : self.heads] = swap[rows[:, : self.heads]]
        literals = rows[:, self.heads : self.literals]
        image[:, self.heads : self.literals] = 2 * swap[literals >> 1] + (literals & 1)
        if (image < 0).any():
            yield None
            return
        image, rows = self._ordered(image), self._ordered(rows)
        if not np.array_equal(image, rows):
            known = set(map(tuple, rows.tolist()))
            yield from (self._rule(row) for row in image.tolist() if tuple(row) not in known)

    def _rule(self, row: Sequence[int]) -> SpelledRule:
        inside = zip(row[self.heads : self.literals], row[self.literals :], strict=True)
        literals = frozenset((literal >> 1, literal & 1, weight) for literal, weight in inside)
        return SpelledRule(frozenset(row[: self.heads]), (self.choice, self.bound, literals), self.last)

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


def _table(atoms: Atoms, rules: Iterable[SpelledRule]) -> _Table:
    rows: list[list[int]] = []
    having: dict[int, list[int]] = {}
    for row, rule in enumerate(rules):
        choice, bound, literals = rule.body
        ordered = sorted(literals)
        inside = [*rule.heads, *(atom for atom, _, _ in ordered)]
        rows.append([*rule.heads, *(2 * atom + sign for atom, sign, _ in ordered), *(each[2] for each in ordered)])
        for entity in {entity for atom in inside for entity in atoms.mentioned[atom]}:
            having.setdefault(entity, []).append(row)
    heads, end = len(rule.heads), len(rule.heads) + len(literals)
    return _Table(np.array(rows, dtype=np.int64), heads, end, choice, bound, rule.last, having)
