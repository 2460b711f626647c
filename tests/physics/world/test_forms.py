from __future__ import annotations

import math
from itertools import product

import pybullet
import pytest

from prag_asp.physics.world.primitives import GEOMETRIES
from prag_asp.physics.world.simulator import open_simulator
from prag_asp.scene.forms import FORMS
from prag_asp.scene.geometry import Pose, extents, inside_by, rotate
from prag_asp.scene.scene import Scene, Shape
from prag_asp.scene.shape_kinds import KINDS

STEPS = 24
TURN = (0.18257418583505536, 0.3651483716701107, 0.5477225575051661, 0.7302967433402214)
SIZES = {"box": (0.05, 0.08, 0.06), "cylinder": (0.06, 0.06, 0.1), "sphere": (0.07, 0.07, 0.07)}


def grains(kind: str) -> list[tuple[float, float, float]]:
    """Return a grid of points within a primitive, by what the word means."""
    half = [side / 2 for side in SIZES[kind]]
    grid = product(*([(2 * k + 1 - STEPS) / STEPS * reach for k in range(STEPS)] for reach in half))
    inside = {
        "box": lambda x, y, z: True,
        "cylinder": lambda x, y, z: math.hypot(x, y) <= half[0],
        "sphere": lambda x, y, z: math.hypot(x, y, z) <= half[0],
    }[kind]
    return [point for point in grid if inside(*point)]


def test_all_primitives_are_known_to_pybullet_and_are_kinds_of_shapes() -> None:
    assert set(FORMS) == set(SIZES) <= set(GEOMETRIES) & set(KINDS)
    assert all(KINDS[name].form is form for name, form in FORMS.items())


@pytest.mark.parametrize("kind", FORMS)
def test_a_primitive_has_the_volume_the_reach_and_the_outline_of_the_points_in_it(kind: str) -> None:
    points, form, shape = grains(kind), FORMS[kind], Shape(kind, SIZES[kind])
    grain = math.prod(SIZES[kind]) / STEPS**3
    assert form.volume(shape.half) == pytest.approx(len(points) * grain, rel=0.02)
    for direction in ((0.0, 0.0, 1.0), (0.6, 0.8, 0.0), rotate(TURN, (1.0, 0.0, 0.0))):
        farthest = max(sum(a * b for a, b in zip(point, direction, strict=True)) for point in points)
        assert farthest <= form.reach(shape.half, direction) <= farthest + 0.006
    corners = form.outline(shape.half, 0.3, -0.2, 0.5)
    turned = [
        (0.3 + math.cos(0.5) * x - math.sin(0.5) * y, math.sin(0.5) * x + math.cos(0.5) * y - 0.2) for x, y, _ in points
    ]
    if KINDS[kind].flat:
        depths = [inside_by(corners, point) for point in turned]
        assert -0.001 < min(depths) < 0.003  # of a circle the outline has sixteen corners
    else:
        assert corners == ((0.3, -0.2),)


@pytest.mark.parametrize("kind", FORMS)
def test_a_turned_primitive_is_as_far_from_the_table_in_the_simulator_as_it_reaches_down(kind: str) -> None:
    shape = Shape(kind, SIZES[kind])
    with open_simulator(Scene({"it": shape})) as simulator:
        simulator.place({"it": Pose((0.5, 0.0, 0.1), TURN)})
        found = pybullet.getClosestPoints(simulator.body("it"), simulator.table, 0.2, physicsClientId=simulator.client)
    assert min(point[8] for point in found) == pytest.approx(
        0.1 - extents(shape, TURN)[2], abs=0.001
    )  # corners are rounded by its margin
