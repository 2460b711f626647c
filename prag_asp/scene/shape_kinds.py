"""The kinds of bodies and their properties, for the scene, the search and the proofs.

A new kind needs a row here. One of a new form needs a row in `prag_asp.scene.forms` too, and one in
`prag_asp.physics.world.primitives` that says what PyBullet calls it; furniture one in `prag_asp.scene.furniture`.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from prag_asp.scene.forms import BALL, BOX, CYLINDER, Primitive


class Kind(NamedTuple):
    """The properties of all bodies of a kind.

    `keys` are the keys of its table in ``scene.shapes`` besides the kind; `form` is its geometry. A `round` body
    looks the same however it is turned about the vertical. A `flat` one ends in planes: it stands on the one below,
    and bears others on the one above; what is not flat rolls. An `even` one is as broad everywhere, so that it can be
    held at its end as well. Things can be in a `hollow` one. `furniture` stands still and has a part on a joint. A
    `body` is an object; a robot, the table and a zone, a flat part of the table's top, are not. A `surface` is the
    table's top or a part of it.
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
"""The kinds of shapes that ``scene.shapes`` knows."""
