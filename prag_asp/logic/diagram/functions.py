"""Boolean functions as binary decision diagrams (Bryant 1986): equal functions are the same node, an integer.

They are used in the export to PDDL, whose functions depend on at most a few dozen fluents. A library such as `dd` or
OxiDD would save the 60 lines of node construction. The export also needs covers by a bounded number of cubes, and case
distinctions shared by several functions, which neither library has. See `diagrams.py` for the measurements.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

Node = int

FALSE: Node = 0
TRUE: Node = 1

Cube = tuple[tuple[int, bool], ...]
"""A conjunction: the numbers of variables with their values, in order."""

BOTTOM = 2**31
"""The level of the constants: below all variables."""


MOST_CUBES = 50_000
"""The maximum number of conjunctions of a function; they take about 100 MB."""


class TooLarge(Exception):
    """A function exceeds the limit on nodes, variables or conjunctions."""


class Functions:
    """All functions of the variables 0, 1, ..., with at most `most` nodes.

    The recursion depth is the number of variables of a function, which is limited to `deepest`.

    Raises:
        TooLarge: a function would exceed a limit.
    """

    def __init__(self, most: int, deepest: int = 200) -> None:
        self._most = most
        self._deepest = deepest
        self._nodes: list[tuple[int, Node, Node]] = [(BOTTOM, FALSE, FALSE), (BOTTOM, TRUE, TRUE)]
        self._nodes_by_key: dict[tuple[int, Node, Node], Node] = {}
        self._chosen: dict[tuple[Node, Node, Node], Node] = {}
        self._depths = [0, 0]

    def variable(self, number: int, *, value: bool = True) -> Node:
        """Return the function that is true if a variable has the given value."""
        return self._node(number, *((FALSE, TRUE) if value else (TRUE, FALSE)))

    def choice(self, condition: Node, then: Node, otherwise: Node) -> Node:
        """Return the function ``if condition then ... else otherwise``."""
        if condition < 2 or then == otherwise:
            return then if condition == TRUE or then == otherwise else otherwise
        if then == TRUE and otherwise == FALSE:
            return condition
        key = (condition, then, otherwise)
        node = self._chosen.get(key)
        if node is None:
            level = min(self._nodes[each][0] for each in key)
            low, high = (self.choice(*(self._child(each, level, side) for each in key)) for side in (False, True))
            node = self._chosen[key] = self._node(level, low, high)
        return node

    def opposite(self, function: Node) -> Node:
        """Return the negation of a function."""
        return self.choice(function, FALSE, TRUE)

    def all(self, functions: Iterable[Node]) -> Node:
        """Return the conjunction of functions."""
        conjunction = TRUE
        for each in functions:
            conjunction = self.choice(conjunction, each, FALSE)
        return conjunction

    def any(self, functions: Iterable[Node]) -> Node:
        """Return the disjunction of functions."""
        disjunction = FALSE
        for each in functions:
            disjunction = self.choice(disjunction, TRUE, each)
        return disjunction

    def at_least(self, bound: int, terms: Sequence[tuple[Node, int]]) -> Node:
        """Return the function that is true if the positive weights of the true functions sum to at least a bound."""
        remaining = [0]
        for _, weight in reversed(terms):
            remaining.append(remaining[-1] + weight)
        remaining.reverse()
        nodes: dict[tuple[int, int], Node] = {}

        def reached(place: int, bound: int) -> Node:
            if bound <= 0 or remaining[place] < bound:
                return TRUE if bound <= 0 else FALSE
            if (place, bound) not in nodes:
                function, weight = terms[place]
                with_it, without = reached(place + 1, bound - weight), reached(place + 1, bound)
                nodes[place, bound] = self.choice(function, with_it, without)
            return nodes[place, bound]

        if len(terms) > self._deepest:
            raise TooLarge
        return reached(0, bound)

    def where(self, function: Node, values: Mapping[int, bool]) -> Node:
        """Return the cofactor of a function for given values of variables."""
        results: dict[Node, Node] = {FALSE: FALSE, TRUE: TRUE}

        def left(node: Node) -> Node:
            if node not in results:
                level, low, high = self._nodes[node]
                if level in values:
                    results[node] = left(high if values[level] else low)
                else:
                    results[node] = self._node(level, left(low), left(high))
            return results[node]

        return left(function)

    def composed(self, function: Node, inner: Mapping[int, Node]) -> Node:
        """Return a function with each of its variables replaced by the function that `inner` holds for the variable."""
        results: dict[Node, Node] = {FALSE: FALSE, TRUE: TRUE}

        def outer(node: Node) -> Node:
            if node not in results:
                level, low, high = self._nodes[node]
                results[node] = self.choice(inner[level], outer(high), outer(low))
            return results[node]

        return outer(function)

    def variables(self, functions: Iterable[Node]) -> set[int]:
        """Return the variables on which any of the given functions depends."""
        seen, waiting = {FALSE, TRUE}, list(functions)
        while waiting:
            node = waiting.pop()
            if node not in seen:
                seen.add(node)
                waiting += self._nodes[node][1:]
        return {self._nodes[node][0] for node in seen} - {BOTTOM}

    def top(self, functions: Iterable[Node]) -> int:
        """Return the first variable on which any of the given functions depends, or `BOTTOM`."""
        return min((self._nodes[each][0] for each in functions), default=BOTTOM)

    def cubes(self, function: Node) -> tuple[Cube, ...]:
        """Return an irredundant sum of products of a function (Minato 1993); its number of cubes need not be minimal.

        Raises:
            TooLarge: the function has more than `MOST_CUBES` cubes.
        """
        return tuple(tuple(sorted(cube)) for cube in self._irredundant(function, function)[0])

    def cases(
        self, functions: tuple[Node, ...], possible: Callable[[Cube], bool], cube: Cube = ()
    ) -> Iterator[tuple[Cube, tuple[Node, ...]]]:
        """Yield disjoint cubes that cover all assignments, each with the constant values of the functions on it.

        Impossible cubes are omitted, together with all longer cubes that contain them.
        """
        level = self.top(functions)
        if level == BOTTOM:
            yield cube, functions
            return
        for value in (True, False):
            longer = (*cube, (level, value))
            if possible(longer):
                restricted = tuple([self._child(each, level, value) for each in functions])
                yield from self.cases(restricted, possible, longer)

    def _irredundant(self, least: Node, most: Node) -> tuple[list[Cube], Node]:
        """Return the cubes of a function between `least` and `most`, and the function itself."""
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
        cubes = [((level, False), *cube) for cube in only_low] + [((level, True), *cube) for cube in only_high] + both
        if len(cubes) > MOST_CUBES:
            raise TooLarge
        return cubes, self.any((of_both, self._node(level, of_low, of_high)))

    def _minus(self, function: Node, other: Node) -> Node:
        return self.choice(other, FALSE, function)

    def _child(self, node: Node, level: int, value: bool) -> Node:
        own, low, high = self._nodes[node]
        return node if own != level else high if value else low

    def _node(self, level: int, low: Node, high: Node) -> Node:
        if low == high:
            return low
        key = (level, low, high)
        node = self._nodes_by_key.get(key)
        if node is None:
            if len(self._nodes) >= self._most:
                raise TooLarge
            node = self._nodes_by_key[key] = len(self._nodes)
            self._nodes.append(key)
            self._depths.append(1 + max(self._depths[low], self._depths[high]))
            if self._depths[node] > self._deepest:
                raise TooLarge
        return node
