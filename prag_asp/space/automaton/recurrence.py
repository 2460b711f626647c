"""Exact counts of very long words, by the linear recurrence that the counts satisfy.

The numbers c(0), c(1), ... of words of an automaton with s states satisfy the recurrence of its characteristic
polynomial (Cayley and Hamilton), so their shortest recurrence has an order d of at most s. Its coefficients are
integers because the minimal polynomial divides every monic integer polynomial that annihilates the sequence (Gauss).
The recurrence is computed modulo a prime (Massey, Shift-register synthesis and BCH decoding, 1969) and then proved over
the integers: the residual of c under a recurrence satisfies the characteristic recurrence too, and is 0 everywhere if
its first s terms are 0. The n-th number then follows from x^n modulo the polynomial (Fiduccia, An efficient formula for
linear recurrences, 1985).
"""

from __future__ import annotations

from collections.abc import Sequence

from prag_asp.space.automaton.automaton import Completions, weights_by_length
from prag_asp.stop_reason import LimitCheck

SHORTEST = 2_000
"""Maximum length for which counting step by step is as fast."""

HIGHEST_ORDER = 64
"""Maximum order for which a recurrence is faster than counting step by step."""

MOST_WORK = 20_000_000
"""Maximum number of edge traversals allowed for proving a recurrence."""

PRIMES = (2**127 - 1, 2**1279 - 1)
"""Mersenne primes for computing the coefficients; if they are too small, the proof fails."""


def count_by_recurrence(completions: Completions, length: int, check: LimitCheck = lambda: None) -> int | None:
    """Return the weight of all words of a given length, or None if counting step by step may be faster.

    The result is also None if `check` reports a limit.
    """
    automaton = completions.automaton
    states = automaton.states
    terms_needed = states + HIGHEST_ORDER
    if not states or length < max(SHORTEST, 2 * terms_needed) or terms_needed * len(automaton.targets) > MOST_WORK:
        return None
    terms = weights_by_length(completions, 2 * HIGHEST_ORDER + 2)
    for prime in PRIMES:
        recurrence = shortest_recurrence(terms, prime)
        if recurrence is None:
            return None
        if len(terms) < terms_needed:
            terms = weights_by_length(completions, terms_needed)
        order = len(recurrence)
        if all(
            terms[place] == sum(coefficient * terms[place - back] for back, coefficient in enumerate(recurrence, 1))
            for place in range(order, order + states)
        ):
            return _nth(recurrence, terms, length, check)
    return None


def weight_of_length(completions: Completions, length: int) -> int:
    """Return the weight of all words of a given length, computed by a recurrence if the length is large."""
    if not completions.automaton.states:
        return 0
    weight = count_by_recurrence(completions, length)
    return int(completions.last_row(length)[0]) if weight is None else weight


def shortest_recurrence(terms: Sequence[int], prime: int) -> list[int] | None:
    """Return a[1], ..., a[d] with c(n) = a[1] c(n-1) + ... + a[d] c(n-d) modulo a prime, as the residues closest to 0.

    The result is None if there are too few terms to determine the recurrence.
    """
    current, previous = [1], [1]
    order, shift, last = 0, 1, 1
    for place in range(len(terms)):
        gap = sum(coefficient * terms[place - back] for back, coefficient in enumerate(current)) % prime
        if not gap:
            shift += 1
            continue
        factor = gap * pow(last, -1, prime) % prime
        longer = current + [0] * (len(previous) + shift - len(current))
        for back, coefficient in enumerate(previous):
            longer[back + shift] = (longer[back + shift] - factor * coefficient) % prime
        if 2 * order <= place:
            order, previous, last, shift = place + 1 - order, current, gap, 1
        else:
            shift += 1
        current = longer
    if 2 * order + 2 > len(terms):
        return None
    current = (current + [0] * order)[1 : order + 1]
    negated = (-coefficient % prime for coefficient in current)
    return [coefficient - prime if coefficient > prime // 2 else coefficient for coefficient in negated]


def _nth(recurrence: Sequence[int], terms: Sequence[int], place: int, check: LimitCheck) -> int | None:
    """Return the term with index `place`, or None at a limit, from x^place modulo the recurrence's polynomial."""
    order = len(recurrence)
    if not order:
        return 0
    power = [1] + [0] * (order - 1)
    for bit in bin(place)[2:]:
        if check():
            return None
        square = [0] * (2 * order - 1)
        for one, coefficient in enumerate(power):
            if coefficient:
                square[2 * one] += coefficient * coefficient
                for other in range(one):
                    square[one + other] += 2 * coefficient * power[other]
        power = _remainder(square, recurrence)
        if bit == "1":
            power = _remainder([0, *power], recurrence)
    return sum(coefficient * term for coefficient, term in zip(power, terms, strict=False))


def _remainder(polynomial: list[int], recurrence: Sequence[int]) -> list[int]:
    """Return the remainder of a polynomial modulo x^d - a[1] x^(d-1) - ... - a[d]."""
    order = len(recurrence)
    while len(polynomial) > order:
        highest = polynomial.pop()
        for back, coefficient in enumerate(recurrence, 1):
            if coefficient:
                polynomial[len(polynomial) - back] += coefficient * highest
    return polynomial
