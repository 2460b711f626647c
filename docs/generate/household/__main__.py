"""Write the meshes and textures of the domain household into its folder ``models``.

``.venv/bin/python docs/generate/household``, with the extra ``pictures``, writes the same files each time.
"""

from __future__ import annotations

import zlib
from collections.abc import Iterator, Sequence
from io import BytesIO
from pathlib import Path

import numpy as np
from objects import MODELS
from parts import Floats
from surfaces import Patch
from textures import COLOURS, TEXTURES

FOLDER = Path(__file__).resolve().parents[3] / "domains" / "household" / "models"
PLAIN = {"dark": "0.16 0.16 0.18", "chrome": "0.78 0.80 0.83", "coated": "0.20 0.21 0.24", "stalk": "0.36 0.24 0.13"}
"""The colours of materials without a texture."""


def parts_file(parts: Sequence[Floats]) -> str:
    """Return an .obj with an object for each convex part."""
    lines, before = [], 1
    for number, triangles in enumerate(parts):
        corners, numbers = np.unique(np.round(triangles.reshape(-1, 3), 2), axis=0, return_inverse=True)
        lines.append(f"o part_{number}")
        lines += [f"v {x:g} {y:g} {z:g}" for x, y, z in corners.tolist()]
        lines += [f"f {a} {b} {c}" for a, b, c in (numbers.reshape(-1, 3) + before).tolist()]
        before += len(corners)
    return "\n".join(lines) + "\n"


def look_file(patches: Sequence[Patch]) -> str:
    """Return an .obj of visible surfaces, whose materials are in ``household.mtl``."""
    tables: dict[str, dict[str, int]] = {"v": {}, "vt": {}, "vn": {}}
    faces: list[str] = []
    for patch in patches:
        faces.append(f"usemtl {patch.material}")
        for corners, places, normals in zip(patch.corners, patch.places, patch.normals, strict=True):
            own = list(_corners(tables, corners, places, normals))
            faces += [
                "f " + " ".join(each)
                for each in ((own[0], own[1], own[2]), (own[0], own[2], own[3]))
                if len(set(each)) == 3
            ]
    lines = ["mtllib household.mtl"]
    for word, table in tables.items():
        lines += [f"{word} {values}" for values in table]
    return "\n".join([*lines, *faces]) + "\n"


def _corners(tables: dict[str, dict[str, int]], *values: Floats) -> Iterator[str]:
    """Yield the corners of a face; each value is written once."""
    for corner in zip(*values, strict=True):
        numbers = []
        for table, digits, value in zip(tables.values(), (1, 3, 2), corner, strict=True):
            text = " ".join(f"{each:g}" for each in (np.round(value, digits) + 0.0).tolist())
            numbers.append(str(table.setdefault(text, len(table) + 1)))
        yield "/".join(numbers)


def materials_file() -> str:
    """Return the .mtl of all materials."""
    lines = [f"newmtl {name}\nKd 1 1 1\nmap_Kd {name}.png" for name in TEXTURES]
    return "\n".join(lines + [f"newmtl {name}\nKd {colour}" for name, colour in PLAIN.items()]) + "\n"


def main() -> None:
    """Write all files."""
    FOLDER.mkdir(exist_ok=True)
    for name, texture in TEXTURES.items():
        content = BytesIO()
        picture = texture(np.random.default_rng(zlib.crc32(name.encode())))
        picture.quantize(COLOURS, dither=0).save(content, "PNG", optimize=True)
        (FOLDER / f"{name}.png").write_bytes(content.getvalue())
    (FOLDER / "household.mtl").write_text(materials_file(), encoding="ascii")
    for name, make in MODELS.items():
        model = make()
        (FOLDER / f"{name}.obj").write_text(parts_file(model.parts), encoding="ascii")
        (FOLDER / f"{name}_look.obj").write_text(look_file(model.looks), encoding="ascii")


if __name__ == "__main__":
    main()
