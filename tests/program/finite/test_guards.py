"""Numbers out of range are reported with file and line, whatever makes them, and nothing else changes."""

from __future__ import annotations

import re

import pytest

from prag_asp.errors import DomainError
from tests.program.finite.grounded import ground, ground_by_clingo_alone

MOST = 2**31 - 1
LARGE = f"q({MOST}). q(3). "
SMALL = f"q(-{MOST}). q(3). "
KEEP = rf"; keep it from -{MOST} to {MOST}$"

OUT_OF_RANGE = [
    # operators
    (LARGE + "p(X+1) :- q(X).", r"X\+1"),
    (SMALL + "p(X-1) :- q(X).", "X-1"),
    (LARGE + "p(X*2) :- q(X).", r"X\*2"),
    (LARGE + "p(X*X) :- q(X).", r"X\*X"),
    (LARGE + "p(X**2) :- q(X).", r"X\*\*2"),
    ("q(7;31). p(2**X) :- q(X).", r"2\*\*X"),
    (LARGE + "p(2**X) :- q(X).", r"2\*\*X"),
    (LARGE + "p(~X) :- q(X).", "~X"),
    (SMALL + "p(X&(-2)) :- q(X).", "X&-2"),
    (SMALL + "p((X-1)^0) :- q(X).", r"\(X-1\)\^0"),
    (SMALL + "p((X-1)?0) :- q(X).", r"\(X-1\)\?0"),
    (SMALL + "p((X-1)/ -1) :- q(X).", r"\(X-1\)/-1"),
    (SMALL + "p((X-1)\\ -1) :- q(X).", r"\(X-1\)\\-1"),
    (LARGE + "p(-(X+1)) :- q(X).", r"X\+1"),
    (SMALL + "p(|X-1|) :- q(X).", "X-1"),
    # on the way
    (LARGE + "p(X+1-1) :- q(X).", r"\(X\+1\)-1"),
    (LARGE + "p(X*2/2) :- q(X).", r"\(X\*2\)/2"),
    ("p(2**31-1).", r"\(2\*\*31\)-1"),
    (LARGE + "p((1;2)+X) :- q(X).", r"\(1;2\)\+X"),
    (LARGE + "p((1..2)+X) :- q(X).", r"\(1\.\.2\)\+X"),
    # places
    ("p(2147483647+1).", r"2147483647\+1"),
    (f"#const n = {MOST}. p(n+1).", r"n\+1"),
    ("#const n = 2**31. p(n).", r"2\*\*31"),
    ("#const n = f(1,2**31). p(n).", r"2\*\*31"),
    ("#const n = m*m. #const m = k-1. #const k = 50000. p(n).", r"m\*m"),
    (LARGE + "p(f(a,(X+1,b))) :- q(X).", r"X\+1"),
    (LARGE + "p(Y) :- q(X), Y = X+1.", r"X\+1"),
    (LARGE + "p(Y) :- q(X), X+1 = Y.", r"X\+1"),
    (LARGE + "p :- q(X), X+1 < 0.", r"X\+1"),
    (LARGE + "p :- q(X), 0 < X < X+1.", r"X\+1"),
    (LARGE + "p :- q(X), not X+1 < 0.", r"X\+1"),
    (LARGE + "p :- q(X), not r(X+1). {r(3)}.", r"X\+1"),
    (LARGE + ":- q(X), X+1 < 0.", r"X\+1"),
    (LARGE + "{p(X+1)} :- q(X).", r"X\+1"),
    (LARGE + "{p(X+1) : q(X)}.", r"X\+1"),
    (LARGE + "p(X+1) : q(X).", r"X\+1"),
    (LARGE + "p(X) ; r(X+1) :- q(X).", r"X\+1"),
    (LARGE + "{p(X) : q(X), X+1 > 2}.", r"X\+1"),
    (LARGE + "p :- q(X), r(Y+1) : q(Y). r(4).", r"Y\+1"),
    (LARGE + "p(N) :- N = #max {X+1 : q(X)}.", r"X\+1"),
    (LARGE + "p(N) :- N = #count {X : q(X), X+1 > 0}.", r"X\+1"),
    (LARGE + "p :- q(X), X+1 < #count {Y : q(Y)}.", r"X\+1"),
    (LARGE + "#sum {X,p : p(X) : q(X)} X+1 :- q(X).", r"X\+1"),
    (SMALL + "p(X) :- q(X+2).", r"X\+2"),
    (SMALL + "p(X) :- q(Y), Y = X+2.", r"X\+2"),
    (SMALL + "p(1..X) :- q(Y), X = Y-1.", "Y-1"),
    (LARGE + "#program step(t). p(X+t,t) :- q(X).", r"X\+t"),
    (LARGE + "#program step(k). p(X+k,k) :- q(X).", r"X\+k"),
    # sums
    (LARGE + "p(N) :- N = #sum {X : q(X)}.", "the sum of X"),
    (LARGE + "p(N) :- N = #sum+ {X : q(X)}.", r"the sum of X"),
    (LARGE + "p :- #sum {X : q(X)} > 3.", "the sum of X"),
    (LARGE + "{r}. p :- #sum {X,r : q(X), r} > 3.", "the sum of X"),
    (LARGE + "1 #sum {X,a : p(X) : q(X)}.", "the sum of X"),
    (LARGE + "p(N) :- N = #sum {X+1 : q(X)}.", r"(X\+1|the sum of \(X\+1\))"),
]


@pytest.mark.parametrize(("text", "said"), OUT_OF_RANGE, ids=[text for text, _ in OUT_OF_RANGE])
def test_an_operation_out_of_range_is_reported_where_it_stands(text: str, said: str) -> None:
    with pytest.raises(DomainError, match=rf"^domain\.lp:3: {said} is out of range{KEEP}"):
        ground(f"% one\n% two\n{text}\n")


def test_the_line_is_that_of_the_operation_where_a_rule_has_several() -> None:
    with pytest.raises(DomainError, match=r"^domain\.lp:3: X\+1 is out of range"):
        ground(LARGE + "\np(Y) :- q(X),\n  X+1 = Y.")
    with pytest.raises(DomainError, match=r"^domain\.lp:4: operation undefined: \(4/X\); guard the operation$"):
        ground("q(0..1). é_free :- q(1).\n".replace("é_", "") + "p(4-X,Y)\n:- q(X),\n Y = 4/X.")


@pytest.mark.parametrize(
    ("rule", "message"),
    [
        ("p(1..X) :- q(X).", r"1\.\.X from 1 to a; guard"),
        ("p(X..3) :- q(X).", r"X\.\.3 from a to 3; guard"),
        ("p(Y) :- r(X), Y = inf..X-1.", r"inf\.\.\(X-1\) from inf to 6; give inf a value by -c or #const, or guard"),
        ("p(1..n).", r"1\.\.n from 1 to n; give n a value by -c or #const, or guard"),
    ],
)
def test_an_interval_with_an_end_that_is_no_number_is_reported_where_it_stands(rule: str, message: str) -> None:
    with pytest.raises(DomainError, match=rf"^domain\.lp:2: interval undefined: {message} the operation$"):
        ground(f"q(a). r(7).\n{rule}")


@pytest.mark.parametrize("operation", ["X+0", "X-0", "1*X", "X*1"])
def test_an_operation_on_a_name_is_reported_as_it_is_written_also_where_it_would_change_no_number(
    operation: str,
) -> None:
    message = f"domain.lp:2: operation undefined: {operation}; guard the operation"
    with pytest.raises(DomainError, match=f"^{re.escape(message)}$"):
        ground(f"q(a).\np(Y) :- q(X), q(Y), Y < {operation}.")


IN_RANGE = [
    LARGE + "p(X+1) :- q(X), X < 9.",
    LARGE + "p(X-1,X/2,X\\7,-X,|X|,X&1,X?1,X^1) :- q(X).",
    SMALL + "p(X / -1, X \\ -1, -X, |X|, X+1, ~X) :- q(X).",
    SMALL + "r(X+1) :- q(X). p(X) :- r(X+1), q(X).",
    LARGE + "r(1). p :- q(X), r(X+1).",
    "q(1..2). r(1..3). p(X) :- q(X), r(X+1).",
    "q(1..4). p(X,Y) :- q(X), q(Y), |X-Y| = 1. s(X+Y,X*Y) :- p(X,Y),\n  X < Y ; not q(X\n+Y).",
    "q(1..4). p(X) :- q(X+1). r(X) :- q(Y), X+1 = Y. s(X) :- q(2*X+1). u(X) :- q(3-X).",
    "q(1..4). p(Z) :- q(X), Z = X-1..X+1. r(1..X+1) :- q(X). s((1;2)+X,(1..X)*2) :- q(X).",
    "q(1..4). p(N) :- N = #sum {X*2,X : q(X)}. r(X) :- q(X), 3 <= #sum+ {Y-X,Y : q(Y), Y > X} <= 5.",
    "q(1..4). 1 {p(X+1) : q(X), X+1 < 4; r(X-1) : q(X)} 2. s(X) :- q(X), p(X+1), not r(X-1).",
    "q(1..4). p(X) :- q(X), q(Y+1) : q(Y), Y+1 < X+2; q(X). r :- not q(X-1) : q(X).",
    "q(1..4). 2 < #sum {X+1,X : p(X+1) : q(X)} < 9. r(X) ; s(X+1) : q(X) :- q(X+1), q(1).",
    '#const n = 3. q(1..n). p(n-1..n+1). s("1+2 % no", "a\\"b") :- q(1). % X+1\n%* q(X+1)\n *% r(2*n).',
    "q(0..3). p(2**X, X**2, X**0, (-2)**X, 2**(X-1)) :- q(X).",
    "q(1..2). #program step(t). p(t-1,t). r(X+t,t) :- q(X), p(t-1,t). #program step(k). s(k*2-1,k) :- p(k-1,k).",
    "q((1,2);(3,4)). p(X+Y) :- q((X,Y)). -s(X-1) :- q((X,_)). u :- -s(X-1), q((X,_)).",
    "n(0). n(X+1) :- n(X), X < 30. m(Y) :- n(X), Y = X\\7+(X/7)*10.",
]


@pytest.mark.parametrize("text", IN_RANGE)
def test_a_program_in_range_has_the_atoms_that_clingo_itself_makes(text: str) -> None:
    found = ground(text)
    assert found == ground_by_clingo_alone(text)
    assert found


LITERALS = ["99999999999", "-99999999999", "2147483648", "0xFFFFFFFF", "0b11111111111111111111111111111111", "1" * 5000]


@pytest.mark.parametrize("number", LITERALS)
def test_a_number_out_of_range_is_reported_as_its_author_wrote_it(number: str) -> None:
    shown = number.lstrip("-") if len(number) < 25 else r"\w{20}\.\.\. \(\d+ digits\)"
    with pytest.raises(DomainError, match=rf"^domain\.lp:2: the number {shown} is out of range: write numbers from -2"):
        ground(f"a.\nq({number}).")


def test_digits_in_names_texts_and_comments_are_no_numbers() -> None:
    text = (
        'q(a99999999999,_x99999999999,"99999999999 \\" 99999999999"). % 99999999999\n%* 99999999999 *% p(2147483647).'
    )
    assert ground(text) == ground_by_clingo_alone(text)


@pytest.mark.parametrize(
    "text",
    [
        "p(1..1000000000).",
        "q(1000000000). p(1..X) :- q(X).",
        "#const n = 1000000000. p(1..n).",
        "p(2*(1..1000000000)).",
    ],
)
def test_an_interval_of_too_many_numbers_is_reported_before_it_is_made(text: str) -> None:
    with pytest.raises(
        DomainError, match=r"^domain\.lp:2: 1\.\.\w+ has 1,000,000,000 numbers, more than 1,000,000; make"
    ):
        ground(f"\n{text}")


def test_intervals_of_too_many_combinations_are_reported_before_they_are_made() -> None:
    with pytest.raises(DomainError, match=r"^domain\.lp:2: .* 1,000,000,000,000 combinations, more than 100,000,000"):
        ground("\nn(X,Y) :- X = 1..1000000, Y = 1..1000000.")
    ground("n((1..9999;1..9999;1..9999)). m :- #count { X : X = 1..9999 } > 1, #count { X : X = 1..99999 } > 1.")
