"""The kinds of bodies, and their properties, which the scene, the search and the proofs use.

A new kind needs a row here. A kind with a new form also needs a row in `prag_asp.scene.forms`, and one in
`prag_asp.physics.world.primitives` with PyBullet's name for the form. Furniture also needs a row in
`prag_asp.scene.furniture`.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from prag_asp.scene.forms import BALL, BOX, CYLINDER, Primitive


class Kind(NamedTuple):
    """The properties of all bodies of a kind.

    `keys` are the keys of a table in ``scene.shapes`` of this kind, apart from ``kind``; `form` is its geometry. A
    `round` body looks the same at any rotation about the vertical. A `flat` body has a plane bottom, on which it
    stands, and a plane top, on which others stand; a body that is not flat rolls. An `even` body has the same width
    everywhere, so that it can also be held at its end. A `hollow` body can contain others. `furniture` stands still and
    has a part on a joint. A `body` is an object; a robot, the table and a zone (a flat part of the table top) are not.
    A `surface` is the table top or a part of it.
    """

    keys: tuple[str, ...] = ()
    form: Primitive = BOX
    round: bool = False
    flat: bool = True
    even: bool = False
    hollow: bool = False
    furniture: bool = False
    body: bool = True
    surface: bool = False


KINDS: Mapping[str, Kind] = {
    "box": Kind(("size",), even=True),
    "cylinder": Kind(("radius", "height"), CYLINDER, round=True),
    "sphere": Kind(("radius",), BALL, round=True, flat=False),
    "container": Kind(("size", "wall"), hollow=True),
    "drawer": Kind(("size", "wall"), hollow=True, furniture=True),
    "cupboard": Kind(("size", "wall"), hollow=True, furniture=True),
    "urdf": Kind(("path",)),
    "mesh": Kind(("path", "visual", "scale", "rotation", "up", "mass", "density", "rests")),
    "table": Kind(body=False, surface=True),
    "robot": Kind(body=False),
    "zone": Kind(("size",), body=False, surface=True),
}
"""The kinds of shapes that can be used in ``scene.shapes``."""
