"""The bound on the width of every grasp of a body, attacked by a search for grasps without arm and margins."""

from __future__ import annotations

import math
import random

import numpy as np
import pytest
from numpy.typing import NDArray

from prag_asp.physics.grasps.normal_cones import angle_between
from prag_asp.physics.grasps.opposite_faces import exceeds_opening
from prag_asp.physics.grasps.pads import ParallelGripper
from prag_asp.physics.predicates import PREDICATES
from prag_asp.scene.read.convex import convex_hull
from prag_asp.scene.robots.panda import PANDA
from prag_asp.scene.scene import BodyModel, Scene, Shape, Solid
from prag_asp.scene.surfaces import part_surfaces
from tests.chance import Chance
from tests.independent.antipodes import gripped, random_body

GRIPPER = ParallelGripper.of(PANDA)
FRICTION = 0.98


def body(*solids: Solid, size: tuple[float, float, float] = (0.1, 0.1, 0.1)) -> Shape:
    """Return a body of solids; the box around it is of no account."""
    return Shape("urdf", size, model=BodyModel(solids, 0.2))


def reasons(shape: Shape) -> list[str]:
    """Return why the Panda can never hold a body."""
    scene = Scene({"panda": Shape("robot"), "table_1": Shape("table"), "thing_1": shape})
    impossible = PREDICATES["holding"].impossible
    assert impossible is not None
    return list(impossible(scene, ("panda", "thing_1")))


BOX = (0.04, 0.10, 0.05)
KNOWN = {
    "a narrow box turned in its own frame": (body(Solid("box", BOX, turn=(0.0, 0.0, math.pi / 4))), False),
    "a hammer": (body(Solid("box", (0.02, 0.25, 0.02)), Solid("box", (0.12, 0.03, 0.03), (0.0, 0.14, 0.0))), False),
    "a bowl of six walls": (
        body(
            *(
                Solid("box", (0.09, 0.005, 0.05), (0.08 * math.sin(a), 0.08 * math.cos(a), 0.0), (0.0, 0.0, -a))
                for a in np.arange(6) * math.pi / 3
            ),
            size=(0.18, 0.18, 0.05),
        ),
        False,
    ),
    "a plate": (body(Solid("box", (0.2, 0.2, 0.008))), False),
    "a low card": (body(Solid("box", (0.09, 0.09, 0.004)), size=(0.09, 0.09, 0.004)), False),
    "a cube": (body(Solid("box", (0.1, 0.1, 0.1))), True),
    "a turned cube": (body(Solid("box", (0.1, 0.1, 0.1), turn=(0.3, 0.5, 0.2))), True),
    "a long beam": (body(Solid("box", (0.3, 0.12, 0.12))), True),
    "a cube with a narrow knob": (body(Solid("box", (0.1, 0.1, 0.1)), Solid("box", (0.02,) * 3, (0, 0, 0.06))), False),
}


@pytest.mark.parametrize("name", KNOWN)
def test_a_body_with_a_model_is_proved_too_wide_by_its_faces_alone(name: str) -> None:
    shape, proved = KNOWN[name]
    expected = "all opposite sides, edges and corners of thing 1 are too far apart: the gripper opens only to 80 mm"
    assert reasons(shape) == ([expected] if proved else [])


def prism(corners: int, radius: float, height: float) -> NDArray[np.float64]:
    """Return the triangles of an upright prism over a regular polygon."""
    turns = 2 * math.pi * np.arange(corners) / corners
    return convex_hull(
        np.array([(radius * math.cos(a), radius * math.sin(a), z) for a in turns for z in (0.0, height)])
    )


@pytest.mark.parametrize("friction", [0.07, 0.42, FRICTION])
def test_a_prism_that_pads_hold_between_an_edge_and_a_side_is_not_proved_too_wide(friction: float) -> None:
    # A floating hand in MuJoCo lifts the triangular prism with each of these coefficients; no two of its sides are
    # opposite to each other.
    assert not exceeds_opening([prism(3, 0.0404, 0.12)], GRIPPER, friction)
    assert not exceeds_opening([prism(5, 0.038, 0.12)], GRIPPER, friction)


def test_a_prism_that_is_too_wide_between_edges_and_sides_is_proved_too_wide() -> None:
    assert exceeds_opening([prism(3, 0.07, 0.12)], GRIPPER, 0.42)
    assert exceeds_opening([prism(5, 0.06, 0.12)], GRIPPER, 0.07)


def test_the_angle_between_normal_cones_is_that_of_a_dense_search(chance: Chance) -> None:
    rng = np.random.default_rng(chance.seed(4))
    for _ in range(chance.examples(60)):
        cones = []
        for count in rng.integers(1, 5, 2):
            axis, spread = rng.normal(size=3), rng.uniform(0.1, 0.9)
            normals = axis / np.linalg.norm(axis) + spread * rng.normal(size=(count, 3)) / 2
            cones.append(normals / np.linalg.norm(normals, axis=1)[:, None])
        samples = [np.concatenate([rng.dirichlet(np.full(len(c), 0.4), 3000), np.eye(len(c))]) @ c for c in cones]
        samples = [each / np.linalg.norm(each, axis=1)[:, None] for each in samples]
        found = math.acos(min(1.0, float((samples[0] @ samples[1].T).max())))
        least = angle_between(*cones)
        assert found - 0.15 <= least <= found + 1e-6


def test_a_body_of_parts_that_are_not_convex_is_not_decided() -> None:
    (cube,) = part_surfaces(Shape("box", (0.1, 0.1, 0.1)))
    dented = np.where((cube == cube.max((0, 1))).all(2)[:, :, None], cube * 0.2, cube)
    assert exceeds_opening([cube], GRIPPER, FRICTION)
    assert not exceeds_opening([dented], GRIPPER, FRICTION)


def any_solid(rng: random.Random, around: float) -> Solid:
    """Return a random primitive near the origin."""
    size = [rng.choice([rng.uniform(0.005, 0.05), rng.uniform(0.06, 0.16)]) for _ in range(3)]
    kind = rng.choice(["box", "box", "cylinder", "sphere"])
    size[1] = size[1] if kind == "box" else size[0]
    size[2] = size[0] if kind == "sphere" else size[2]
    at, turn = ([rng.uniform(-reach, reach) for _ in range(3)] for reach in (around, 3.0))
    return Solid(kind, (size[0], size[1], size[2]), (at[0], at[1], at[2]), (turn[0], turn[1], turn[2]))


def narrowest_pinch(parts: tuple[NDArray[np.float64], ...], rng: np.random.Generator) -> float:
    """Return the least distance of two random points of a surface between which a force is in both friction cones."""
    triangles = np.concatenate(parts)
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    areas = np.linalg.norm(normals, axis=1)
    chosen = rng.choice(len(triangles), 700, p=areas / areas.sum())
    shares = rng.dirichlet((1.0, 1.0, 1.0), len(chosen))
    points, normals = np.einsum("ij,ijk->ik", shares, triangles[chosen]), normals[chosen] / areas[chosen, None]
    lines = points[:, None] - points[None]
    lengths = np.linalg.norm(lines, axis=2) + 1e-12
    outward = np.einsum("ijk,ik->ij", lines, normals) / lengths
    least = math.cos(math.atan(FRICTION))
    pinched = (outward >= least) & (outward >= least).T
    return float(lengths[pinched].min(initial=math.inf))


def test_no_body_that_is_proved_too_wide_has_an_antipodal_grasp(chance: Chance) -> None:
    rng, draws, proved = chance.generator(1), np.random.default_rng(chance.seed(1)), 0
    for _ in range(chance.examples(40)):
        count = rng.choice([1, 1, 1, 2, 3])
        parts = part_surfaces(body(*(any_solid(rng, 0.0 if count == 1 else 0.06) for _ in range(count))))
        if exceeds_opening(parts, GRIPPER, FRICTION):
            proved += 1
            assert narrowest_pinch(parts, draws) > GRIPPER.opening
    assert proved >= 2


def test_no_random_shape_that_is_proved_too_wide_is_gripped_by_two_pads(chance: Chance) -> None:
    rng, proved = np.random.default_rng(chance.seed(2)), 0
    for _ in range(chance.examples(40)):
        _, corners = random_body(rng, ("block", "cone", "profile", "stone"))
        if exceeds_opening([convex_hull(part) for part in corners], GRIPPER, FRICTION):
            proved += 1
            assert gripped(corners, GRIPPER.opening, FRICTION, rng, 60) is None
    assert proved >= 2


def test_the_search_for_grips_finds_those_that_are_there(chance: Chance) -> None:
    rng = np.random.default_rng(chance.seed(3))
    sides = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) / 2
    assert gripped([sides * (0.078, 0.2, 0.2)], 0.08, FRICTION, rng, 60) is not None
    assert gripped([sides * (0.081, 0.2, 0.2)], 0.08, FRICTION, rng, 60) is None
    assert gripped([sides * 0.2, sides * (0.01, 0.06, 0.1) + (0.0, 0.0, 0.15)], 0.08, FRICTION, rng, 200) is not None


def test_a_rougher_body_or_a_wider_gripper_is_proved_less_often() -> None:
    parts = part_surfaces(Shape("box", (0.1, 0.1, 0.1)))
    assert exceeds_opening(parts, GRIPPER, FRICTION)
    assert not exceeds_opening(parts, GRIPPER, 1.1)  # beyond 45 degrees sides that meet at a corner face each other
    assert not exceeds_opening(parts, GRIPPER._replace(opening=0.0975), FRICTION)
