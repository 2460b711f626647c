"""Draws that are dealt to several, like cards: each of N workers gets every N-th."""

from __future__ import annotations

import re
from dataclasses import dataclass

from prag_asp.errors import QueryError

MOST = 1_000_000
"""So many can be dealt to."""


@dataclass(frozen=True)
class Deal:
    """What is dealt to the one of a `number` from 1, `of` so many; its own draws are numbered from 0 again.

    Raises:
        QueryError: there is no such number.
    """

    number: int = 1
    of: int = 1

    def __post_init__(self) -> None:
        if not 1 <= self.number <= self.of <= MOST:
            raise QueryError(f"part {self}: write K/N, with K from 1 to N, and N at most {MOST}, such as 3/64")

    @classmethod
    def parse(cls, text: str) -> Deal:
        """Return the deal that ``3/64`` names.

        Raises:
            QueryError: it is written in another way.
        """
        found = re.fullmatch(r"\s*([0-9]{1,9})\s*/\s*([0-9]{1,9})\s*", text, re.ASCII)
        if found is None:
            raise QueryError(f"part {text}: write K/N, such as 3/64")
        return cls(int(found[1]), int(found[2]))

    @classmethod
    def holding(cls, whole: int, of: int) -> Deal:
        """Return which of `of` deals has one of all draws."""
        return cls(whole % of + 1, of)

    def __str__(self) -> str:
        return f"{self.number}/{self.of}"

    def whole(self, own: int) -> int:
        """Return the number among all draws of one of its own."""
        return own * self.of + self.number - 1

    def own(self, whole: int) -> int | None:
        """Return the number among its own draws of one of all, None where it is dealt to another."""
        found, other = divmod(whole - self.number + 1, self.of)
        return None if other else found

    def share(self, size: int) -> int:
        """Return how many of so many draws are dealt to it."""
        return max(-(-(size - self.number + 1) // self.of), 0)


ALL = Deal()
"""All draws, dealt to one."""
