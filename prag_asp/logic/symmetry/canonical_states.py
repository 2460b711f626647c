"""States up to renaming of interchangeable entities, or units of a joint group.

If permutations of some entities map a step function onto itself, they map the plans from a state onto the plans from
the renamed state, so that only one renaming of each state is explored. To find it, entities are sorted by the bits that
name them and by colour refinement (Weisfeiler and Leman 1968) for variables that relate several entities. If entities
that are not twins remain tied, one of them is individualized and the rest is refined again. As a result, two renamings
of one state may remain two states; the automaton is then still exact, but larger.

Tasks. `rules/canonical_names.lp` lets a step name an entity of a group only after the previous ones, so that the
entities named before a state are the first ones of their group. A permutation of these entities maps the completions of
the state onto those of the renamed state and does not change which entities come next. The other entities need no
permutation, because no earlier action names them and the state does not distinguish them. The last entity of a group
has no atom `mentioned`; it is permuted as soon as all others are mentioned, because no naming rule applies any more.

Units. Units of a joint group that contain no other group are permuted like entities: here a unit *is* an entity, and an
atom that names a member names the unit. `rules/joint_names.lp` has atoms `unit_named` for units. Units that contain
other groups are not permuted, but those groups are, because a unit counts as named once an entity of such a group has
been named.

Twins are entities whose swap does not change a state. An action and its renamings by twins lead to renamings of one
state, so that one of them is expanded and counted with the number of renamings.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from prag_asp.logic.step.packed import WORD, Rows, mask_of
from prag_asp.logic.step.transition import Transition
from prag_asp.logic.symmetry.colour_refinement import Colours, StateBits, are_twins, find_bits, refine_colours
from prag_asp.logic.symmetry.symmetries import Symmetries, Unit
from prag_asp.logic.symmetry.term_patterns import NOBODY, Patterns, read_patterns
from prag_asp.logic.symmetry.twins import Twins
from prag_asp.program.entity_names import mentioned_entities

Orders = NDArray[np.int64]
"""Entities in a new order: row i has entity ``orders[i, j]`` at position j; shape (rows, entities)."""

UNTOUCHED, FIXED, LOW = np.uint64(1 << 62), np.uint64(2 << 62), np.uint64(2)
"""Sort keys within a group: entities that no bit names come after the others, and fixed entities come last."""

TOGETHER = 2**20
"""The number of pairs of a state and an entity that are sorted at once."""

MARK = np.uint64(0x5851F42D4C957F2D)
"""The colour that individualizes one of several tied entities."""


@dataclass(frozen=True)
class Merging:
    """The renamings of the states and the actions of a transition.

    `groups` are the units that may be permuted, called entities here. They are numbered consecutively across all
    groups; `starts` holds the number of the first entity of each group. `variables` are the patterns of the variables
    that renamings move, with the numbers `moved`; `actions` are the patterns of all actions. `guards` holds, for each
    entity, the variable that is true once the entity may be renamed, or `ALWAYS` or `NEVER`; `before` holds, for each
    entity, the entity that must be named before it, or the entity itself.
    """

    groups: tuple[tuple[Unit, ...], ...]
    starts: tuple[int, ...]
    variables: Patterns
    actions: Patterns
    moved: NDArray[np.int64]
    initial: Rows
    guards: tuple[int, ...]
    before: tuple[int, ...]

    @property
    def size(self) -> int:
        """The number of entities."""
        return len(self.guards)

    @cached_property
    def _mask(self) -> Rows:
        """The bits that renaming moves."""
        return mask_of(self.moved.tolist(), len(self.initial))

    @cached_property
    def _term_of(self) -> NDArray[np.int64]:
        terms = np.full(len(self.initial) * WORD, NOBODY, dtype=np.int64)
        terms[self.moved] = np.arange(len(self.moved))
        return terms

    @cached_property
    def _begins(self) -> NDArray[np.bool_]:
        """Whether each entity is the first of its group, shape (entities,)."""
        begins = np.zeros(self.size, dtype=np.bool_)
        begins[list(self.starts)] = True
        return begins

    @cached_property
    def _group(self) -> NDArray[np.int64]:
        """The number of the group of each entity, shape (entities,)."""
        return np.cumsum(self._begins)

    def canonical(self, states: Rows) -> tuple[Rows, Orders]:
        """Return the canonical renaming of each state, and the order of entities that yields it."""
        together = max(TOGETHER // self.size, 1)
        renamed, all_orders = [states[:0]], [np.zeros((0, self.size), dtype=np.int64)]
        for start in range(0, len(states), together):
            some = states[start : start + together]
            orders = self._orders(some)
            bits = find_bits((some ^ self.initial) & self._mask, self.variables, self._term_of)
            place_of = np.full((len(some), self.size + 1), NOBODY, dtype=np.int64)
            np.put_along_axis(place_of, orders, np.arange(self.size), axis=1)
            entities = place_of[bits.state[:, None], self.variables.entities[bits.term]]
            variable = self.moved[self.variables.find(self.variables.pattern[bits.term], entities)]
            word, shift = np.divmod(variable, WORD)
            moved = np.zeros_like(some)
            np.bitwise_or.at(moved, (bits.state, word), np.uint64(1) << shift.astype(np.uint64))
            renamed.append((some & ~self._mask) | ((moved ^ self.initial) & self._mask))
            all_orders.append(orders)
        return np.concatenate(renamed), np.concatenate(all_orders)

    def twins(self, states: Rows) -> NDArray[np.bool_]:
        """Return which entities are twins of the previous entity, shape (states, entities)."""
        together = max(TOGETHER // self.size, 1)
        columns = [np.zeros((0, self.size), dtype=np.bool_)]
        for start in range(0, len(states), together):
            bits, keys = self._keys(states[start : start + together])
            columns.append(self._alike(bits, keys, np.broadcast_to(np.arange(self.size), keys.shape))[0])
        return np.concatenate(columns)

    def classes(self, twins: NDArray[np.bool_]) -> Twins:
        """Return the classes of twins in the given states, given which entities are twins of the previous one."""
        return Twins.between(self.actions, twins)

    def free(self, states: Rows) -> NDArray[np.bool_]:
        """Return which entities may be renamed in which states, shape (states, entities)."""
        free = np.ones((len(states), self.size), dtype=np.bool_)
        for entity, guard in enumerate(self.guards):
            if guard != ALWAYS:
                word, shift = divmod(max(guard, 0), WORD)
                free[:, entity] = (guard != NEVER) & ((states[:, word] >> np.uint64(shift)) & np.uint64(1) == 1)
        return free

    def representatives(self, states: Rows, twins: Twins) -> NDArray[np.bool_]:
        """Return which actions are expanded in which states, shape (states, actions).

        Of actions that differ only by twins, one is expanded; actions that name an entity before its turn are not
        expanded.
        """
        chosen = twins.representatives()
        if all(guard == ALWAYS for guard in self.guards):
            return chosen
        free, before = self.free(states), np.array(self.before)
        entities = self.actions.entities
        for place, entity in enumerate(entities.T):
            named = np.flatnonzero(entity >= 0)
            turn = before[entity[named]]
            led = (entities[named, :place] == turn[:, None]).any(axis=1) | (turn == entity[named])
            chosen[:, named] &= led | free[:, entity[named]] | free[:, turn]
        return chosen

    def _orders(self, states: Rows) -> Orders:
        orders = np.empty((len(states), self.size), dtype=np.int64)
        waiting = np.arange(len(states))
        groups = list(zip(self.starts, [*self.starts[1:], self.size], strict=True))
        initial_colours: Colours = np.zeros((len(states), self.size), dtype=np.uint64)
        while len(waiting):
            bits, keys = self._keys(states[waiting], initial_colours)
            order = np.concatenate([a + np.argsort(keys[:, a:b], axis=1, kind="stable") for a, b in groups], axis=1)
            orders[waiting] = order
            keys = np.take_along_axis(keys, order, axis=1)
            twins, ties = self._alike(bits, keys, order)
            unsettled = ties & ~twins
            rows = np.flatnonzero(unsettled.any(axis=1))
            # One of the first tied entities that are not twins is individualized, together with its twins.
            one = unsettled[rows].argmax(axis=1)[:, None]
            tied = keys[rows] == np.take_along_axis(keys[rows], one, axis=1)
            row, place = np.nonzero(tied & (self._group == self._group[one]))
            chosen = order[rows[row], one[row, 0]]
            alike = are_twins(bits, self.moved, rows[row], np.stack([chosen, order[rows[row], place]], axis=1))
            initial_colours = initial_colours[rows]
            initial_colours[row[alike], order[rows[row], place][alike]] += MARK
            waiting = waiting[rows]
        return orders

    def _keys(self, states: Rows, initial_colours: Colours | None = None) -> tuple[StateBits, Colours]:
        """Return the bits in which states differ from the initial state, and sort keys, shape (states, entities)."""
        bits = find_bits((states ^ self.initial) & self._mask, self.variables, self._term_of)
        marks = np.zeros((len(states), self.size), dtype=np.uint64) if initial_colours is None else initial_colours
        keys = refine_colours(bits, marks) >> LOW
        touched = np.array(bits.alone.any(axis=2), dtype=np.bool_)
        entities = bits.entities(bits.related)
        bit, place = np.nonzero(entities >= 0)
        touched[bits.state[bits.related[bit]], entities[bit, place]] = True
        keys[~touched] = UNTOUCHED
        state, entity = np.nonzero(~self.free(states))
        keys[state, entity] = FIXED | entity.astype(np.uint64)
        return bits, keys

    def _alike(self, bits: StateBits, keys: Colours, orders: Orders) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
        """Return which entities, in the given orders, are twins of their predecessors, and which have the same keys.

        Both results have shape (states, entities).
        """
        ties = np.zeros(keys.shape, dtype=np.bool_)
        ties[:, 1:] = (keys[:, 1:] == keys[:, :-1]) & ~self._begins[1:]
        twins: NDArray[np.bool_] = ties & (keys == UNTOUCHED)
        state, place = np.nonzero(ties & ~twins)
        pairs = np.stack([orders[state, place - 1], orders[state, place]], axis=1)
        np.place(twins, ties & ~twins, are_twins(bits, self.moved, state, pairs))
        return twins, ties


ALWAYS, NEVER = -1, -2


def find_merging(
    transition: Transition, groups: Sequence[Sequence[Unit]], named_in_order: Symmetries | None = None
) -> Merging | None:
    """Return the renamings of states, given units whose permutations map the step function onto itself.

    `named_in_order` holds the symmetries whose entities are introduced in order by tasks. The result is None if there
    is nothing to rename, or if a table of all renamings would need too much memory.
    """
    permuted = tuple(tuple(group) for group in groups if len(group) > 1)
    entities = {entity for group in permuted for unit in group for entity in unit}
    naming = named_in_order.naming if named_in_order else {}
    mentions = {naming[symbol]: place for place, symbol in enumerate(transition.variables) if symbol in naming}
    kept = set(mentions.values())
    moved = [
        place
        for place, symbol in enumerate(transition.variables)
        if place not in kept and any(mentioned_entities(symbol, entities))
    ]
    variables = read_patterns([transition.variables[place] for place in moved], permuted)
    actions = read_patterns(transition.actions, permuted)
    if not permuted or not len(transition.initial) or not variables or not actions:
        return None
    if not (variables.complete and actions.complete):
        return None
    starts = tuple(int(place) for place in np.cumsum([0, *map(len, permuted)])[:-1])
    ordered = named_in_order.innermost if named_in_order else ()
    before = {unit: group[max(place - 1, 0)] for group in ordered for place, unit in enumerate(group)}
    units = [unit for group in permuted for unit in group]
    guards = tuple(
        mentions.get(unit, mentions.get(before[unit], NEVER)) if unit in before else ALWAYS for unit in units
    )
    numbers = {unit: place for place, unit in enumerate(units)}
    return Merging(
        permuted,
        starts,
        variables,
        actions,
        np.array(moved, dtype=np.int64),
        transition.initial[0],
        guards,
        tuple(numbers.get(before.get(unit, unit), place) for unit, place in numbers.items()),
    )
