"""Whether the friction of two pads bears the torque of an object that is held beside its centre of mass."""

from __future__ import annotations

import math

from prag_asp.physics.predicates.gripper import GRAVITY, pad_friction
from prag_asp.physics.situation import Situation
from prag_asp.scene.geometry import centre_of_mass, rotate
from prag_asp.scene.solids import weight


def grip_load(situation: Situation, entity: str, robot: str) -> float:
    """Return the load of a grip as a share of what its friction bears; above 1 the object slips or turns.

    Gravity pulls at the centre of mass, which turns the object about the axis through both pads. With a uniform
    pressure each pad bears the force mu F, or the torque mu F r with the mean distance r of its points from its middle.
    Both together follow an ellipse (Howe and Cutkosky, "Practical force-motion models for sliding manipulation", 1996).
    """
    scene, gripper, tool = situation.scene, situation.robot(robot), situation.tool(robot)
    along_x, _, along_z = gripper.finger_boxes[0].size
    most = 2 * pad_friction(scene, entity) * gripper.grip_force
    force = GRAVITY * weight(scene, entity)
    centre = centre_of_mass(situation.shape(entity), situation.pose(entity))
    lever = [a - b for a, b in zip(centre, tool.position, strict=True)]
    axis = rotate(tool.quaternion, (0.0, 1.0, 0.0))
    torque = force * abs(lever[0] * axis[1] - lever[1] * axis[0])
    return math.hypot(force / most, torque / (most * mean_radius(along_x, along_z)))


def mean_radius(a: float, b: float) -> float:
    """Return the mean distance of the points of a rectangle from its middle, for sides in metres."""
    diagonal = math.hypot(a, b)
    ends = a * a / (2 * b) * math.log((b + diagonal) / a) + b * b / (2 * a) * math.log((a + diagonal) / b)
    return (diagonal + ends) / 6
