from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from prag_asp.physics.bullet import pybullet
from prag_asp.physics.motion.clearance import CLEARANCE, keeps_clear
from prag_asp.physics.motion.route import _is_free, free_path, is_vertical, straight_path
from prag_asp.physics.motion.trajectory import LOADED_ACCELERATION, ROUNDING, blend_paths, joint_limits, time_path
from prag_asp.physics.robot.kinematics import inverse, tool_pose
from prag_asp.physics.situation import Situation
from prag_asp.physics.witness import Arm
from prag_asp.physics.world.simulator import Simulator, open_simulator
from prag_asp.scene.geometry import Pose
from prag_asp.scene.robots import KUKA, PANDA, Joints, Robot
from prag_asp.scene.scene import Scene, Shape
from tests.chance import examples

DOWN = (1.0, 0.0, 0.0, 0.0)
TIME_STEP = 1 / 120

angles = st.floats(-2.5, 2.5)
paths = st.lists(st.tuples(*[angles] * 7), min_size=2, max_size=5)
robots = st.sampled_from([PANDA, KUKA])


def _motion(path: Sequence[Joints], rows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the highest speed and acceleration of each joint from one time step to the next, from rest to rest."""
    whole = np.concatenate([np.array(path[:1]), rows])
    speeds = np.diff(whole, axis=0) / TIME_STEP
    accelerations = np.diff(speeds, axis=0, prepend=np.zeros((1, 7)), append=np.zeros((1, 7))) / TIME_STEP
    return np.abs(speeds).max(axis=0), np.abs(accelerations).max(axis=0)


@pytest.mark.parametrize("robot", [PANDA, KUKA])
def test_the_limits_of_every_joint_are_the_makers(robot):
    limits, loaded = joint_limits(robot), joint_limits(robot, loaded=True)
    assert (limits.speeds < robot.speeds).all() and (limits.accelerations < robot.accelerations).all()
    assert (loaded.speeds == limits.speeds).all() and (loaded.accelerations <= LOADED_ACCELERATION).all()
    if robot is PANDA:
        assert robot.accelerations == (15.0, 7.5, 10.0, 12.5, 15.0, 20.0, 20.0)


def _assert_within_limits(robot: Robot, path: Sequence[Joints], rows: np.ndarray) -> None:
    speeds, accelerations = _motion(path, rows)
    assert rows[-1] == pytest.approx(path[-1], abs=1e-9)
    assert (speeds <= robot.speeds).all() and (accelerations <= robot.accelerations).all()


@settings(max_examples=examples(60))
@given(path=paths, robot=robots)
def test_a_timed_path_keeps_to_the_limits_of_each_joint_and_to_the_box_of_its_points(path, robot):
    rows, points = time_path(path, TIME_STEP, joint_limits(robot)), np.array(path)
    _assert_within_limits(robot, path, rows)
    assert (rows >= points.min(axis=0) - 1e-9).all() and (rows <= points.max(axis=0) + 1e-9).all()


@pytest.mark.parametrize("joint", range(7))
def test_a_joint_that_turns_alone_is_as_fast_as_it_may_be(joint):
    goal = tuple(1.5 * (i == joint) for i in range(7))
    limits = joint_limits(PANDA)
    speeds, accelerations = _motion([(0.0,) * 7], time_path([(0.0,) * 7, goal], TIME_STEP, limits))
    assert speeds[joint] > 0.95 * limits.speeds[joint]
    assert accelerations[joint] > 0.9 * limits.accelerations[joint]


def test_a_path_of_many_pieces_that_hardly_turn_is_not_slower_than_one_that_is_straight():
    turn = np.linspace(0.0, 1.0, 30)[:, None]
    bent = np.sin(turn) * [1.2, 0.5, 0, 0, 0, 0, 0] + (1 - np.cos(turn)) * [0, 0.3, 0.5, 0, 0, 0, 0]
    path = [tuple(row) for row in bent.tolist()]
    rows, direct = (time_path(each, TIME_STEP, joint_limits(PANDA)) for each in (path, [path[0], path[-1]]))
    _assert_within_limits(PANDA, path, rows)
    assert len(rows) < 1.2 * len(direct)


@pytest.mark.parametrize("tiny", [5e-324, 2e-308, 1e-300, 1e-160, 1e-30, 1e-13, 1e-11])
def test_a_turn_too_small_for_numbers_is_none(tiny):
    start, near, far = (0.0,) * 7, (*(0.0,) * 6, tiny), (0.0, 1.0, *(0.0,) * 4, tiny)
    limits = joint_limits(PANDA)
    for path in ([start, near], [start, near, far], [start, far], [far, start, near]):
        rows = time_path(path, TIME_STEP, limits)
        assert np.isfinite(rows).all()
        _assert_within_limits(PANDA, path, rows)


@settings(max_examples=examples(60))
@given(points=st.lists(st.tuples(*[angles] * 7), min_size=3, max_size=4), loaded=st.booleans(), robot=robots)
def test_blended_ways_keep_to_the_limits_and_pass_the_corners_nearby(points, loaded, robot):
    limits = joint_limits(robot, loaded)
    ways = [time_path(pair, TIME_STEP, limits) for pair in pairwise(points)]
    whole = blend_paths(ways, points[0], TIME_STEP, limits)
    _assert_within_limits(robot, points, whole)
    assert len(whole) <= sum(map(len, ways))
    # What is left of the one way and what is done of the other is little.
    for corner in points[1:-1]:
        nearest = np.abs(whole - np.array(corner)).max(axis=1).min()
        assert nearest <= limits.accelerations.max() * ROUNDING**2 / 6


def test_blended_ways_pass_on_without_a_stop():
    points = [(0.0,) * 7, (1.0,) * 7, (1.0, 2.0, 1.0, 1.0, 1.0, 1.0, 1.0)]
    ways = [time_path(pair, TIME_STEP, joint_limits(PANDA)) for pair in pairwise(points)]
    whole = blend_paths(ways, points[0], TIME_STEP, joint_limits(PANDA))
    assert len(whole) == sum(map(len, ways)) - round(ROUNDING / TIME_STEP)


def _reach(x: float, y: float, z: float) -> Joints:
    return next(inverse(PANDA, Pose((x, y, z), DOWN)))


def test_a_straight_path_is_straight():
    high = _reach(0.5, 0.2, 0.2)
    low = next(inverse(PANDA, Pose((0.5, 0.2, 0.1), DOWN), near=high))
    assert is_vertical(PANDA, high, low) and not is_vertical(PANDA, high, _reach(0.5, 0.25, 0.2))
    for row in time_path(straight_path(PANDA, high, low), TIME_STEP, joint_limits(PANDA)).tolist():
        x, y, z = tool_pose(PANDA, tuple(row)).position
        assert (x, y) == pytest.approx((0.5, 0.2), abs=0.002) and 0.099 < z < 0.201


def _walled(scene: Scene, height: float) -> Scene:
    """Return a scene with a wall across the reach of the arm; a viewer sees it from its narrow side."""
    bodies = {"brick_1": Shape("box", (0.8, 0.03, height)), "cube_1": Shape("box", (0.05,) * 3)}
    return replace(scene, shapes={**scene.shapes, **bodies})


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
        wall = simulator.body("brick_1")
        smallest = min([smallest, *(gap for _, gap in simulator.arm.contacts(wall, PANDA.links, 0.05))])
        if held:
            points = pybullet.getClosestPoints(wall, simulator.body("cube_1"), 0.05, physicsClientId=simulator.client)
            smallest = min([smallest, *(point[8] for point in points)])
    return smallest


@pytest.mark.parametrize("held", [False, True])
def test_a_path_goes_over_what_stands_in_the_way(tabletop, held):
    start, goal = _reach(0.5, -0.2, 0.12), _reach(0.5, 0.2, 0.12)
    with open_simulator(_walled(tabletop, 0.2)) as simulator:
        poses = {"brick_1": Pose((0.6, 0.0, 0.1))}
        arm = Arm(start, 0.05)
        if held:
            poses["cube_1"] = Pose((0.5, -0.2, 0.115))
            arm = Arm(start, 0.05, "cube_1", Pose((0.0, 0.0, 0.005), DOWN))
        situation = Situation(simulator.scene, poses)
        direct = time_path([start, goal], TIME_STEP, joint_limits(PANDA))
        simulator.place({"brick_1": poses["brick_1"]})
        assert _gap(simulator, direct, held) < -0.01
        found = free_path(simulator, situation, arm, goal, TIME_STEP)
        assert found is not None and found[-1] == pytest.approx(goal)
        simulator.place({"brick_1": poses["brick_1"]})
        assert _gap(simulator, found, held) > 0.8 * CLEARANCE


def test_a_way_over_a_wall_is_free_where_it_keeps_a_centimetre_away(tabletop):
    start, goal = _reach(0.5, 0.2, 0.30), _reach(0.5, -0.2, 0.30)
    rows = np.array([start, *time_path([start, goal], TIME_STEP, joint_limits(PANDA)).tolist()])
    scene = _walled(tabletop, 0.2)
    found = set()
    with open_simulator(scene) as simulator:
        for height in np.arange(-0.03, 0.06, 0.004).tolist():  # of the middle of the wall
            pose = Pose((0.6, 0.0, height))
            simulator.place({"brick_1": pose})
            gap = _gap(simulator, rows, False)
            free = _is_free(simulator, Situation(scene, {"brick_1": pose}), Arm(start, 0.05), rows)
            if not 0.9 * CLEARANCE < gap < 1.1 * CLEARANCE:
                assert free == (gap > CLEARANCE), gap
                found.add((free, gap > 0.0))
    assert found == {(True, True), (False, True), (False, False)}


def test_only_what_is_near_an_end_of_a_way_may_be_near_on_it_and_until_it_has_been_left():
    near, nearer, tray = {("the arm", "tray"): 0.004}, {("the arm", "tray"): 0.002}, ("the arm", "tray")
    far: dict[tuple[str, str], float] = {}
    assert keeps_clear(near, [near, {tray: 0.008}, far, far], far)
    assert keeps_clear(far, [far, far, {tray: 0.009}, near], near)
    assert keeps_clear(near, [near, far, near], near) and keeps_clear(near, [near, near], near)
    assert not keeps_clear(near, [near, far, near, far], far)
    assert not keeps_clear(near, [near, nearer, far], far)
    assert not keeps_clear(near, [far, near], far) and not keeps_clear(far, [near, far], near)
    assert not keeps_clear(near, [{("the arm", "crate"): 0.009}], near)


def test_no_path_is_made_up_where_there_is_none(tabletop):
    start, goal = _reach(0.5, -0.2, 0.12), _reach(0.5, 0.2, 0.12)
    with open_simulator(_walled(tabletop, 1.8)) as simulator:
        situation = Situation(simulator.scene, {"brick_1": Pose((0.6, 0.0, 0.9))})
        assert free_path(simulator, situation, Arm(start, 0.05), goal, TIME_STEP) is None
