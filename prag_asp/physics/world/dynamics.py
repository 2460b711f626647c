"""A world with forces: the arm moves by its motors, and the gripper holds by friction alone."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from prag_asp.domain.scene import Scene
from prag_asp.errors import SceneError
from prag_asp.physics.geometry import Pose
from prag_asp.physics.robot import Joints, robot_of
from prag_asp.physics.robot.file import write_robot
from prag_asp.physics.verdict import Moment
from prag_asp.physics.world.bodies import make_body, make_table
from prag_asp.physics.world.bullet import pybullet
from prag_asp.physics.world.furniture import JOINT, read_opening, set_opening
from prag_asp.physics.world.silence import STDOUT, silenced
from prag_asp.physics.world.simulated_arm import load_robot
from prag_asp.physics.world.simulator import open_client, read_pose, start_world

TIME_STEP = 1 / 120
"""Seconds; half of it doubles the costs and does not raise the share of tasks that succeed."""

POSITION_GAIN = 0.2
"""What share of a joint's error its motor corrects in one step."""

GRIP_FORCE = 10.0
"""Newtons of each finger: with a coefficient of friction of 1 the two carry 2 kg."""

FINGER_FRICTION = 1.4
"""Of rubber: with the friction of the objects, 0.7, the coefficient is 1."""

SLEEP = 1e-5
"""A body that for two seconds moves with less than the root of this, 3 mm/s, is not simulated until it is touched."""

COUPLING_GAIN, COUPLING_FORCE = 0.5, 500.0
PARTS = ("arm", "left finger", "right finger", "table")


class Dynamics:
    """One PyBullet client, its world built anew for every task, on which alone the results then depend."""

    def __init__(self, scene: Scene, client: int, urdf: Path):
        self.scene = scene
        self.client = client
        self.robot = robot_of(scene)
        self._urdf = urdf
        self._driven = [*self.robot.arm_links, *self.robot.finger_joints]
        self._bodies: dict[str, int] = {}
        self._furniture: dict[str, int] = {}
        self._arm = self._table = -1

    def begin(self, objects: Sequence[str], moment: Moment, scene: Scene | None = None) -> None:
        """Build a world with some objects and the arm as they are at a moment; `scene` may have other sizes.

        Raises:
            SceneError: the robot cannot be loaded, or PyBullet refuses a body.
        """
        self.scene = scene or self.scene
        start_world(self.client)
        pybullet.setTimeStep(TIME_STEP, physicsClientId=self.client)
        self._arm = self._load_arm()
        self._table = make_table(self.client, self.scene)
        self._bodies = {
            entity: make_body(self.client, self.scene, entity, moment.poses[entity].position) for entity in objects
        }
        self._furniture = {entity: self._bodies[entity] for entity in moment.openings}
        for entity, opening in moment.openings.items():
            set_opening(self.client, self._bodies[entity], opening)
        for entity, body in self._bodies.items():
            pybullet.changeDynamics(
                body,
                -1,
                activationState=pybullet.ACTIVATION_STATE_ENABLE_SLEEPING,
                sleepThreshold=SLEEP,
                physicsClientId=self.client,
            )
            pybullet.resetBasePositionAndOrientation(body, *moment.poses[entity], physicsClientId=self.client)
        values = [[angle] for angle in (*moment.joints, moment.width / 2, moment.width / 2)]
        pybullet.resetJointStatesMultiDof(self._arm, self._driven, values, physicsClientId=self.client)

    def step(self, joints: Sequence[float], speeds: Sequence[float], opening: float) -> None:
        """Let one `TIME_STEP` pass, with motors that drive to joint angles in radians and an opening in metres.

        `speeds` are those that the joints should have there, in radians a second. An opening less than that of
        an object between the fingers squeezes it.
        """
        pybullet.setJointMotorControlArray(
            self._arm,
            self._driven,
            pybullet.POSITION_CONTROL,
            targetPositions=[*joints, opening / 2, opening / 2],
            targetVelocities=[*speeds, 0.0, 0.0],
            forces=[*self.robot.torques, GRIP_FORCE, GRIP_FORCE],
            positionGains=[POSITION_GAIN] * len(self._driven),
            physicsClientId=self.client,
        )
        pybullet.stepSimulation(physicsClientId=self.client)

    def arm(self) -> tuple[Joints, float]:
        """Return the joint angles of the arm in radians, and how far the gripper is open in metres."""
        states = pybullet.getJointStates(self._arm, self._driven, physicsClientId=self.client)
        *joints, left, right = (state[0] for state in states)
        return tuple(joints), left + right

    def poses(self) -> dict[str, Pose]:
        """Return where the objects are."""
        return {entity: read_pose(self.client, body) for entity, body in self._bodies.items()}

    def openings(self) -> dict[str, float]:
        """Return how far furniture is open, in metres or radians."""
        return {entity: read_opening(self.client, body) for entity, body in self._furniture.items()}

    def contacts(self) -> Mapping[tuple[int, int], float]:
        """Return the normal force in newtons between bodies that press on each other.

        Bodies are numbered: `PARTS` first, then the objects in the order in which the world was begun with.
        """
        parts = {(self._table, -1): PARTS.index("table")}
        links = ((body, i) for i, body in enumerate(self._bodies.values()))
        parts |= {(body, link): len(PARTS) + i for body, i in links for link in (-1, JOINT)}
        parts |= {(self._arm, link): 1 + i for i, link in enumerate(self.robot.finger_links)}
        forces: dict[tuple[int, int], float] = {}
        for point in pybullet.getContactPoints(physicsClientId=self.client):
            force = point[9]
            if force > 0.0:
                one, two = parts.get(point[1:4:2], 0), parts.get(point[2:5:2], 0)
                pair = (one, two) if one < two else (two, one)
                forces[pair] = forces.get(pair, 0.0) + force
        return dict(sorted(forces.items()))

    def _load_arm(self) -> int:
        """Load the robot, its fingers coupled, as the one motor of the real hand does, and with rubber pads."""
        client = self.client
        with silenced(STDOUT):
            arm = load_robot(client, self._urdf, self.robot.base)
        left, right = self.robot.finger_joints
        ends = ([1, 0, 0], [0, 0, 0], [0, 0, 0])
        gear = pybullet.createConstraint(arm, left, arm, right, pybullet.JOINT_GEAR, *ends, physicsClientId=client)
        pybullet.changeConstraint(
            gear, gearRatio=-1, erp=COUPLING_GAIN, maxForce=COUPLING_FORCE, physicsClientId=client
        )
        for link in self.robot.finger_links:
            pybullet.changeDynamics(arm, link, lateralFriction=FINGER_FRICTION, physicsClientId=client)
        return arm


@contextmanager
def open_dynamics(scene: Scene) -> Iterator[Dynamics]:
    """Open a world with forces, and close it afterwards.

    Raises:
        SceneError: the robot of the scene cannot be loaded, or there are several.
    """
    if len(scene.mounts) > 1:
        raise SceneError(
            f"demonstrations are performed by one robot; this scene has {', '.join(scene.mounts)}; use --tier transit"
        )
    with TemporaryDirectory(prefix="prag_asp_") as folder, open_client() as client:
        yield Dynamics(scene, client, write_robot(robot_of(scene), Path(folder)))
