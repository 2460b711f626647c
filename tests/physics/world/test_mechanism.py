from __future__ import annotations

import math

import pybullet
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from prag_asp.physics.world.simulator import open_simulator
from prag_asp.scene.furniture import bounds, cavity_pose, mechanism, part_pose, swept
from prag_asp.scene.geometry import Pose, compose, yaw_quaternion
from prag_asp.scene.scene import Shape
from prag_asp.scene.scene_loader import parse_scene
from tests.chance import examples

DRAWER = Shape("drawer", (0.26, 0.24, 0.1), 0.008)
CUPBOARD = Shape("cupboard", (0.22, 0.2, 0.12), 0.008)
SHAPES = st.sampled_from([DRAWER, CUPBOARD])
POSES = st.builds(
    lambda x, y, yaw: Pose((x, y, 0.05), yaw_quaternion(yaw)), st.floats(-1, 1), st.floats(-1, 1), st.floats(-3, 3)
)


@pytest.fixture(scope="module")
def two():
    """Open a simulator with a drawer and a cupboard."""
    shapes = {shape.kind: {"kind": shape.kind, "size": list(shape.size), "wall": 0.008} for shape in (DRAWER, CUPBOARD)}
    table = {"shapes": shapes, "fixed": {"drawer": [0.4, -0.4], "cupboard": [0.4, 0.4]}}
    with open_simulator(parse_scene(table, {}, {"drawer": "drawer", "cupboard": "cupboard"})) as simulator:
        yield simulator


@given(SHAPES, POSES, st.floats(0, 1))
@settings(max_examples=examples(40))
def test_the_bounding_box_and_the_part_are_where_the_simulator_has_them(two, shape, pose, share):
    opening = share * mechanism(shape).limit
    two.place({shape.kind: pose}, {shape.kind: opening})
    body = two.body(shape.kind)
    link = pybullet.getLinkState(body, 0, computeForwardKinematics=True, physicsClientId=two.client)
    part = part_pose(shape, pose, opening)
    assert link[4] == pytest.approx(part.position, abs=1e-6)
    assert abs(sum(a * b for a, b in zip(link[5], part.quaternion, strict=True))) == pytest.approx(1.0, abs=1e-6)
    boxes = [pybullet.getAABB(body, i, physicsClientId=two.client) for i in (-1, 0)]
    low, high = bounds(shape, pose, opening)
    # The simulator's boxes hold the boxes of the body's own frame, so they are larger where it is turned.
    assert all(min(box[0][i] for box in boxes) <= low[i] + 1e-6 for i in range(3))
    assert all(max(box[1][i] for box in boxes) >= high[i] - 1e-6 for i in range(3))


@pytest.mark.parametrize("shape", [DRAWER, CUPBOARD])
def test_the_bounding_box_of_what_is_square_to_the_axes_is_that_of_the_simulator(two, shape):
    for opening in (0.0, mechanism(shape).limit):
        pose = Pose((0.5, 0.2, shape.half[2]))
        two.place({shape.kind: pose}, {shape.kind: opening})
        boxes = [pybullet.getAABB(two.body(shape.kind), i, physicsClientId=two.client) for i in (-1, 0)]
        low, high = bounds(shape, pose, opening)
        assert low == pytest.approx([min(box[0][i] for box in boxes) for i in range(3)], abs=1e-6)
        assert high == pytest.approx([max(box[1][i] for box in boxes) for i in range(3)], abs=1e-6)


@given(SHAPES, POSES, st.floats(0, 1))
@settings(max_examples=examples(40))
def test_what_furniture_sweeps_holds_it_at_every_opening(shape, pose, share):
    body, part = swept(shape, pose)
    low, high = bounds(shape, pose, share * mechanism(shape).limit)
    assert all(min(a, c) - 0.002 <= x for a, c, x in zip(body[0], part[0], low, strict=True))
    assert all(max(b, d) + 0.002 >= x for b, d, x in zip(body[1], part[1], high, strict=True))


@pytest.mark.parametrize("shape", [DRAWER, CUPBOARD])
def test_open_furniture_leaves_its_cavity_free_and_closed_furniture_covers_it(shape):
    pose, made = Pose((0.5, 0.0, shape.half[2])), mechanism(shape)
    for opening, free in ((made.limit, True), (0.0, False)):
        middle = cavity_pose(shape, pose, opening)
        covers = [(pose, made.body), (part_pose(shape, pose, opening), made.part)]
        size_x, size_y, _ = made.cavity
        for share_x in (-0.49, 0.0, 0.49):
            for share_y in (-0.49, 0.0, 0.49):
                x, y, z = compose(middle, Pose((share_x * size_x, share_y * size_y, 0.0))).position
                above = [
                    box
                    for frame, boxes in covers
                    for box in boxes
                    if _is_over(compose(frame, Pose(box[0])), box[1], (x, y), z + 0.001)
                ]
                assert bool(above) != free


def _is_over(pose: Pose, half: tuple[float, ...], point: tuple[float, float], height: float) -> bool:
    """Tell whether an upright box is over a point of the plane, above a height."""
    yaw = 2 * math.atan2(pose.quaternion[2], pose.quaternion[3])
    dx, dy = point[0] - pose.position[0], point[1] - pose.position[1]
    along, across = math.cos(yaw) * dx + math.sin(yaw) * dy, math.cos(yaw) * dy - math.sin(yaw) * dx
    return abs(along) < half[0] and abs(across) < half[1] and pose.position[2] + half[2] > height
