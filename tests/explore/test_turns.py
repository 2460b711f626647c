"""A newer request of a window ends the work on its older ones, and no other."""

from __future__ import annotations

from dataclasses import replace
from threading import Event, Thread
from time import sleep

import pytest

from prag_asp import LimitReached, Limits, TaskSpace, load_domain
from prag_asp.explore.turns import CANCEL, POLL, Turns


def test_a_newer_request_ends_the_count_of_an_older_one() -> None:
    turns = Turns()
    limits = Limits(stop=turns.stop, cached=False)
    space = TaskSpace(replace(load_domain("blocks")), 4, limits=limits)  # which has no ground step yet
    with turns.turn("a", 2), turns_of_another_thread(turns, "a", 3):
        with pytest.raises(LimitReached) as error:
            space.count()
        assert error.value.reason == CANCEL
    with turns.turn("a", 3):
        assert space.count() == TaskSpace(load_domain("blocks"), 4).count()


def test_requests_of_other_windows_and_of_the_same_state_wait() -> None:
    turns = Turns()
    for window, number in (("b", 9), ("a", 1)):
        with turns.turn("a", 1), turns_of_another_thread(turns, window, number):
            assert turns.stop() is None


def test_a_request_ends_once_its_client_has_gone() -> None:
    turns, gone = Turns(), Event()
    with turns.turn("a", 1, gone=gone.is_set):
        assert turns.stop() is None
        gone.set()
        sleep(2 * POLL)
        assert turns.stop() == CANCEL
    assert turns.stop() is None
    with pytest.raises(LimitReached), turns.turn("b", 1, gone=lambda: True):
        pass
    with turns.turn("b", 1):
        assert turns.stop() is None


def test_an_old_request_does_not_begin() -> None:
    turns = Turns()
    with turns.turn("a", 5):
        pass
    with pytest.raises(LimitReached), turns.turn("a", 4):
        pass
    turns.close()
    with pytest.raises(LimitReached), turns.turn("a", 6):
        pass


class turns_of_another_thread:
    """Another thread that asks for a turn, and waits for it meanwhile."""

    def __init__(self, turns: Turns, window: str, number: int) -> None:
        self._asked = Event()

        def ask() -> None:
            self._asked.set()
            with turns.turn(window, number):
                pass

        self._thread = Thread(target=ask)

    def __enter__(self) -> None:
        self._thread.start()
        self._asked.wait()
        self._thread.join(0.1)

    def __exit__(self, *_: object) -> None:
        Thread(target=self._thread.join).start()
