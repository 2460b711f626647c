"""Counts and ranks of the words of a step function, by decision diagrams over its states; states are not listed.

For words of length n, the forward pass collects the states reached within n - 1 steps and, for each action, those in
which it is valid. The backward pass counts completions: the number of completions of a state with k letters left is the
sum, over its valid actions, of the number of completions of the successor with k - 1 letters left. The numbers for each
k form one diagram. All numbers are exact.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass
from heapq import nlargest
from itertools import accumulate
from sys import maxsize
from weakref import WeakSet

from prag_asp.logic.diagram.diagrams import EMPTY, Diagrams, Node
from prag_asp.logic.diagram.diagrams import Word as State
from prag_asp.logic.diagram.digits import find_digits
from prag_asp.logic.diagram.pieces import Piece, SetStep
from prag_asp.logic.step.transition import Transition
from prag_asp.space.automaton.automaton import Word
from prag_asp.space.automaton.walks import Choice, owner_of, words_along
from prag_asp.stop_reason import LimitCheck

Look = Callable[[], None]
"""A function that is called periodically, and raises an error at a limit."""

Key = tuple[int, tuple[tuple[int, tuple[int, int]], ...], tuple[int, ...]]
"""The letter, the changes and the labels of a piece, which all its states share."""

REMEMBERED = 1 << 14
"""Number of states whose successors are cached."""

WIDER = 4
"""Factor by which the beam of `count_along` grows from round to round, while time remains."""


@dataclass(frozen=True)
class DiagramEdge:
    """An edge of a state: its letter, its weight, and the successor."""

    letter: int
    weight: int
    state: State


class Layers:
    """The words of a step function, for any length; results are cached between queries.

    `weigh` returns the integer weight of an edge, given its letter and the numbers of its true labels.
    """

    def __init__(
        self,
        transition: Transition,
        look: Look,
        tell: Callable[[str], None],
        weigh: Callable[[int, tuple[int, ...]], int] = lambda letter, labels: 1,
    ) -> None:
        self._tell = tell
        self._weigh = weigh
        self._look = look
        digits = find_digits(transition, look) if len(transition.initial) else None
        self.inhabited = digits is not None
        self.used: WeakSet[LayeredWords] = WeakSet()
        if digits is None:
            return
        self.diagrams = Diagrams(len(digits.places), look)
        self._step = SetStep(transition, digits, self.diagrams)
        self.start: State = digits.word(transition.initial, len(transition.variables))
        self.reached: Node = self._step.initial()
        self._frontier: Node = self.reached
        self._depth = 0
        self._pieces: dict[Key, Node] = {}
        self._rows: list[Node] = []
        self._covered = -1
        self._onward: dict[State, list[DiagramEdge]] = {}

    @property
    def closed(self) -> bool:
        """Whether further steps reach no new state."""
        return not self._frontier

    def row(self, length: int, left: int) -> Node:
        """Return, for each state within ``length - left`` steps, the weight of its completions with `left` letters."""
        self.extend(length)
        if self._covered < length:
            self._rows = [self._step.accepted(self.reached)]
            self._covered = maxsize if self.closed else length
        while len(self._rows) <= left:
            self._rows.append(self.back(self._rows[-1]))
            self._tell(f"{len(self._rows) - 1} steps before the end: {len(self.diagrams):,} nodes")
        return self._rows[left]

    def rows_so_far(self, length: int) -> list[Node]:
        """Return the rows computed so far for a given length, for 0, 1, ... remaining letters; at least the first.

        Their values are lower bounds that take only the states and rows computed so far into account.
        """
        return self._rows if self._covered >= length else [self._step.accepted(self.reached)]

    def back(self, row: Node, letters: Collection[int] | None = None) -> Node:
        """Return the weight of the completions that begin with one of `letters`, given the `row` of the successors.

        By default, they may begin with any letter.
        """
        terms = []
        for (letter, changes, labels), states in self._pieces.items():
            if letters is None or letter in letters:
                self._look()
                weighed = self.diagrams.everywhere(states, self._weigh(letter, labels))
                terms.append(self.diagrams.before(weighed, dict(changes), row))
        summed = self.diagrams.sum(terms)
        self._clean(row, summed)
        return summed

    def extend(self, length: int) -> None:
        """Explore the states that can be reached within `length` steps."""
        while self._depth < length and self._frontier:
            pieces: list[Piece] = []
            for piece in self._step.pieces(self._frontier, self._look):
                pieces.append(piece)
                self._look()
            images = [self.diagrams.image(piece.states, piece.changes) for piece in pieces]
            new = self.diagrams.minus(self.diagrams.union(images), self.reached)
            for piece in pieces:
                key = (piece.letter, tuple(sorted(piece.changes.items())), piece.labels)
                self._pieces[key] = self.diagrams.join(self._pieces.get(key, EMPTY), piece.states)
            self.reached, self._frontier = self.diagrams.join(self.reached, new), new
            self._depth += 1
            self._onward.clear()
            self._clean()
            states = self.diagrams.total(self.reached)
            self._tell(f"depth {self._depth}: {states:,} states, {len(self.diagrams):,} nodes")

    def images(self, states: Node) -> Iterator[tuple[int, Node]]:
        """Yield letters, each with a set of states to which it leads from the given reached states."""
        for (letter, changes, _), where in self._pieces.items():
            image = self.diagrams.image(self.diagrams.within(states, where), dict(changes))
            if image:
                yield letter, image

    def only_start(self) -> Node:
        """Return the set that contains only the initial state."""
        return self.diagrams.word(self.start)

    def accepts(self, states: Node) -> bool:
        """Return whether a word may end in any of the given states."""
        return bool(self._step.accepted(states))

    def onward(self, state: State) -> list[DiagramEdge]:
        """Return the edges of a reached state, in order of their letters."""
        if state not in self._onward:
            while len(self._onward) >= REMEMBERED:
                del self._onward[next(iter(self._onward))]
            edges = []
            for (letter, changes, labels), where in self._pieces.items():
                if self.diagrams.value(where, state):
                    after = list(state)
                    for level, (keep, put) in changes:
                        after[level] = (after[level] & keep) | put
                    edges.append(DiagramEdge(letter, self._weigh(letter, labels), tuple(after)))
            self._onward[state] = sorted(edges, key=lambda edge: edge.letter)
        return self._onward[state]

    def _clean(self, *rows: Node) -> None:
        used = (row for words in self.used for row in words.early)
        self.diagrams.clean([self.reached, self._frontier, *self._pieces.values(), *self._rows, *used, *rows])


class LayeredWords:
    """The words of one length whose first letters `prefix` allows, in order and with their ranks.

    `total` is the sum of their weights.
    """

    def __init__(self, layers: Layers, length: int, prefix: Sequence[Collection[int]] = ()) -> None:
        self._layers = layers
        self._length = length
        self._prefix = prefix
        self.early: list[Node] = []
        self.total = 0
        layers.used.add(self)
        if not layers.inhabited or len(prefix) > length:
            return
        row = layers.row(length, length - len(prefix))
        for letters in reversed(prefix):
            row = layers.back(row, letters)
            self.early.append(row)
        self.total = layers.diagrams.value(row, layers.start)

    def __iter__(self) -> Iterator[Word]:
        """Yield each word of positive weight once, in order, lazily."""
        if self.total:
            yield from words_along(self._layers.start, self._length, self._ways)

    def unrank(self, rank: int) -> Word:
        """Return the word with a given rank, from 0 to total - 1, if all weights are 1."""
        return self.walk(owner_of(rank))[0]

    def rank(self, word: Sequence[int]) -> int | None:
        """Return the rank of a word if all weights are 1, or None if it is not a word."""
        if not self.total or len(word) != self._length:
            return None
        rank, state = 0, self._layers.start
        for step, letter in enumerate(word):
            edges = self._layers.onward(state)
            taken = next((edge for edge in edges if edge.letter == letter), None)
            if taken is None or not self._behind(taken, step):
                return None
            rank += sum(self._behind(edge, step) for edge in edges if edge.letter < letter)
            state = taken.state
        return rank

    def walk(self, choose: Choice) -> tuple[Word, int]:
        """Return a word and its weight.

        At each step, `choose` selects an edge, given the running totals of the weights.
        """
        word, weight, state = [], 1, self._layers.start
        for step in range(self._length):
            edges = self._layers.onward(state)
            edge = edges[choose(step, list(accumulate(self._behind(edge, step) for edge in edges)))]
            word.append(edge.letter)
            weight *= edge.weight
            state = edge.state
        return tuple(word), weight

    def following(self) -> dict[int, int]:
        """Return, for each letter that can follow the prefix, the total weight of the words that continue with it."""
        found: dict[int, int] = {}
        if not self.total or len(self._prefix) >= self._length:
            return found
        states: dict[State, int] = {self._layers.start: 1}
        for allowed in self._prefix:
            after: dict[State, int] = {}
            for state, weight in states.items():
                for edge in self._layers.onward(state):
                    if edge.letter in allowed:
                        after[edge.state] = after.get(edge.state, 0) + weight * edge.weight
            states = after
        for state, weight in states.items():
            for edge in self._layers.onward(state):
                found[edge.letter] = found.get(edge.letter, 0) + weight * self._behind(edge, len(self._prefix))
        return {letter: number for letter, number in sorted(found.items()) if number}

    def _ways(self, state: State, step: int) -> Iterator[tuple[int, State]]:
        allowed = self._prefix[step] if step < len(self._prefix) else None
        for edge in self._layers.onward(state):
            if (allowed is None or edge.letter in allowed) and self._behind(edge, step):
                yield edge.letter, edge.state

    def _behind(self, edge: DiagramEdge, step: int) -> int:
        """Return the total weight of the suffixes that begin with an edge."""
        left = self._length - step - 1
        early = len(self._prefix) - step - 1
        row = self.early[early - 1] if early > 0 else self._layers.row(self._length, left)
        return edge.weight * self._layers.diagrams.value(row, edge.state)


def count_along(layers: Layers, length: int, prefix: Sequence[Collection[int]], check: LimitCheck) -> int:
    """Return a lower bound on the number of words of a given length, computed until `check` reports a limit.

    At each step, a beam search keeps the states with the most prefixes: one in the first round, then four, and so on.
    The search uses the completions that are already known. Since partial diagrams contain only reachable states, each
    counted path is a word.
    """
    rows = layers.rows_so_far(length)
    left = min(len(rows) - 1, length - len(prefix))
    best, width, dropped = 0, 1, True
    while left >= 0 and dropped:
        ways: dict[State, int] = {layers.start: 1}
        dropped = False
        for step in range(length - left):
            following: dict[State, int] = {}
            for state, number in ways.items():
                if check():
                    return best
                for edge in layers.onward(state):
                    if step >= len(prefix) or edge.letter in prefix[step]:
                        following[edge.state] = following.get(edge.state, 0) + number * edge.weight
            dropped = dropped or len(following) > width
            ways = dict(nlargest(width, following.items(), key=lambda item: item[1]))
        best = max(best, sum(number * layers.diagrams.value(rows[left], state) for state, number in ways.items()))
        width *= WIDER
    return best
