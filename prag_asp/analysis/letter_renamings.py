"""The renamings of interchangeable entities, as permutations of the letters of an automaton."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise

import clingo
import numpy as np
from numpy.typing import NDArray

from prag_asp.errors import QueryError
from prag_asp.logic.symmetry.renaming import renamed
from prag_asp.logic.symmetry.symmetries import Symmetries
from prag_asp.program.entity_names import mentioned_entities
from prag_asp.similarity.interchange import Interchange
from prag_asp.space.engines import Level
from prag_asp.space.task_space import TaskSpace

MOST = 1 << 13
"""Maximum number of renamings that are listed; eight interchangeable entities have 40,320."""


def letter_renamings(space: TaskSpace, by: Level, letters: tuple[str, ...]) -> NDArray[np.int64]:
    """Return the distinct renamings, shape (renamings, letters), as the index of each letter's image, or -1.

    The first one is the identity, and the only one for plans and skeletons, which are not considered up to renaming.

    Raises:
        QueryError: there are more than `MOST` renamings.
    """
    identity = np.arange(len(letters))
    if by != "task" or not space.symmetries:
        return identity[None, :]
    numbers = {letter: number for number, letter in enumerate(letters)}
    symbols = [space.engines.actions[letter] for letter in letters]
    generators = []
    for names in swaps(space.symmetries):
        images = (str(renamed(symbol, names)) for symbol in symbols)
        generators.append(np.array([numbers.get(image, -1) for image in images] + [-1]))  # -1 remains -1
    found = {np.append(identity, -1).tobytes(): np.append(identity, -1)}
    waiting = list(found.values())
    while waiting:
        one = waiting.pop()
        for generator in generators:
            other = generator[one]
            if found.setdefault(other.tobytes(), other) is other:
                waiting.append(other)
        if len(found) > MOST:
            raise QueryError(
                f"{space.title}: its tasks have {space.symmetries.order:,} renamings, more than {MOST:,}; "
                "compare plans or skeletons"
            )
    return np.array([each[:-1] for each in found.values()])


def plan_images(space: TaskSpace, plan: Sequence[clingo.Symbol]) -> list[tuple[clingo.Symbol, ...]]:
    """Return the distinct images of a plan under the renamings of a space; the plan itself comes first.

    Raises:
        QueryError: there are more than `MOST` images.
    """
    symmetries = space.symmetries
    moving = Interchange(symmetries.groups, symmetries.joint)
    mentioned = [entity for action in plan for entity in mentioned_entities(action, moving.entities)]
    images: dict[tuple[clingo.Symbol, ...], None] = {}
    for names in moving.renamings(mentioned, fixed=moving.entities):
        images[tuple(renamed(action, names) for action in plan)] = None
        if len(images) > MOST:
            raise QueryError(f"the plan has more than {MOST:,} renamings in {space.title}; it names too many entities")
    return list(images)


def swaps(symmetries: Symmetries) -> Iterator[Mapping[clingo.Symbol, clingo.Symbol]]:
    """Yield renamings that generate all others: swaps of neighbours in each group and joint group."""
    groups = tuple(tuple((entity,) for entity in group) for group in symmetries.groups)
    for units in (*symmetries.joint, *groups):
        for one, other in pairwise(units):
            yield dict(zip(one + other, other + one, strict=True))
