"""A kinematic PyBullet world with the robots, the table and one body for each object of the scene.

Bodies are made once and reused, because making and removing them leaks memory. Bodies that a task does not use are
parked, each at a separate place. PyBullet does not report unknown bodies or poses that are not finite, so both are
checked here.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from contextlib import contextmanager

from prag_asp.errors import SceneError
from prag_asp.physics.bullet import STDOUT, mute_output, pybullet
from prag_asp.physics.witness import Moment
from prag_asp.physics.world.bodies import body_pose, make_body, make_table, parking_place, put_body, show_zone
from prag_asp.physics.world.furniture_bodies import set_opening
from prag_asp.physics.world.simulated_arm import SimulatedArm
from prag_asp.scene.geometry import Pose, finite
from prag_asp.scene.robots import Joints, Robot, robot_of
from prag_asp.scene.scene import Scene

COLLISION = -0.0015
"""The distance in metres below which bodies collide: a penetration of more than 1.5 mm."""

NOTHING_OPEN: Mapping[str, float] = {}
CONTACT_BREAKING = 0.005
"""The distance in metres at which contacts break.

With PyBullet's default of 20 mm, contact points keep outdated normals after a held object has been rotated; with 2 mm,
a standing can sinks by up to 5 mm into its support. All worlds of a process share this number.
"""


class Simulator:
    """A PyBullet client and its bodies; `open_simulator` creates one, and closes it afterwards."""

    def __init__(self, scene: Scene, client: int, visual: bool):
        self.scene = scene
        self.client = client
        start_world(client)
        self.arms = {name: SimulatedArm(client, robot_of(scene, name), visual) for name in scene.robots}
        self.acting = next(iter(self.arms))
        self.table = make_table(client, scene, visual=visual)
        self._pool = {
            (entity, each): make_body(
                client, scene.with_shapes({entity: each}), entity, parking_place(0), visual=visual
            )
            for entity, shape in scene.shapes.items()
            if shape.traits.body
            for each in scene.ranges.get(entity, (shape,))
        }
        for entity, shape in scene.shapes.items() if visual else ():
            if shape.kind == "zone":
                show_zone(client, scene, entity)
        self.bodies = self._chosen()
        self._poses: dict[str, Pose] = {}
        self._openings: dict[str, float] = {}
        for i, body in enumerate(self._pool.values()):
            move(client, body, Pose(parking_place(i)))

    def use(self, scene: Scene) -> None:
        """Switch to a scene that differs from the current one only in the sizes of its bodies.

        Raises:
            SceneError: a size is not in its range.
        """
        if scene is self.scene:
            return
        for entity in list(self._poses):
            self._park(entity)
        self.scene = scene
        self.bodies = self._chosen()

    def place(self, poses: Mapping[str, Pose], openings: Mapping[str, float] = NOTHING_OPEN) -> None:
        """Move objects to poses, and park all others; `openings` of furniture are in metres or radians.

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
            current = self._poses.get(entity)
            if current is not pose and current != pose:
                if not finite(pose):
                    raise SceneError(f"{entity} has the pose {pose}, which is not a finite position and rotation")
                put_body(self.client, self.scene, entity, self.body(entity), pose)
                self._poses[entity] = pose
        for entity in [entity for entity in self._poses if entity not in poses]:
            self._park(entity)

    @property
    def robot(self) -> Robot:
        """The acting robot."""
        return self.arm.robot

    @property
    def arm(self) -> SimulatedArm:
        """The acting arm."""
        return self.arms[self.acting]

    def turn_to(self, robot: str) -> None:
        """Make another robot the acting robot."""
        self.acting = robot

    def pose_arm(self, joints: Joints, width: float) -> None:
        """Set the seven joint angles of the acting arm in radians, and the opening of its gripper in metres.

        Raises:
            SceneError: a number is not finite, or there are not seven joints.
        """
        self.arm.pose(joints, width)

    def show(self, moment: Moment) -> None:
        """Show a moment by moving all objects and arms."""
        self.place(moment.poses, moment.openings)
        for name, arm in moment.arms.items():
            self.arms[name].pose(arm.joints, arm.width)

    def overlap(self, one: int, two: int) -> float:
        """Return the negated penetration depth of two bodies in metres, or 0 if they are apart."""
        points = pybullet.getClosestPoints(one, two, 0.0, physicsClientId=self.client)
        return min((point[8] for point in points), default=0.0)

    def flange(self) -> Pose:
        """Return the pose of the acting arm's flange, which the simulator computes by forward kinematics."""
        return self.arm.flange()

    def read(self, entity: str) -> Pose:
        """Return the pose of an object in the simulator.

        Raises:
            SceneError: the entity has no body.
        """
        return body_pose(self.client, self.scene, entity, self.body(entity))

    def body(self, entity: str) -> int:
        """Return the id of an object's body.

        Raises:
            SceneError: the entity has no body.
        """
        if entity not in self.bodies:
            raise SceneError(f"{entity} has no body; give its class a shape under [scene.shapes]")
        return self.bodies[entity]

    def _park(self, entity: str) -> None:
        """Move a body to its parking place."""
        i = list(self._pool).index((entity, self.scene.shapes[entity]))
        move(self.client, self.bodies[entity], Pose(parking_place(i)))
        del self._poses[entity]

    def _chosen(self) -> dict[str, int]:
        """Return the body of each object in its current size."""
        shapes, objects = self.scene.shapes, dict.fromkeys(entity for entity, _ in self._pool)
        missing = [entity for entity in objects if (entity, shapes[entity]) not in self._pool]
        if missing:
            raise SceneError(f"{missing[0]} has no body of the size {shapes[missing[0]].size}; open another simulator")
        return {entity: self._pool[entity, shapes[entity]] for entity in objects}


def start_world(client: int) -> None:
    """Reset the world of a client: empty, with gravity, and deterministic."""
    pybullet.resetSimulation(physicsClientId=client)
    pybullet.setPhysicsEngineParameter(
        deterministicOverlappingPairs=1, contactBreakingThreshold=CONTACT_BREAKING, physicsClientId=client
    )
    pybullet.setGravity(0, 0, -9.81, physicsClientId=client)


def move(client: int, body: int, pose: Pose) -> None:
    """Move a body; the pose is that of its inertial frame."""
    pybullet.resetBasePositionAndOrientation(body, pose.position, pose.quaternion, physicsClientId=client)


def read_pose(client: int, body: int) -> Pose:
    """Return the pose of a body's inertial frame."""
    return Pose(*pybullet.getBasePositionAndOrientation(body, physicsClientId=client))


@contextmanager
def open_client() -> Iterator[int]:
    """Connect to PyBullet without a window, and disconnect afterwards.

    Raises:
        SceneError: this process has too many open clients.
    """
    with mute_output(STDOUT):
        client = pybullet.connect(pybullet.DIRECT)
    if client < 0:
        raise SceneError("PyBullet cannot open a simulator: too many are open in this process")
    try:
        yield client
    finally:
        pybullet.disconnect(physicsClientId=client)


@contextmanager
def open_simulator(scene: Scene, *, visual: bool = False) -> Iterator[Simulator]:
    """Open a simulator without a window, and close it afterwards; `visual` adds the visual shapes for pictures."""
    with open_client() as client:
        with mute_output(STDOUT):
            simulator = Simulator(scene, client, visual)
        yield simulator
