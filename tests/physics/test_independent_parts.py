from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from prag_asp.physics.world.bullet import pybullet, pybullet_data
from tests.independent import panda
from tests.independent.convex import clearance, depth
from tests.independent.statics import falling
from tests.independent.world import Frame, Part, frame, world_of

IDENTITY = np.eye(3)


def test_the_kinematics_is_that_of_the_robot():
    # At zero angles the arm stands upright, its hand hanging from the 88 mm offset of joint 7.
    hand = panda.tool((0.0,) * 7)
    assert np.allclose(hand.at, [0.088, 0, 0.333 + 0.316 + 0.384 - 0.107 - 0.1034])
    rng = np.random.default_rng(3)
    file = Path(pybullet_data.getDataPath()) / "franka_panda" / "panda.urdf"
    client = pybullet.connect(pybullet.DIRECT)
    try:
        flags = pybullet.URDF_IGNORE_VISUAL_SHAPES
        arm = pybullet.loadURDF(str(file), useFixedBase=True, flags=flags, physicsClientId=client)
        for _ in range(30):
            joints, width = rng.uniform(panda.LOWER, panda.UPPER), rng.uniform(0, panda.OPENING)
            for number, angle in zip((*range(7), 9, 10), (*joints, width / 2, width / 2), strict=True):
                pybullet.resetJointState(arm, number, angle, physicsClientId=client)
            for number, own in zip((0, 3, 6, 8, 9, 10), (1, 4, 7, 8, 9, 10), strict=True):
                state = pybullet.getLinkState(arm, number, computeForwardKinematics=True, physicsClientId=client)
                moved, turned = panda.link_frames(joints.tolist(), width)[own].offset(frame([state[4], state[5]]))
                # The right finger of the URDF is not turned, only its mesh is.
                assert moved < 1e-5 and (turned < 1e-4 or number == 10)
    finally:
        pybullet.disconnect(client)


@pytest.mark.parametrize("link", sorted(panda.CAPSULES))
def test_the_capsules_lie_within_the_links(link):
    file = Path(pybullet_data.getDataPath()) / "franka_panda" / "meshes" / "collision" / f"{link}.obj"
    lines = [line.split() for line in file.read_text().splitlines() if line[:2] in ("v ", "f ")]
    corners = np.array([line[1:4] for line in lines if line[0] == "v"], dtype=float)
    client = pybullet.connect(pybullet.DIRECT)
    try:
        shape = pybullet.createCollisionShape(pybullet.GEOM_MESH, vertices=corners.tolist(), physicsClientId=client)
        hull = pybullet.createMultiBody(0, shape, physicsClientId=client)
        for start, end, radius in panda.CAPSULES[link]:
            for share in np.linspace(0, 1, 9):
                at = np.array(start) + share * (np.array(end) - np.array(start))
                _assert_within(client, hull, corners, at, radius)
    finally:
        pybullet.disconnect(client)


def _assert_within(client, hull, corners, at, radius):
    """A ball is in a hull if in no direction it reaches farther; PyBullet's own depth agrees that its centre is in."""
    directions = np.random.default_rng(0).normal(size=(4000, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    assert (directions @ at + radius <= (corners @ directions.T).max(axis=0) + 5e-4).all()
    point = pybullet.createCollisionShape(pybullet.GEOM_SPHERE, radius=radius, physicsClientId=client)
    ball = pybullet.createMultiBody(0, point, basePosition=at.tolist(), physicsClientId=client)
    depths = [each[8] for each in pybullet.getClosestPoints(hull, ball, 0.0, physicsClientId=client)]
    assert min(depths) <= -2 * radius + 2e-3
    pybullet.removeBody(ball, physicsClientId=client)


def _turned(angle):
    return np.array([[math.cos(angle), -math.sin(angle), 0], [math.sin(angle), math.cos(angle), 0], [0, 0, 1]])


def _depth(one, two, at, turn=IDENTITY):
    here, there = Frame(IDENTITY, np.zeros(3)), Frame(turn, np.array(at, dtype=float))
    return depth(one, here, two, there, -math.inf)


CUBE = Part("box", np.array([0.05, 0.05, 0.05]), np.zeros(3))
CAN = Part("cylinder", np.array([0.03, 0.03, 0.1]), np.zeros(3))
BALL = Part("sphere", np.array([0.04, 0.04, 0.04]), np.zeros(3))


@pytest.mark.parametrize(
    ("one", "two", "at", "turn", "expected"),
    [
        (CUBE, CUBE, (0.098, 0.03, 0), IDENTITY, 0.002),
        (CUBE, CUBE, (0.05 + 0.05 * math.sqrt(2) - 0.001, 0, 0), _turned(math.pi / 4), 0.001),
        (CUBE, CAN, (0.079, 0, 0.02), IDENTITY, 0.001),
        (CUBE, CAN, (0.01, 0, 0.1485), IDENTITY, 0.0015),
        # A corner of the cube towards the can, along the diagonal.
        (CUBE, CAN, (0.05 + 0.029 / math.sqrt(2), 0.05 + 0.029 / math.sqrt(2), 0), IDENTITY, 0.001),
        (CAN, CAN, (0.036, 0.046, 0.05), _turned(1.0), 0.06 - math.hypot(0.036, 0.046)),
        (BALL, BALL, (0.03, 0.04, 0.06), IDENTITY, 0.08 - math.hypot(0.03, 0.04, 0.06)),
        (BALL, CUBE, (0.088, 0.01, 0), IDENTITY, 0.002),
        (CUBE, BALL, (0.05 + 0.02, 0.05 + 0.02, 0.05 + 0.02), IDENTITY, 0.04 - math.hypot(0.02, 0.02, 0.02)),
    ],
)
def test_depths_are_right(one, two, at, turn, expected):
    assert _depth(one, two, at, turn) == pytest.approx(expected, abs=1e-5)
    assert _depth(two, one, -np.array(at) @ turn, turn.T) == pytest.approx(expected, abs=1e-5)


def test_points_are_as_far_from_a_primitive_as_sampled_points_of_it_are():
    rng = np.random.default_rng(5)
    points = rng.uniform(-0.15, 0.15, (40, 3))
    place = Frame(_turned(0.7), np.array([0.01, -0.02, 0.03]))
    cloud = rng.uniform(-0.1, 0.1, (200_000, 3))
    for part in (CUBE, CAN, BALL):
        inner = np.abs(cloud) <= part.half
        if part.kind != "box":
            flat = cloud[:, :2] if part.kind == "cylinder" else cloud
            inner &= (np.linalg.norm(flat, axis=1) <= part.half[0])[:, None]
        solid = cloud[inner.all(axis=1)] @ place.turn.T + place.at
        for point, distance in zip(points, clearance(part, place, points), strict=True):
            nearest = np.linalg.norm(solid - point, axis=1).min()
            assert max(distance, 0.0) == pytest.approx(nearest, abs=0.006)
            if distance < -0.006:
                assert nearest < 0.004


def test_balance_is_that_of_all_that_rests_on_a_body(tabletop):
    world = world_of(tabletop)

    def fallen(**places):
        return falling(world, {name: Frame(IDENTITY, np.array(at)) for name, at in places.items()}, None)

    on_table = (0.5, 0.0, 0.025)
    assert fallen(cube_1=on_table) is None
    assert fallen(cube_1=on_table, cube_2=(0.5, 0.024, 0.075)) is None
    assert fallen(cube_1=on_table, cube_2=(0.5, 0.026, 0.075)) == "cube_2"
    # A brick that hangs over by itself falls, and is kept by a can on its other end.
    brick = (0.54, 0.0, 0.07)
    assert fallen(cube_1=on_table, brick_1=brick) == "brick_1"
    assert fallen(cube_1=on_table, brick_1=brick, can_1=(0.49, 0.0, 0.14)) is None
    # A bridge over two cubes rests; over one of them at its end it does not.
    assert fallen(cube_1=(0.46, 0, 0.025), cube_2=(0.54, 0, 0.025), brick_1=(0.5, 0, 0.07)) is None
    assert fallen(cube_1=(0.46, 0, 0.025), cube_2=(0.54, 0, 0.3), brick_1=(0.5, 0, 0.07)) in ("brick_1", "cube_2")
    assert fallen(cube_1=(1.2, 0, 0.025)) == "cube_1"
