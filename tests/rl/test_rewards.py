"""Rewards by potentials: they do not change what is best, and nothing is earned in a circle."""

from __future__ import annotations

from itertools import pairwise, product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from prag_asp.rl.goals import PLACES
from prag_asp.rl.rewards import goal_distance, potential, reached, step_rewards
from tests.chance import Chance, examples

DISCOUNT = 0.9
SIDE, GOAL = 5, (4, 4)
MOVES = ((0, 1), (0, -1), (1, 0), (-1, 0), (0, 0))
DESIRED = np.zeros(PLACES)


def vector(cell: tuple[int, int]) -> NDArray[np.floating]:
    """Return the moment of a cell of a grid, 10 cm wide: what x and y are missed by."""
    found = np.zeros(PLACES)
    found[1:3] = [0.1 * (goal - at) for goal, at in zip(GOAL, cell, strict=True)]
    return found


def best(share: float, discount: float = DISCOUNT) -> dict[tuple[int, int], set[tuple[int, int]]]:
    """Return the best moves of each cell by value iteration."""
    cells = [cell for cell in product(range(SIDE), repeat=2) if cell != GOAL]
    values = dict.fromkeys([*cells, GOAL], 0.0)

    def value(cell: tuple[int, int], move: tuple[int, int]) -> float:
        there = tuple(min(max(at + by, 0), SIDE - 1) for at, by in zip(cell, move, strict=True))
        assert len(there) == 2
        gain, _ = step_rewards(vector(cell), vector(there), DESIRED, discount=discount, share=share)
        return float(gain) + DISCOUNT * values[there]

    for _ in range(300):
        values.update({cell: max(value(cell, move) for move in MOVES) for cell in cells})
    found = {}
    for cell in cells:
        worth = {move: value(cell, move) for move in MOVES}
        found[cell] = {move for move, each in worth.items() if each > max(worth.values()) - 1e-9}
    return found


@pytest.mark.parametrize(("share", "discount"), [(0.3, DISCOUNT), (1.0, DISCOUNT), (1.0, 1.0)])
def test_shaping_leaves_the_best_moves_as_they_are(share: float, discount: float) -> None:
    sparse = best(0.0)
    assert best(share, discount) == sparse
    assert sparse[0, 0] == {(0, 1), (1, 0)} and sparse[4, 3] == {(0, 1)}


moments = st.lists(st.floats(-1.0, 3.0, width=32), min_size=PLACES - 1, max_size=PLACES - 1)


@settings(max_examples=examples(100))
@given(path=st.lists(moments, min_size=1, max_size=8), stage=st.integers(0, 4), discount=st.floats(0.5, 1.0))
def test_no_closed_loop_earns_anything(path: list[list[float]], stage: int, discount: float) -> None:
    desired = np.zeros(PLACES)
    desired[0] = stage + 1
    loop = [np.array([stage, *each]) for each in (*path, path[0])]
    total = sum(float(step_rewards(one, two, desired, discount=discount, share=1.0)[0]) for one, two in pairwise(loop))
    assert total <= 1e-9


def test_standing_still_costs_and_coming_nearer_earns_more_the_nearer() -> None:
    def gain(before: float, after: float) -> float:
        one, two = np.zeros(PLACES), np.zeros(PLACES)
        one[1], two[1] = before, after
        return float(step_rewards(one, two, DESIRED, discount=0.99, share=1.0)[0])

    assert gain(0.2, 0.2) < 0.0
    assert gain(0.5, 0.5) < gain(0.5, 0.4) < 0.0 < gain(0.3, 0.2) < gain(0.2, 0.1)
    assert gain(0.1, 0.2) < gain(0.2, 0.2)


def test_a_subgoal_that_is_reached_earns_1_and_so_does_the_goal() -> None:
    goal, one, two, end = np.zeros((4, PLACES))
    goal[0] = two[0] = end[0] = 1.0
    one[3], two[3] = 0.4, 0.7
    for before, after, ended in ((one, two, False), (two, end, True)):
        gain, done = step_rewards(before, after, goal, discount=0.9, share=0.0)
        assert float(gain) == 1.0 and bool(done) is ended


def test_the_potential_does_not_fall_where_the_next_subgoal_begins() -> None:
    near, reached_it = np.zeros(PLACES), np.zeros(PLACES)
    near[1], reached_it[0], reached_it[1] = 1e-6, 1.0, 5.0
    assert potential(reached_it, DESIRED) >= potential(near, DESIRED)


def test_batches_are_what_single_steps_are(chance: Chance) -> None:
    rng = chance.generator(3)
    rows = np.array([[rng.choice((0, 1, 2)), *(rng.uniform(-0.1, 0.3) for _ in range(PLACES - 1))] for _ in range(60)])
    rows = np.maximum(rows, np.where(np.arange(60)[:, None] % 3, -1.0, 0.0))
    before, after, desired = rows[:20], rows[20:40], rows[40:]
    gains, ends = step_rewards(before, after, desired, discount=0.9, share=0.5)
    assert gains.shape == ends.shape == (20,) and 0 < ends.sum() < 20
    for i in range(20):
        gain, ended = step_rewards(before[i], after[i], desired[i], discount=0.9, share=0.5)
        assert gain == gains[i] and ended == ends[i] == reached(after[i], desired[i])
        assert goal_distance(after[i], desired[i]) == goal_distance(after, desired)[i] >= 0.0
