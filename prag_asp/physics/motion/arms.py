"""The situation that arms make: one of them acts, the others stand still; and what a gripper holds, and how."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from prag_asp.physics.robot import robot_of
from prag_asp.physics.robot.kinematics import tool_pose
from prag_asp.physics.situation import Situation, Standing
from prag_asp.physics.witness import ArmState
from prag_asp.scene.geometry import Pose
from prag_asp.scene.model import Scene


@dataclass(frozen=True)
class Grip:
    """What a gripper holds and how: the pose of the object in the frame of the tool."""

    entity: str
    pose: Pose


def grip_of(held: str | None, *arms: ArmState) -> Grip | None:
    """Return how the first of some states of an arm that hold an object do so, None where none does."""
    for arm in arms:
        if arm.held is not None and arm.held == held and arm.grasp is not None:
            return Grip(arm.held, arm.grasp)
    return None


def situation_with(
    scene: Scene, poses: Mapping[str, Pose], openings: Mapping[str, float], arms: Mapping[str, ArmState], acting: str
) -> Situation:
    """Return what is to be seen where objects, furniture and arms are somewhere; the arm `acting` is to move."""
    others = {
        name: Standing(arm.joints, tool_pose(robot_of(scene, name), arm.joints), arm.width, arm.held, arm.grasp)
        for name, arm in arms.items()
        if name != acting
    }
    own = arms[acting]
    tool = tool_pose(robot_of(scene, acting), own.joints)
    return Situation(scene, poses, tool, own.width, openings=openings, acting=acting, others=others)
