"""Numbers that mathematics knows: queens, colourings, cycles, independent sets, spanning trees, latin squares."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection
from fractions import Fraction
from itertools import combinations, product

import pytest

from prag_asp import answer_sets

QUEENS = """
{ q(I,1..n) } = 1 :- I = 1..n.
:- q(I,J), q(K,J), I < K.
:- q(I,J), q(K,L), I < K, |I-K| = |J-L|.
"""
GRID = "v(1..n,1..n). e((X,Y),(X+1,Y)) :- v(X,Y), v(X+1,Y). e((X,Y),(X,Y+1)) :- v(X,Y), v(X,Y+1). "
COLOURING = "{ c(X,1..k) } = 1 :- X = 1..n. :- c(X,C), c(X+1,C). :- c(1,C), c(n,C). "
INDEPENDENT = GRID + "{ in(A) } :- v(X,Y), A = (X,Y). :- e(A,B), in(A), in(B). #show in/1."
TREE = (
    GRID
    + """
e(A,B) :- e(B,A). { t(A,B) : e(A,B) } = 1 :- v(X,Y), A = (X,Y), A != (1,1).
r((1,1)). r(A) :- t(A,B), r(B). :- v(X,Y), not r((X,Y)). #show t/2.
"""
)
CYCLE = """
node(1..n). { t(X,Y) : node(Y), X != Y } = 1 :- node(X). :- node(Y), #count { X : t(X,Y) } != 1.
r(1). r(Y) :- r(X), t(X,Y). :- node(X), not r(X). #show t/2.
"""
LATIN = """
{ l(I,J,1..n) } = 1 :- I = 1..n, J = 1..n.
:- l(I,J,K), l(I,L,K), J < L. :- l(I,J,K), l(L,J,K), I < L.
"""


def spanning_trees(side: int, without: Collection[tuple[int, int]] = ()) -> int:
    """Count the spanning trees of a square grid by Kirchhoff's theorem: a determinant, by exact elimination.

    The edge between two nodes may be left out.
    """
    nodes = list(product(range(1, side + 1), repeat=2))
    near = {(a, b) for a, b in product(nodes, repeat=2) if abs(a[0] - b[0]) + abs(a[1] - b[1]) == 1}
    near -= {(a, b) for a, b in near if a in without and b in without}
    degree = Counter(a for a, _ in near)
    rows = [[Fraction(degree[a] if a == b else -((a, b) in near)) for b in nodes[1:]] for a in nodes[1:]]
    found = Fraction(1)
    for place in range(len(rows)):
        pivot = rows[place][place]
        found *= pivot
        for below in rows[place + 1 :]:
            factor = below[place] / pivot
            for column in range(place, len(rows)):
                below[column] -= factor * rows[place][column]
    assert found.denominator == 1
    return found.numerator


def independent_sets(side: int) -> int:
    """Count the independent sets of a square grid by its rows."""
    rows = [row for row in range(2**side) if not row & row >> 1]
    ways = dict.fromkeys(rows, 1)
    for _ in range(side - 1):
        ways = {row: sum(number for other, number in ways.items() if not row & other) for row in rows}
    return sum(ways.values())


@pytest.mark.parametrize(("n", "known"), [(1, 1), (2, 0), (4, 2), (5, 10), (6, 4), (7, 40), (8, 92)])
def test_queens(n: int, known: int) -> None:
    assert answer_sets(text=QUEENS, constants={"n": n}, engine="diagram").count() == known


def test_colourings_of_a_cycle_are_those_of_its_chromatic_polynomial() -> None:
    for n, k in product((3, 4, 9), (2, 3, 4)):
        found = answer_sets(text=COLOURING, constants={"n": n, "k": k}, engine="diagram").count()
        assert found == (k - 1) ** n + (-1) ** n * (k - 1)
    assert answer_sets(text=COLOURING, constants={"n": 60, "k": 4}).count() == 3**60 + 3


def test_independent_sets_of_a_grid_are_those_of_its_rows() -> None:
    assert answer_sets(text=INDEPENDENT, constants={"n": 4}, engine="diagram").count() == independent_sets(4) == 1234
    assert answer_sets(text=INDEPENDENT, constants={"n": 8}).count() == independent_sets(8) == 660647962955


def test_spanning_trees_of_a_grid_are_those_of_kirchhoff() -> None:
    found = [answer_sets(text=TREE, constants={"n": n}).count() for n in (2, 3, 4)]
    assert found == [spanning_trees(n) for n in (2, 3, 4)] == [4, 192, 100352]
    assert answer_sets(text=TREE, constants={"n": 3}, engine="ganak").count() == 192


def test_an_edge_is_in_as_many_spanning_trees_as_are_gone_without_it() -> None:
    shares = answer_sets(text=TREE, constants={"n": 3}).marginals()
    assert sum(shares.values()) == 8  # edges of a tree
    by_name = {str(symbol): share for symbol, share in shares.items()}
    expected = 1 - Fraction(spanning_trees(3, without=((2, 2), (2, 3))), spanning_trees(3))
    assert by_name["t((2,2),(2,3))"] + by_name["t((2,3),(2,2))"] == expected


@pytest.mark.parametrize(("n", "known"), [(3, 2), (5, 24), (6, 120)])
def test_hamiltonian_cycles_of_a_complete_graph(n: int, known: int) -> None:
    assert answer_sets(text=CYCLE, constants={"n": n}).count() == known


def test_latin_squares() -> None:
    known = {1: 1, 2: 2, 3: 12, 4: 576}
    assert {n: answer_sets(text=LATIN, constants={"n": n}, engine="diagram").count() for n in known} == known
    assert answer_sets(text=LATIN, constants={"n": 4}, engine="ganak").count() == 576


def test_subsets_of_a_size_are_binomials_and_their_elements_equally_likely() -> None:
    subsets = answer_sets(text="{ in(1..20) } = 7. #show in/1.")
    assert subsets.count() == len(list(combinations(range(20), 7))) == 77520
    assert set(subsets.marginals().values()) == {Fraction(7, 20)}


def test_sums_over_many_atoms_are_counted_by_what_they_lack() -> None:
    text = "{ in(1..30) }. :- #sum { I : in(I) } != 200."
    ways = [1] + 200 * [0]
    for weight in range(1, 31):
        ways = [old + (ways[total - weight] if total >= weight else 0) for total, old in enumerate(ways)]
    assert answer_sets(text=text, engine="diagram").count() == ways[200]
