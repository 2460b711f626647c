"""Sparse rewards for subgoals, and dense rewards from potential-based shaping.

The goal vector of a moment contains the index of the current subgoal and the signed distances of its facts in metres or
radians: one for each fact that the action achieves, and the largest distance of all other facts. A distance is at most
0 if the fact holds. A goal is also such a vector: the index of the last subgoal, and the distances that its facts must
reach. Thus any moment can be the goal of another moment.

The potential of a moment is the number of reached subgoals plus ``1 / (1 + D / REACH)``, where D is the sum of the
distances to the goal. The potential is never negative, and grows all the way to the goal, more steeply near it. The
dense reward of a step is `WORTH` times the difference of the potentials, minus `STEP_COST`, plus the sparse reward.
With the discount of the agent, as in Ng, Harada and Russell ("Policy invariance under reward transformations", 1999),
the potentials of an episode cancel except for the one at the end, which is the same for all episodes that reach the
goal. With one subgoal, the optimal policy is therefore the same as without potentials, if steps have a cost. With
several subgoals, the last one counts more than in the sparse reward. Because no potential is negative, the dense
rewards of a closed loop never add up to more than 0.
"""

from __future__ import annotations

from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

Reward = Literal["dense", "sparse", "faded"]
REWARDS: tuple[Reward, ...] = get_args(Reward)
"""The reward for a step: `sparse` is 1 for each reached subgoal, `dense` adds the difference of the potentials and the
cost of a step, and `faded` adds an annealed share of both."""

WORTH = 100.0
"""The total dense reward for approaching a subgoal, relative to the sparse reward for reaching it.

Agents that are also rewarded for entropy, such as soft actor-critic, initially get about 3.5 per step for it (5 action
components between -1 and 1, with the usual initial coefficient of 1). With a total of 10, they would lose more entropy
reward by ending an episode than they would earn.
"""

REACH = 0.1
"""The distance from a subgoal at which its potential is half the maximum, in metres or radians."""

STEP_COST = 4.0
"""The cost of a step when the dense reward has weight 1; it is `WORTH` / 25.

On the way to a goal, steps of a few centimetres earn about as much as they cost, so the values of most states are near
0. Without this cost, hovering would cost an agent hardly anything, and it would overestimate the value of hovering more
and more.
"""

Floats = NDArray[np.floating]
Flags = NDArray[np.bool_]


def goal_distance(achieved: Floats, desired: Floats) -> Floats:
    """Return distances from goals, summed over facts in metres or radians; the last axis is the goal vector."""
    distance: Floats = np.add.reduce(np.maximum(0.0, achieved[..., 1:] - desired[..., 1:]), axis=-1)
    return distance


def reached(achieved: Floats, desired: Floats) -> Flags:
    """Return whether moments are at their goals or in a later subgoal; the last axis is the goal vector."""
    at, goal = achieved[..., 0], desired[..., 0]
    near = np.logical_and.reduce(achieved[..., 1:] <= desired[..., 1:], axis=-1)
    is_reached: Flags = (at > goal) | ((at == goal) & near)
    return is_reached


def potential(achieved: Floats, desired: Floats) -> Floats:
    """Return the potentials of moments, at least 0: the number of reached subgoals plus a term for the distance."""
    result: Floats = achieved[..., 0] + 1.0 / (1.0 + goal_distance(achieved, desired) / REACH)
    return result


def step_rewards(
    before: Floats, after: Floats, desired: Floats, *, discount: float, share: float
) -> tuple[Floats, Flags]:
    """Return the rewards for steps, and whether they reach their goals; the last axis is the goal vector.

    `share` is the weight of the dense reward: 0 is sparse, and 1 is dense. The sparse reward is 1 for each reached
    subgoal.
    """
    done, both = reached(after, desired), np.array([before, after])
    stages = np.minimum(both[..., 0], desired[..., 0])
    sparse = stages[1] - stages[0] + done
    if share == 0.0:
        return sparse, done
    potentials = potential(both, desired)
    nearer = discount * potentials[1] - potentials[0]
    return sparse + share * (WORTH * nearer - STEP_COST), done
