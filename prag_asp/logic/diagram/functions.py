"""Boolean functions as binary decision diagrams (Bryant 1986): equal functions are the same node, a whole number.

They serve the export to PDDL, whose functions read a few dozen fluents at most. A library such as `dd` or OxiDD would
save the 60 lines that make nodes; what the export needs beside them, cubes that cover a function within a bound and
cases of several functions at once, neither has. `diagrams.py` has the measurements.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

Node = int

FALSE: Node = 0
TRUE: Node = 1

Cube = tuple[tuple[int, bool], ...]
"""A conjunction: variables, which are numbers, with their values, in order."""

BOTTOM = 2**31
"""The level of the constants: below all variables."""


MOST_CUBES = 50_000
"""Conjunctions that a function is written with at most: some 100 MB."""


class TooLarge(Exception):
    """A function needs more nodes, more variables or more conjunctions than there may be."""


class Functions:
    """All functions of variables 0, 1, ...; no more than `most` nodes are made.

    Recursion is as deep as a function has variables, so it has no more than `deepest` of them.

    Raises:
        TooLarge: a function would need more.
    """

    def __init__(self, most: int, deepest: int = 200) -> None:
        self._most = most
        self._deepest = deepest
        self._nodes: list[tuple[int, Node, Node]] = [(BOTTOM, FALSE, FALSE), (BOTTOM, TRUE, TRUE)]
        self._made: dict[tuple[int, Node, Node], Node] = {}
        self._chosen: dict[tuple[Node, Node, Node], Node] = {}
        self._depths = [0, 0]

    def variable(self, number: int, *, value: bool = True) -> Node:
        """Return the function that is true where a variable has a value."""
        return self._node(number, *((FALSE, TRUE) if value else (TRUE, FALSE)))

    def choice(self, condition: Node, then: Node, otherwise: Node) -> Node:
        """Return the function that is `then` where the condition is true, and `otherwise` where it is not."""
        if condition < 2 or then == otherwise:
            return then if condition == TRUE or then == otherwise else otherwise
        if then == TRUE and otherwise == FALSE:
            return condition
        key = (condition, then, otherwise)
        found = self._chosen.get(key)
        if found is None:
            level = min(self._nodes[each][0] for each in key)
            low, high = (self.choice(*(self._child(each, level, side) for each in key)) for side in (False, True))
            found = self._chosen[key] = self._node(level, low, high)
        return found

    def opposite(self, function: Node) -> Node:
        """Return the function that is true where another is not."""
        return self.choice(function, FALSE, TRUE)

    def all(self, functions: Iterable[Node]) -> Node:
        """Return the conjunction of functions."""
        found = TRUE
        for each in functions:
            found = self.choice(found, each, FALSE)
        return found

    def any(self, functions: Iterable[Node]) -> Node:
        """Return the disjunction of functions."""
        found = FALSE
        for each in functions:
            found = self.choice(found, TRUE, each)
        return found

    def at_least(self, bound: int, terms: Sequence[tuple[Node, int]]) -> Node:
        """Return where the weights, above 0, of the functions that are true reach a bound."""
        left = [0]
        for _, weight in reversed(terms):
            left.append(left[-1] + weight)
        left.reverse()
        known: dict[tuple[int, int], Node] = {}

        def reached(place: int, bound: int) -> Node:
            if bound <= 0 or left[place] < bound:
                return TRUE if bound <= 0 else FALSE
            if (place, bound) not in known:
                function, weight = terms[place]
                with_it, without = reached(place + 1, bound - weight), reached(place + 1, bound)
                known[place, bound] = self.choice(function, with_it, without)
            return known[place, bound]

        if len(terms) > self._deepest:
            raise TooLarge
        return reached(0, bound)

    def where(self, function: Node, values: Mapping[int, bool]) -> Node:
        """Return what is left of a function where variables have these values."""
        known: dict[Node, Node] = {FALSE: FALSE, TRUE: TRUE}

        def left(node: Node) -> Node:
            if node not in known:
                level, low, high = self._nodes[node]
                if level in values:
                    known[node] = left(high if values[level] else low)
                else:
                    known[node] = self._node(level, left(low), left(high))
            return known[node]

        return left(function)

    def composed(self, function: Node, inner: Mapping[int, Node]) -> Node:
        """Return a function of functions: what each variable stands for is another one."""
        known: dict[Node, Node] = {FALSE: FALSE, TRUE: TRUE}

        def outer(node: Node) -> Node:
            if node not in known:
                level, low, high = self._nodes[node]
                known[node] = self.choice(inner[level], outer(high), outer(low))
            return known[node]

        return outer(function)

    def variables(self, functions: Iterable[Node]) -> set[int]:
        """Return the variables that some functions depend on."""
        seen, waiting = {FALSE, TRUE}, list(functions)
        while waiting:
            node = waiting.pop()
            if node not in seen:
                seen.add(node)
                waiting += self._nodes[node][1:]
        return {self._nodes[node][0] for node in seen} - {BOTTOM}

    def top(self, functions: Iterable[Node]) -> int:
        """Return the first variable that one of some functions depends on; `BOTTOM` where none does."""
        return min((self._nodes[each][0] for each in functions), default=BOTTOM)

    def cubes(self, function: Node) -> tuple[Cube, ...]:
        """Return conjunctions, none of which can be left out or made shorter by a literal, whose disjunction it is.

        Their number is not the least there is (Minato 1993, irredundant sums of products).

        Raises:
            TooLarge: there are more than `MOST_CUBES`.
        """
        return tuple(tuple(sorted(cube)) for cube in self._irredundant(function, function)[0])

    def cases(
        self, functions: tuple[Node, ...], possible: Callable[[Cube], bool], cube: Cube = ()
    ) -> Iterator[tuple[Cube, tuple[Node, ...]]]:
        """Yield all cases of some functions lazily: conjunctions no two of which meet, and what is constant there.

        Conjunctions that are not possible, as all that are longer, are left out.
        """
        level = self.top(functions)
        if level == BOTTOM:
            yield cube, functions
            return
        for value in (True, False):
            longer = (*cube, (level, value))
            if possible(longer):
                left = tuple([self._child(each, level, value) for each in functions])
                yield from self.cases(left, possible, longer)

    def _irredundant(self, least: Node, most: Node) -> tuple[list[Cube], Node]:
        """Return the cubes of a function between two, and that function."""
        if least == FALSE:
            return [], FALSE
        if most == TRUE:
            return [()], TRUE
        level = self.top((least, most))
        (low, high), (low_most, high_most) = (
            [self._child(each, level, side) for side in (False, True)] for each in (least, most)
        )
        only_low, of_low = self._irredundant(self._minus(low, high_most), low_most)
        only_high, of_high = self._irredundant(self._minus(high, low_most), high_most)
        rest = self.any((self._minus(low, of_low), self._minus(high, of_high)))
        both, of_both = self._irredundant(rest, self.choice(low_most, high_most, FALSE))
        found = [((level, False), *cube) for cube in only_low] + [((level, True), *cube) for cube in only_high] + both
        if len(found) > MOST_CUBES:
            raise TooLarge
        return found, self.any((of_both, self._node(level, of_low, of_high)))

    def _minus(self, function: Node, other: Node) -> Node:
        return self.choice(other, FALSE, function)

    def _child(self, node: Node, level: int, value: bool) -> Node:
        own, low, high = self._nodes[node]
        return node if own != level else high if value else low

    def _node(self, level: int, low: Node, high: Node) -> Node:
        if low == high:
            return low
        key = (level, low, high)
        found = self._made.get(key)
        if found is None:
            if len(self._nodes) >= self._most:
                raise TooLarge
            found = self._made[key] = len(self._nodes)
            self._nodes.append(key)
            self._depths.append(1 + max(self._depths[low], self._depths[high]))
            if self._depths[found] > self._deepest:
                raise TooLarge
        return found
