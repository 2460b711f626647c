"""Check that the numbers in a witness are complete, finite, and within the limits of the robots."""

from __future__ import annotations

import math
from collections.abc import Iterator

from prag_asp.physics.checks.furniture_motion import opening_problems
from prag_asp.physics.symbolic_facts import PhysicalTask
from prag_asp.physics.witness import Moment, Witness
from prag_asp.physics.world.simulator import Simulator
from prag_asp.scene.geometry import Pose, finite
from prag_asp.wording import plural

LIMIT_TOLERANCE = 1e-9


def count_mismatch(witness: Witness, actions: int) -> str | None:
    """Return a mismatch between the numbers of states or motions of a witness and of a task, or None if they agree."""
    for name, count, expected in (
        ("motion", len(witness.motions), actions),
        ("state", len(witness.moments), actions + 1),
    ):
        if count != expected:
            return f"the witness has {plural(count, name)}, the task {plural(actions, 'action')}"
    return None


def broken_numbers(
    moment: Moment, physical: PhysicalTask, simulator: Simulator, tolerance: float = LIMIT_TOLERANCE
) -> Iterator[str]:
    """Yield missing objects, numbers that are not finite, and violated limits of the robots.

    `tolerance` applies to joint limits in radians, and to gripper openings in metres.
    """
    for entity in physical.objects:
        if entity not in moment.poses:
            yield f"{entity} has no pose"
        elif not finite(moment.poses[entity]):
            yield f"the pose of {entity} is not a finite position and rotation"
    yield from opening_problems(moment, physical, simulator.scene)
    for entity in moment.poses:
        if entity not in simulator.bodies:
            yield f"{entity} is not in the scene"
    if sorted(moment.arms) != sorted(simulator.arms):
        has, expected = ", ".join(moment.arms) or "none", ", ".join(simulator.arms)
        yield f"it has the arms of {has}; the scene has those of {expected}"
        return
    for name, arm in moment.arms.items():
        yield from broken_arm(name, arm.joints, arm.width, simulator, tolerance)
        if (arm.held is None) != (arm.grasp is None):
            yield "an arm has a held object and a grasp, or neither"
        elif arm.held is not None and (arm.held not in moment.poses or not finite(arm.grasp or Pose((0, 0, 0)))):
            yield f"the grasp of {arm.held} is not a finite position and rotation"


def broken_arm(
    name: str, joints: tuple[float, ...], width: float, simulator: Simulator, tolerance: float = LIMIT_TOLERANCE
) -> Iterator[str]:
    """Yield joint angles and openings that are impossible for a robot."""
    if name not in simulator.arms:
        yield f"there is no robot {name}"
        return
    robot = simulator.arms[name].robot
    if len(joints) != len(robot.lower) or not all(map(math.isfinite, (*joints, width))):
        yield "the arm needs seven finite joint angles and a finite opening"
    elif not robot.within_limits(joints, tolerance):
        yield f"the joint angles {tuple(round(angle, 4) for angle in joints)} are beyond the limits"
    elif not -tolerance <= width <= robot.opening + tolerance:
        yield f"the gripper cannot open {width:.4f} m"
