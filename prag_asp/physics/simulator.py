"""A PyBullet world with the robot, the table and one body for each object of the scene.

Bodies are made once and reused: making and removing them leaks. Those that a task does not use are parked,
each at its own place. PyBullet is silent about unknown bodies and about poses that are not finite, so both
are checked here.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

from prag_asp.domain.scene import Scene, Shape
from prag_asp.errors import SceneError
from prag_asp.physics.geometry import Pose, Vector, finite
from prag_asp.physics.robot import ROBOTS, Joints, Robot
from prag_asp.physics.silence import STDERR, STDOUT, silenced
from prag_asp.physics.situation import TABLE_THICKNESS
from prag_asp.physics.solids import container_boxes, volume

with silenced(STDOUT, STDERR):  # the import announces when PyBullet was built
    import pybullet
    import pybullet_data

COLLISION = -0.0015
"""Bodies collide where they are closer than this, in metres: deeper than 1.5 mm in each other."""

PARKING = (20.0, 20.0, 5.0)
DENSITY = 400.0
REMEMBERED = 64


class _Part(NamedTuple):
    """A primitive of a body: its kind in PyBullet, its sizes and its place in the body in metres."""

    kind: int
    half: Vector = (0.0, 0.0, 0.0)
    radius: float = 0.0
    height: float = 0.0
    at: Vector = (0.0, 0.0, 0.0)


class Simulator:
    """One PyBullet client and the bodies in it; use `open_simulator`, which closes it."""

    def __init__(self, scene: Scene, client: int, visual: bool):
        self.scene = scene
        self.client = client
        self.robot: Robot = ROBOTS[scene.robot]
        self._visual = visual
        pybullet.setPhysicsEngineParameter(deterministicOverlappingPairs=1, physicsClientId=client)
        pybullet.setGravity(0, 0, -9.81, physicsClientId=client)
        self.arm = self._load_robot()
        self.table = self._load_table()
        self.bodies = {
            entity: self._load_body(entity, shape)
            for entity, shape in scene.shapes.items()
            if shape.kind not in ("robot", "table")
        }
        self._poses: dict[str, Pose] = {}
        self._trunk, self._wrist = (sorted(set(links)) for links in zip(*self.robot.self_pairs, strict=True))
        self._link_boxes: list[tuple[Vector, Vector]] = []
        self._arm_at: tuple[Joints, float] | None = None
        self._joints_at: Joints = ()
        self._self_overlaps: dict[Joints, float] = {}
        self._joints = [*self.robot.arm_links, *self.robot.finger_joints]
        for entity in self.bodies:
            self._park(entity)

    def place(self, poses: Mapping[str, Pose]) -> None:
        """Put objects at poses, and park all others.

        Raises:
            SceneError: an object has no body, or its pose is not finite.
        """
        for entity, pose in poses.items():
            known = self._poses.get(entity)
            if known is not pose and known != pose:
                if not finite(pose):
                    raise SceneError(f"{entity} has the pose {pose}, which is not a finite position and rotation")
                self._move(entity, pose)
        for entity in [entity for entity in self._poses if entity not in poses]:
            self._park(entity)

    def pose_arm(self, joints: Joints, width: float) -> None:
        """Put the arm at seven joint angles in radians, the gripper at an opening in metres.

        Raises:
            SceneError: a number is not finite, or there are not seven joints.
        """
        if self._arm_at == (joints, width):
            return
        if len(joints) != len(self.robot.lower) or not all(map(math.isfinite, (*joints, width))):
            raise SceneError(f"the arm cannot take the joint angles {joints} with the opening {width}")
        values = [[angle] for angle in (*joints, width / 2, width / 2)]
        pybullet.resetJointStatesMultiDof(self.arm, self._joints, values, physicsClientId=self.client)
        self._arm_at, self._joints_at, self._link_boxes = (joints, width), joints, []

    def overlap(self, one: int, two: int) -> float:
        """Return the distance of two bodies that touch in metres: negative in each other, 0 where apart."""
        points = pybullet.getClosestPoints(one, two, 0.0, physicsClientId=self.client)
        return min((point[8] for point in points), default=0.0)

    def arm_contacts(self, body: int) -> list[tuple[int, float]]:
        """Return the links of the arm that touch a body, with the distance in metres."""
        points = pybullet.getClosestPoints(self.arm, body, 0.0, physicsClientId=self.client)
        return [(point[3], point[8]) for point in points]

    def self_overlap(self) -> float:
        """Return the smallest distance of two links of the arm that touch in metres, 0 where none do."""
        known = self._self_overlaps.get(self._joints_at)
        if known is not None:
            return known
        boxes = dict(zip(self.robot.links, self.link_boxes(), strict=True))
        smallest = 0.0
        trunk = _around([boxes[link] for link in self._trunk])
        near = {link for link in self._wrist if boxes_touch(boxes[link], trunk)}
        for low, high in self.robot.self_pairs:
            if high not in near or not boxes_touch(boxes[low], boxes[high]):
                continue
            points = pybullet.getClosestPoints(
                self.arm, self.arm, 0.0, linkIndexA=low, linkIndexB=high, physicsClientId=self.client
            )
            smallest = min(smallest, min((point[8] for point in points), default=0.0))
        if len(self._self_overlaps) >= REMEMBERED:
            self._self_overlaps.clear()
        self._self_overlaps[self._joints_at] = smallest
        return smallest

    def link_boxes(self) -> list[tuple[Vector, Vector]]:
        """Return the lowest and the highest corner of the bounding box of each link of the arm, in metres."""
        if not self._link_boxes:
            read, arm, client = pybullet.getAABB, self.arm, self.client
            self._link_boxes = [read(arm, link, client) for link in self.robot.links]
        return self._link_boxes

    def flange(self) -> Pose:
        """Return the pose of the flange as the simulator's own kinematics has it.

        Its quaternion is off unit length by up to 1e-7, for the URDF's angles are rounded; it is made one.
        """
        state = pybullet.getLinkState(
            self.arm, self.robot.flange_link, computeForwardKinematics=True, physicsClientId=self.client
        )
        length = math.hypot(*state[5])
        x, y, z, w = (part / length for part in state[5])
        return Pose(tuple(state[4]), (x, y, z, w))

    def read(self, entity: str) -> Pose:
        """Return where the simulator has an object.

        Raises:
            SceneError: it has no body.
        """
        body = self.body(entity)
        position, quaternion = pybullet.getBasePositionAndOrientation(body, physicsClientId=self.client)
        return Pose(tuple(position), tuple(quaternion))

    def body(self, entity: str) -> int:
        """Return the id of an object's body.

        Raises:
            SceneError: it has none.
        """
        if entity not in self.bodies:
            raise SceneError(f"{entity} has no body; give its class a shape under [scene.shapes]")
        return self.bodies[entity]

    def _park(self, entity: str) -> None:
        """Put one body where it is in nobody's way."""
        i = list(self.bodies).index(entity)
        self._move(entity, Pose((PARKING[0] + 2.0 * i, PARKING[1], PARKING[2])))
        del self._poses[entity]

    def _move(self, entity: str, pose: Pose) -> None:
        """Put one body at a pose."""
        pybullet.resetBasePositionAndOrientation(
            self.body(entity), pose.position, pose.quaternion, physicsClientId=self.client
        )
        self._poses[entity] = pose

    def _load_robot(self) -> int:
        """Load the arm at the origin."""
        path = Path(pybullet_data.getDataPath()) / self.robot.urdf
        flags = 0 if self._visual else pybullet.URDF_IGNORE_VISUAL_SHAPES
        try:
            arm = pybullet.loadURDF(str(path), useFixedBase=True, flags=flags, physicsClientId=self.client)
        except pybullet.error as error:
            raise SceneError(f"{path}: the robot cannot be loaded: {error}") from error
        return int(arm)

    def _load_table(self) -> int:
        """Make the table, its top at z = 0."""
        table = self.scene.table
        half = (table.size[0] / 2, table.size[1] / 2, TABLE_THICKNESS / 2)
        at = (*table.centre, -TABLE_THICKNESS / 2)
        return self._body([_Part(pybullet.GEOM_BOX, half=half)], 0.0, table.color, at)

    def _load_body(self, entity: str, shape: Shape) -> int:
        """Make the body of an object."""
        radius, height = shape.half[0], shape.size[2]
        if shape.kind == "sphere":
            parts = [_Part(pybullet.GEOM_SPHERE, radius=radius)]
        elif shape.kind == "cylinder":
            parts = [_Part(pybullet.GEOM_CYLINDER, radius=radius, height=height)]
        elif shape.kind == "container":
            parts = [_Part(pybullet.GEOM_BOX, half=half, at=at) for at, half in container_boxes(shape)]
        else:
            parts = [_Part(pybullet.GEOM_BOX, half=shape.half)]
        mass = 0.0 if entity in self.scene.fixed else DENSITY * volume(shape)
        return self._body(parts, mass, self.scene.colors.get(entity, "#808080"), PARKING)

    def _body(self, parts: Sequence[_Part], mass: float, color: str, at: Vector) -> int:
        """Make one body of several primitives.

        Raises:
            SceneError: PyBullet refuses a shape.
        """
        kinds = [part.kind for part in parts]
        radii, lengths = [part.radius for part in parts], [part.height for part in parts]
        halves, centres = [part.half for part in parts], [part.at for part in parts]
        shapes = pybullet.createCollisionShapeArray(
            shapeTypes=kinds,
            radii=radii,
            lengths=lengths,
            halfExtents=halves,
            collisionFramePositions=centres,
            physicsClientId=self.client,
        )
        looks = -1
        if self._visual:
            rgba = [int(color[i : i + 2], 16) / 255 for i in (1, 3, 5)] + [1.0]
            looks = pybullet.createVisualShapeArray(
                shapeTypes=kinds,
                radii=radii,
                lengths=lengths,
                halfExtents=halves,
                visualFramePositions=centres,
                rgbaColors=[rgba] * len(kinds),
                physicsClientId=self.client,
            )
        body = -1
        if shapes >= 0 and (looks >= 0 or not self._visual):
            body = pybullet.createMultiBody(mass, shapes, looks, at, physicsClientId=self.client)
        if body < 0:
            raise SceneError(f"PyBullet refuses a body of {parts}")
        return int(body)


def boxes_touch(one: tuple[Vector, Vector], two: tuple[Vector, Vector]) -> bool:
    """Tell whether two bounding boxes, each its lowest and its highest corner, have a point in common."""
    (ax, ay, az), (bx, by, bz) = one
    (cx, cy, cz), (dx, dy, dz) = two
    return ax <= dx and cx <= bx and ay <= dy and cy <= by and az <= dz and cz <= bz


def _around(boxes: Sequence[tuple[Vector, Vector]]) -> tuple[Vector, Vector]:
    """Return the bounding box of bounding boxes, each its lowest and its highest corner."""
    lows, highs = zip(*boxes, strict=True)
    (ax, ay, az), (bx, by, bz) = (map(min, zip(*lows, strict=True)), map(max, zip(*highs, strict=True)))
    return (ax, ay, az), (bx, by, bz)


@contextmanager
def open_simulator(scene: Scene, *, visual: bool = False) -> Iterator[Simulator]:
    """Open a simulator without a window, and close it afterwards; `visual` loads what pictures need."""
    with silenced(STDOUT):
        client = pybullet.connect(pybullet.DIRECT)
    if client < 0:
        raise SceneError("PyBullet cannot open a simulator: too many are open in this process")
    try:
        with silenced(STDOUT):
            simulator = Simulator(scene, client, visual)
        yield simulator
    finally:
        pybullet.disconnect(physicsClientId=client)
