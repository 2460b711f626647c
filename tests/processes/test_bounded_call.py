"""A call in a process of its own returns what it returns, and ends at its limits whatever it does."""

from __future__ import annotations

import time

import pytest

from prag_asp import LimitReached, QueryError, bounded
from prag_asp.stop_reason import StopKind, StopReason
from tests.processes.bounded_calls import crash, fill, grow, refuse, total


def test_what_a_function_returns_comes_back() -> None:
    assert bounded(total, [1, 2, 3], seconds=60) == 6


def test_what_a_function_raises_is_raised() -> None:
    with pytest.raises(QueryError, match="not so"):
        bounded(refuse)


@pytest.mark.parametrize(
    ("function", "limits", "told"),
    [
        (grow, {"seconds": 3}, r"the time limit of 3 s was reached"),
        (fill, {"memory_bytes": 10**8}, r"the memory limit of 100 MB was reached"),
        (crash, {}, r"the process ended by SIGSEGV"),
    ],
)
def test_a_limit_ends_it_whatever_it_does(function, limits, told, started) -> None:  # type: ignore[no-untyped-def]
    begun = time.monotonic()
    with pytest.raises(LimitReached, match=told):
        bounded(function, **limits)
    assert time.monotonic() - begun < 120
    assert not started()


def test_its_caller_ends_it(started) -> None:  # type: ignore[no-untyped-def]
    reason = StopReason(StopKind.CANCEL)
    with pytest.raises(LimitReached) as error:
        bounded(grow, seconds=60, stop=lambda: reason)
    assert error.value.reason == reason
    assert not started()


def test_a_function_that_no_other_process_finds_is_refused() -> None:
    with pytest.raises(QueryError, match="put the function into a module"):
        bounded(lambda: 1)
