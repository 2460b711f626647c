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

from prag_asp.domain.scene import Scene
from prag_asp.errors import SceneError
from prag_asp.physics.bodies import make_body, make_table, parking_place
from prag_asp.physics.bullet import pybullet, pybullet_data
from prag_asp.physics.furniture import set_opening
from prag_asp.physics.geometry import Pose, Vector, finite
from prag_asp.physics.robot import ROBOTS, Joints, Robot
from prag_asp.physics.silence import STDOUT, silenced

COLLISION = -0.0015
"""Bodies collide where they are closer than this, in metres: deeper than 1.5 mm in each other."""

REMEMBERED = 64
NOTHING_OPEN: Mapping[str, float] = {}
CONTACT_BREAKING = 0.005
"""Metres; with PyBullet's 20 mm, points of contact keep normals from before a held object was turned, and with 2 mm,
a can that stands still sinks up to 5 mm into what is below.

It is one number for all worlds of a process.
"""


class Simulator:
    """One PyBullet client and the bodies in it; use `open_simulator`, which closes it."""

    def __init__(self, scene: Scene, client: int, visual: bool):
        self.scene = scene
        self.client = client
        self.robot: Robot = ROBOTS[scene.robot]
        start_world(client)
        self.arm = load_robot(client, self.robot, visual=visual)
        self.table = make_table(client, scene, visual=visual)
        self._pool = {
            (entity, each): make_body(
                client, scene.with_shapes({entity: each}), entity, parking_place(0), visual=visual
            )
            for entity, shape in scene.shapes.items()
            if shape.kind not in ("robot", "table")
            for each in scene.ranges.get(entity, (shape,))
        }
        self.bodies = self._chosen()
        self._poses: dict[str, Pose] = {}
        self._openings: dict[str, float] = {}
        self._trunk, self._wrist = (sorted(set(links)) for links in zip(*self.robot.self_pairs, strict=True))
        self._link_boxes: list[tuple[Vector, Vector]] = []
        self._arm_at: tuple[Joints, float] | None = None
        self._joints_at: Joints = ()
        self._self_overlaps: dict[Joints, float] = {}
        self._joints = [*self.robot.arm_links, *self.robot.finger_joints]
        for i, body in enumerate(self._pool.values()):
            self._put(body, Pose(parking_place(i)))

    def use(self, scene: Scene) -> None:
        """Take the bodies of a scene that has other sizes of the ranges of this one.

        Raises:
            SceneError: a size is none of theirs.
        """
        if scene is self.scene:
            return
        for entity in list(self._poses):
            self._park(entity)
        self.scene = scene
        self.bodies = self._chosen()

    def place(self, poses: Mapping[str, Pose], openings: Mapping[str, float] = NOTHING_OPEN) -> None:
        """Put objects at poses, and park all others; `openings` of furniture are metres or radians.

        Raises:
            SceneError: an object has no body, or its pose or opening is not finite.
        """
        for entity, opening in openings.items():
            if self._openings.get(entity) != opening:
                if not math.isfinite(opening):
                    raise SceneError(f"{entity} has the opening {opening}, which is not a finite number")
                set_opening(self.client, self.body(entity), opening)
                self._openings[entity] = opening
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
        """Return the pose of the flange as the simulator's own kinematics has it."""
        return read_flange(self.client, self.arm, self.robot)

    def read(self, entity: str) -> Pose:
        """Return where the simulator has an object.

        Raises:
            SceneError: it has no body.
        """
        return read_pose(self.client, self.body(entity))

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
        i = list(self._pool).index((entity, self.scene.shapes[entity]))
        self._put(self.bodies[entity], Pose(parking_place(i)))
        del self._poses[entity]

    def _move(self, entity: str, pose: Pose) -> None:
        """Put an object at a pose."""
        self._put(self.body(entity), pose)
        self._poses[entity] = pose

    def _put(self, body: int, pose: Pose) -> None:
        """Put one body at a pose."""
        pybullet.resetBasePositionAndOrientation(body, pose.position, pose.quaternion, physicsClientId=self.client)

    def _chosen(self) -> dict[str, int]:
        """Return the body of each object, of the size that the scene has now.

        Raises:
            SceneError: there is none of that size.
        """
        shapes, objects = self.scene.shapes, dict.fromkeys(entity for entity, _ in self._pool)
        missing = [entity for entity in objects if (entity, shapes[entity]) not in self._pool]
        if missing:
            raise SceneError(f"{missing[0]} has no body of the size {shapes[missing[0]].size}; open another simulator")
        return {entity: self._pool[entity, shapes[entity]] for entity in objects}


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


def load_robot(client: int, robot: Robot, *, visual: bool = False) -> int:
    """Load an arm at the origin.

    Raises:
        SceneError: PyBullet cannot load it.
    """
    path = Path(pybullet_data.getDataPath()) / robot.urdf
    flags = 0 if visual else pybullet.URDF_IGNORE_VISUAL_SHAPES
    try:
        return int(pybullet.loadURDF(str(path), useFixedBase=True, flags=flags, physicsClientId=client))
    except pybullet.error as error:
        raise SceneError(f"{path}: the robot cannot be loaded: {error}") from error


def start_world(client: int) -> None:
    """Make the world of a client empty, with gravity, and repeatable."""
    pybullet.resetSimulation(physicsClientId=client)
    pybullet.setPhysicsEngineParameter(
        deterministicOverlappingPairs=1, contactBreakingThreshold=CONTACT_BREAKING, physicsClientId=client
    )
    pybullet.setGravity(0, 0, -9.81, physicsClientId=client)


def read_pose(client: int, body: int) -> Pose:
    """Return where a body is."""
    position, quaternion = pybullet.getBasePositionAndOrientation(body, physicsClientId=client)
    return Pose(tuple(position), tuple(quaternion))


def read_flange(client: int, arm: int, robot: Robot) -> Pose:
    """Return the pose of an arm's flange as the simulator's own kinematics has it.

    Its quaternion is off unit length by up to 1e-7, for the URDF's angles are rounded; it is made one.
    """
    state = pybullet.getLinkState(arm, robot.flange_link, computeForwardKinematics=True, physicsClientId=client)
    length = math.hypot(*state[5])
    x, y, z, w = (part / length for part in state[5])
    return Pose(tuple(state[4]), (x, y, z, w))


@contextmanager
def open_client() -> Iterator[int]:
    """Connect to a PyBullet without a window, and disconnect afterwards.

    Raises:
        SceneError: too many are open in this process.
    """
    with silenced(STDOUT):
        client = pybullet.connect(pybullet.DIRECT)
    if client < 0:
        raise SceneError("PyBullet cannot open a simulator: too many are open in this process")
    try:
        yield client
    finally:
        pybullet.disconnect(physicsClientId=client)


@contextmanager
def open_simulator(scene: Scene, *, visual: bool = False) -> Iterator[Simulator]:
    """Open a simulator without a window, and close it afterwards; `visual` loads what pictures need."""
    with open_client() as client:
        with silenced(STDOUT):
            simulator = Simulator(scene, client, visual)
        yield simulator
