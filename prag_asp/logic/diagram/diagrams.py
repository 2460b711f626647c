"""Decision diagrams over several values with whole numbers at their ends, each node made once.

A state is a word: the values of its digits, one at each level. A diagram maps words to whole numbers, and is the
smallest acyclic automaton of the words that it does not map to 0 (Bryant 1986; Clarke, Fujita and Zhao 1995 for numbers
at the ends). A node is a mapping from values to nodes of the next level, at the last level to the numbers themselves; a
value without an entry leads to 0. So a value is known from when a state has it, no number is ever rounded, and equal
functions are the same node, a number above 0. The empty diagram is 0. A set is a diagram that maps to 1 and 0 alone.

No library is used, because none that runs from Python has exact numbers at the ends: CUDD (`dd` 0.6) has floats there,
OxiDD 0.13 has binary diagrams only. With one diagram for each binary digit of a count, both are exact as well. On
`benchmarks/diagrams.py` (1.8 * 10^8 states, 3,024,000,000 plans) they take 7.1 s of CPU and 104 MB (CUDD), or 4.6 s and
298 MB (OxiDD), for actions that were encoded by hand; this module takes 11.3 s and 254 MB, reading and grounding the
domain included. A factor of 1.6 to 2.4 does not pay for a native dependency without wheels for every platform that runs
uninterruptible operations (`look` is called within them here), nor for the encoding into bits.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence

Node = int
Word = tuple[int, ...]

EMPTY: Node = 0

LOOK = 4096
"""Entries of nodes that are worked on between two looks at the limits, be it for a new node or for one there is."""

CROWDED = 200_000
"""Nodes up to which nothing is thrown away."""

REMEMBERED = 2_000_000
"""Results that are remembered, at most, when an operation begins."""

Changes = Mapping[int, tuple[int, int]]
"""For some levels, which bits of a digit are kept, and which are then set."""


class Diagrams:
    """All diagrams over words of so many digits, at least one; `look` is called now and then, and may raise an error.

    Recursion is as deep as words are long.
    """

    def __init__(self, digits: int, look: Callable[[], None]) -> None:
        self.digits = digits
        self._last = digits - 1
        self._look = look
        self._worked = 0
        self._children: dict[Node, dict[int, int]] = {}
        self._made: dict[tuple[int, frozenset[tuple[int, int]]], Node] = {}
        self._highest = 0
        self._known: dict[str, dict[tuple[int, ...], Node]] = {}
        self._crowded = CROWDED

    def __len__(self) -> int:
        """Return how many nodes there are; they fit into memory."""
        return len(self._children)

    def word(self, word: Sequence[int]) -> Node:
        """Return the set of one word."""
        node = 1
        for level in range(self._last, -1, -1):
            node = self._node(level, {word[level]: node})
        return node

    def value(self, node: Node, word: Sequence[int]) -> int:
        """Return what a diagram maps a word to."""
        for digit in word:
            if not node:
                return 0
            node = self._children[node].get(digit, EMPTY)
        return node

    def total(self, node: Node) -> int:
        """Return the sum of all that a diagram maps to: of a set, the number of its words."""
        known: dict[Node, int] = {EMPTY: 0}

        def total(level: int, node: Node) -> int:
            if node not in known:
                below = self._children[node].values()
                self._work(len(below))
                known[node] = sum(below) if level == self._last else sum(total(level + 1, each) for each in below)
            return known[node]

        return total(0, node)

    def join(self, first: Node, second: Node) -> Node:
        """Return the union of two sets."""
        self._work(1)
        return self._either("join", 0, first, second, lambda a, b: 1)

    def add(self, first: Node, second: Node) -> Node:
        """Return the sum of two diagrams."""
        self._work(1)
        return self._either("add", 0, first, second, lambda a, b: a + b)

    def sum(self, several: Iterable[Node]) -> Node:
        """Return the sum of diagrams, those next to each other first: most of them meet in little."""
        return _paired(list(several), self.add)

    def union(self, several: Iterable[Node]) -> Node:
        """Return the union of sets."""
        return _paired(list(several), self.join)

    def within(self, states: Node, node: Node) -> Node:
        """Return a diagram with 0 for all words that are not in a set."""
        self._work(1)
        return self._within(0, states, node)

    def minus(self, first: Node, second: Node) -> Node:
        """Return what a set has that another has not."""
        self._work(1)
        return self._minus(0, first, second)

    def having(self, node: Node, level: int, mask: int) -> Node:
        """Return a diagram with 0 for all words without a bit, given as a mask, in the digit of a level."""
        self._work(1)
        return self._having(0, node, level, mask)

    def mapped(self, node: Node, number: Callable[[int], int]) -> Node:
        """Return a diagram with each number that is not 0 replaced."""
        known: dict[Node, Node] = {EMPTY: EMPTY}

        def mapped(level: int, node: Node) -> Node:
            if level > self._last:
                return number(node)
            if node not in known:
                below = {digit: mapped(level + 1, each) for digit, each in self._children[node].items()}
                known[node] = self._node(level, below)
            return known[node]

        return mapped(0, node)

    def everywhere(self, states: Node, number: int) -> Node:
        """Return the diagram that maps the words of a set to one number."""
        return states if number == 1 else self.mapped(states, lambda _: number)

    def image(self, states: Node, changes: Changes) -> Node:
        """Return the set of what the words of a set are changed to."""
        last = max(changes, default=-1)
        known: dict[Node, Node] = {EMPTY: EMPTY}

        def image(level: int, node: Node) -> Node:
            if level > last:
                return node
            if node not in known:
                keep, put = changes.get(level, (-1, 0))
                below: dict[int, Node] = {}
                for digit, each in self._children[node].items():
                    after, image_of = (digit & keep) | put, image(level + 1, each)
                    sofar = below.get(after, EMPTY)
                    below[after] = self._either("join", level + 1, sofar, image_of, lambda a, b: 1)
                known[node] = self._node(level, below)
            return known[node]

        return image(0, states)

    def before(self, states: Node, changes: Changes, node: Node) -> Node:
        """Return the diagram that maps each word of a set to what `node` maps it to once it is changed.

        Where `states` has other numbers than 1, they are multiplied.
        """
        last = max(changes, default=-1)
        known: dict[tuple[Node, Node], Node] = {}

        def before(level: int, states: Node, node: Node) -> Node:
            if not states or not node:
                return EMPTY
            if level > last:
                return self._within(level, states, node)
            key = (states, node)
            if key not in known:
                keep, put = changes.get(level, (-1, 0))
                reached = self._children[node]
                known[key] = self._node(level, {
                    digit: before(level + 1, each, reached.get((digit & keep) | put, EMPTY))
                    for digit, each in self._children[states].items()
                })  # fmt: skip
            return known[key]

        return before(0, states, node)

    def clean(self, roots: Iterable[Node]) -> None:
        """Throw all nodes away that no root leads to, once they are many; what was computed is forgotten with them."""
        if sum(map(len, self._known.values())) > REMEMBERED:
            self._known.clear()
        if len(self._children) < self._crowded:
            return
        kept: set[Node] = set()
        layer = {root for root in roots if root}
        for level in range(self.digits):
            kept |= layer
            if level < self._last:
                layer = {each for node in layer for each in self._children[node].values()}
        self._children = {node: below for node, below in self._children.items() if node in kept}
        self._made = {key: node for key, node in self._made.items() if node in kept}
        self._known.clear()
        self._crowded = max(CROWDED, 2 * len(kept))

    def _work(self, entries: int) -> None:
        """Look at the limits where so many more entries make it time to."""
        self._worked += entries
        if self._worked >= LOOK:
            self._worked = 0
            self._look()

    def _node(self, level: int, below: dict[int, Node]) -> Node:
        """Return the node of a mapping, which is kept and no longer changed."""
        self._work(1 + len(below))
        if EMPTY in below.values():
            below = {digit: each for digit, each in below.items() if each}
        if not below:
            return EMPTY
        key = (level, frozenset(below.items()))
        found = self._made.get(key)
        if found is None:
            self._highest = found = self._highest + 1
            self._made[key] = found
            self._children[found] = below
        return found

    def _either(self, kind: str, level: int, first: Node, second: Node, both: Callable[[int, int], int]) -> Node:
        """Return the diagram of what one of two diagrams maps to, or of `both` where each has a number."""
        known = self._known.setdefault(kind, {})

        def either(level: int, first: Node, second: Node) -> Node:
            if not first or not second:
                return first or second
            if level > self._last:
                return both(first, second)
            if kind == "join" and first == second:
                return first
            key = (first, second) if first < second else (second, first)
            found = known.get(key)
            if found is None:
                below, others = dict(self._children[first]), self._children[second]
                for digit, other in others.items():
                    own = below.get(digit)
                    below[digit] = other if own is None else either(level + 1, own, other)
                found = known[key] = self._node(level, below)
            return found

        return either(level, first, second)

    def _within(self, level: int, states: Node, node: Node) -> Node:
        if not states or not node:
            return EMPTY
        if level > self._last:
            return states * node
        known = self._known.setdefault("within", {})
        found = known.get((states, node))
        if found is None:
            others, below = self._children[node], self._children[states]
            found = self._node(level, {
                digit: self._within(level + 1, each, others[digit]) for digit, each in below.items() if digit in others
            })  # fmt: skip
            known[states, node] = found
        return found

    def _minus(self, level: int, first: Node, second: Node) -> Node:
        if not first or not second or first == second:
            return EMPTY if first == second else first
        known = self._known.setdefault("minus", {})
        found = known.get((first, second))
        if found is None:
            others, below = self._children[second], self._children[first]
            found = self._node(level, {
                digit: self._minus(level + 1, each, others.get(digit, EMPTY)) for digit, each in below.items()
            })  # fmt: skip
            known[first, second] = found
        return found

    def _having(self, level: int, node: Node, target: int, mask: int) -> Node:
        if not node:
            return EMPTY
        known = self._known.setdefault("having", {})
        key = (node, target, mask)
        found = known.get(key)
        if found is None:
            below = self._children[node]
            if level == target:
                below = {digit: each for digit, each in below.items() if digit & mask}
            else:
                below = {digit: self._having(level + 1, each, target, mask) for digit, each in below.items()}
            found = known[key] = self._node(level, below)
        return found


def _paired(several: list[Node], both: Callable[[Node, Node], Node]) -> Node:
    """Return what is left of diagrams after taking neighbours together, again and again."""
    while len(several) > 1:
        joined = [both(*several[place : place + 2]) for place in range(0, len(several) - 1, 2)]
        several = joined + several[2 * len(joined) :]
    return several[0] if several else EMPTY
