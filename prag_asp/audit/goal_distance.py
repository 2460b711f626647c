"""The distance between two goals: the number of facts that are in only one of them, under the best renaming."""

from __future__ import annotations

from collections import Counter
from collections.abc import Hashable, Mapping, Sequence

from prag_asp.audit.canonical_facts import Relation
from prag_asp.errors import QueryError

Kinds = Mapping[str, str]

MOST_STEPS = 1_000_000
"""The maximum number of steps in the search for the best renaming; a million steps take half a minute."""


def goal_distance(first: Sequence[Relation], second: Sequence[Relation], kinds: tuple[Kinds, Kinds]) -> int:
    """Return the size of the symmetric difference of two sets of facts, minimised over renamings within classes.

    A renaming maps objects of the first goal one-to-one to objects of the same class in the second goal. `kinds` are
    the classes of the objects of each goal.

    Raises:
        QueryError: the facts of the goals are too alike to be compared in `MOST_STEPS` steps.
    """
    ordered = sorted(set(first), key=repr)
    others = sorted(set(second), key=repr)
    return len(ordered) + len(others) - 2 * _most_common(ordered, others, kinds)


def _most_common(first: Sequence[Relation], second: Sequence[Relation], kinds: tuple[Kinds, Kinds]) -> int:
    """Return the largest number of facts that a renaming maps to facts of the other goal, by branch and bound."""
    ours = [_description(fact, kinds[0]) for fact in first]
    theirs = {fact: _description(fact, kinds[1]) for fact in second}
    left = [Counter(ours[place:]) for place in range(len(first) + 1)]
    bound = sum((left[0] & Counter(theirs.values())).values())
    best = steps = 0

    def search(place: int, common: int, free: tuple[Relation, ...], forth: dict[Hashable, Hashable]) -> None:
        nonlocal best, steps
        best, steps = max(best, common), steps + 1
        if steps > MOST_STEPS:
            raise QueryError(
                f"the goals of {len(first)} and {len(second)} facts have too many renamings to find the best one"
            )
        rest = Counter(theirs[fact] for fact in free)
        if place == len(first) or best == bound or common + sum((left[place] & rest).values()) <= best:
            return
        for fact in free:
            if theirs[fact] == ours[place]:
                extended = _extended(forth, first[place][1], fact[1])
                if extended is not None:
                    search(place + 1, common + 1, tuple(each for each in free if each != fact), extended)
        search(place + 1, common, free, forth)

    search(0, 0, tuple(second), {})
    return best


def _description(fact: Relation, kinds: Kinds) -> tuple[object, ...]:
    label, objects = fact
    return (label, *(kinds.get(str(each), str(each)) for each in objects))


def _extended(
    forth: dict[Hashable, Hashable], objects: Sequence[Hashable], others: Sequence[Hashable]
) -> dict[Hashable, Hashable] | None:
    """Return a renaming with more pairs, or None if it would no longer be one to one."""
    result = dict(forth)
    for one, other in zip(objects, others, strict=True):
        if result.setdefault(one, other) != other:
            return None
    return result if len(set(result.values())) == len(result) else None
