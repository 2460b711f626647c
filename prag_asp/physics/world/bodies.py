"""Make the table and the objects of a scene as PyBullet bodies, and move them."""

from __future__ import annotations

from collections.abc import Sequence

from prag_asp.errors import SceneError
from prag_asp.physics.bullet import pybullet
from prag_asp.physics.situation import TABLE_THICKNESS
from prag_asp.physics.world.furniture_bodies import make_furniture
from prag_asp.physics.world.primitives import open_shapes
from prag_asp.scene.boxes import Vector
from prag_asp.scene.colours import rgb
from prag_asp.scene.geometry import Pose, compose, invert, yaw_quaternion
from prag_asp.scene.scene import Look, Material, Scene, Solid
from prag_asp.scene.solids import solids, walls, weight

PARKING = (20.0, 20.0, 5.0)
NO_MARGIN = 0.0
"""The collision margin of meshes. By default, PyBullet keeps other bodies 1 mm away from the hull of a mesh; it also
rounds the edges of other solids by 1 mm, but only the vertical edges if they are upright."""

PATCH = 0.001
"""The height of the coloured patch of a zone above the table, in metres."""


def parking_place(i: int) -> Vector:
    """Return the parking place of body number `i`, in metres; all places are distinct."""
    return (PARKING[0] + 2.0 * i, PARKING[1], PARKING[2])


def make_table(client: int, scene: Scene, *, visual: bool = False) -> int:
    """Make the table, with its top at z = 0."""
    table = scene.table
    top = Solid("box", (*table.size, TABLE_THICKNESS))
    at = (*table.centre, -TABLE_THICKNESS / 2)
    material = next((scene.material(e) for e, shape in scene.shapes.items() if shape.kind == "table"), Material())
    return _make([top], material, 0.0, at, client, table.color if visual else None)


def show_zone(client: int, scene: Scene, entity: str) -> None:
    """Show a zone as a coloured patch on the table that collides with nothing."""
    (x, y, yaw), half = scene.fixed[entity], scene.shapes[entity].half
    patch = pybullet.createVisualShape(
        pybullet.GEOM_BOX,
        halfExtents=(half[0], half[1], PATCH),
        rgbaColor=[*(part / 255 for part in rgb(scene.color(entity))), 1.0],
        physicsClientId=client,
    )
    pybullet.createMultiBody(0.0, -1, patch, (x, y, 0.0), yaw_quaternion(yaw), physicsClientId=client)


def make_body(
    client: int, scene: Scene, entity: str, at: Vector, *, visual: bool = False, free: bool = False, floor: bool = True
) -> int:
    """Make the body of an object; a fixed object has no mass, and a container can be made without its floor.

    With `free`, it is a plain rigid body, which is cheaper to simulate, unless it is furniture, which needs a joint, or
    a body with a model, which needs exact geometry.

    Raises:
        SceneError: PyBullet refuses the body's shape.
    """
    color = scene.color(entity) if visual else None
    shape, material = scene.shapes[entity], scene.material(entity)
    if shape.traits.furniture:
        return make_furniture(client, shape, material, at, color)
    if shape.model is None:
        made_of = solids(shape) if floor else walls(shape)
        return _make(made_of, material, mass(scene, entity), at, client, color, free)
    solid, frame = shape.model.solids, mass_frame(scene, entity)
    body = _make(solid, material, mass(scene, entity), at, client, color, frame=frame, looks=shape.model.looks)
    pybullet.changeDynamics(body, -1, collisionMargin=NO_MARGIN, physicsClientId=client)
    set_mass(client, scene, entity, body)
    return body


def mass_frame(scene: Scene, entity: str) -> Pose | None:
    """Return a body's inertial frame (centre of mass, principal axes) in its frame, or None if the two are equal.

    PyBullet's poses of bodies are the poses of their inertial frames.
    """
    model = scene.shapes[entity].model
    return None if model is None or entity in scene.fixed else Pose(model.centre, model.axes)


def put_body(client: int, scene: Scene, entity: str, body: int, pose: Pose) -> None:
    """Move the body of an object to a pose."""
    frame = mass_frame(scene, entity)
    at, turn = pose if frame is None else compose(pose, frame)
    pybullet.resetBasePositionAndOrientation(body, at, turn, physicsClientId=client)


def body_pose(client: int, scene: Scene, entity: str, body: int) -> Pose:
    """Return the pose of the body of an object."""
    position, quaternion = pybullet.getBasePositionAndOrientation(body, physicsClientId=client)
    frame, pose = mass_frame(scene, entity), Pose(tuple(position), tuple(quaternion))
    return pose if frame is None else compose(pose, invert(frame))


def set_mass(client: int, scene: Scene, entity: str, body: int, still: bool = False) -> None:
    """Set the mass and inertia of an object's body, or remove them if the body must stay `still`."""
    model, kilograms = scene.shapes[entity].model, 0.0 if still else mass(scene, entity)
    pybullet.changeDynamics(body, -1, mass=kilograms, physicsClientId=client)
    if model is not None and kilograms > 0.0 and any(model.moments):
        pybullet.changeDynamics(body, -1, localInertiaDiagonal=model.moments, physicsClientId=client)


def mass(scene: Scene, entity: str) -> float:
    """Return the mass of an object in kilograms, or 0 for a fixed object."""
    return 0.0 if entity in scene.fixed else weight(scene, entity)


def _make(
    made_of: Sequence[Solid],
    material: Material,
    mass: float,
    at: Vector,
    client: int,
    color: str | None,
    free: bool = False,
    frame: Pose | None = None,
    looks: Sequence[Look] = (),
) -> int:
    """Make one body that consists of several solids, with its inertial `frame`; without a colour, it is invisible."""
    own = {} if frame is None else {"baseInertialFramePosition": frame[0], "baseInertialFrameOrientation": frame[1]}
    with open_shapes(made_of, client, color, looks) as (solid, seen):
        body = pybullet.createMultiBody(
            mass, solid, seen, at, useMaximalCoordinates=free, physicsClientId=client, **own
        )
    if body < 0:
        raise SceneError(f"PyBullet refuses a body of {list(made_of)}")
    rolls = len(made_of) == 1 and made_of[0].kind == "sphere"
    pybullet.changeDynamics(
        body,
        -1,
        lateralFriction=material.friction,
        rollingFriction=material.rolling if rolls else 0.0,
        physicsClientId=client,
    )
    return int(body)
