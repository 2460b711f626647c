from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from prag_asp import load_domain, load_scene
from prag_asp.physics.bullet import pybullet, pybullet_data
from prag_asp.physics.predicates import PREDICATES
from prag_asp.physics.robot.kinematics import tool_pose
from prag_asp.physics.situation import Situation, fixed_pose
from prag_asp.physics.witness import Arm
from prag_asp.scene.furniture import mechanism
from prag_asp.scene.geometry import Pose
from prag_asp.scene.robots import ROBOTS as DESCRIBED
from tests.independent.convex import Part, clearance, depth, surface
from tests.independent.frames import Frame, frame
from tests.independent.hulls import box_hull, hull_of, mesh_hull
from tests.independent.relations import MEANINGS, Seen, holds
from tests.independent.robots import ROBOTS, Mounted
from tests.independent.statics import falling, riders
from tests.independent.world import Layout, world_of

IDENTITY = np.eye(3)
URDFS = {"panda": "franka_panda/panda.urdf", "kuka": "kuka_iiwa/model.urdf"}


@pytest.mark.parametrize("kind", ["panda", "kuka"])
def test_the_kinematics_is_that_of_the_robot(kind, chance):
    own, base = ROBOTS[kind], Pose((0.3, -0.2, 0.0), (0.0, 0.0, math.sin(0.4), math.cos(0.4)))
    mounted, rng = Mounted(own, frame(base)), np.random.default_rng(chance.seed(3))
    client = pybullet.connect(pybullet.DIRECT)
    try:
        file = str(Path(pybullet_data.getDataPath()) / URDFS[kind])
        flags = pybullet.URDF_IGNORE_VISUAL_SHAPES
        arm = pybullet.loadURDF(file, *base, useFixedBase=True, flags=flags, physicsClientId=client)
        for _ in range(chance.examples(30)):
            joints, width = tuple(rng.uniform(own.lower, own.upper).tolist()), rng.uniform(0, own.opening)
            fingers = (9, 10) if kind == "panda" else ()
            for number, angle in zip((*range(7), *fingers), (*joints, width / 2, width / 2), strict=False):
                pybullet.resetJointState(arm, number, angle, physicsClientId=client)
            found = mounted.frames(joints, width)
            for number, link in enumerate((1, 2, 3, 4, 5, 6, 7, 7, 8, 9, 10)[: 11 if fingers else 7]):
                if number == 7:
                    continue  # The flange has no mesh.
                state = pybullet.getLinkState(arm, number, computeForwardKinematics=True, physicsClientId=client)
                far, angle = found[link].offset(frame([state[4], state[5]]))
                # The right finger of the URDF is not turned, only its mesh is.
                assert far < 1e-5 and (angle < 1e-4 or number == 10)
            shown = frame(base) @ frame(tool_pose(DESCRIBED[kind], joints))
            assert max(mounted.tool(joints).offset(shown)) < 1e-7
            assert own.opening == DESCRIBED[kind].opening and own.reach == DESCRIBED[kind].reach
    finally:
        pybullet.disconnect(client)


@pytest.mark.parametrize("path", ["franka_panda/meshes/collision/hand.obj", "kuka_iiwa/meshes/link_7.stl"])
def test_a_mesh_is_read_whole_and_its_hull_is_as_large_as_that_of_the_simulator(path, chance):
    hull = mesh_hull(path, 0.005)
    client = pybullet.connect(pybullet.DIRECT)
    try:
        file = str(Path(pybullet_data.getDataPath()) / path)
        shape = pybullet.createCollisionShape(pybullet.GEOM_MESH, fileName=file, physicsClientId=client)
        body = pybullet.createMultiBody(0, shape, physicsClientId=client)
        ball = pybullet.createCollisionShape(pybullet.GEOM_SPHERE, radius=0.001, physicsClientId=client)
        probe = pybullet.createMultiBody(0, ball, physicsClientId=client)
        directions = np.random.default_rng(chance.seed(4)).normal(size=(chance.examples(200), 3))
        for direction in directions / np.linalg.norm(directions, axis=1)[:, None]:
            at = hull.middle + 0.2 * direction
            pybullet.resetBasePositionAndOrientation(probe, at.tolist(), (0, 0, 0, 1), physicsClientId=client)
            shown = pybullet.getClosestPoints(body, probe, 1.0, physicsClientId=client)[0][8] + 0.001
            nearest = np.linalg.norm(hull.points - at, axis=1).min()
            # PyBullet's hulls have a margin of one or two millimetres.
            assert -0.0002 <= nearest - shown <= 0.0025
    finally:
        pybullet.disconnect(client)


def test_hulls_of_random_corners_hold_all_of_them_and_nothing_else(chance):
    rng = np.random.default_rng(chance.seed(6))
    corners = rng.normal(size=(60, 3)) * (0.1, 0.05, 0.02)
    hull = hull_of(corners, 0.01)
    assert hull.within(corners).min() > -2e-5
    assert np.abs(hull.within(hull.points)).max() < 2e-5
    directions = rng.normal(size=(500, 3))
    assert np.allclose((hull.points @ directions.T).max(axis=0), (corners @ directions.T).max(axis=0), atol=2e-4)
    box = box_hull((0.0, 0.0, 0.5), (0.2, 0.4, 1.0), 0.05)
    assert box.within(np.array([[0.0, 0.0, 0.5], [0.0, 0.0, 0.97], [0.2, 0.0, 0.5]])) == pytest.approx(
        [0.1, 0.03, -0.1]
    )


def test_no_two_neighbours_are_taken_for_links_that_meet():
    for kind, own in ROBOTS.items():
        assert all(high - low > 2 for low, high in own.apart), kind
        assert set(range(5, 11)) == {high for _, high in own.apart}


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


def test_points_are_as_far_from_a_primitive_as_sampled_points_of_it_are(chance):
    rng = np.random.default_rng(chance.seed(5))
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


@pytest.mark.parametrize("part", [CUBE, CAN, BALL])
def test_points_on_a_primitive_are_on_it_and_nowhere_far_apart(part):
    points = surface(part, 0.005)
    place = Frame(IDENTITY, np.zeros(3))
    assert np.abs(clearance(part, place, points)).max() < 1e-9
    between = np.linalg.norm(points[:, None] - points[None], axis=2) + np.eye(len(points))
    assert between.min(axis=1).max() < 0.008


def _layout(world, openings=None, **places):
    return Layout(world, {name: Frame(IDENTITY, np.array(at)) for name, at in places.items()}, openings or {})


def test_balance_is_that_of_all_that_rests_on_a_body(tabletop):
    world = world_of(tabletop)

    def fallen(**places):
        return falling(_layout(world, **places), ())

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


@pytest.fixture(scope="module")
def kitchen():
    return load_scene(load_domain("kitchen"))


def test_furniture_has_the_measures_of_the_product(kitchen):
    world = world_of(kitchen)
    for name in ("drawer_1", "cupboard_1"):
        made, own = mechanism(kitchen.shapes[name]), world.furniture[name]
        assert own.limit == pytest.approx(made.limit) and np.allclose(own.grip, made.handle)
        for boxes, ends in ((made.body, own.still), (made.part, own.moving)):
            theirs = {tuple(np.round([*np.subtract(*box), *np.add(*box)], 6)) for box in boxes}
            ours = {tuple(np.round([*np.array(each)[:, 0], *np.array(each)[:, 1]], 6)) for each in ends}
            assert ours == theirs


def test_what_lies_in_a_tray_goes_along_and_what_lies_beside_it_does_not(kitchen):
    world = world_of(kitchen)
    x, y = kitchen.fixed["drawer_1"][:2]
    for opening in (0.0, 0.2):
        layout = _layout(
            world,
            {"drawer_1": opening, "cupboard_1": 0.0},
            drawer_1=(x, y, 0.05),
            cupboard_1=(0.3, 0.3, 0.04),
            apple_1=(x - opening, y, 0.04),
            apple_2=(x, y + 0.2, 0.03),
            cup_1=(0.3, 0.3, 0.038),
        )
        assert riders(layout, "drawer_1") == {"apple_1"}
        assert riders(layout, "cupboard_1") == set()
        assert falling(layout, ()) is None
        further = layout.opened(
            "drawer_1", opening + 0.01, {"apple_1": layout.joint("drawer_1").inverse() @ layout.poses["apple_1"]}
        )
        assert layout.poses["apple_1"].at - further.poses["apple_1"].at == pytest.approx([0.01, 0.0, 0.0])
        assert further.poses["apple_2"] is layout.poses["apple_2"]


@pytest.mark.parametrize("name", ["kitchen", "tabletop", "two_arms"])
def test_every_predicate_says_of_random_scenes_what_the_product_says(name, chance):
    scene = load_scene(load_domain(name))
    world, rng = world_of(scene), np.random.default_rng(chance.seed(8))
    bodies, values_seen = sorted(world.parts), dict.fromkeys(MEANINGS, frozenset[bool]())
    flat = [entity for entity, shape in scene.shapes.items() if shape.kind in ("table", "zone")]
    grippers, places = sorted(scene.robots), [*bodies, *flat]
    rotations, furniture = sorted(scene.rotations), sorted(world.furniture)
    roles = {"robot": grippers, "rotation": rotations, "furniture": furniture}
    for _ in range(chance.examples(200)):
        situation, seen = _random_scene(scene, world, rng)
        for predicate in MEANINGS:
            options = [roles.get(role, places if k else bodies) for k, role in enumerate(scene.roles(predicate))]
            if predicate in ("located", "inside"):
                hollow = [e for e in places if world.kinds[e] in ("container", "drawer", "cupboard")]
                options[1] = hollow + [e for e in places if world.kinds[e] == "table" and predicate == "located"]
            elif options[-1] is places and predicate not in ("on_top", "over"):
                options = [bodies if each is places else each for each in options]
            if not all(options):
                continue
            arguments = tuple(str(rng.choice(each)) for each in options)
            if len(set(arguments)) < len(arguments):
                continue
            value = PREDICATES[predicate].holds(situation, arguments)
            assert holds(seen, predicate, arguments, value), (predicate, arguments, value)
            values_seen[predicate] |= {value}
    for predicate, values in values_seen.items():
        assert values in (frozenset(), {True, False}) or predicate in ("upright", "holding", "at", "inside"), predicate


def _random_scene(scene, world, rng):
    """Return a random arrangement, some of it on, in and next to each other, as the product and the check see it."""
    openings = {
        name: float(rng.choice([0.0, rng.uniform(0, made.limit), made.limit])) for name, made in world.furniture.items()
    }
    poses = {name: fixed_pose(scene, name) for name in scene.fixed if name in world.parts}
    for name in sorted(world.parts.keys() - poses.keys()):
        half, yaw = world.halves[name][2], rng.choice([0.0, math.pi / 2, rng.uniform(-3, 3)])
        x, y, z = rng.uniform(0.3, 0.7), rng.uniform(-0.4, 0.4), rng.choice([half, rng.uniform(half, 0.3)])
        if poses and rng.random() < 0.6:
            other = str(rng.choice(sorted(poses)))
            layout = Layout(world, {each: frame(pose) for each, pose in poses.items()}, openings)
            middle = np.add(*layout.span(other)) / 2
            x, y = middle[:2] + rng.choice([0.0, 0.02, 0.2]) * rng.normal(size=2)
            z = half + rng.choice([layout.span(other)[1][2], layout.span(other)[0][2] + world.walls[other], 0.0])
        poses[name] = Pose((float(x), float(y), float(z)), (0.0, 0.0, math.sin(yaw / 2), math.cos(yaw / 2)))
    down = {}
    for robot in scene.robots:
        name = str(rng.choice(sorted(poses)))
        x, y, z = np.array(poses[name].position) + rng.choice([0.0, 0.01]) * rng.normal(size=3)
        yaw = float(rng.choice([0.0, math.pi / 2])) + 2 * math.atan2(*poses[name].quaternion[2:])
        down[robot] = Pose((x, y, z + float(rng.choice([0.0, 0.2]))), (math.cos(yaw / 2), math.sin(yaw / 2), 0.0, 0.0))
    widths = {robot: float(rng.choice([0.0, 0.08, 0.035, 0.05, 0.06])) for robot in down}
    arms = {robot: Arm((0.0,) * 7, width) for robot, width in widths.items()}
    situation = Situation(scene, poses, arms, openings, tools=down)
    layout = Layout(world, {name: frame(pose) for name, pose in poses.items()}, openings)
    return situation, Seen(layout, {name: frame(pose) for name, pose in down.items()}, widths)
