"""Programs of all shapes, from no answer set to numbers of hundreds of digits."""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import chain


@dataclass(frozen=True)
class Shape:
    """A program with values for its constants; with `project`, answer sets that agree on the shown atoms are one."""

    text: str
    constants: dict[str, int] = field(default_factory=dict)
    project: bool = False

    @property
    def full_text(self) -> str:
        """The text with the values of its constants."""
        return "".join(f"#const {name} = {value}.\n" for name, value in self.constants.items()) + self.text


GRID = "v(1..n,1..m). e((X,Y),(X+1,Y)) :- v(X,Y), v(X+1,Y). e((X,Y),(X,Y+1)) :- v(X,Y), v(X,Y+1). "
PIGEONS = "{ a(P,1..n-1) } = 1 :- P = 1..n. :- a(P,H), a(Q,H), P < Q."
HOLES = "{ a(P,1..n) } = 1 :- P = 1..n. :- a(P,H), a(Q,H), P < Q."
PARITY = "{ x(1..n) }. :- { x(1..n) } = 2*K, K = 0..n/2."
CHAIN_PARITY = (
    "{ x(1..n) }. odd(1) :- x(1). odd(I) :- I = 2..n, odd(I-1), not x(I). odd(I) :- I = 2..n, not odd(I-1), x(I). "
    ":- not odd(n)."
)
QUEENS = "{ q(I,1..n) } = 1 :- I = 1..n. :- q(I,J), q(K,J), I < K. :- q(I,J), q(K,L), I < K, |I-K| = |J-L|."
LATIN = (
    "{ l(I,J,1..n) } = 1 :- I = 1..n, J = 1..n. :- l(I,J,K), l(I,L,K), J < L. :- l(I,J,K), l(L,J,K), I < L. "
    ":- I = 1..n, K = 1..n, not l(I,J,K) : J = 1..n."
)
CIRCLE = "{ c(X,1..k) } = 1 :- X = 1..n. :- c(X,C), c(X+1,C). :- c(1,C), c(n,C)."
GRID_COLOURING = GRID + "{ c(A,1..k) } = 1 :- v(X,Y), A = (X,Y). :- e(A,B), c(A,C), c(B,C)."
COMPLETE_COLOURING = "{ c(X,1..k) } = 1 :- X = 1..n. :- c(X,C), c(Y,C), X < Y."
INDEPENDENT = GRID + "{ in(A) } :- v(X,Y), A = (X,Y). :- e(A,B), in(A), in(B)."
MAXIMAL = (
    INDEPENDENT + " near(A) :- e(A,B), in(B). near(B) :- e(A,B), in(A). :- v(X,Y), A = (X,Y), not in(A), not near(A)."
)
CYCLE = (
    "node(1..n). { t(X,Y) : node(Y), X != Y } = 1 :- node(X). :- node(Y), #count { X : t(X,Y) } != 1. "
    "r(1). r(Y) :- r(X), t(X,Y). :- node(X), not r(X). #show t/2."
)
GRID_CYCLE = (
    GRID + "d(A,B) :- e(A,B). d(B,A) :- e(A,B). { t(A,B) : d(A,B) } = 1 :- v(X,Y), A = (X,Y). "
    ":- v(X,Y), B = (X,Y), #count { A : t(A,B) } != 1. r((1,1)). r(B) :- r(A), t(A,B). :- v(X,Y), not r((X,Y))."
)
BLOCKS = (
    "block(1..b). on(B,0,0) :- block(B). { move(B,L,T) : block(B), L = 0..b, L != B } = 1 :- T = 1..n. "
    "on(B,L,T) :- move(B,L,T). moved(B,T) :- move(B,L,T). on(B,L,T) :- on(B,L,T-1), T = 1..n, not moved(B,T). "
    ":- move(B,L,T), on(C,B,T-1). :- move(B,L,T), L > 0, on(C,L,T-1). :- move(B,L,T), on(B,L,T-1). "
)
TOWER = BLOCKS + ":- B = 2..b, not on(B,B-1,n)."
WALK = "at(1,0). { at(X-1,T); at(X+1,T) } = 1 :- at(X,T-1), T = 1..n. :- at(0,T). :- at(w+1,T)."
SUBSETS = "{ in(1..n) } = k."
SUMS = "{ in(1..n) }. :- #sum { I : in(I) } != s."
TREE = (
    GRID + "d(A,B) :- e(A,B). d(B,A) :- e(A,B). { t(A,B) : d(A,B) } = 1 :- v(X,Y), A = (X,Y), A != (1,1). "
    "r((1,1)). r(A) :- t(A,B), r(B). :- v(X,Y), not r((X,Y)). #show t/2."
)
CONNECTED = (
    GRID + "{ t(A,B) } :- e(A,B). r((1,1)). r(B) :- r(A), t(A,B). r(A) :- r(B), t(A,B). :- v(X,Y), not r((X,Y))."
)
REACH = "{ edge(X,Y) } :- X = 1..n, Y = 1..n, X != Y. reach(1). reach(Y) :- reach(X), edge(X,Y). :- not reach(n)."
REACHED = "{ edge(X,Y) } :- X = 1..n, Y = 1..n, X < Y. reach(1). reach(Y) :- reach(X), edge(X,Y). #show reach/1."
COVER = GRID + "{ in(A) } :- v(X,Y), A = (X,Y). :- e(A,B), not in(A), not in(B). side(X) :- in((X,Y)). #show side/1."
ROWS = (
    "{ q(I,1..n) } = 1 :- I = 1..n. :- q(I,J), q(K,J), I < K. :- q(I,J), q(K,L), I < K, |I-K| = |J-L|. "
    "low(I) :- q(I,J), 2*J <= n. #show low/1."
)
DISJUNCTION = "a(X) ; b(X) ; c(X) :- X = 1..n. :- a(X), a(X+1). :- b(X), b(X+1)."
SATURATED = "t(X) ; f(X) :- X = 1..n. t(X) :- f(X), t(X+1). f(X) :- t(X), f(X+1), not g(X). { g(X) } :- X = 1..n."
HEAD_CYCLES = "a(X) ; b(X) :- X = 1..n. a(X) :- b(X), s(X). b(X) :- a(X), s(X). { s(X) } :- X = 1..n."
FREE = "{ a(1..n) }. :- a(X), a(X+1), a(X+2)."
EVEN_LOOPS = "a(X) :- not b(X), X = 1..n. b(X) :- not a(X), X = 1..n. :- a(X), a(X+1)."


KNAPSACK = "w(1..n). { in(I) } :- w(I). :- #sum { I*I\\17+1,I : in(I) } > s. :- #sum { I*I\\17+1,I : in(I) } < s-4."
"""Sets of items whose weights sum to about `s`: aggregates with two bounds."""
SUDOKU = (
    "{ x(I,J,1..n*n) } = 1 :- I = 1..n*n, J = 1..n*n. :- x(I,J,K), x(I,L,K), J < L. :- x(I,J,K), x(L,J,K), I < L. "
    ":- x(I,J,K), x(L,M,K), (I-1)/n = (L-1)/n, (J-1)/n = (M-1)/n, (I,J) < (L,M). "
)
GIVEN = "53  7    6  195    98    6 8   6   34  8 3  17   2   6 6    28    419  5    8  79"
CLUES = "".join(
    f":- not x({place // 9 + 1},{place % 9 + 1},{value}). " for place, value in enumerate(GIVEN) if value != " "
)
"""The clues of a Sudoku with one solution."""
DOMINOES = (
    "c(1..n,1..m). h(X,Y) :- c(X,Y), c(X+1,Y). v(X,Y) :- c(X,Y), c(X,Y+1). { right(X,Y) : h(X,Y); up(X,Y) : v(X,Y) }. "
    "covered(X,Y) :- c(X,Y), 1 { right(X,Y); right(X-1,Y); up(X,Y); up(X,Y-1) } 1. :- c(X,Y), not covered(X,Y)."
)
MAGIC = (
    "{ x(I,J,1..9) } = 1 :- I = 1..3, J = 1..3. :- x(I,J,K), x(L,M,K), (I,J) < (L,M). "
    ":- I = 1..3, #sum { K,J : x(I,J,K) } != 15. :- J = 1..3, #sum { K,I : x(I,J,K) } != 15. "
    ":- #sum { K,I : x(I,I,K) } != 15. :- #sum { K,I : x(I,4-I,K) } != 15."
)
LADDER = "v(1..n,1..2). e((X,Y),(X+1,Y)) :- v(X,Y), v(X+1,Y). e((X,1),(X,2)) :- v(X,1). " + (
    "{ c(A,1..k) } = 1 :- v(X,Y), A = (X,Y). :- e(A,B), c(A,C), c(B,C)."
)
TERNARY = "{ d(I,0..2) } = 1 :- I = 1..n. :- S = #sum { V,I : d(I,V) }, S \\ 3 != 0."
HIDDEN = "{ h(1..n) }. { p(1..m) }. q(I) :- p(I), h(J), J > I. r(I) :- q(I), not p(I+1). #show r/1."
MATCHING = "{ m(I,J) : J = I+1..2*n } :- I = 1..2*n. :- I = 1..2*n, { m(I,J); m(J,I) } != 1."
MINIMAL_COVER = "e(X,X\\n+1) :- X = 1..n. in(X) ; in(Y) :- e(X,Y)."
FLOW = "{ f(I,0..3) } = 1 :- I = 1..n. t(0,0). t(I,S+V) :- t(I-1,S), f(I,V), S+V <= s. :- not t(n,s)."
TOURNAMENT = "{ b(I,J) ; b(J,I) } = 1 :- I = 1..n, J = I+1..n. :- b(I,J), b(J,K), b(K,I)."
UNFOUNDED = "a(I) :- a(I\\n+1), I = 1..n. { b(1..m) }. :- not a(1)."
ROBOT = (
    "at(1,0). { go(D,T) : D = -1..1 } = 1 :- T = 1..n. at(X+D,T) :- at(X,T-1), go(D,T). :- at(X,T), X < 1. "
    ":- at(X,T), X > w. seen(X) :- at(X,T). :- X = 1..w, not seen(X)."
)
TRANSITIVE = "{ r(X,Y) } :- X = 1..n, Y = 1..n. :- r(X,Y), r(Y,Z), not r(X,Z). :- X = 1..n, not r(X,X)."
STABLE = (
    "a(I) :- not b(I), I = 1..n. b(I) :- not c(I), I = 1..n. c(I) :- not d(I), I = 1..n. d(I) :- not a(I), I = 1..n."
)
BALANCES = "{ in(1..n) }. :- #sum { I*(1-2*(I\\2)),I : in(I) } != 0."
TWO_BUDGETS = "{ in(1..n) }. :- #sum { I*I\\17+1,I : in(I) } > s. :- #sum { I*7\\19+1,I : in(I) } < s."
DICE = "{ d(I,1..6) } = 1 :- I = 1..n. :- #sum { V,I : d(I,V) } != s."
LARGE_WEIGHTS = (
    "{ in(1..n) }. :- #sum { 1000*I+I*I,I : in(I) } > 1000*s. :- #sum { 1000*I+I*I,I : in(I) } < 1000*s-1500."
)
TOTALS = "{ in(1..n) }. t(S) :- S = #sum { I : in(I) }. :- t(S), S \\ 7 != 0."
GRID_ROBOT = (
    "c(1..w,1..h). at((1,1),0). m(0,1). m(1,0). m(0,-1). m(-1,0). { go(X,Y,T) : m(X,Y) } = 1 :- T = 1..n. "
    "at((X+A,Y+B),T) :- at((X,Y),T-1), go(A,B,T). :- at((X,Y),T), not c(X,Y). seen(C) :- at(C,T). "
    ":- c(X,Y), not seen((X,Y))."
)
TWO_ROBOTS = (
    "at(1,1,0). at(2,w,0). { go(R,D,T) : D = -1..1 } = 1 :- R = 1..2, T = 1..n. "
    "at(R,X+D,T) :- at(R,X,T-1), go(R,D,T). "
    ":- at(R,X,T), X < 1. :- at(R,X,T), X > w. :- at(1,X,T), at(2,X,T). seen(X) :- at(1,X,T). :- X = 1..w, not seen(X)."
)
VACUUM = (
    "at(1,0). dirty(X,0) :- X = 1..w. { left(T); right(T); clean(T) } = 1 :- T = 1..n. "
    "at(X-1,T) :- at(X,T-1), left(T). "
    "at(X+1,T) :- at(X,T-1), right(T). at(X,T) :- at(X,T-1), clean(T). :- at(0,T). :- at(w+1,T). "
    "dirty(X,T) :- dirty(X,T-1), T = 1..n, not wiped(X,T). wiped(X,T) :- clean(T), at(X,T-1). :- dirty(X,n)."
)
SWITCHES = (
    "{ press(X,T) : X = 1..w } = 1 :- T = 1..n. used(X) :- press(X,T). :- X = 1..w, not used(X). "
    ":- press(X,T), press(X,T+1)."
)
NOTHING_LEFT = "{ a(1..n) }. :- { a(1..n) } n/2. :- { a(1..n) } > n/2."


def clauses(variables: int, number: int) -> str:
    """Return random clauses of three literals, by a generator of Lehmer (1951) so that they never change."""
    state, rules = 2 * variables + number, []
    for _ in range(number):
        literals = []
        for _ in range(3):
            state = 48271 * state % (2**31 - 1)
            literals.append(("" if state >> 8 & 1 else "not ") + f"x({state % variables + 1})")
        rules.append(f":- {', '.join(literals)}.")
    return f"{{ x(1..{variables}) }}. " + " ".join(rules)


def sized(name: str, text: str, *values: dict[str, int], project: bool = False) -> dict[str, Shape]:
    """Return a program with some values of its constants, by name."""
    return {f"{name} {' x '.join(map(str, each.values()))}": Shape(text, each, project) for each in values}


PROGRAMS: dict[str, Shape] = dict(
    chain.from_iterable(
        group.items()
        for group in (
            sized("pigeons", PIGEONS, {"n": 4}, {"n": 7}, {"n": 9}),
            sized("pigeons with room", HOLES, {"n": 5}, {"n": 8}),
            sized("parity", PARITY, {"n": 7}, {"n": 14}),
            sized("parity along a chain", CHAIN_PARITY, {"n": 7}, {"n": 16}, {"n": 200}),
            sized("queens", QUEENS, {"n": 6}, {"n": 8}, {"n": 10}, {"n": 11}),
            sized("latin squares", LATIN, {"n": 4}, {"n": 5}),
            sized("colourings of a circle", CIRCLE, {"n": 8, "k": 3}, {"n": 100, "k": 5}),
            sized("colourings of a grid", GRID_COLOURING, {"n": 3, "m": 3, "k": 3}, {"n": 4, "m": 6, "k": 4}),
            sized("colourings of all pairs", COMPLETE_COLOURING, {"n": 6, "k": 5}, {"n": 7, "k": 8}),
            sized("independent sets", INDEPENDENT, {"n": 4, "m": 4}, {"n": 6, "m": 6}, {"n": 6, "m": 60}),
            sized("maximal independent sets", MAXIMAL, {"n": 5, "m": 5}, {"n": 7, "m": 7}),
            sized("hamiltonian cycles", CYCLE, {"n": 6}, {"n": 9}),
            sized("hamiltonian cycles of a grid", GRID_CYCLE, {"n": 4, "m": 4}, {"n": 6, "m": 6}, {"n": 5, "m": 5}),
            sized("blocks", BLOCKS, {"b": 3, "n": 3}, {"b": 3, "n": 6}),
            sized("towers", TOWER, {"b": 4, "n": 4}, {"b": 4, "n": 6}, {"b": 5, "n": 3}),
            sized("walks", WALK, {"w": 4, "n": 12}, {"w": 9, "n": 60}),
            sized("subsets", SUBSETS, {"n": 12, "k": 6}, {"n": 40, "k": 20}),
            sized("sums", SUMS, {"n": 14, "s": 50}, {"n": 24, "s": 150}),
            sized("sums", SUMS, {"n": 30, "s": 200}),
            sized("balances", BALANCES, {"n": 22}),
            sized("two budgets", TWO_BUDGETS, {"n": 20, "s": 90}),
            sized("dice", DICE, {"n": 10, "s": 35}),
            sized("large weights", LARGE_WEIGHTS, {"n": 22, "s": 60}),
            sized("totals", TOTALS, {"n": 18}),
            sized("spanning trees", TREE, {"n": 3, "m": 3}, {"n": 4, "m": 4}),
            sized("connected subgraphs", CONNECTED, {"n": 3, "m": 3}, {"n": 3, "m": 6}),
            sized("reachable", REACH, {"n": 4}, {"n": 5}),
            sized("reached", REACHED, {"n": 5}, {"n": 9}, project=True),
            sized("covers by rows", COVER, {"n": 6, "m": 4}, project=True),
            sized("low queens", ROWS, {"n": 8}, {"n": 10}, project=True),
            sized("disjunctions", DISJUNCTION, {"n": 8}, {"n": 100}),
            sized("saturated disjunctions", SATURATED, {"n": 8}, {"n": 14}),
            sized("head cycles", HEAD_CYCLES, {"n": 6}),
            sized("free", FREE, {"n": 15}, {"n": 900}),
            sized("even loops", EVEN_LOOPS, {"n": 20}, {"n": 300}),
            sized("knapsacks", KNAPSACK, {"n": 16, "s": 60}, {"n": 22, "s": 80}),
            {"sudoku 9 x 9": Shape(SUDOKU + CLUES, {"n": 3})},
            sized("sudokus", SUDOKU, {"n": 2}),
            sized("dominoes", DOMINOES, {"n": 4, "m": 5}, {"n": 8, "m": 8}),
            {"magic squares": Shape(MAGIC)},
            sized("colourings of a ladder", LADDER, {"n": 150, "k": 4}),
            sized("sums modulo 3", TERNARY, {"n": 8}),
            sized("hidden", HIDDEN, {"n": 12, "m": 12}, project=True),
            sized("matchings", MATCHING, {"n": 4}, {"n": 8}),
            sized("minimal covers of a circle", MINIMAL_COVER, {"n": 60}),
            sized("flows", FLOW, {"n": 12, "s": 18}),
            sized("orders", TOURNAMENT, {"n": 7}, {"n": 9}),
            sized("unfounded", UNFOUNDED, {"n": 30, "m": 30}),
            sized("robots", ROBOT, {"w": 6, "n": 14}),
            sized("robots", ROBOT, {"w": 7, "n": 18}, {"w": 5, "n": 11}),
            sized("robots on a grid", GRID_ROBOT, {"w": 3, "h": 3, "n": 14}),
            sized("two robots", TWO_ROBOTS, {"w": 5, "n": 8}),
            sized("vacuum cleaners", VACUUM, {"w": 5, "n": 15}),
            sized("switches", SWITCHES, {"w": 5, "n": 10}),
            sized("preorders", TRANSITIVE, {"n": 4}, {"n": 5}),
            sized("cycles of negation", STABLE, {"n": 40}),
            sized("nothing left", NOTHING_LEFT, {"n": 24}),
            {"empty": Shape("")},
            {"random clauses 60 x 240": Shape(clauses(60, 240)), "random clauses 50 x 120": Shape(clauses(50, 120))},
        )
    )
)
