"""The assignment of draws to machines, for a single run, for machine parts, and for their merge."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

from prag_asp.space.sampling.sharding import ALL, Deal


class Holder(NamedTuple):
    """The index of the machine part that has validated a draw, and the index of the draw in that part."""

    machine: int
    draw: int


@dataclass(frozen=True)
class DrawPlan:
    """The draws of one part of the split in a run, numbered from 0.

    With a `deal` such as ``3/64``, these are every 64th of all draws, from the third on. In a merge, the n-th machine
    part has validated the first ``validated[n]`` of its draws; the run validates the others.
    """

    deal: Deal = ALL
    validated: tuple[int, ...] = ()

    def search_index(self, draw: int) -> int:
        """Return the search index of a draw, which does not depend on the number of machines."""
        return self.deal.whole(draw)

    def holder(self, draw: int) -> Holder | None:
        """Return the machine part that has validated a draw, or None if this run validates it."""
        if not self.validated:
            return None
        deal = Deal.holding(draw, len(self.validated))
        own = deal.own(draw)
        assert own is not None
        return Holder(deal.number - 1, own) if own < self.validated[deal.number - 1] else None

    def missing(self, first: int, limit: int) -> Iterator[int]:
        """Yield the draws from `first` to `limit` - 1 that this run validates, lazily and in order."""
        return (draw for draw in range(first, limit) if self.holder(draw) is None)
