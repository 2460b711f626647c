"""Goals: what is known after the last action of a word."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from prag_asp.logic.step.hindsight import Hindsight


def numbered_goals(hindsight: Hindsight, marks: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Return a number for what is known after each edge, the same where the same is known, shape (edges,).

    `marks` has the truth of `hindsight.last_read` after each edge, shape (edges, atoms).
    """
    kinds, places = np.unique(marks, axis=0, return_inverse=True)
    _, goal_of = np.unique(hindsight.tell_ends(kinds.T), axis=1, return_inverse=True)
    found: NDArray[np.int64] = goal_of.reshape(-1)[places.reshape(-1)]
    return found
