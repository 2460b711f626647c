"""Numbers of any length as text and back: Python's own ways take long, or refuse, from some thousands of digits on."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from prag_asp.integers import PLAIN_DIGITS, digits_of, grouped, number_of

LONG = st.builds(lambda digits, shift: 10**digits + shift, st.integers(0, 9000), st.integers(-1, 10**6))


@given(LONG)
def test_a_number_comes_back_from_its_digits(number: int) -> None:
    digits = digits_of(number)
    assert number_of(digits) == number
    assert grouped(number).replace(",", "") == digits
    assert all(len(group) == 3 for group in grouped(number).split(",")[1:]) and grouped(number)[0] != ","


@pytest.mark.parametrize("text", ["", "-1e5", "x", "1" * PLAIN_DIGITS + "x", "²" * (PLAIN_DIGITS + 1)])
def test_what_are_no_digits_is_no_number(text: str) -> None:
    with pytest.raises(ValueError):
        number_of(text)
