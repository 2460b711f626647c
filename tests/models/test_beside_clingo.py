"""Programs of many shapes: every answer is that of a plain enumeration by clingo."""

from __future__ import annotations

from fractions import Fraction

import clingo
import pytest

from prag_asp import answer_sets
from prag_asp.errors import NotFound
from prag_asp.models.answer_sets import AnswerSet

FEW = """
{ p(P,1..3) } = 1 :- P = 1..4. :- p(P,H), p(Q,H), P < Q.
{ p(P,1..3) } = 1 :- P = 1..3. :- p(P,H), p(Q,H), P < Q.
{ x(1..7) }. :- { x(1..7) } = 2*K, K = 0..3.
{ x(1..6) }. odd(1) :- x(1). odd(I) :- I=2..6, odd(I-1), not x(I). odd(I) :- I=2..6, not odd(I-1), x(I). :- odd(6).
{ q(I,1..5) } = 1 :- I = 1..5. :- q(I,J), q(K,J), I < K. :- q(I,J), q(K,L), I < K, |I-K| = |J-L|.
{ l(I,J,1..3) } = 1 :- I = 1..3, J = 1..3. :- l(I,J,K), l(I,L,K), J < L. :- l(I,J,K), l(L,J,K), I < L.
{ a(1..6) }. :- #sum { X,X : a(X) } != 10.
2 { a(1..5) } 3. :- a(X), a(X+1).
{ a(1..4) } = 5.
a :- not b. b :- not c. c :- not a.
a(X) ; b(X) :- X = 1..4. :- a(X), a(X+1).
a :- b. b :- a. { c }. a :- c. :- not b.
{ e(1,2); e(2,3); e(3,1) }. r(1). r(Y) :- r(X), e(X,Y). :- not r(3).
{ a }. :- a. :- not a.
{ a(1..3) }. -a(X) :- not a(X), X = 1..3. a(2) :- -a(1).
{ c(X,1..3) } = 1 :- X = 1..5. :- c(X,C), c(X\\5+1,C).
a(1..3). b(X*X) :- a(X). { c(X) } :- b(X), X > 1. d(S) :- S = #sum { X : c(X) }.
#const n = 4. { m(I,J) : J = I+1..n } :- I = 1..n. :- I = 1..n, { m(I,J); m(J,I) } != 1.
#external f. { g }. h :- f, g.
#defined z/0. { a; b }. :- a, z. :- b, not z.
"""
"""Programs with no or few answer sets."""

BEST = """
{ in(1..5) }. :- not in(X), not in(X\\5+1), X = 1..5. #minimize { 1,X : in(X) }.
{ a; b; c }. #maximize { 2 : a; 3 : b; 1 : c }. :- a, b.
{ a; b; c }. :~ a. [1@2] :~ not a. [1@2] :~ b. [3@1] :~ not c. [2@1]
{ a(1..4) } = 2. #minimize { X,X : a(X) }.
{ a(1..4) }. #maximize { X@X : a(X) }. :- a(4), a(3).
{ a(1..3) }. :~ a(X). [0,X]
{ a; b }. #minimize { 1 : a; 1 : b }. #minimize { 5@3 : not a, not b }.
{ x(1..5) }. :~ S = #sum { X : x(X) }. [|S-7|]
{ a }. :- a. :- not a. #minimize { 1 : a }.
{ c(X,1..2) } = 1 :- X = 1..4. :~ c(X,C), c(X+1,C). [1,X]
a ; b. c :- a. #maximize { 1 : c }. { d }.
{ a; b; c }. #minimize { -1,1 : a; -1,2 : b; 3 : c }. :- a, b, not c.
"""
"""Programs that optimise."""

SHOWN = """
{ a; b }. #show a/0.
{ a; b }. #show _hit : a. #show _hit : b.
#show _hit/0. { pin(1..3) }. _hit :- pin(1).
{ a; b; c }. #show. #show f(1) : a. #show f(1) : b. #show _g : c, not a.
{ a(1..4) }. #show n(N) : N = #count { X : a(X) }.
{ e(X,Y) } :- X = 1..3, Y = 1..3, X < Y. r(1). r(Y) :- r(X), e(X,Y). #show r/1.
{ a; b }. #show.
{ _a; a }. #show _a/0. #show -b/0. { -b }.
{ p(1..3) }. #show q(X) : p(X), not p(X+1).
a ; b. { c }. #show x : a. #show x : b. #show c/0.
{ p(1..4) }. _q(X+1) :- p(X). #show _q/1. :- p(1), p(2).
{ a; b; c }. #show "t" : a. #show (1,_x) : b, c.
"""
"""Programs that show less than all."""


def programs(text: str) -> list[str]:
    return text.strip().split("\n")


def enumerate_shown(text: str, *options: str) -> list[AnswerSet]:
    """Return what each answer set shows, sorted; with an option for optimisation, of the optimal ones."""
    control = clingo.Control(["0", *options], logger=lambda *_: None)
    control.add("base", [], text)
    control.ground([("base", [])])
    found: list[AnswerSet] = []

    def keep(model: clingo.Model) -> None:
        if not options or model.optimality_proven:
            found.append(tuple(sorted(set(model.symbols(shown=True)))))

    control.solve(on_model=keep)
    return found


def check(expected: list[AnswerSet], text: str, **how: bool) -> None:
    """Compare counts, lists, samples, marginals and facets with a list of answer sets."""
    found = answer_sets(text=text, **how)
    assert found.count() == len(expected)
    assert sorted(found) == sorted(expected)
    if not expected:
        with pytest.raises(NotFound):
            found.marginals()
        assert found.explain() is not None
        return
    assert set(found.sample(20, seed=1)) <= set(expected)
    shares = {
        symbol: Fraction(sum(symbol in each for each in expected), len(expected))
        for each in expected
        for symbol in each
    }
    assert {symbol: share for symbol, share in found.marginals().items() if share} == shares
    facets = {symbol for symbol, share in shares.items() if share < 1}
    for symbol, facet in found.facets().items():
        assert facet.share == shares.get(symbol, 0) and facet.is_facet == (symbol in facets)
        for choice, chosen in ((facet.chosen, True), (facet.excluded, False)):
            left = [each for each in expected if (symbol in each) == chosen]
            common = [sum(other in each for each in left) for other in facets]
            if choice is not None:
                assert choice.answer_sets == len(left)
                assert choice.facets == sum(0 < number < len(left) for number in common)
                assert choice.of_facets == 1 - Fraction(choice.facets, len(facets))


@pytest.mark.parametrize("text", programs(FEW))
def test_few_answer_sets(text: str) -> None:
    check(enumerate_shown(text), text)


@pytest.mark.parametrize("text", programs(BEST))
def test_optimal_answer_sets(text: str) -> None:
    check(enumerate_shown(text, "--opt-mode=optN"), text, optimal=True)


@pytest.mark.parametrize("text", programs(SHOWN))
def test_projections_on_what_is_shown(text: str) -> None:
    check(sorted(set(enumerate_shown(text))), text, project=True)
    assert answer_sets(text=text).count() == len(enumerate_shown(text))
