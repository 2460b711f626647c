"""From a step function to the automaton of its plans: breadth-first, all states of a layer at once.

States are numbered in the order in which a breadth-first search finds them that takes states by their number and the
actions of a state in their order. So numbers depend on the step function alone.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from prag_asp.logic.step.packed import Rows
from prag_asp.logic.step.transition import Successors, Transition
from prag_asp.space.automaton.automaton import Automaton
from prag_asp.space.automaton.numbering import Numbering
from prag_asp.stop_reason import StopReason

if TYPE_CHECKING:
    from prag_asp.logic.step.relaxation import Relaxation
    from prag_asp.logic.symmetry.canonical_states import Merging, Orders
    from prag_asp.logic.symmetry.twins import Twins

MOST, FEWEST = 16_384, 64
"""States that are expanded together: enough to amortise the overhead of NumPy, few enough for the memory."""

MANY = 4096
"""Number of states from which those too far from the end of a plan are not expanded; fewer are expanded as fast."""

FEW = 1 / 16
"""The least share of states too far from the end for which it pays to look for them."""

ROOM = 2**26
"""Bytes that the states after those expanded together should take at most."""


@dataclass(frozen=True)
class Extent:
    """The extent of an exploration; `nbytes` is the memory in use, including what concatenating the edges takes."""

    depth: int
    states: int
    edges: int
    nbytes: int


Watch = Callable[[Extent], "StopReason | None"]
"""Called now and then with the extent of the exploration; returns why it has to stop, None as long as it may go on."""


@dataclass(frozen=True)
class Renamings:
    """The meaning of edges and states of an automaton with merged states.

    An edge stands for `multiplicities` actions, shape (edges,); its letter is the first of them. The state after it,
    renamed, is the target: entity ``orders[order_of[edge], j]`` of the one is entity j of the other. `twins` says of
    each state which entities cannot be told from the one before, shape (states, entities).
    """

    multiplicities: NDArray[np.int64]
    order_of: NDArray[np.int32]
    orders: Orders
    twins: NDArray[np.bool_]


@dataclass(frozen=True)
class Exploration:
    """The automaton of the plans of a step function.

    `labels` has shape (edges, number of labels). `stop` is why exploration ended early, if it did: some states
    then have no edges, so that words are missing, none wrong.
    """

    automaton: Automaton
    labels: NDArray[np.bool_]
    stop: StopReason | None = None
    renamings: Renamings | None = None


def explore(
    transition: Transition,
    length: int,
    watch: Watch | None = None,
    *,
    merging: Merging | None = None,
    object_to: Callable[[Rows], StopReason | None] | None = None,
) -> Exploration:
    """Return the automaton of all plans of up to `length` actions, with states merged as `merging` allows.

    Letters are numbers of `transition.actions`. Where plans end in some states alone, and there are `MANY` states, a
    state is not expanded from which no plan ends within the steps left. A state is found first where most steps are
    left, so words of more than `length` actions alone may be missing. `object_to` sees all states, and
    returns why exploration has to stop, if it has to.
    """
    search = _BreadthFirst(transition, merging)
    first, depth = 0, 0
    stop: StopReason | None = None
    while first < len(search.states):
        last = len(search.states)
        while first < last:
            rows = search.states.rows[first : min(first + search.together, last)]
            search.take(rows, 0 if stop else length - depth)
            first += len(rows)
            if object_to:
                stop = object_to(rows) or stop
            if watch and not stop:
                stop = watch(Extent(depth + 1, len(search.states), search.edges, search.nbytes))
        if depth == length:
            return search.result(length, stop)
        depth += 1
    return search.result(length if search.cut else None, stop)


class _BreadthFirst:
    """The states and edges found so far."""

    def __init__(self, transition: Transition, merging: Merging | None) -> None:
        self._transition = transition
        self._merging = merging
        self.states = Numbering(transition.initial.shape[1])
        self.states.add(transition.initial)
        self.together = FEWEST
        self._orders = Numbering(_pack(np.zeros((0, merging.size), dtype=np.int64)).shape[1]) if merging else None
        self._accepting: list[NDArray[np.bool_]] = []
        self._degrees: list[NDArray[np.int64]] = []
        self._edges: list[_Edges] = []
        self.edges = 0
        self._twins: list[NDArray[np.bool_]] = []
        self._bytes = 0
        self.cut = False
        self._worth_a_look: tuple[int, bool] | None = None

    @cached_property
    def _relaxation(self) -> Relaxation | None:
        """The relaxation that bounds the distance of states to the end of a plan; None if plans end anywhere."""
        if not self._transition.step.final:
            return None
        from prag_asp.logic.step.relaxation import relax

        return relax(self._transition)

    @property
    def nbytes(self) -> int:
        """The memory in use in bytes, including what concatenating the edges takes."""
        return self.states.nbytes + 2 * self._bytes

    def take(self, rows: Rows, left: int) -> None:
        """Add the next states and, where steps are left, their edges and the states that these lead to."""
        self._accepting.append(self._transition.accepts(rows))
        if self._merging:
            self._twins.append(self._merging.twins(rows))
        self._degrees.append(np.zeros(len(rows), dtype=np.int64))
        places = self._near(rows, left) if left else np.arange(0)
        if not len(places):
            return
        rows = rows[places]
        twins = self._merging.classes(self._twins[-1][places]) if self._merging else None
        candidates = self._merging.representatives(rows, twins) if self._merging and twins else None
        found = list(self._transition.expand(rows, candidates))
        sources = np.concatenate([np.zeros(0, dtype=np.uint16), *(each.sources.astype(np.uint16) for each in found)])
        order = np.argsort(sources, kind="stable")
        self._degrees[-1][places] = np.bincount(sources, minlength=len(rows))
        if len(order):
            edges = self._number_edges(found, order, twins)
            self._edges.append(edges)
            self._bytes += edges.nbytes
            self.edges += len(edges.letters)
        taken = len(order) * rows.shape[1] * 8 // len(rows) + (len(self._transition.actions) if twins else 0)
        room = ROOM // max(taken, 1)
        self.together = max(FEWEST, min(MOST, 4 * self.together, room))

    def _near(self, rows: Rows, left: int) -> NDArray[np.intp]:
        """Return the places of the states from which a plan may end in at most so many steps.

        Where few of the leading states of a layer are too far, the others are not looked at.
        """
        if len(self.states) < MANY or self._relaxation is None or self._worth_a_look == (left, False):
            return np.arange(len(rows))
        near, forever = self._relaxation.within(rows, left)
        self.cut |= not forever
        places = np.flatnonzero(near)
        self._worth_a_look = (left, len(rows) - len(places) > len(rows) * FEW)
        return places

    def _number_edges(self, found: list[Successors], order: NDArray[np.intp], twins: Twins | None) -> _Edges:
        """Return the edges of some successors in order of source and letter, and number the states that they reach."""
        letters = np.concatenate([np.full(len(each.sources), each.letter, dtype=np.int32) for each in found])[order]
        states = np.concatenate([each.states for each in found])[order]
        labels = np.concatenate([each.labels for each in found])[order]
        if self._merging is None or self._orders is None or twins is None:
            nothing = _Edges.none(0)
            targets = self.states.add(states).astype(np.int32)
            return _Edges(letters, targets, labels, nothing.multiplicities, nothing.order_of)
        states, orders = self._merging.canonical(states)
        targets = self.states.add(states).astype(np.int32)
        multiplicities = np.concatenate([twins.multiplicity(each.letter, each.sources) for each in found])[order]
        return _Edges(letters, targets, labels, multiplicities, self._orders.add(_pack(orders)).astype(np.int32))

    def result(self, horizon: int | None, stop: StopReason | None) -> Exploration:
        """Return all that was found; without a horizon, every word is."""
        offsets = np.zeros(len(self.states) + 1, dtype=np.int64)
        if self._degrees:
            np.cumsum(np.concatenate(self._degrees), out=offsets[1:])
        ends = np.concatenate([np.zeros(0, dtype=np.bool_), *self._accepting])
        empty = _Edges.none(len(self._transition.labels))
        edges = [empty, *self._edges]
        letters, targets = (np.concatenate([getattr(each, key) for each in edges]) for key in ("letters", "targets"))
        automaton = Automaton(offsets, letters, targets, ends, horizon=horizon)
        labels = np.concatenate([each.labels for each in edges])
        if self._merging is None or self._orders is None:
            return Exploration(automaton, labels, stop)
        renamings = Renamings(
            np.concatenate([each.multiplicities for each in edges]),
            np.concatenate([each.order_of for each in edges]),
            _unpack(self._orders.rows, self._merging.size),
            np.concatenate([np.zeros((0, self._merging.size), dtype=np.bool_), *self._twins]),
        )
        return Exploration(automaton, labels, stop, renamings)


def _pack(orders: Orders) -> Rows:
    """Return orders of entities as rows of words."""
    short = np.zeros((len(orders), -(-orders.shape[1] // 4) * 4), dtype=np.uint16)
    short[:, : orders.shape[1]] = orders
    return short.view(np.uint64)


def _unpack(rows: Rows, entities: int) -> Orders:
    return np.ascontiguousarray(rows).view(np.uint16)[:, :entities].astype(np.int64)


@dataclass(frozen=True)
class _Edges:
    """Some edges, in order; see `Exploration`."""

    letters: NDArray[np.int32]
    targets: NDArray[np.int32]
    labels: NDArray[np.bool_]
    multiplicities: NDArray[np.int64]
    order_of: NDArray[np.int32]

    @classmethod
    def none(cls, labels: int) -> _Edges:
        """Return no edges."""
        nothing = np.zeros(0, dtype=np.int32)
        return cls(nothing, nothing, np.zeros((0, labels), dtype=np.bool_), nothing.astype(np.int64), nothing)

    @property
    def nbytes(self) -> int:
        """The memory in use, in bytes."""
        arrays = (self.letters, self.targets, self.labels, self.multiplicities, self.order_of)
        return sum(each.nbytes for each in arrays)
