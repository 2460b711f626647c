"""Shards of draws: each of N workers takes every N-th draw."""

from __future__ import annotations

import re
from dataclasses import dataclass

from prag_asp.errors import QueryError

MOST = 1_000_000
"""Maximum number of shards."""


@dataclass(frozen=True)
class Deal:
    """One of `of` shards; `number` counts from 1. Its draws are renumbered from 0.

    Raises:
        QueryError: there is no shard with that number.
    """

    number: int = 1
    of: int = 1

    def __post_init__(self) -> None:
        if not 1 <= self.number <= self.of <= MOST:
            raise QueryError(f"part {self}: write K/N, with K from 1 to N, and N at most {MOST}, such as 3/64")

    @classmethod
    def parse(cls, text: str) -> Deal:
        """Return the shard that a text such as ``3/64`` specifies.

        Raises:
            QueryError: the text does not have this form.
        """
        match = re.fullmatch(r"\s*([0-9]{1,9})\s*/\s*([0-9]{1,9})\s*", text, re.ASCII)
        if match is None:
            raise QueryError(f"part {text}: write K/N, such as 3/64")
        return cls(int(match[1]), int(match[2]))

    @classmethod
    def holding(cls, whole: int, of: int) -> Deal:
        """Return which of `of` shards holds a draw, given its overall number."""
        return cls(whole % of + 1, of)

    def __str__(self) -> str:
        return f"{self.number}/{self.of}"

    def whole(self, own: int) -> int:
        """Return the overall number of a draw, given its number in this shard."""
        return own * self.of + self.number - 1

    def own(self, whole: int) -> int | None:
        """Return the number of a draw in this shard, given its overall number, or None if another shard has it."""
        own, remainder = divmod(whole - self.number + 1, self.of)
        return None if remainder else own

    def share(self, size: int) -> int:
        """Return how many of the first `size` draws belong to this shard."""
        return max(-(-(size - self.number + 1) // self.of), 0)


ALL = Deal()
"""All draws in a single shard."""
