"""Interchangeable entities, found on the ground program.

Two entities of one class are interchangeable if swapping their names maps the ground rules of the step, the final check
and the initial values onto themselves, up to entailed rules. Such swaps generate all permutations of a group. If no
single swap does, several swaps together may: `unit_symmetry` searches for them.

A renaming that consists of swaps is its own inverse. If the rules entail their image, the image therefore entails the
rules, and both have the same answer sets.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property, partial
from itertools import combinations
from weakref import WeakKeyDictionary

import clingo
import numpy as np
from numpy.typing import NDArray

from prag_asp.logic.ground.ground_step import GroundStep
from prag_asp.logic.symmetry.atom_numbering import START, Atoms, SpelledRule
from prag_asp.logic.symmetry.consequences import Consequences
from prag_asp.logic.symmetry.renaming import Shaped, Shapes, by_entity
from prag_asp.logic.symmetry.symmetries import Symmetries
from prag_asp.logic.symmetry.unit_symmetry import MissingImage, joint_groups
from prag_asp.program.entity_names import action_name
from prag_asp.program.facts import Facts

WITNESSES = 4
"""The maximum number of rules that are cached because some swap does not preserve them."""


def find_symmetries(facts: Facts, ground: GroundStep, bare: Callable[[], GroundStep] | None = None) -> Symmetries:
    """Return the groups of interchangeable entities, each in clingo's order of terms, and the joint groups.

    If `bare` is given, renamings must also preserve the step that it returns; it is called only if `ground` has
    interchangeable entities.
    """
    entities, class_of = sorted(facts.entities), _stated(facts)
    by_class: dict[Hashable, list[int]] = {}
    for number, each in enumerate(entities):
        by_class.setdefault(class_of[each], []).append(number)
    classes = [members for members in by_class.values() if len(members) > 1]
    if not classes:
        return Symmetries()
    numbers = {entities[number]: number for members in classes for number in members}
    rules = _Rules(Atoms(ground, numbers), None if bare is None else lambda: _shared_rules(bare(), numbers))
    blocks: list[list[int]] = []
    for members in classes:
        alike: list[list[int]] = []
        for entity in members:
            for group in alike:
                if rules.kept_by(group[0], entity):
                    group.append(entity)
                    break
            else:
                alike.append([entity])
        blocks += alike
    kinds = {number: class_of[entity] for entity, number in numbers.items()}
    joint = joint_groups([tuple(block) for block in blocks], kinds, rules)

    def named(numbers: Iterable[int]) -> tuple[clingo.Symbol, ...]:
        return tuple(entities[number] for number in numbers)

    groups = tuple(named(block) for block in blocks if len(block) > 1)
    return Symmetries(groups, tuple(tuple(map(named, units)) for units in joint))


def may_interchange(facts: Facts) -> bool:
    """Return whether some renaming maps the actions onto themselves, as those of `find_symmetries` do.

    A step has an atom for each action, so if there is no such renaming, the ground program need not be searched.
    """
    names_of_classes = list(_stated(facts).values())
    shapes = Shapes({entity: number for number, entity in enumerate(facts.entities)})
    shaped = dict.fromkeys(map(shapes.of, facts.actions))
    actions = _Terms(shaped, by_entity(shaped), shaped.__contains__)

    def spoken(entity: int) -> object:
        """Return an invariant of swaps: patterns of the actions that name an entity, without others of its class."""
        own = names_of_classes[entity]
        patterns = Counter(
            (shape, tuple(-1 if each == entity else -2 if names_of_classes[each] == own else each for each in inside))
            for shape, inside in actions.naming.get(entity, ())
        )
        return own, frozenset(patterns.items())

    def kept(first: int, second: int) -> bool:
        return next(actions.lacking({first: second, second: first}, (first, second)), None) is None

    alike: dict[object, list[int]] = {}
    for entity in range(len(names_of_classes)):
        alike.setdefault(spoken(entity), []).append(entity)
    if any(kept(*pair) for members in alike.values() for pair in combinations(members, 2)):
        return True
    kinds = dict(enumerate(names_of_classes))
    return bool(joint_groups([(entity,) for entity in kinds], kinds, actions))


def _stated(facts: Facts) -> dict[clingo.Symbol, Hashable]:
    """Return the class of each entity, and also its name if the entity is itself an action.

    Skeletons consist of action names, so renamings must preserve them.
    """
    actions = frozenset(facts.actions)
    return {each: (kind, action_name(each) if each in actions else "") for each, kind in facts.entities.items()}


@dataclass(frozen=True)
class _Terms:
    """Terms that renamings must map onto themselves; `has` tests for a term, `naming` holds the terms by entity."""

    exact: Collection[Shaped]
    naming: Mapping[int, Sequence[Shaped]]
    has: Callable[[Shaped], bool]

    def lacking(self, names: Mapping[int, int], entities: Iterable[int]) -> Iterator[MissingImage]:
        """Yield the terms that name any of the given entities and whose image is not a term."""
        for entity in entities:
            for shape, inside in self.naming.get(entity, ()):
                if not self.has((shape, tuple([names.get(each, each) for each in inside]))):
                    yield MissingImage(frozenset(inside), partial(self._has_image, (shape, inside)))

    def _has_image(self, shaped: Shaped, names: Mapping[int, int]) -> bool:
        shape, inside = shaped
        return self.has((shape, tuple(names.get(each, each) for each in inside)))

    def broken(self, names: Mapping[int, int]) -> Iterator[MissingImage]:
        """Yield nothing: there are no rules."""
        return iter(())

    def size(self, entities: Iterable[int]) -> int:
        """Return the number of terms that name each entity, summed over the entities, as a measure of the work."""
        return sum(len(self.naming.get(entity, ())) for entity in entities)


@dataclass(frozen=True)
class _Rules:
    """The rules of a ground step with its initial values, and any other rules that renamings must also preserve."""

    atoms: Atoms
    others: Callable[[], _Rules] | None = None
    _kept: dict[tuple[int, int], bool] = field(default_factory=dict)
    _consequences: dict[bool, Consequences] = field(default_factory=dict)
    _witnesses: list[tuple[SpelledRule, int, int]] = field(default_factory=list)
    """Rules that swaps of two entities do not preserve, each with the two entities; the most recently useful rule comes
    first."""

    @cached_property
    def _others(self) -> _Rules | None:
        return self.others() if self.others else None

    def kept_by(self, first: int, second: int) -> bool:
        """Return whether the swap of two entities maps the rules onto themselves, up to entailed rules."""
        if (first, second) not in self._kept:
            self._kept[first, second] = self._test_swap(first, second)
        return self._kept[first, second]

    def _test_swap(self, first: int, second: int) -> bool:
        """Test a swap.

        The test is cheap because most pairs differ in one of the first atoms, or in a rule similar to one in which an
        earlier pair differs.
        """
        names = {first: second, second: first}
        if self._differ_as_before(first, second) or next(self._terms.lacking(names, names), None) is not None:
            return False
        rule = next(self._broken(names), None)
        if rule is not None:
            self._witnesses.insert(0, (rule, first, second))
            del self._witnesses[WITNESSES:]
            return False
        return self._others is None or self._others.kept_by(first, second)

    def _differ_as_before(self, first: int, second: int) -> bool:
        """Return whether the swap of two entities fails on a rule similar to one on which an earlier swap failed."""
        for place, (rule, one, other) in enumerate(self._witnesses):
            like = self.atoms.renamed(rule, {one: first, other: second})
            if like in self._deriving and not self._says(like, {first: second, second: first}):
                self._witnesses.insert(0, self._witnesses.pop(place))
                return True
        return False

    def lacking(self, names: Mapping[int, int], entities: Iterable[int]) -> Iterator[MissingImage]:
        """Yield the atoms of rules that name any of the given entities and whose image is not an atom."""
        yield from self._terms.lacking(names, entities)
        if self._others:
            yield from self._others.lacking(names, entities)

    def broken(self, names: Mapping[int, int]) -> Iterator[MissingImage]:
        """Yield the rules whose image is neither a rule nor entailed."""
        for rule in self._broken(names):
            yield MissingImage(self.atoms.entities(rule), partial(self._says, rule))
        if self._others:
            yield from self._others.broken(names)

    def _broken(self, names: Mapping[int, int]) -> Iterator[SpelledRule]:
        """Yield the rules (not the `others`) whose image is neither a rule nor entailed."""
        renamed = self.atoms.under(names)
        for table in self._tables:
            for rule, image in table.missing(renamed, names):
                if image is None or not self._entails(image):
                    yield rule

    def _says(self, rule: SpelledRule, names: Mapping[int, int]) -> bool:
        """Return whether the image of a rule is either a rule or entailed."""
        image = self.atoms.renamed(rule, names)
        return image is not None and (image in self._deriving or self._entails(image))

    def _entails(self, rule: SpelledRule) -> bool:
        """Return whether other rules entail a rule: the rules of every step or, for the final check, all rules."""
        if rule.last not in self._consequences:
            rules = (each for each in self.atoms.rules if rule.last or not each.last)
            self._consequences[rule.last] = Consequences([*rules, *self.atoms.definitions])
        return self._consequences[rule.last].has(rule)

    def size(self, entities: Iterable[int]) -> int:
        """Return the number of atoms that name each entity, summed over the given entities."""
        return self._terms.size(entities)

    @cached_property
    def _terms(self) -> _Terms:
        return _Terms((), self.atoms.shapes(self._deriving), self.atoms.has)

    @cached_property
    def exact(self) -> list[Shaped]:
        """The atoms, each with a mark, that every symmetry maps onto themselves.

        They are stated initially or chosen, and the rules for such atoms are never entailed by other rules.
        """
        stated: dict[int, int] = {}
        for heads, (choice, bound, _), _ in self.atoms.rules:
            if choice or bound >= START:
                for atom in heads:
                    stated[atom] = stated.get(atom, 0) | (1 if choice else 2)
        return [(4 * shape + mark, inside) for (shape, inside), mark in self.atoms.named_atoms(stated)]

    @cached_property
    def _deriving(self) -> dict[SpelledRule, None]:
        """The distinct rules, except those that derive nothing because they read their own head."""
        return {
            rule: None
            for rule in self.atoms.rules
            if not (rule.is_plain and any((head, 0, 1) in rule.body[2] for head in rule.heads))
        }

    @cached_property
    def _tables(self) -> list[_RuleRows]:
        """The rules, grouped by form."""
        forms: dict[tuple[int, bool, bool, int, int], list[SpelledRule]] = {}
        for rule in self._deriving:
            heads, (choice, bound, literals), last = rule
            forms.setdefault((len(heads), last, choice, bound, len(literals)), []).append(rule)
        tables = []
        for (heads_end, last, choice, bound, size), rules in forms.items():
            rows: list[list[int]] = []
            having: dict[int, list[int]] = {}
            for row, rule in enumerate(rules):
                ordered = sorted(rule.body[2])
                spelled = (2 * atom + sign for atom, sign, _ in ordered)
                rows.append([*rule.heads, *spelled, *(weight for _, _, weight in ordered)])
                for entity in self.atoms.entities(rule):
                    having.setdefault(entity, []).append(row)
            table = np.array(rows, dtype=np.int64)
            tables.append(_RuleRows(table, heads_end, heads_end + size, choice, bound, last, having))
        return tables


_of_steps: WeakKeyDictionary[GroundStep, dict[tuple[clingo.Symbol, ...], _Rules]] = WeakKeyDictionary()
"""The rules of each step that was passed as `bare`, by the numbered entities: spaces under conditions share them."""


def _shared_rules(ground: GroundStep, numbers: Mapping[clingo.Symbol, int]) -> _Rules:
    """Return the rules of a step; for the same step and entities, return the same object."""
    by_entities, entities = _of_steps.setdefault(ground, {}), tuple(numbers)
    if entities not in by_entities:
        by_entities[entities] = _Rules(Atoms(ground, numbers))
    return by_entities[entities]


@dataclass(frozen=True)
class _RuleRows:
    """Rules of one form, as rows: the numbers of the heads, then literals, then weights.

    A literal is twice the number of its atom, plus 1 if it is negated.

    `heads` and `literals` are the indices at which these end in a row; all rules have the same `choice`, `bound` and
    `last`. `having` holds, for each entity, the rows that mention it.
    """

    rows: NDArray[np.int64]
    heads: int
    literals: int
    choice: bool
    bound: int
    last: bool
    having: dict[int, list[int]]

    def missing(
        self, renamed: NDArray[np.int64], entities: Iterable[int]
    ) -> Iterator[tuple[SpelledRule, SpelledRule | None]]:
        """Yield each rule whose image under a renaming of entities is not a rule, together with the image.

        The image is None if it contains an atom that is not in the program.
        """
        having = sorted({row for entity in entities for row in self.having.get(entity, ())})
        if not having:
            return
        rows = self.rows[having]
        image = rows.copy()
        image[:, : self.heads] = renamed[rows[:, : self.heads]]
        literals = rows[:, self.heads : self.literals]
        image[:, self.heads : self.literals] = 2 * renamed[literals >> 1] + (literals & 1)
        lacking = (image < 0).any(axis=1)
        if lacking.any():
            yield self._rule(rows[lacking.argmax()].tolist()), None
            return
        images, ordered = self._inside(image), self._inside(rows)
        if not np.array_equal(_sorted(images), _sorted(ordered)):
            present = set(map(tuple, ordered.tolist()))
            for row, each in enumerate(images.tolist()):
                if tuple(each) not in present:
                    yield self._rule(ordered[row].tolist()), self._rule(each)

    def _rule(self, row: Sequence[int]) -> SpelledRule:
        inside = zip(row[self.heads : self.literals], row[self.literals :], strict=True)
        literals = frozenset((literal >> 1, literal & 1, weight) for literal, weight in inside)
        return SpelledRule(frozenset(row[: self.heads]), (self.choice, self.bound, literals), self.last)

    def _inside(self, rows: NDArray[np.int64]) -> NDArray[np.int64]:
        """Return rows with their heads and their literals sorted."""
        inside: NDArray[np.int64] = rows.copy()
        inside[:, : self.heads].sort(axis=1)
        order = np.argsort(inside[:, self.heads : self.literals], axis=1, kind="stable")
        for start in (self.heads, self.literals):
            part = inside[:, start : start + order.shape[1]]
            part[:] = np.take_along_axis(part, order, axis=1)
        return inside


def _sorted(rows: NDArray[np.int64]) -> NDArray[np.int64]:
    ordered: NDArray[np.int64] = rows[np.lexsort(rows.T[::-1])]
    return ordered
