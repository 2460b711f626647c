"""Rewards by potentials over how far what shall be is from being so.

What a goal says of a moment is a vector: the number of the subgoal that is being pursued, and signed distances of its
facts in metres or radians, at most 0 where they hold: one for each that the action brings about, and the worst of all
others. A goal is such a vector, too: the last subgoal, and how near the facts have to come. So any moment can serve as
the goal of another one.

The potential of a moment is the number of subgoals that are reached plus ``1 / (1 + D / REACH)``, with D the sum of
what these distances miss. It is never negative, grows all the way to the goal, and the steeper the nearer that is.
The dense reward of a step is `WORTH` times what the potential has grown by, beside the sparse one. With the discount of
the agent, as in Ng, Harada and Russell ("Policy invariance under reward transformations", 1999), all that is left of
an episode's potentials is that of its end, which is the same for all that reach the goal: where one subgoal is pursued,
the best policy stays the best. Where several are, the last counts for more than it does in the sparse reward. With the
discount 1 all this is so for agents that do not discount; others learn with it in fewer steps, for coming nearer is not
paid back by staying there, but are no longer promised what is best. Since no potential is negative, the rewards of a
closed loop never add up to more than 0.
"""

from __future__ import annotations

from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

Reward = Literal["dense", "sparse", "faded"]
REWARDS: tuple[Reward, ...] = get_args(Reward)
"""What a step earns: `sparse` 1 for each subgoal that is reached, `dense` also what the potential has grown by, `faded`
a share of that."""

WORTH = 10.0
"""How many times as much as a subgoal in the sparse reward the way to it is worth in the dense one."""

REACH = 0.1
"""How far from a subgoal in metres or radians half of its potential is left."""

Floats = NDArray[np.floating]
Flags = NDArray[np.bool_]


def missed(achieved: Floats, desired: Floats) -> Floats:
    """Return what the facts of moments are missed by in all, in metres and radians; vectors are the last axis."""
    found: Floats = np.add.reduce(np.maximum(0.0, achieved[..., 1:] - desired[..., 1:]), axis=-1)
    return found


def reached(achieved: Floats, desired: Floats) -> Flags:
    """Return whether moments are at their goals, or beyond: pursuing a later subgoal; vectors are the last axis."""
    at, goal = achieved[..., 0], desired[..., 0]
    near = np.logical_and.reduce(achieved[..., 1:] <= desired[..., 1:], axis=-1)
    found: Flags = (at > goal) | ((at == goal) & near)
    return found


def potential(achieved: Floats, desired: Floats) -> Floats:
    """Return the potentials of moments, at least 0: the subgoals reached, and how near the next one is."""
    found: Floats = achieved[..., 0] + 1.0 / (1.0 + missed(achieved, desired) / REACH)
    return found


def earned(before: Floats, after: Floats, desired: Floats, *, discount: float, share: float) -> tuple[Floats, Flags]:
    """Return what steps earn, and whether they end at their goals; vectors are the last axis.

    `share` is how much of the dense reward counts: 0 is sparse, 1 dense. A step earns 1 for each subgoal reached.
    """
    done = reached(after, desired)
    sparse = np.minimum(after[..., 0], desired[..., 0]) - np.minimum(before[..., 0], desired[..., 0]) + done
    if share == 0.0:
        return sparse, done
    return sparse + share * WORTH * (discount * potential(after, desired) - potential(before, desired)), done
