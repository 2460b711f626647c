"""Counting with no more entities than plans of a length need.

Tasks and skeletons are the same with any more of them. A task whose plan names j of a group of m interchangeable
entities stands for m (m - 1) ... (m - j + 1) plans. How many plans name how many is read off one number: each entity
that a plan uses weighs a power of two beyond all counts (Kronecker's substitution), so that the sum of all weights has
them as its digits. Such weights treat entities alike, and states merge as ever. docs/explanations/needed.md has the
proof.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property
from math import perm, prod

import clingo

from prag_asp.domain.load import Domain
from prag_asp.domain.reduction import Needed, named_in
from prag_asp.errors import LimitReached
from prag_asp.logic.domain_logic import Model
from prag_asp.processes.progress_events import stage
from prag_asp.program.entity_names import action_name
from prag_asp.space.automaton.automaton import count_words
from prag_asp.space.automaton.bounded_count import count_within
from prag_asp.space.automaton.merged_states import count_merged
from prag_asp.space.engines.automaton_engine import AutomatonEngine
from prag_asp.space.engines.engine import Engine, Letters, Level, Progress, name_in_prefix
from prag_asp.space.engines.reachability import Explorer, Reach
from prag_asp.space.limits import Limits, limit_error
from prag_asp.space.weights.weights import Weights
from prag_asp.stop_reason import StopReason

Group = tuple[clingo.Symbol, ...]


@dataclass
class AsNeeded:
    """Counts the words of a domain that has more entities of some groups than plans need; `engine` is a name."""

    domain: Domain
    needed: Needed
    engine: str
    progress: Progress | None
    limits: Limits
    _made: dict[tuple[int, ...], Fewer] = field(default_factory=dict)

    def count(self, by: Level, length: int, prefix: Letters = ()) -> int | None:
        """Return the number of words of a length, or None where all entities have to be ground.

        Raises:
            LimitReached: a limit ended the count; the error has the number of words that were found.
        """
        fewer = self._fewer(length)
        if fewer is None or not fewer.takes(prefix) or fewer.whole_sizes is None:
            return None
        if by != "plan":
            return fewer.engine(by).count(length, prefix)
        if isinstance(fewer.engine("plan"), AutomatonEngine):
            return fewer.explored_plans(length, prefix)
        return fewer.listed_plans(length, prefix)

    def _fewer(self, length: int) -> Fewer | None:
        sizes = self.needed.sizes(length)
        if sizes not in self._made:
            found = self.needed.fewer(length)
            if found is None:
                return None
            program, facts = found
            model = Model(replace(self.domain, program=program, facts=facts, needed=None))
            self._made = {sizes: Fewer(model, self.needed.groups, self.engine, self.progress, self.limits)}
            if self.progress:
                pairs = zip(sizes, self.needed.groups, strict=True)
                told = ", ".join(f"{size} of {len(group):,} entities like {group[0]}" for size, group in pairs)
                self.progress(f"{told} are ground: plans of length {length} need no more")
        return self._made[sizes]


@dataclass
class Fewer:
    """The model with as many entities as are needed, and the `groups` of the whole one."""

    model: Model
    groups: Sequence[Group]
    name: str
    progress: Progress | None
    limits: Limits
    _engines: dict[Level, Engine] = field(default_factory=dict)

    def takes(self, prefix: Letters) -> bool:
        """Return whether a prefix has nothing but names: actions may name entities that are not ground."""
        actions = self.model.domain.facts.actions
        names, spelled = set(map(action_name, actions)), set(map(str, actions))
        return all(name_in_prefix(item, spelled) in names for item in prefix)

    def engine(self, by: Level) -> Engine:
        """Return the engine of a level."""
        from prag_asp.space.engines import select

        if by not in self._engines:
            self._engines[by] = select(self.name, self.model, by, self.progress, self.limits)
        return self._engines[by]

    @cached_property
    def alike(self) -> tuple[Group, ...]:
        """The groups of interchangeable entities that are ground."""
        return self.model.groups(0)

    @cached_property
    def whole_sizes(self) -> tuple[int, ...] | None:
        """How many entities each group of interchangeable ones has in the whole; None where one is told apart.

        It is None as well where a unit may be like another one here, and not in the whole, or the other way around.
        """
        sizes = list(map(len, self.alike))
        for group in self.groups:
            ground = set(group) & self.model.domain.facts.entities.keys()
            places = [place for place, each in enumerate(self.alike) if ground.issubset(each)]
            if not places:
                return None
            sizes[places[0]] += len(group) - len(ground)
        return tuple(sizes) if self._keep_units(sizes) else None

    def _keep_units(self, sizes: Sequence[int]) -> bool:
        """Return whether units are interchangeable here where they are in the whole, given the whole sizes of groups.

        Their groups have to be of one size where they have one here, and only there.
        """
        size_of = {entity: size for group, size in zip(self.alike, sizes, strict=True) for entity in group}
        here: dict[object, set[int]] = {}
        for group, size in zip(self.alike, sizes, strict=True):
            here.setdefault((self.model.domain.facts.entities[group[0]], size), set()).add(len(group))
        return all(len(found) == 1 for found in here.values()) and all(
            len({size_of.get(entity) for entity in row}) == 1
            for units in self.model.symmetries(0).joint
            for row in zip(*units, strict=True)
        )

    def explored_plans(self, length: int, prefix: Letters) -> int:
        """Return the number of plans of a length, by how many entities of each group they name."""
        facts = self.model.domain.facts
        ground = [[entity for entity in group if entity in facts.entities] for group in self.groups]
        bits = (len(facts.tried) ** length + 1).bit_length()
        weights: dict[clingo.Symbol, Fraction] = {}
        places = [bits]
        for members in ground:
            weights |= dict.fromkeys(members, Fraction(2 ** places[-1]))
            places.append(places[-1] * (len(members) + 1))
        reach, unit, _ = Explorer(self.model, "plan", self.progress).weighed(
            length, Weights(entities=weights), self.limits.begin()
        )
        assert unit == 1
        stage("counting")
        found, stop = self._weight(reach, length, prefix)
        reason = reach.stop or stop
        if reason:
            raise limit_error(reason, 0, "plan", length, reach.states)
        pairs = [(len(group), len(members)) for group, members in zip(self.groups, ground, strict=True)]
        return _renamed(found, [*zip(pairs, places, strict=False)])

    def _weight(self, reach: Reach, length: int, prefix: Letters) -> tuple[int, StopReason | None]:
        """Return the weight of all words, and which limit ended the sum, if any."""
        if not prefix:
            return count_within(reach.completions, length, self.limits.begin().reached_limit)
        names = [name_in_prefix(item, ()) for item in prefix]
        sets = [frozenset(letter for letter, own in enumerate(reach.names) if own == name) for name in names]
        if reach.merged:
            return count_merged(reach.merged, reach.completions, length, sets), None
        return count_words(reach.completions, length, [each.__contains__ for each in sets]), None

    def listed_plans(self, length: int, prefix: Letters) -> int:
        """Return the number of plans of a length: each task that is found stands for its renamings."""
        actions = {str(action): action for action in self.model.domain.facts.actions}
        found = 0
        try:
            for word in self.engine("task").words(length, prefix):
                named = set[clingo.Symbol]().union(*(named_in(actions[letter], self._members) for letter in word))
                found += prod(
                    perm(size, len(named.intersection(group)))
                    for group, size in zip(self.alike, self.whole_sizes or (), strict=True)
                ) * prod(
                    perm(len(units), sum(not named.isdisjoint(unit) for unit in units))
                    for units in self.model.symmetries(0).joint
                )
        except LimitReached as limit:
            raise limit_error(limit.reason, found, "plan", length) from None
        return found

    @cached_property
    def _members(self) -> frozenset[clingo.Symbol]:
        return self.model.symmetries(0).entities


def _renamed(weight: int, groups: Sequence[tuple[tuple[int, int], int]]) -> int:
    """Return the number of plans of the whole, given the sum of the weights of those with fewer entities.

    Each group has its size in the whole, its size here, and how many bits a digit of it takes.
    """
    if not groups:
        return weight
    *others, ((many, few), bits) = groups
    total, named = 0, 0
    while weight:
        digit = weight & ((1 << bits) - 1)
        found, rest = divmod(_renamed(digit, others) * perm(many, named), perm(few, named))
        assert not rest, "a plan has renamings that were not counted"
        total, named, weight = total + found, named + 1, weight >> bits
    return total
