"""Compute whether the friction of two pads bears the weight of a body, and its torque about an off-centre grip."""

from __future__ import annotations

import math

from prag_asp.physics.grasps.antipodal import Grasp
from prag_asp.physics.grasps.body_grasps import body_grasps, lever
from prag_asp.physics.grasps.pads import ParallelGripper
from prag_asp.physics.grasps.tilting import grip_tilting
from prag_asp.physics.predicates.grip_geometry import contact_at
from prag_asp.physics.predicates.predicate import words
from prag_asp.physics.situation import Situation
from prag_asp.scene.geometry import centre_of_mass, compose, invert, rotate
from prag_asp.scene.robots import robot_of
from prag_asp.scene.scene import Scene
from prag_asp.scene.solids import weight

FINGER_FRICTION = 1.4
"""The friction coefficient of the rubber pads, which PyBullet multiplies by that of the object."""

GRAVITY = 9.81
"""The acceleration of gravity in m/s²."""

LIGHTLY = 50.0
"""The largest force of a finger on a body with a model, as a multiple of the body's weight.

If fingers squeeze a body much harder, PyBullet's solver does not keep them out of it: with 12 N, they penetrate the
whole wall of an 8 g paper cup, but not at all with 4 N. With this force, friction bears the torque of a lever arm of
about 15 cm.
"""

SLIPS = 1.05
"""The factor by which a load has to exceed the static friction for a body to slip or turn in the gripper.

The robot also accelerates the object, so it may drop lighter bodies as well; a proof needs this margin.
"""


def grasps_in_body(situation: Situation, entity: str, robot: str) -> tuple[Grasp, ...]:
    """Return the grasps of a body with a model, in the body's frame, best first."""
    gripper = ParallelGripper.of(situation.robot(robot))
    return body_grasps(situation.shape(entity), gripper, pad_friction(situation.scene, entity))


def bearable(scene: Scene, entity: str, robot: str) -> float:
    """Return the largest mass, in kilograms, of a body of a given material that a robot's fingers can hold by friction.

    By Coulomb's law, the mass is 2 mu F / g, where F is the force of a finger and mu is the product of the two friction
    coefficients, which is how PyBullet combines them.
    """
    return 2 * pad_friction(scene, entity) * robot_of(scene, robot).grip_force / GRAVITY


def pad_friction(scene: Scene, entity: str) -> float:
    """Return the coefficient of friction between the pads and a body, as PyBullet combines it."""
    return FINGER_FRICTION * scene.material(entity).friction


def finger_force(scene: Scene, entity: str | None, robot: str) -> float:
    """Return the force in newtons with which each finger of a robot presses on a held body.

    The force on a light body with a model is only `LIGHTLY` times the weight of the body; friction still bears a
    hundred times the weight.
    """
    most = robot_of(scene, robot).grip_force
    if entity is None or scene.shapes[entity].model is None:
        return most
    return min(most, LIGHTLY * GRAVITY * weight(scene, entity))


def slips(scene: Scene, entity: str, robot: str) -> str | None:
    """Return the reason, in words, why a body slips out of a gripper that lifts it, or None if this is not proved."""
    heavy, most = weight(scene, entity), bearable(scene, entity, robot)
    if heavy > SLIPS * most:
        lifts = f"{gripper_words(scene, robot)} lifts {most:.3g} kg by its friction"
        return f"{words(entity)} weighs {heavy:.3g} kg, and {lifts}"
    return None


def gripper_words(scene: Scene, robot: str) -> str:
    """Return the gripper's name for use in a sentence."""
    return f"the {words(robot)} gripper" if len(scene.robots) > 1 else "the gripper"


def grip_load(scene: Scene, entity: str, robot: str, lever_arm: float, radius: float) -> float:
    """Return the load of a grip as a share of the load that friction bears; above 1, the body slips or turns.

    Gravity pulls at the centre of mass, `lever_arm` metres from the axis through both pads, and turns the body about
    that axis. With uniform pressure, each pad bears the force mu F, or the torque mu F r, where r (`radius`, in metres)
    is the mean distance of the pad's points from its centre. Combinations of force and torque are limited by an ellipse
    (Howe and Cutkosky, "Practical force-motion models for sliding manipulation", 1996).
    """
    most = 2 * pad_friction(scene, entity) * robot_of(scene, robot).grip_force
    force = GRAVITY * weight(scene, entity)
    return math.hypot(force / most, force * lever_arm / (most * radius)) if radius > 0.0 else math.inf


def held_load(situation: Situation, entity: str, robot: str) -> float:
    """Return the `grip_load` of a body that a gripper holds in the air, or 0 if there is nothing between the pads.

    For a body with a model, the load is at least the torque that tilts the body out of the pads, as a share of the
    bearable torque. Pads touch a primitive with their whole area, but they may touch a body with a model with only a
    part of it. The radius of gyration of that part then replaces the mean distance, which is up to 7 % smaller for a
    rectangle like a pad.
    """
    shape, tool = situation.shape(entity), situation.tool(robot)
    if shape.model is not None:
        contact = contact_at(situation, entity, robot)
        if contact is None:
            return 0.0
        place, friction = compose(invert(situation.pose(entity)), tool), pad_friction(situation.scene, entity)
        twisting = grip_load(situation.scene, entity, robot, lever(shape, place, contact), contact.radius)
        press = GRAVITY * weight(situation.scene, entity) / finger_force(situation.scene, entity, robot)
        tilting = grip_tilting(shape, ParallelGripper.of(situation.robot(robot)), friction, place).total * press
        return max(twisting, tilting)
    along_x, _, along_z = situation.robot(robot).finger_boxes[0].size
    centre = centre_of_mass(shape, situation.pose(entity))
    x, y, _ = (a - b for a, b in zip(centre, tool.position, strict=True))
    axis_x, axis_y, _ = rotate(tool.quaternion, (0.0, 1.0, 0.0))
    return grip_load(situation.scene, entity, robot, abs(x * axis_y - y * axis_x), mean_radius(along_x, along_z))


def mean_radius(a: float, b: float) -> float:
    """Return the mean distance from the centre of a rectangle with sides `a` and `b` to its points, all in metres."""
    diagonal = math.hypot(a, b)
    ends = a * a / (2 * b) * math.log((b + diagonal) / a) + b * b / (2 * a) * math.log((a + diagonal) / b)
    return (diagonal + ends) / 6
