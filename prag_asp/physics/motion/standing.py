"""The situation that the arms of a witness make: one of them acts, the others stand still."""

from __future__ import annotations

from collections.abc import Mapping

from prag_asp.domain.scene import Scene
from prag_asp.physics.geometry import Pose
from prag_asp.physics.robot import robot_of
from prag_asp.physics.robot.kinematics import tool_pose
from prag_asp.physics.situation import Situation, Standing
from prag_asp.physics.verdict import ArmState


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
