"""Add collision-free paths of the arm between the waypoints of a witness, so that it contains the whole motion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from prag_asp.physics.motion.route import carry_object, checked_path, grasp_of
from prag_asp.physics.robot.kinematics import tool_pose
from prag_asp.physics.search.furniture_handling import open_furniture
from prag_asp.physics.search.moving import with_riders
from prag_asp.physics.situation import Situation
from prag_asp.physics.symbolic_facts import ActionEffect, PhysicalTask, physical_task
from prag_asp.physics.witness import TRANSIT, Arm, Moment, Waypoint, Witness
from prag_asp.physics.world.simulator import Simulator, open_simulator
from prag_asp.physics.world.time_step import TIME_STEP
from prag_asp.scene.geometry import compose
from prag_asp.scene.robots import robot_of
from prag_asp.scene.scene import Scene
from prag_asp.task import Task


def with_transit(simulator: Simulator, physical: PhysicalTask, witness: Witness) -> Witness | None:
    """Return a witness with the waypoints of collision-free paths added, or None if a path is not found.

    Neither the arm nor its load collides on these paths. Transit waypoints that the witness already has are replaced.
    """
    motions = []
    for k, effect in enumerate(physical.effects):
        own = [waypoint for waypoint in witness.motions[k] if waypoint.name != TRANSIT]
        motion = _motion(simulator, effect, own, witness.moments[k], witness.moments[k + 1])
        if motion is None:
            return None
        motions.append(motion)
    return replace(witness, motions=tuple(motions))


def plan_transit(task: Task, witness: Witness, scene: Scene) -> Witness | None:
    """Return a witness with the waypoints of collision-free paths added, or None if a path is not found.

    Raises:
        SceneError: the task contains an entity that has no shape.
    """
    with open_simulator(scene) as simulator:
        return with_transit(simulator, physical_task(task, scene), witness)


def _motion(
    simulator: Simulator, effect: ActionEffect, own: Sequence[Waypoint], before: Moment, after: Moment
) -> tuple[Waypoint, ...] | None:
    """Return the waypoints of an action with transit waypoints between them, or None if a path is not found."""
    waypoints_so_far: list[Waypoint] = []
    arms, poses, openings = dict(before.arms), before.poses, before.openings
    if (effect.grasps, effect.releases, effect.holds) == (None, None, None):
        poses = after.poses  # bodies that no gripper moves have moved before the arm does
    for waypoint in own:
        robot = waypoint.robot
        grasp = grasp_of(waypoint.held, arms[robot], after.arms[robot])
        situation = Situation(simulator.scene, poses, dict(arms), openings)
        if waypoint.opening is not None:  # the motion of a handle was checked step by step
            opened = open_furniture(situation, str(waypoint.held), waypoint.opening, list(poses))
            poses, openings = opened.poses, opened.openings
        elif waypoint.joints != arms[robot].joints:
            simulator.turn_to(robot)
            arm = carry_object(arms[robot], waypoint.width, waypoint.held, grasp)
            way = checked_path(simulator, situation, arm, waypoint.joints, TIME_STEP)
            if way is None:
                return None
            waypoints_so_far += [Waypoint(TRANSIT, robot, each, waypoint.width, waypoint.held) for each in way]
            if arm.held is not None and grasp is not None:
                tool = tool_pose(robot_of(simulator.scene, robot), waypoint.joints)
                poses = with_riders(situation, arm.held, compose(tool, grasp), situation.poses)
        waypoints_so_far.append(waypoint)
        arms[robot] = Arm(waypoint.joints, waypoint.width, waypoint.held, grasp)
    return tuple(waypoints_so_far)
