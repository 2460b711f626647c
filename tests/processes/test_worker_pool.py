"""The pool yields results in order, whatever happens to its workers, and ends them with its iterator."""

from __future__ import annotations

import os
from collections.abc import Callable
from functools import partial
from itertools import count, islice
from pathlib import Path

import pytest

from prag_asp.errors import WorkerError
from prag_asp.processes import worker_pool
from prag_asp.processes.worker_pool import map_ordered
from tests.processes.pool_functions import Wish, opened, unopened


def results(wishes: list[Wish], folder: Path, workers: int = 3, chunk: int = 2) -> list[object]:
    """Return the results of wishes, numbered from 0."""
    opener = partial(opened, str(folder))
    return list(map_ordered(enumerate(wishes), opener, workers, activity="testing", chunk=chunk))


@pytest.mark.parametrize("workers", [1, 2, 3])
def test_results_come_in_the_order_of_the_items(workers: int, tmp_path: Path, started: Callable[[], list[int]]) -> None:
    wishes: list[Wish] = [("sleep", 0.2 if i % 5 == 0 else 0.0) for i in range(23)]
    assert results(wishes, tmp_path, workers) == list(range(23))
    assert not started()


def test_one_worker_is_this_process(tmp_path: Path) -> None:
    assert results([("pid", None)], tmp_path, 1) == [os.getpid()]
    assert os.getpid() not in results([("pid", None)] * 6, tmp_path, 2)


def test_items_of_workers_that_died_are_done_by_new_ones(tmp_path: Path, started: Callable[[], list[int]]) -> None:
    wishes: list[Wish] = [("die once" if i in (0, 5, 6) else "echo", None) for i in range(12)]
    assert results(wishes, tmp_path) == list(range(12))
    assert not started()


def test_an_item_of_which_every_worker_dies_is_an_error(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, started: Callable[[], list[int]]
) -> None:
    monkeypatch.setattr(worker_pool, "REPLACEMENTS", 2)
    with pytest.raises(WorkerError, match="workers died 3 times in a row around task 4, the last by SIGKILL"):
        results([("echo", None)] * 4 + [("die", None)], tmp_path)
    assert not started()


@pytest.mark.parametrize("workers", [1, 3])
def test_an_error_comes_after_the_results_before_it(workers: int, tmp_path: Path) -> None:
    wishes: list[Wish] = [("sleep", 0.3), *[("echo", None)] * 3, ("raise", None), ("echo", None)]
    values = map_ordered(enumerate(wishes), partial(opened, str(tmp_path)), workers, activity="testing", chunk=1)
    assert list(islice(values, 4)) == [0, 1, 2, 3]
    with pytest.raises(ValueError, match="item 4"):
        next(values)


@pytest.mark.parametrize("workers", [1, 2])
def test_an_error_of_the_opener_is_raised(workers: int) -> None:
    with pytest.raises(OSError, match="it cannot be opened"):
        list(map_ordered(enumerate([("echo", None)] * 5), unopened, workers, activity="testing"))


def test_endless_items_are_read_a_little_ahead_and_closing_ends_the_workers(
    tmp_path: Path, started: Callable[[], list[int]]
) -> None:
    read = count()
    endless = ((next(read), ("echo", None)) for _ in count())
    values = map_ordered(endless, partial(opened, str(tmp_path)), 2, activity="testing", chunk=2)
    assert list(islice(values, 5)) == [0, 1, 2, 3, 4]
    values.close()
    assert next(read) <= 5 + 2 * 2 * (worker_pool.CHUNKS_AHEAD + 1)
    assert not started()
