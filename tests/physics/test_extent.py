"""The extent of a body after its mesh file has changed under the same name."""

import itertools
from pathlib import Path

import pytest

from prag_asp.physics.extent import extent, extent_along, least_reach, reach, side_yaw, silhouette
from prag_asp.scene.geometry import IDENTITY, Pose, matrix
from prag_asp.scene.scene import BodyModel, Shape, Solid
from prag_asp.scene.surfaces import part_boxes, part_outlines

FACES = ((1, 2, 4, 3), (5, 7, 8, 6), (1, 5, 6, 2), (3, 4, 8, 7), (1, 3, 7, 5), (2, 6, 8, 4))


def write_box(path: Path, x: float, y: float, z: float) -> None:
    corners = itertools.product((-x / 2, x / 2), (-y / 2, y / 2), (-z / 2, z / 2))
    lines = [f"v {a} {b} {c}" for a, b, c in corners] + [f"f {' '.join(map(str, face))}" for face in FACES]
    path.write_text("\n".join(lines) + "\n")


def test_a_changed_mesh_file_has_its_new_extent(tmp_path: Path) -> None:
    path = tmp_path / "box.obj"
    model = BodyModel((Solid("mesh", (1.0, 1.0, 1.0), mesh=str(path)),), 0.1)
    shape, axes = Shape("mesh", (0.04, 0.06, 0.08), model=model), matrix(Pose((0.0, 0.0, 0.0)))[:3, :3]
    for x, y, z in ((0.04, 0.06, 0.08), (0.1, 0.05, 0.07123)):
        write_box(path, x, y, z)
        assert extent(shape, IDENTITY).half == pytest.approx((x / 2, y / 2, z / 2))
        assert extent_along(shape, IDENTITY, (1.0, 0.0, 0.0)) == pytest.approx((0.0, x / 2))
        assert reach(shape, axes)[1] == pytest.approx((x / 2, y / 2, z / 2))
        assert max(silhouette(shape, Pose((0.0, 0.0, 0.0)))) == pytest.approx((x / 2, y / 2))
        assert least_reach(shape) == pytest.approx(min(x, y, z) / 2)
        assert side_yaw(shape) == 0.0
        assert part_boxes(shape, IDENTITY)[0, 1] == pytest.approx((x / 2, y / 2, z / 2))
        assert part_outlines(shape, IDENTITY)[0].corners.max(0) == pytest.approx((x / 2, y / 2))
