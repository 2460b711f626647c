from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from prag_asp.physics.motion.route import Grip, Load, free_path, straight, vertical
from prag_asp.physics.motion.trajectory import ACCELERATION, LOADED_ACCELERATION, ROUNDING, blended, timed
from prag_asp.physics.robot.kinematics import inverse, tool_pose
from prag_asp.physics.situation import Situation
from prag_asp.physics.world.simulator import Simulator, open_simulator
from prag_asp.scene.geometry import Pose
from prag_asp.scene.model import Scene, Shape
from prag_asp.scene.robots import PANDA, Joints

DOWN = (1.0, 0.0, 0.0, 0.0)
TIME_STEP = 1 / 120

angles = st.floats(-2.5, 2.5)
paths = st.lists(st.tuples(*[angles] * 7), min_size=2, max_size=5)


@given(path=paths)
def test_a_timed_path_ends_where_it_should_and_keeps_to_the_limits(path):
    rows = timed(path, TIME_STEP, ACCELERATION, PANDA.speed)
    assert rows[-1] == pytest.approx(path[-1], abs=1e-9)
    whole = np.concatenate([np.array(path[:1]), rows])
    speeds = np.diff(whole, axis=0) / TIME_STEP
    assert np.abs(speeds).max() <= PANDA.speed * 1.001
    if len(path) == 2:
        accelerations = np.diff(speeds, axis=0, prepend=np.zeros((1, 7)), append=np.zeros((1, 7))) / TIME_STEP
        assert np.abs(accelerations).max() <= ACCELERATION * 1.05


@given(path=paths)
def test_a_timed_path_stays_within_the_box_of_its_points(path):
    rows = timed(path, TIME_STEP, ACCELERATION, PANDA.speed)
    points = np.array(path)
    assert (rows >= points.min(axis=0) - 1e-9).all() and (rows <= points.max(axis=0) + 1e-9).all()


@given(points=st.lists(st.tuples(*[angles] * 7), min_size=3, max_size=4), loaded=st.booleans())
def test_blended_ways_pass_on_without_a_stop_and_keep_to_the_limits(points, loaded):
    limit = LOADED_ACCELERATION if loaded else ACCELERATION
    ways = [timed(pair, TIME_STEP, limit, PANDA.speed) for pair in pairwise(points)]
    whole = blended(ways, TIME_STEP)
    assert whole[-1] == pytest.approx(points[-1], abs=1e-9)
    assert len(whole) == sum(map(len, ways)) - (len(ways) - 1) * round(ROUNDING / TIME_STEP)
    speeds = np.diff(np.concatenate([np.array(points[:1]), whole]), axis=0) / TIME_STEP
    accelerations = np.diff(speeds, axis=0, prepend=np.zeros((1, 7)), append=np.zeros((1, 7))) / TIME_STEP
    assert np.abs(accelerations).max() <= limit * 1.1
    # The corner is passed nearby: what is left of the one way and what is done of the other is little.
    for corner in points[1:-1]:
        nearest = np.abs(whole - np.array(corner)).max(axis=1).min()
        assert nearest <= limit * ROUNDING**2 / 6


def _reach(x: float, y: float, z: float) -> Joints:
    return next(inverse(PANDA, Pose((x, y, z), DOWN)))


def test_a_straight_path_is_straight():
    high = _reach(0.5, 0.2, 0.2)
    low = next(inverse(PANDA, Pose((0.5, 0.2, 0.1), DOWN), near=high))
    assert vertical(PANDA, high, low) and not vertical(PANDA, high, _reach(0.5, 0.25, 0.2))
    for row in timed(straight(PANDA, high, low), TIME_STEP, ACCELERATION, PANDA.speed).tolist():
        x, y, z = tool_pose(PANDA, tuple(row)).position
        assert (x, y) == pytest.approx((0.5, 0.2), abs=0.002) and 0.099 < z < 0.201


def _walled(scene: Scene, height: float) -> Scene:
    """Return a scene with a wall across the reach of the arm; a viewer sees it from its narrow side."""
    return replace(
        scene,
        shapes={**scene.shapes, "brick_1": Shape("box", (0.8, 0.03, height)), "cube_1": Shape("box", (0.05,) * 3)},
    )


def _gap(simulator: Simulator, rows: np.ndarray, held: bool) -> float:
    """Return how near the arm, and a cube 5 mm below its tool, come to the wall: every row is looked at."""
    smallest = 1.0
    for row in rows.tolist():
        simulator.pose_arm(tuple(row), 0.05)
        poses = {"brick_1": simulator.read("brick_1")}
        if held:
            x, y, z = tool_pose(PANDA, tuple(row)).position
            poses["cube_1"] = Pose((x, y, z - 0.005), (0, 0, 0, 1))
        simulator.place(poses)
        smallest = min([smallest, *(gap for _, gap in simulator.arm.contacts(simulator.body("brick_1"), PANDA.links))])
        if held:
            smallest = min(smallest, simulator.overlap(simulator.body("brick_1"), simulator.body("cube_1")))
    return smallest


@pytest.mark.parametrize("held", [False, True])
def test_a_path_goes_over_what_stands_in_the_way(tabletop, held):
    start, goal = _reach(0.5, -0.2, 0.12), _reach(0.5, 0.2, 0.12)
    with open_simulator(_walled(tabletop, 0.2)) as simulator:
        poses = {"brick_1": Pose((0.6, 0.0, 0.1))}
        load = Load(0.05)
        if held:
            poses["cube_1"] = Pose((0.5, -0.2, 0.115))
            load = Load(0.05, Grip("cube_1", Pose((0.0, 0.0, 0.005), DOWN)))
        situation = Situation(simulator.scene, poses)
        direct = timed([start, goal], TIME_STEP, ACCELERATION, PANDA.speed)
        simulator.place({"brick_1": poses["brick_1"]})
        assert _gap(simulator, direct, held) < -0.01
        found = free_path(simulator, situation, load, start, goal, TIME_STEP)
        assert found is not None and found[-1] == pytest.approx(goal)
        simulator.place({"brick_1": poses["brick_1"]})
        assert _gap(simulator, found, held) > -0.005


def test_no_path_is_made_up_where_there_is_none(tabletop):
    start, goal = _reach(0.5, -0.2, 0.12), _reach(0.5, 0.2, 0.12)
    with open_simulator(_walled(tabletop, 1.8)) as simulator:
        situation = Situation(simulator.scene, {"brick_1": Pose((0.6, 0.0, 0.9))})
        assert free_path(simulator, situation, Load(0.05), start, goal, TIME_STEP) is None
