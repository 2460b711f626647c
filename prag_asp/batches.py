"""Batches that double in size: the first item is available at once, and later items share the cost of a batch."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from itertools import islice
from typing import TypeVar

Item = TypeVar("Item")


def growing_ranges(most: int) -> Iterator[tuple[int, int]]:
    """Yield the start and the size of each of endlessly many consecutive batches; sizes double from 1 up to `most`."""
    first, size = 0, 1
    while True:
        yield first, size
        first, size = first + size, min(2 * size, most)


def growing_batches(
    items: Iterable[Item], most: int | Callable[[Item], int], *, first: int = 1
) -> Iterator[list[Item]]:
    """Yield items in batches; the first batch has `first` items, and sizes double up to `most`.

    `most` may depend on the first item of the previous batch.
    """
    iterator, size = iter(items), first
    while batch := list(islice(iterator, size)):
        yield batch
        size = min(2 * size, most if isinstance(most, int) else most(batch[0]))
