"""The domain household: its files are whole, its objects can be held, and tasks with them are performed."""

from __future__ import annotations

import re

import numpy as np
import pytest

from prag_asp import Domain, TaskSpace, load_domain, load_scene, shipped_domains
from prag_asp.physics import Budget, validate_task
from prag_asp.physics.grasps.body_grasps import body_grasps
from prag_asp.physics.grasps.pads import ParallelGripper
from prag_asp.physics.predicates.gripper import pad_friction
from prag_asp.scene.read.convex import is_closed, is_convex
from prag_asp.scene.read.looks.surfaces import mesh_surfaces
from prag_asp.scene.read.mesh import file_parts
from prag_asp.scene.robots.panda import PANDA
from prag_asp.scene.scene import Scene, Shape

FOLDER = shipped_domains()["household"]
MODELS = FOLDER / "models"
LARGEST = 1_500_000
"""The most bytes of all models: they are in the wheel."""


@pytest.fixture(scope="module")
def domain() -> Domain:
    return load_domain("household")


@pytest.fixture(scope="module")
def scene(domain: Domain) -> Scene:
    return load_scene(domain)


def bodies(scene: Scene) -> dict[str, Shape]:
    return {entity: shape for entity, shape in scene.shapes.items() if shape.model is not None}


def test_the_files_are_small_and_each_is_used() -> None:
    files = {path.name for path in MODELS.iterdir()}
    named = set(re.findall(r"models/(\w+\.obj)", (FOLDER / "domain.toml").read_text()))
    library = (MODELS / "household.mtl").read_text()
    assert files == {*named, *re.findall(r"map_Kd (\S+)", library), "household.mtl"}
    used = {name for path in MODELS.glob("*_look.obj") for name in re.findall(r"usemtl (\w+)", path.read_text())}
    assert used == set(re.findall(r"newmtl (\w+)", library))
    assert sum(path.stat().st_size for path in MODELS.iterdir()) < LARGEST


def test_every_part_is_closed_and_convex_and_what_is_seen_is_where_it_collides(scene: Scene) -> None:
    assert len(bodies(scene)) == 23
    for entity, shape in bodies(scene).items():
        (solid,), (look,) = shape.model.solids, shape.model.looks
        parts = [np.array(part) for part in file_parts(solid.mesh, solid.size)]
        assert all(is_closed(part) and is_convex(part) for part in parts), entity
        seen = np.concatenate([each.corners.reshape(-1, 3) for each in mesh_surfaces(look.solid.mesh, look.folder)])
        points = np.concatenate([part.reshape(-1, 3) for part in parts]) * 1000
        slack = 12.0 if entity == "apple_1" else 5.0  # the stalk of the apple gives way
        assert np.abs(seen.min(0) - points.min(0)).max() < slack and np.abs(seen.max(0) - points.max(0)).max() < slack


def test_a_hand_lifts_every_object_by_its_mass_and_those_of_each_kind_have_grasps(scene: Scene) -> None:
    """Grasps of all take half a minute; a box, a thing of few parts and one with a rim stand for the others."""
    assert all(0.01 < bodies(scene)[entity].model.mass < 0.6 for entity in bodies(scene).keys() - scene.fixed.keys())
    for entity in ("book_1", "knife_1", "plate_1"):
        assert body_grasps(scene.shapes[entity], ParallelGripper.of(PANDA), pad_friction(scene, entity)), entity


def test_a_mug_is_picked_at_its_rim_and_put_on_the_rack(domain: Domain, scene: Scene) -> None:
    task = next(
        task for task in TaskSpace(domain, 2).where("begins pick(panda,mug_1,table_1)", "ends on_top(mug_1,rack_1)")
    )
    verdict = validate_task(task, scene, seed=1, budget=Budget(10, 10, "demonstration"))
    assert verdict.feasible and verdict.demonstration is not None
