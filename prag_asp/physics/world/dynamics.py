"""A dynamic simulation: motors move the arms, and the grippers hold objects by friction alone."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from itertools import combinations
from typing import NamedTuple

from prag_asp.physics.bullet import STDOUT, mute_output, pybullet
from prag_asp.physics.predicates.grip_friction import FINGER_FRICTION, finger_force
from prag_asp.physics.robot.robot_files import robot_file
from prag_asp.physics.witness import ROBOT_PARTS, Arm, Moment
from prag_asp.physics.world.bodies import make_body, make_table, mass_frame, parking_place, put_body
from prag_asp.physics.world.collisions import BASE_LINK
from prag_asp.physics.world.furniture_bodies import JOINT, UPRIGHT, read_opening, set_opening
from prag_asp.physics.world.simulated_arm import load_robot_files, set_joints
from prag_asp.physics.world.simulator import open_client, read_pose, start_world
from prag_asp.physics.world.time_step import TIME_STEP
from prag_asp.scene.geometry import Pose, compose, invert
from prag_asp.scene.robots import Joints, Robot, robot_of
from prag_asp.scene.scene import Scene

SOLVER_ITERATIONS = 200
"""The number of solver iterations. With PyBullet's default of 50, a joint sometimes exceeds its acceleration limit; 200
iterations cost a sixth more time."""

POSITION_GAIN = 0.2
"""The share of a joint's position error that its motor corrects in one step."""

POSITION_GAINS = (POSITION_GAIN,) * 9
"""The gains of seven joints and two fingers."""

RESTING, RESTING_TURN = 0.005, 0.05
"""Speeds below which a body counts as at rest, in m/s and rad/s, because held objects vibrate a little."""

SLEEP_FRAMES = 4
"""The number of consecutive frames at rest after which a body is put to sleep, until a moving body comes close.

PyBullet itself waits for two seconds.
"""

BETWEEN = 0.002
"""The distance in metres from each finger within which a body counts as between the fingers, which close by 1.3 mm in a
step.
"""

FORGETTING = 2
"""The number of steps for which bodies have to be far apart before PyBullet discards their contacts."""

AWAKE, ASLEEP = pybullet.ACTIVATION_STATE_WAKE_UP, pybullet.ACTIVATION_STATE_SLEEP
COUPLING_GAIN, COUPLING_FORCE = 0.5, 500.0
STILL = (0.0,) * 7


class ArmCommand(NamedTuple):
    """Position targets for the motors of an arm: seven joint angles in radians, and the gripper's opening in metres."""

    joints: Joints
    opening: float

    @property
    def motor_targets(self) -> list[float]:
        """The target of each motor: seven joint angles in radians, and the place of each finger in metres."""
        finger = self.opening / 2
        return [*self.joints, finger, finger]


class Pressing(NamedTuple):
    """The contact of two bodies: the sum of their normal forces in newtons, and the depth in metres."""

    force: float
    depth: float


NO_PRESSING = Pressing(0.0, 0.0)


@dataclass(frozen=True)
class LoadedArm:
    """An arm in a simulation: its robot, its body, and the joints of the arm and gripper that motors drive.

    `forces` are the largest forces of these motors, in newton metres, and in newtons for the fingers. `base` is the
    pose of the arm in PyBullet: the pose of the centre of mass of its first link.
    """

    robot: Robot
    body: int
    driven: Sequence[int]
    forces: Sequence[float]
    base: Pose


class Dynamics:
    """A PyBullet client whose world is rebuilt for every task, so that results depend only on the task."""

    def __init__(self, scene: Scene, client: int):
        self.scene = scene
        self.client = client
        self._arms: dict[str, LoadedArm] = {}
        self._bodies: dict[str, int] = {}
        self._furniture: dict[str, int] = {}
        self._from_mass: dict[str, Pose | None] = {}
        self._fixed: dict[str, Pose] = {}
        self._quiet: dict[str, int] = {}
        self._gentle: dict[str, dict[str, float]] = {}
        self._parts: dict[tuple[int, int], int] = {}

    def begin(self, objects: Sequence[str], moment: Moment, scene: Scene | None = None) -> None:
        """Build a world with the given objects and with the arms as at a moment; `scene` may have different sizes.

        Raises:
            SceneError: a robot cannot be loaded, or PyBullet refuses a body.
        """
        self.scene = scene or self.scene
        start_world(self.client)
        pybullet.setPhysicsEngineParameter(
            fixedTimeStep=TIME_STEP, numSolverIterations=SOLVER_ITERATIONS, physicsClientId=self.client
        )
        self._arms = {name: self._load_arm(name) for name in self.scene.robots}
        table = make_table(self.client, self.scene)
        self._bodies = {
            entity: make_body(self.client, self.scene, entity, moment.poses[entity].position) for entity in objects
        }
        self._furniture = {entity: self._bodies[entity] for entity in moment.openings}
        frames = {entity: mass_frame(self.scene, entity) for entity in objects}
        self._from_mass = {entity: None if frame is None else invert(frame) for entity, frame in frames.items()}
        for body in self._bodies.values():
            pybullet.changeDynamics(
                body,
                -1,
                activationState=pybullet.ACTIVATION_STATE_ENABLE_SLEEPING,
                sleepThreshold=RESTING**2 + RESTING_TURN**2,
                physicsClientId=self.client,
            )
        self._place(moment)
        self._parts = self._numbered(table)
        for name, loaded in self._arms.items():
            forces = {entity: finger_force(self.scene, entity, name) for entity in objects}
            most = loaded.robot.grip_force
            self._gentle[name] = forces if min(forces.values(), default=most) < most else {}

    def restore(self, moment: Moment) -> None:
        """Reset the world to a moment, at rest; only held objects are awake.

        From there on, the simulation depends only on the moment, bit for bit. PyBullet caches contacts and their
        forces, so all bodies are first moved far apart for `FORGETTING` steps. The moment must include all objects and
        arms of the world.
        """
        client = self.client
        apart = [*self._bodies.values(), *(arm.body for arm in self._arms.values())]
        for i, body in enumerate(apart):
            pybullet.changeDynamics(body, -1, activationState=AWAKE, physicsClientId=client)
            pybullet.resetBasePositionAndOrientation(body, parking_place(i), UPRIGHT, physicsClientId=client)
        for _ in range(FORGETTING):
            self.step()
        for arm in self._arms.values():
            pybullet.resetBasePositionAndOrientation(arm.body, *arm.base, physicsClientId=client)
        self._place(moment)
        held = moment.held
        for entity, body in self._bodies.items():
            if entity not in held:
                pybullet.changeDynamics(body, -1, activationState=ASLEEP, physicsClientId=client)

    def _place(self, moment: Moment) -> None:
        """Reset the objects, the arms and the furniture to a moment, with zero velocities."""
        for entity, opening in moment.openings.items():
            set_opening(self.client, self._bodies[entity], opening)
        for entity, body in self._bodies.items():
            put_body(self.client, self.scene, entity, body, moment.poses[entity])
        for name, arm in moment.arms.items():
            loaded = self._arms[name]
            set_joints(self.client, loaded.body, loaded.robot, arm.joints, arm.width)
        self._quiet = dict.fromkeys(self._bodies, 0)
        # nothing moves a fixed body in between
        self._fixed = {
            entity: read_pose(self.client, body) for entity, body in self._bodies.items() if entity in self.scene.fixed
        }

    def drive(self, robot: str, command: ArmCommand, speeds: Sequence[float] = STILL) -> None:
        """Set the targets of the motors of an arm for the next step.

        `speeds` are the target speeds of the joints in rad/s. An opening smaller than the width of an object between
        the fingers squeezes it with `finger_force`.
        """
        self._motors(robot, speeds)(targetPositions=command.motor_targets, forces=self._forces(robot))

    def run(self, targets: Mapping[str, Sequence[Sequence[float]]], speeds: Mapping[str, Sequence[float]]) -> None:
        """Simulate one `TIME_STEP` for each of the motor targets of a robot; all robots have equally many.

        `speeds` are the target speeds of the joints in rad/s. Little is computed between the time steps, because
        PyBullet displaces everything else from the caches of the processor.
        """
        client, simulate, gentle = self.client, pybullet.stepSimulation, self._gentle
        motors = [
            (robot, self._motors(robot, speeds[robot]), rows, self._arms[robot].forces)
            for robot, rows in targets.items()
        ]
        for number in range(len(motors[0][2])):
            for robot, motor, rows, most in motors:
                motor(targetPositions=rows[number], forces=self._forces(robot) if gentle[robot] else most)
            simulate(physicsClientId=client)

    def _motors(self, robot: str, speeds: Sequence[float]) -> partial[None]:
        """Return the function of PyBullet that sets the targets and forces of an arm's motors for the next step."""
        arm = self._arms[robot]
        return partial(
            pybullet.setJointMotorControlArray,
            arm.body,
            arm.driven,
            pybullet.POSITION_CONTROL,
            targetVelocities=[*speeds, 0.0, 0.0],
            positionGains=POSITION_GAINS,
            physicsClientId=self.client,
        )

    def _forces(self, robot: str) -> Sequence[float]:
        """Return the largest force of each motor; that of the fingers depends on the bodies between them.

        The unit is newton metres, and newtons for the fingers.
        """
        arm, forces = self._arms[robot], self._gentle[robot]
        if not forces:
            return arm.forces
        most = arm.robot.grip_force
        light = [entity for entity, force in forces.items() if force < most]
        if not any(self._is_between(arm, entity) for entity in light):
            return arm.forces
        squeeze = max(force for entity, force in forces.items() if self._is_between(arm, entity))
        return (*arm.robot.torques, squeeze, squeeze)

    def _is_between(self, arm: LoadedArm, entity: str) -> bool:
        """Return whether both fingers are close to a body."""
        body = self._bodies[entity]
        return all(
            pybullet.getClosestPoints(arm.body, body, BETWEEN, link, physicsClientId=self.client)
            for link in arm.robot.finger_links
        )

    def step(self) -> None:
        """Simulate one `TIME_STEP`."""
        pybullet.stepSimulation(physicsClientId=self.client)

    def arms(self) -> dict[str, Arm]:
        """Return the state of each arm; held objects are unknown."""
        arms = {}
        for name, arm in self._arms.items():
            states = pybullet.getJointStates(arm.body, arm.driven, physicsClientId=self.client)
            *joints, left, right = [state[0] for state in states]
            arms[name] = Arm(tuple(joints), left + right)
        return arms

    def poses(self) -> dict[str, Pose]:
        """Return the poses of the objects."""
        client, fixed, poses = self.client, self._fixed, dict[str, Pose]()
        for entity, from_mass in self._from_mass.items():
            pose = fixed.get(entity)
            if pose is None:
                pose = Pose(*pybullet.getBasePositionAndOrientation(self._bodies[entity], physicsClientId=client))
                pose = pose if from_mass is None else compose(pose, from_mass)
            poses[entity] = pose
        return poses

    def openings(self) -> dict[str, float]:
        """Return the opening of furniture, in metres or radians."""
        return {entity: read_opening(self.client, body) for entity, body in self._furniture.items()}

    def at_rest(self) -> bool:
        """Return whether nothing moves; objects at rest for `SLEEP_FRAMES` consecutive calls are put to sleep."""
        return self.settle() and all(
            abs(state[1]) < RESTING
            for arm in self._arms.values()
            for state in pybullet.getJointStates(arm.body, arm.driven, physicsClientId=self.client)
        )

    def settle(self) -> bool:
        """Return whether no object moves; objects at rest for `SLEEP_FRAMES` consecutive calls are put to sleep."""
        still, client, quiet = True, self.client, self._quiet
        for entity, body in self._bodies.items():
            if entity in self._furniture:
                resting = abs(pybullet.getJointState(body, JOINT, physicsClientId=client)[1]) < RESTING
            elif entity in self._fixed:
                resting = True
            else:
                velocity, spin = pybullet.getBaseVelocity(body, physicsClientId=client)
                resting = math.hypot(*velocity) < RESTING and math.hypot(*spin) < RESTING_TURN
            still = still and resting
            quiet[entity] = quiet[entity] + 1 if resting else 0
            if quiet[entity] == SLEEP_FRAMES:
                pybullet.changeDynamics(body, -1, activationState=ASLEEP, physicsClientId=client)
        return still

    @property
    def parts(self) -> tuple[str, ...]:
        """The names of bodies and links in contacts; the names of the objects come after these."""
        grippers = [f"{part} of {name}" for name in self.scene.robots for part in ROBOT_PARTS]
        return (*grippers, "table")

    def contacts(self) -> Mapping[tuple[int, int], Pressing]:
        """Return the contact of each pair of bodies that press on each other.

        Bodies are numbered: `parts` first, then the objects in the order of `begin`.
        """
        pressing: dict[tuple[int, int], Pressing] = {}
        for point in pybullet.getContactPoints(physicsClientId=self.client):
            force = point[9]
            if force > 0.0:
                one, two = self._parts[point[1], point[3]], self._parts[point[2], point[4]]
                pair = (one, two) if one < two else (two, one)
                before = pressing.get(pair, NO_PRESSING)
                pressing[pair] = Pressing(before.force + force, max(before.depth, -point[8]))
        return pressing

    def _numbered(self, table: int) -> dict[tuple[int, int], int]:
        """Return the number that stands for each body and link in contacts."""
        numbers: dict[tuple[int, int], int] = {}
        first = 0
        for arm in self._arms.values():
            links = range(-1, pybullet.getNumJoints(arm.body, physicsClientId=self.client))
            numbers |= {(arm.body, link): first for link in links}
            numbers |= {(arm.body, link): first + 1 + i for i, link in enumerate(arm.robot.finger_links)}
            first += 1 + len(arm.robot.finger_links)
        numbers[table, -1] = first
        for i, body in enumerate(self._bodies.values()):
            numbers |= {(body, link): first + 1 + i for link in (-1, JOINT)}
        return numbers

    def _load_arm(self, name: str) -> LoadedArm:
        """Load a robot whose links collide only in its `self_pairs`.

        Its fingers have rubber pads, and are coupled as if one motor drove them.
        """
        client, robot = self.client, robot_of(self.scene, name)
        with mute_output(STDOUT):
            body = load_robot_files(client, {"robot.urdf": robot_file(robot)}, robot.base, solid=True)
        pairs = {frozenset(pair) for pair in robot.self_pairs}
        for pair in combinations(range(BASE_LINK, pybullet.getNumJoints(body, physicsClientId=client)), 2):
            if frozenset(pair) not in pairs:
                pybullet.setCollisionFilterPair(body, body, *pair, 0, physicsClientId=client)
        left, right = robot.finger_joints
        ends = ([1, 0, 0], [0, 0, 0], [0, 0, 0])
        gear = pybullet.createConstraint(body, left, body, right, pybullet.JOINT_GEAR, *ends, physicsClientId=client)
        pybullet.changeConstraint(
            gear, gearRatio=-1, erp=COUPLING_GAIN, maxForce=COUPLING_FORCE, physicsClientId=client
        )
        for link in robot.finger_links:
            pybullet.changeDynamics(body, link, lateralFriction=FINGER_FRICTION, physicsClientId=client)
        forces = (*robot.torques, robot.grip_force, robot.grip_force)
        return LoadedArm(robot, body, robot.driven, forces, read_pose(client, body))


@contextmanager
def open_dynamics(scene: Scene) -> Iterator[Dynamics]:
    """Open a dynamic simulation, and close it afterwards.

    Raises:
        SceneError: a robot of the scene cannot be loaded.
    """
    with open_client() as client:
        yield Dynamics(scene, client)
