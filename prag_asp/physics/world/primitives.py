"""Collision and visual shapes of PyBullet from solids."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import nullcontext
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from prag_asp.errors import SceneError
from prag_asp.physics.bullet import pybullet
from prag_asp.scene.model import Solid
from prag_asp.scene.read.mesh import read_mesh

GEOMETRIES: Mapping[str, int] = {
    "box": pybullet.GEOM_BOX,
    "cylinder": pybullet.GEOM_CYLINDER,
    "sphere": pybullet.GEOM_SPHERE,
    "mesh": pybullet.GEOM_MESH,
}
"""What PyBullet calls the solids; of a mesh it takes the hull."""

NOTHING = -1
STRAIGHT = (0.0, 0.0, 0.0)


def make_shapes(solids: Sequence[Solid], client: int, color: str | None) -> tuple[int, int]:
    """Return the ids of what several solids collide with and look like; without a colour they cannot be seen.

    Raises:
        SceneError: PyBullet refuses one.
    """
    # Each kind of solid takes what it needs of these.
    sizes = {
        "shapeTypes": [GEOMETRIES[solid.kind] for solid in solids],
        "radii": [solid.size[0] / 2 for solid in solids],
        "lengths": [solid.size[2] for solid in solids],
        "halfExtents": [tuple(side / 2 for side in solid.size) for solid in solids],
    }
    places = [solid.at for solid in solids]
    with TemporaryDirectory() if any(solid.mesh for solid in solids) else nullcontext("") as folder:
        files = [_rewritten(solid.mesh, Path(folder) / str(i)) for i, solid in enumerate(solids)]
        body = pybullet.createCollisionShapeArray(
            **sizes, collisionFramePositions=places, **_turned("collision", solids, files), physicsClientId=client
        )
        looks = NOTHING
        if color is not None:
            rgba = [int(color[i : i + 2], 16) / 255 for i in (1, 3, 5)] + [1.0]
            looks = pybullet.createVisualShapeArray(
                **sizes,
                visualFramePositions=places,
                **_turned("visual", solids, files),
                rgbaColors=[rgba] * len(solids),
                physicsClientId=client,
            )
    if body < 0 or (looks < 0 and color is not None):
        raise SceneError(f"PyBullet refuses a body of {list(solids)}")
    return int(body), int(looks)


def _rewritten(mesh: str, path: Path) -> str:
    """Return a file that PyBullet can trust in place of a mesh, nothing where there is none.

    Raises:
        SceneError: the mesh cannot be read any more.
    """
    if not mesh:
        return ""
    file = path.with_suffix(Path(mesh).suffix.lower())
    file.write_bytes(read_mesh(mesh).written)
    return str(file)


def _turned(what: str, solids: Sequence[Solid], files: Sequence[str]) -> dict[str, Any]:
    """Return the arguments for turned solids and for meshes, none where there are none."""
    if not any(solid.mesh or solid.turn != STRAIGHT for solid in solids):
        return {}
    return {
        "fileNames": files,
        "meshScales": [solid.size if solid.mesh else (1.0, 1.0, 1.0) for solid in solids],
        f"{what}FrameOrientations": [pybullet.getQuaternionFromEuler(solid.turn) for solid in solids],
    }
