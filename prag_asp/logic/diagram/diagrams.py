"""Multi-valued decision diagrams with integer terminals; nodes are unique.

A state is a word: the values of its digits, one per level. A diagram maps words to nonnegative integers, and is the
minimal acyclic automaton of the words that it does not map to 0 (Bryant 1986; Clarke, Fujita and Zhao 1995 for integer
terminals). A node maps values to nodes of the next level or, at the last level, to the integers themselves; a missing
value leads to 0. The values of a digit therefore need not be known beforehand, no integer is ever rounded, and equal
functions are the same node. Nodes are numbered from 1; the empty diagram is 0. A set is a diagram with values 0 and 1.

No library is used, because none with a Python interface has exact integer terminals: CUDD (`dd` 0.6) has floats, OxiDD
0.13 has only binary diagrams. Both are exact with one diagram for each binary digit of a count. On
`benchmarks/diagrams.py` (1.8 * 10^8 states, 3,024,000,000 plans), they take 7.1 s of CPU and 104 MB (CUDD), or 4.6 s
and 298 MB (OxiDD), for hand-encoded actions; this module takes 11.3 s and 254 MB, including reading and grounding the
domain. A factor of 1.6 to 2.4 does not justify encoding states into bits, nor a native dependency that lacks wheels for
some platforms and whose operations cannot be interrupted (operations of this module call `look`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence

Node = int
Word = tuple[int, ...]

EMPTY: Node = 0

LOOK = 4096
"""The number of node entries that are processed between two calls of `look`."""

CROWDED = 200_000
"""The number of nodes up to which garbage is not collected."""

REMEMBERED = 2_000_000
"""The maximum number of cached results at the beginning of an operation."""

Changes = Mapping[int, tuple[int, int]]
"""The changes to digits, by level: a mask of the bits that are kept, and a mask of the bits that are set afterwards."""


class Diagrams:
    """All diagrams over words of `digits` digits; there is at least one digit.

    `look` is called regularly during operations, and may raise an error to stop them. The recursion depth is the number
    of digits.
    """

    def __init__(self, digits: int, look: Callable[[], None]) -> None:
        self.digits = digits
        self._last = digits - 1
        self._look = look
        self._worked = 0
        self._children: dict[Node, dict[int, int]] = {}
        self._nodes_by_key: dict[tuple[int, frozenset[tuple[int, int]]], Node] = {}
        self._highest = 0
        self._results: dict[str, dict[tuple[int, ...], Node]] = {}
        self._crowded = CROWDED

    def __len__(self) -> int:
        """Return the number of nodes in memory."""
        return len(self._children)

    def word(self, word: Sequence[int]) -> Node:
        """Return the set that contains one word."""
        node = 1
        for level in range(self._last, -1, -1):
            node = self._node(level, {word[level]: node})
        return node

    def value(self, node: Node, word: Sequence[int]) -> int:
        """Return the value of a word."""
        for digit in word:
            if not node:
                return 0
            node = self._children[node].get(digit, EMPTY)
        return node

    def total(self, node: Node) -> int:
        """Return the sum of the values of all words: for a set, the number of its words."""
        totals: dict[Node, int] = {EMPTY: 0}

        def total(level: int, node: Node) -> int:
            if node not in totals:
                below = self._children[node].values()
                self._work(len(below))
                totals[node] = sum(below) if level == self._last else sum(total(level + 1, each) for each in below)
            return totals[node]

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
        """Return the sum of diagrams, added in pairs as in a balanced tree, because most diagrams share few nodes."""
        return _paired(list(several), self.add)

    def union(self, several: Iterable[Node]) -> Node:
        """Return the union of sets."""
        return _paired(list(several), self.join)

    def within(self, states: Node, node: Node) -> Node:
        """Return a diagram restricted to a set, so that all other words have the value 0."""
        self._work(1)
        return self._within(0, states, node)

    def minus(self, first: Node, second: Node) -> Node:
        """Return the difference of two sets."""
        self._work(1)
        return self._minus(0, first, second)

    def having(self, node: Node, level: int, mask: int) -> Node:
        """Return a diagram restricted to the words whose digit at a level has the bit `mask`."""
        self._work(1)
        return self._having(0, node, level, mask)

    def mapped(self, node: Node, number: Callable[[int], int]) -> Node:
        """Return a diagram with `number` applied to each value except 0."""
        images: dict[Node, Node] = {EMPTY: EMPTY}

        def mapped(level: int, node: Node) -> Node:
            if level > self._last:
                return number(node)
            if node not in images:
                below = {digit: mapped(level + 1, each) for digit, each in self._children[node].items()}
                images[node] = self._node(level, below)
            return images[node]

        return mapped(0, node)

    def everywhere(self, states: Node, number: int) -> Node:
        """Return the diagram that maps all words of a set to one value, and all other words to 0."""
        return states if number == 1 else self.mapped(states, lambda _: number)

    def image(self, states: Node, changes: Changes) -> Node:
        """Return the image of a set under changes to digits."""
        last = max(changes, default=-1)
        images: dict[Node, Node] = {EMPTY: EMPTY}

        def image(level: int, node: Node) -> Node:
            if level > last:
                return node
            if node not in images:
                keep, put = changes.get(level, (-1, 0))
                below: dict[int, Node] = {}
                for digit, each in self._children[node].items():
                    after, image_of = (digit & keep) | put, image(level + 1, each)
                    sofar = below.get(after, EMPTY)
                    below[after] = self._either("join", level + 1, sofar, image_of, lambda a, b: 1)
                images[node] = self._node(level, below)
            return images[node]

        return image(0, states)

    def before(self, states: Node, changes: Changes, node: Node) -> Node:
        """Return the diagram that maps each word of a set to the value that the changed word has in `node`.

        If `states` has values other than 1, they are factors of the result.
        """
        last = max(changes, default=-1)
        results: dict[tuple[Node, Node], Node] = {}

        def before(level: int, states: Node, node: Node) -> Node:
            if not states or not node:
                return EMPTY
            if level > last:
                return self._within(level, states, node)
            key = (states, node)
            if key not in results:
                keep, put = changes.get(level, (-1, 0))
                reached = self._children[node]
                results[key] = self._node(level, {
                    digit: before(level + 1, each, reached.get((digit & keep) | put, EMPTY))
                    for digit, each in self._children[states].items()
                })  # fmt: skip
            return results[key]

        return before(0, states, node)

    def clean(self, roots: Iterable[Node]) -> None:
        """Remove all nodes that are unreachable from the roots, and all cached results, if there are many nodes."""
        if sum(map(len, self._results.values())) > REMEMBERED:
            self._results.clear()
        if len(self._children) < self._crowded:
            return
        live: set[Node] = set()
        layer = {root for root in roots if root}
        for level in range(self.digits):
            live |= layer
            if level < self._last:
                layer = {each for node in layer for each in self._children[node].values()}
        self._children = {node: below for node, below in self._children.items() if node in live}
        self._nodes_by_key = {key: node for key, node in self._nodes_by_key.items() if node in live}
        self._results.clear()
        self._crowded = max(CROWDED, 2 * len(live))

    def _work(self, entries: int) -> None:
        """Count processed entries, and call `look` after every `LOOK` of them."""
        self._worked += entries
        if self._worked >= LOOK:
            self._worked = 0
            self._look()

    def _node(self, level: int, below: dict[int, Node]) -> Node:
        """Return the unique node of a mapping, which must not change afterwards."""
        self._worked += 1 + len(below)
        if self._worked >= LOOK:
            self._work(0)
        if EMPTY in below.values():
            below = {digit: each for digit, each in below.items() if each}
        if not below:
            return EMPTY
        key = (level, frozenset(below.items()))
        node = self._nodes_by_key.get(key)
        if node is None:
            self._highest = node = self._highest + 1
            self._nodes_by_key[key] = node
            self._children[node] = below
        return node

    def _either(self, kind: str, level: int, first: Node, second: Node, both: Callable[[int, int], int]) -> Node:
        """Return the pointwise combination of two diagrams: the only nonzero value, or `both` of two nonzero values."""
        cache = self._results.setdefault(kind, {})

        def either(level: int, first: Node, second: Node) -> Node:
            if not first or not second:
                return first or second
            if level > self._last:
                return both(first, second)
            if kind == "join" and first == second:
                return first
            key = (first, second) if first < second else (second, first)
            result = cache.get(key)
            if result is None:
                below, others = dict(self._children[first]), self._children[second]
                for digit, other in others.items():
                    own = below.get(digit)
                    below[digit] = other if own is None else either(level + 1, own, other)
                result = cache[key] = self._node(level, below)
            return result

        return either(level, first, second)

    def _within(self, level: int, states: Node, node: Node) -> Node:
        if not states or not node:
            return EMPTY
        if level > self._last:
            return states * node
        cache = self._results.setdefault("within", {})
        result = cache.get((states, node))
        if result is None:
            others, below = self._children[node], self._children[states]
            result = self._node(level, {
                digit: self._within(level + 1, each, others[digit]) for digit, each in below.items() if digit in others
            })  # fmt: skip
            cache[states, node] = result
        return result

    def _minus(self, level: int, first: Node, second: Node) -> Node:
        if not first or not second or first == second:
            return EMPTY if first == second else first
        cache = self._results.setdefault("minus", {})
        result = cache.get((first, second))
        if result is None:
            others, below = self._children[second], self._children[first]
            result = self._node(level, {
                digit: self._minus(level + 1, each, others.get(digit, EMPTY)) for digit, each in below.items()
            })  # fmt: skip
            cache[first, second] = result
        return result

    def _having(self, level: int, node: Node, target: int, mask: int) -> Node:
        cache, children = self._results.setdefault("having", {}), self._children

        def having(level: int, node: Node) -> Node:
            key = (node, target, mask)
            result = cache.get(key)
            if result is None:
                below = children[node]
                if level == target:
                    kept = {digit: each for digit, each in below.items() if digit & mask}
                else:
                    kept = {digit: having(level + 1, each) for digit, each in below.items()}
                result = cache[key] = node if kept == below else self._node(level, kept)
            return result

        return having(level, node) if node else EMPTY


def _paired(several: list[Node], both: Callable[[Node, Node], Node]) -> Node:
    """Return the combination of diagrams with `both`, combining neighbours in a balanced tree."""
    while len(several) > 1:
        joined = [both(*several[place : place + 2]) for place in range(0, len(several) - 1, 2)]
        several = joined + several[2 * len(joined) :]
    return several[0] if several else EMPTY
