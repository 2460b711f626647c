"""Furniture as PyBullet bodies with one joint."""

from __future__ import annotations

from prag_asp.errors import SceneError
from prag_asp.physics.bullet import pybullet
from prag_asp.physics.world.primitives import open_shapes
from prag_asp.scene.boxes import Vector
from prag_asp.scene.colours import rgb
from prag_asp.scene.furniture import mechanism
from prag_asp.scene.scene import Material, Shape
from prag_asp.scene.solids import boxes, volume

JOINT = 0
UPRIGHT = (0.0, 0.0, 0.0, 1.0)
SLIDE_DRAG, HINGE_DRAG = 2.0, 0.2
"""The friction of a joint, in newtons for a drawer and in newton metres for a door."""

LIGHTER = 0.25


def make_furniture(client: int, shape: Shape, material: Material, at: Vector, color: str | None) -> int:
    """Make closed furniture; without a colour, it is invisible.

    Raises:
        SceneError: PyBullet refuses the furniture's shape.
    """
    parts = mechanism(shape)
    weight = material.density * volume(boxes(parts.part))
    body_shapes = open_shapes(boxes(parts.body), client, color)
    part_shapes = open_shapes(boxes(parts.part), client, color and lighter(color))
    with body_shapes as (solid, looks), part_shapes as (part, part_looks):
        body = pybullet.createMultiBody(
            0.0,
            solid,
            looks,
            at,
            linkMasses=[weight],
            linkCollisionShapeIndices=[part],
            linkVisualShapeIndices=[part_looks],
            linkPositions=[parts.joint],
            linkOrientations=[UPRIGHT],
            linkInertialFramePositions=[(0.0, 0.0, 0.0)],
            linkInertialFrameOrientations=[UPRIGHT],
            linkParentIndices=[0],
            linkJointTypes=[pybullet.JOINT_PRISMATIC if parts.slides else pybullet.JOINT_REVOLUTE],
            linkJointAxis=[parts.axis],
            physicsClientId=client,
        )
    if body < 0:
        raise SceneError(f"PyBullet refuses furniture of the size {shape.size}")
    for link in (-1, JOINT):
        pybullet.changeDynamics(body, link, lateralFriction=material.friction, physicsClientId=client)
    pybullet.changeDynamics(body, JOINT, jointLowerLimit=0.0, jointUpperLimit=parts.limit, physicsClientId=client)
    pybullet.setJointMotorControl2(
        body,
        JOINT,
        pybullet.VELOCITY_CONTROL,
        targetVelocity=0.0,
        force=SLIDE_DRAG if parts.slides else HINGE_DRAG,
        physicsClientId=client,
    )
    return int(body)


def set_opening(client: int, body: int, opening: float) -> None:
    """Set the opening of furniture, in metres or radians."""
    pybullet.resetJointState(body, JOINT, opening, physicsClientId=client)


def read_opening(client: int, body: int) -> float:
    """Return the opening of furniture, in metres or radians."""
    return float(pybullet.getJointState(body, JOINT, physicsClientId=client)[0])


def lighter(color: str) -> str:
    """Return a lighter shade of a colour."""
    return "#" + "".join(f"{round(part + LIGHTER * (255 - part)):02x}" for part in rgb(color))
