from __future__ import annotations

import numpy as np
import pytest

from prag_asp.physics.predicates.inside import INSIDE
from prag_asp.scene.geometry import extents
from prag_asp.scene.scene import BodyModel, Scene, Shape, Solid
from prag_asp.scene.surfaces import least_extent, surface
from tests.chance import Chance

PLATE = (0.26, 0.03, 0.1)


def body(*solids: Solid) -> Shape:
    model = BodyModel(solids, 0.3)
    corners = surface(Shape("mesh", (1.0, 1.0, 1.0), model=model)).reshape(-1, 3)
    x, y, z = np.ptp(corners, axis=0).tolist()
    return Shape("mesh", (x, y, z), model=model)


@pytest.mark.parametrize("turn", [(0.0, 0.0, 0.0), (0.0, 0.0, 0.8), (0.3, -0.5, 1.9)])
def test_the_least_extent_of_a_box_is_that_of_its_sides_in_any_orientation(turn: tuple[float, float, float]) -> None:
    width, area = least_extent(body(Solid("box", PLATE, turn=turn)))
    assert 0.0299 < width <= 0.03 + 1e-12 and 0.00299 < area <= 0.003 + 1e-12


def test_the_least_extent_is_a_bound_in_all_directions_and_near_the_least(chance: Chance) -> None:
    rng = np.random.default_rng(chance.seed(1))
    for _ in range(chance.examples(6)):
        size, at, turn = rng.uniform(0.01, 0.2, (3, 3)), rng.uniform(-0.1, 0.1, (3, 3)), rng.uniform(-3.0, 3.0, (3, 3))
        rows = zip(size.tolist(), at.tolist(), turn.tolist(), strict=True)
        shape = body(*(Solid("box", *map(tuple, row)) for row in rows))  # type: ignore[arg-type]
        along = rng.normal(size=(20_000, 3))
        along /= np.linalg.norm(along, axis=1)[:, None]
        widths = np.ptp(along @ surface(shape).reshape(-1, 3).T, axis=1)
        assert 0.95 * widths.min() < least_extent(shape).width <= widths.min()


def test_a_plate_that_is_oblique_in_its_file_is_not_proved_too_large_for_a_narrow_container() -> None:
    oblique = body(Solid("box", PLATE, turn=(0.0, 0.0, 0.785)))
    assert min(extents(oblique, (0.0, 0.0, 0.0, 1.0))) > 0.04
    box = Shape("container", (0.3, 0.1, 0.05), 0.006)
    scene = Scene(
        {"plate_1": oblique, "tray_1": box, "cube_1": body(Solid("box", (0.2, 0.2, 0.2), turn=(0.0, 0.5, 0.0)))}
    )
    assert not [*INSIDE.impossible(scene, ("plate_1", "tray_1"))]
    assert [*INSIDE.impossible(scene, ("cube_1", "tray_1"))] == ["cube 1 is larger than the cavity of tray 1"]
