"""Breadth-first exploration of the automaton of the plans of a step function, many states of a layer at once.

States are numbered in the order of a breadth-first search that expands states in order of their numbers and tries
actions in their order, so the numbers depend only on the step function.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from prag_asp.space.automaton.automaton import Automaton
from prag_asp.space.automaton.numbering import Numbering
from prag_asp.stop_reason import StopReason

if TYPE_CHECKING:
    from prag_asp.logic.step.packed import Rows
    from prag_asp.logic.step.relaxation import Relaxation
    from prag_asp.logic.step.transition import Successors, Transition
    from prag_asp.logic.symmetry.canonical_states import Merging, Orders
    from prag_asp.logic.symmetry.twins import Twins

MOST, FEWEST = 16_384, 64
"""Bounds on the number of states expanded together: enough to amortise the overhead of NumPy, few enough to fit in
memory."""

MANY = 4096
"""Above this number of states, states too far from the end of a plan are pruned; below it, pruning gains nothing."""

FEW = 1 / 16
"""Minimum share of states too far from the end of a plan for which pruning pays off."""

ROOM = 2**26
"""Target for the maximum memory, in bytes, of the successors of states that are expanded together."""


@dataclass(frozen=True)
class Extent:
    """The size of an exploration; `nbytes` is its memory, including the memory for concatenating the edges.

    `expanded` is the number of states whose edges are known, and `by_letter` the number of edges with each letter.
    """

    depth: int
    states: int
    edges: int
    nbytes: int
    expanded: int = 0
    by_letter: Sequence[int] | NDArray[np.int64] = ()


Watch = Callable[[Extent], "StopReason | None"]
"""A function that is called periodically with the extent of the exploration, and returns a reason to stop or None."""


@dataclass(frozen=True)
class Renamings:
    """The meaning of edges and states of an automaton with merged states.

    An edge stands for `multiplicities` actions, shape (edges,); its letter is the first of them. Its target is the
    successor with renamed entities: entity ``orders[order_of[edge], j]`` of the successor is entity j of the target.
    `twins` marks for each state the entities that are indistinguishable from the previous one, shape (states,
    entities).
    """

    multiplicities: NDArray[np.int64]
    order_of: NDArray[np.int32]
    orders: Orders
    twins: NDArray[np.bool_]


@dataclass(frozen=True)
class Exploration:
    """The automaton of the plans of a step function.

    `labels` has shape (edges, number of labels). If exploration ended early, `stop` is the reason; some states then
    lack edges, so words may be missing, but none is wrong.
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

    Letters are numbers of `transition.actions`. If plans can end only in some states, and there are at least `MANY`
    states, states from which no plan can end within the remaining steps are not expanded. Since a state is first
    reached with the most remaining steps, only words of more than `length` actions may be missing. `object_to` receives
    all states, and may return a reason to stop.
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
                sizes = (len(search.states), search.edges, search.nbytes)
                stop = watch(Extent(depth + 1, *sizes, first, search.by_letter))
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
        self.by_letter = np.zeros(len(transition.actions), dtype=np.int64)
        self._twins: list[NDArray[np.bool_]] = []
        self._bytes = 0
        self.cut = False
        self._worth_a_look: tuple[int, bool] | None = None

    @cached_property
    def _relaxation(self) -> Relaxation | None:
        """The relaxation that bounds the distance to the end of a plan, or None if plans may end anywhere."""
        if not self._transition.step.final:
            return None
        from prag_asp.logic.step.relaxation import relax

        return relax(self._transition)

    @property
    def nbytes(self) -> int:
        """The memory in bytes, including the memory for concatenating the edges."""
        return self.states.nbytes + 2 * self._bytes

    def take(self, rows: Rows, left: int) -> None:
        """Add the next states and, if steps remain, their edges and their successors."""
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
        successors = list(self._transition.expand(rows, candidates))
        sources = np.concatenate(
            [np.zeros(0, dtype=np.uint16), *(some.sources.astype(np.uint16) for some in successors)]
        )
        order = np.argsort(sources, kind="stable")
        self._degrees[-1][places] = np.bincount(sources, minlength=len(rows))
        if len(order):
            edges = self._number_edges(successors, order, twins)
            self._edges.append(edges)
            self._bytes += edges.nbytes
            self.edges += len(edges.letters)
            self.by_letter += np.bincount(edges.letters, minlength=len(self.by_letter))
        taken = len(order) * rows.shape[1] * 8 // len(rows) + (len(self._transition.actions) if twins else 0)
        room = ROOM // max(taken, 1)
        self.together = max(FEWEST, min(MOST, 4 * self.together, room))

    def _near(self, rows: Rows, left: int) -> NDArray[np.intp]:
        """Return the indices of the states from which a plan may end within `left` steps.

        If only a few states at the beginning of a layer are too far from the end, the others are not tested.
        """
        if len(self.states) < MANY or self._relaxation is None or self._worth_a_look == (left, False):
            return np.arange(len(rows))
        near, forever = self._relaxation.within(rows, left)
        self.cut |= not forever
        places = np.flatnonzero(near)
        self._worth_a_look = (left, len(rows) - len(places) > len(rows) * FEW)
        return places

    def _number_edges(self, successors: list[Successors], order: NDArray[np.intp], twins: Twins | None) -> _Edges:
        """Return the edges to the given successors, ordered by source and letter, and number their targets."""
        letters = np.concatenate([np.full(len(some.sources), some.letter, dtype=np.int32) for some in successors])[
            order
        ]
        states = np.concatenate([some.states for some in successors])[order]
        labels = np.concatenate([some.labels for some in successors])[order]
        if self._merging is None or self._orders is None or twins is None:
            nothing = _Edges.none(0)
            targets = self.states.add(states).astype(np.int32)
            return _Edges(letters, targets, labels, nothing.multiplicities, nothing.order_of)
        states, orders = self._merging.canonical(states)
        targets = self.states.add(states).astype(np.int32)
        multiplicities = np.concatenate([twins.multiplicity(some.letter, some.sources) for some in successors])[order]
        return _Edges(letters, targets, labels, multiplicities, self._orders.add(_pack(orders)).astype(np.int32))

    def result(self, horizon: int | None, stop: StopReason | None) -> Exploration:
        """Return the exploration; without a `horizon`, it contains the words of all lengths."""
        offsets = np.zeros(len(self.states) + 1, dtype=np.int64)
        if self._degrees:
            np.cumsum(np.concatenate(self._degrees), out=offsets[1:])
        ends = np.concatenate([np.zeros(0, dtype=np.bool_), *self._accepting])
        empty = _Edges.none(len(self._transition.labels))
        edges = [empty, *self._edges]
        letters, targets = (np.concatenate([getattr(some, key) for some in edges]) for key in ("letters", "targets"))
        automaton = Automaton(offsets, letters, targets, ends, horizon=horizon)
        labels = np.concatenate([some.labels for some in edges])
        if self._merging is None or self._orders is None:
            return Exploration(automaton, labels, stop)
        renamings = Renamings(
            np.concatenate([some.multiplicities for some in edges]),
            np.concatenate([some.order_of for some in edges]),
            np.ascontiguousarray(self._orders.rows).view(np.uint16)[:, : self._merging.size].astype(np.int64),
            np.concatenate([np.zeros((0, self._merging.size), dtype=np.bool_), *self._twins]),
        )
        return Exploration(automaton, labels, stop, renamings)


def _pack(orders: Orders) -> Rows:
    """Return orders of entities, packed into rows of 64-bit words."""
    short = np.zeros((len(orders), -(-orders.shape[1] // 4) * 4), dtype=np.uint16)
    short[:, : orders.shape[1]] = orders
    return short.view(np.uint64)


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
        """Return an empty set of edges."""
        nothing = np.zeros(0, dtype=np.int32)
        return cls(nothing, nothing, np.zeros((0, labels), dtype=np.bool_), nothing.astype(np.int64), nothing)

    @property
    def nbytes(self) -> int:
        """The memory in use, in bytes."""
        arrays = (self.letters, self.targets, self.labels, self.multiplicities, self.order_of)
        return sum(array.nbytes for array in arrays)
