"""Counts of plans with the small-model reduction (see `prag_asp.reduction`).

The tasks and skeletons of a domain are those of its reduced program. A task whose plan names j of a group of m
interchangeable entities stands for m (m - 1) ... (m - j + 1) plans. The numbers of plans that name j entities, for all
j, are the digits of a single weighted count: each entity that a plan uses weighs a power of two above all counts
(Kronecker substitution). These weights are symmetric in the entities, so that states still merge. The proof is in
docs/explanations/small_model_reduction.md.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property
from math import perm, prod

import clingo

from prag_asp.domain.load import Domain
from prag_asp.errors import LimitReached
from prag_asp.logic.domain_logic import DomainLogic
from prag_asp.processes.progress_events import stage
from prag_asp.program.entity_names import action_name
from prag_asp.reduction.reduction import Reduction, named_in
from prag_asp.space.automaton.bounded_count import count_within
from prag_asp.space.engines.automaton_engine import AutomatonEngine
from prag_asp.space.engines.engine import Engine, Letters, Level, Progress, name_in_prefix, prefix_sets
from prag_asp.space.engines.reachability import Explorer
from prag_asp.space.limits import Limits, limit_error
from prag_asp.space.weights.weights import Weights
from prag_asp.stop_reason import StopReason

Group = tuple[clingo.Symbol, ...]


@dataclass
class ReducedCounter:
    """A counter of a domain's words that uses the domain's small-model reduction; `engine` is the name of an engine."""

    domain: Domain
    reduction: Reduction
    engine: str
    progress: Progress | None
    limits: Limits
    _models: dict[tuple[int, ...], ReducedModel] = field(default_factory=dict)

    def count(self, by: Level, length: int, prefix: Letters = ()) -> int | None:
        """Return the number of words of a given length, or None if the reduction does not apply.

        Raises:
            LimitReached: a limit ended the count; the error gives the number of words counted so far.
        """
        sizes, groups = self.reduction.sizes(length), self.reduction.groups
        if sizes not in self._models:
            program_and_facts = self.reduction.reduced(length)
            if program_and_facts is None:
                return None
            program, facts = program_and_facts
            model = DomainLogic(replace(self.domain, program=program, facts=facts, reduction=None))
            self._models = {sizes: ReducedModel(model, groups, self.engine, self.progress, self.limits)}
            if self.progress:
                pairs = zip(sizes, groups, strict=True)
                numbers = ", ".join(f"{size} of {len(group):,} entities like {group[0]}" for size, group in pairs)
                self.progress(f"{numbers} are ground: plans of length {length} need no more")
        reduced = self._models[sizes]
        if not reduced.takes(prefix) or reduced.whole_sizes is None:
            return None
        if by != "plan":
            return reduced.engine(by).count(length, prefix)
        if isinstance(reduced.engine("plan"), AutomatonEngine):
            return reduced.explored_plans(length, prefix)
        return reduced.listed_plans(length, prefix)


@dataclass
class ReducedModel:
    """The logic of the reduced program, and the `groups` of entities in the whole program.

    `name` is the name of the engine.
    """

    model: DomainLogic
    groups: Sequence[Group]
    name: str
    progress: Progress | None
    limits: Limits
    _engines: dict[Level, Engine] = field(default_factory=dict)

    def takes(self, prefix: Letters) -> bool:
        """Return whether a prefix contains only names; a ground action may use an entity outside the reduction."""
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
        """The groups of interchangeable entities in the ground program."""
        return self.model.groups(0)

    @cached_property
    def whole_sizes(self) -> tuple[int, ...] | None:
        """The size of each group of interchangeable entities in the whole program, or None without a valid reduction.

        The reduction is invalid if entities of a group are not all interchangeable, or if units are interchangeable in
        only one of the reduced and the whole program.
        """
        sizes = list(map(len, self.alike))
        for group in self.groups:
            ground = set(group) & self.model.domain.facts.entities.keys()
            places = [place for place, members in enumerate(self.alike) if ground.issubset(members)]
            if not places:
                return None
            sizes[places[0]] += len(group) - len(ground)
        return tuple(sizes) if self._keep_units(sizes) else None

    def _keep_units(self, sizes: Sequence[int]) -> bool:
        """Return whether the same units are interchangeable in the whole program, given the sizes of its groups.

        Groups must have equal sizes in the whole program if and only if they have equal sizes in the reduced one.
        """
        size_of = {entity: size for group, size in zip(self.alike, sizes, strict=True) for entity in group}
        ground_sizes: dict[object, set[int]] = {}
        for group, size in zip(self.alike, sizes, strict=True):
            ground_sizes.setdefault((self.model.domain.facts.entities[group[0]], size), set()).add(len(group))
        return all(len(sizes) == 1 for sizes in ground_sizes.values()) and all(
            len({size_of.get(entity) for entity in row}) == 1
            for units in self.model.symmetries(0).joint
            for row in zip(*units, strict=True)
        )

    def explored_plans(self, length: int, prefix: Letters) -> int:
        """Return the number of plans of a given length from the sum of their weights."""
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
        stop: StopReason | None = None
        if prefix:
            weight = reach.count(length, prefix_sets(prefix, {}, reach.names))
        else:
            weight, stop = count_within(reach.completions, length, self.limits.begin().reached_limit)
        reason = reach.stop or stop
        if reason:
            raise limit_error(reason, 0, "plan", length, reach.states)
        pairs = [(len(group), len(members)) for group, members in zip(self.groups, ground, strict=True)]
        return _renamed(weight, [*zip(pairs, places, strict=False)])

    def listed_plans(self, length: int, prefix: Letters) -> int:
        """Return the number of plans of a given length by enumerating the tasks and counting the renamings of each."""
        actions = {str(action): action for action in self.model.domain.facts.actions}
        members, plans = self.model.symmetries(0).entities, 0
        try:
            for word in self.engine("task").words(length, prefix):
                named = set[clingo.Symbol]().union(*(named_in(actions[letter], members) for letter in word))
                plans += prod(
                    perm(size, len(named.intersection(group)))
                    for group, size in zip(self.alike, self.whole_sizes or (), strict=True)
                ) * prod(
                    perm(len(units), sum(not named.isdisjoint(unit) for unit in units))
                    for units in self.model.symmetries(0).joint
                )
        except LimitReached as limit:
            raise limit_error(limit.reason, plans, "plan", length) from None
        return plans


def _renamed(weight: int, groups: Sequence[tuple[tuple[int, int], int]]) -> int:
    """Return the number of plans of the whole program, given the weighted count of the reduced one.

    Each group is given by its size in the whole program, its size in the reduced program, and its number of bits per
    digit.
    """
    if not groups:
        return weight
    *others, ((many, few), bits) = groups
    total, named = 0, 0
    while weight:
        digit = weight & ((1 << bits) - 1)
        renamings, rest = divmod(_renamed(digit, others) * perm(many, named), perm(few, named))
        assert not rest, "a plan has renamings that were not counted"
        total, named, weight = total + renamings, named + 1, weight >> bits
    return total
