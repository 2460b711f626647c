"""Disjoint random parts of the tasks of one length: by rank, or by whole skeletons."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Protocol, TypeVar

from prag_asp.space.conditions.condition import Condition
from prag_asp.space.conditions.whole_skeletons import LONGEST, MOST_SKELETONS, SPELLABLE, Skeletons, divide_skeletons
from prag_asp.space.engines.engine import Level
from prag_asp.space.engines.prefix import Prefix
from prag_asp.space.parts.ranked_tasks import RankRange, ShuffledRanks
from prag_asp.space.parts.shares import divided, parse_shares
from prag_asp.space.parts.shuffle import Shuffle
from prag_asp.space.weights.weights import Number

Space = TypeVar("Space", bound="DivisibleSpace")


class DivisibleSpace(Protocol):
    """A task space of one length that conditions divide."""

    @property
    def length(self) -> int:
        """The number of actions of all tasks."""
        ...

    def part(self: Space, condition: str | Condition) -> Space:
        """Return the tasks that satisfy a condition."""
        ...

    def count(self, by: Level = "task", prefix: Prefix = ()) -> int:
        """Return the number of words that begin with `prefix`."""
        ...

    def enumerate(self, by: Level = "task", prefix: Prefix = ()) -> Iterator[tuple[str, ...]]:
        """Yield the words that begin with `prefix`."""
        ...

    def action_texts(self, by: Level = "task") -> tuple[str, ...]:
        """Return the texts of actions, or names for skeletons."""
        ...


def split_ranks(count: int, shares: Mapping[str, Number | float], seed: int) -> dict[str, ShuffledRanks]:
    """Return the ranks of disjoint random parts of `count` tasks, each share rounded by less than one task.

    Raises:
        QueryError: the shares do not add up to 1.
    """
    order = Shuffle(count, seed)
    parts = divided(order.size, parse_shares(shares))
    return {name: ShuffledRanks(order, RankRange(places)) for name, places in parts.items()}


def split_skeletons(space: Space, shares: Mapping[str, Number | float], seed: int) -> dict[str, Space]:
    """Return disjoint random parts of a space that share no skeleton.

    Raises:
        QueryError: the shares do not add up to 1.
    """
    spaces: dict[Condition, Space] = {}

    def count(condition: Condition) -> int:
        if condition not in spaces:
            spaces[condition] = space.part(condition)
        return spaces[condition].count()

    def tasks_by_skeleton() -> Skeletons | None:
        if space.length > LONGEST or space.count("skeleton") > MOST_SKELETONS:
            return None
        if not all(map(SPELLABLE.fullmatch, space.action_texts("skeleton"))):
            return None
        return {skeleton: space.count("task", skeleton) for skeleton in space.enumerate("skeleton")}

    parts = divide_skeletons(parse_shares(shares), seed, count, tasks_by_skeleton)
    return {name: spaces[condition] for name, condition in parts.items()}
