from __future__ import annotations

import json
from dataclasses import replace
from itertools import islice

import pybullet
import pytest

from prag_asp.errors import SceneError
from prag_asp.physics import (
    Verdict,
    Witness,
    check_demonstration,
    check_witness,
    demonstrate,
    film_strip,
    open_validator,
    settle,
    validate_task,
    validate_tasks,
)
from prag_asp.physics.world.bodies import mass
from prag_asp.physics.world.simulator import open_simulator
from prag_asp.scene.scene import Material, Scene, Shape
from tests.physics.random_tasks import random_tasks, scene_with
from tests.physics.scenarios import stacking

SIZES = 8
CUBE = {"kind": "box", "size": {"low": [0.03, 0.03, 0.04], "high": [0.06, 0.05, 0.04]}}
CAN = {"kind": "cylinder", "radius": [0.02, 0.034], "height": 0.1}


@pytest.fixture(scope="module")
def ranged() -> Scene:
    return scene_with("tabletop", {"cube": CUBE, "can": CAN})


def test_a_range_holds_sizes_from_its_lower_to_its_upper_end(ranged):
    boxes, cans = ranged.ranges["cube_1"], ranged.ranges["can_1"]
    assert len(boxes) == len(cans) == SIZES
    assert (boxes[0].size, boxes[-1].size) == ((0.03, 0.03, 0.04), (0.06, 0.05, 0.04))
    assert boxes[1].size == pytest.approx((0.03 + 0.03 / 7, 0.03 + 0.02 / 7, 0.04))
    assert (cans[0].size, cans[-1].size) == ((0.04, 0.04, 0.1), (0.068, 0.068, 0.1))
    assert ranged.shapes["cube_1"] == boxes[-1]
    assert "brick_1" not in ranged.ranges


def test_sizes_differ_between_tasks_and_repeat_with_the_seed_in_any_order_and_in_workers(ranged, chance):
    tasks, seed = list(islice(random_tasks("tabletop", 4, chance.seed(3)), 10)), chance.seed(5)
    lines = [json.dumps(verdict.to_json()) for verdict in validate_tasks(tasks, ranged, seed=seed, workers=2)]
    with open_validator(ranged) as validator:
        before = _body_counts()
        again = {i: json.dumps(validator.validate(tasks[i], seed=seed, index=i).to_json()) for i in reversed(range(10))}
        assert _body_counts() == before, "each size has one body, which is kept"
    assert lines == [again[i] for i in range(10)]
    drawn = {tuple(size) for text in lines for size in (json.loads(text)["witness"] or {}).get("sizes", {}).values()}
    assert len(drawn) > 4


def _body_counts():
    return [pybullet.getNumBodies(physicsClientId=i) for i in range(20) if pybullet.isConnected(i)]


def test_a_witness_carries_its_sizes_and_every_check_uses_them(ranged):
    verdict = validate_task(stacking(), ranged, seed=1)
    again = Verdict.from_json(json.loads(json.dumps(verdict.to_json())))
    assert again == verdict
    witness = again.witness
    assert set(witness.sizes) == {"cube_1"}
    assert check_witness(stacking(), witness, ranged) == []
    assert settle(stacking(), witness, ranged) is None
    sizes = [shape.size for shape in ranged.ranges["cube_1"]]
    other = sizes[sizes.index(witness.sizes["cube_1"]) - SIZES // 2]
    assert check_witness(stacking(), replace(witness, sizes={"cube_1": other}), ranged)
    assert "range" in check_witness(stacking(), replace(witness, sizes={"cube_1": (0.05, 0.05, 0.05)}), ranged)[0]
    assert "no size of cube_1" in check_witness(stacking(), replace(witness, sizes={}), ranged)[0]
    with pytest.raises(SceneError, match="brick_1 cannot have the size"):
        settle(stacking(), replace(witness, sizes={"brick_1": (0.05, 0.05, 0.05)}), ranged)


def test_a_demonstration_and_a_picture_have_the_sizes_of_the_witness(ranged):
    witness = validate_task(stacking(), ranged, seed=1).witness
    demonstration = demonstrate(stacking(), witness, ranged)
    assert demonstration.success
    assert demonstration.sizes[demonstration.objects.index("cube_1")] == pytest.approx(witness.sizes["cube_1"])
    assert check_demonstration(stacking(), demonstration, ranged) == []
    other = next(size for size in ((0.03, 0.03, 0.04), (0.06, 0.05, 0.04)) if size != witness.sizes["cube_1"])
    resized = Witness(witness.moments, witness.motions, {"cube_1": other})
    one, two, three = (
        film_strip(stacking(), shown, ranged, frames=2, size=(120, 100)) for shown in (witness, demonstration, resized)
    )
    assert one.size == two.size
    assert one.tobytes() != three.tobytes()


def test_a_simulator_refuses_a_size_for_which_it_has_no_body(ranged):
    with open_simulator(ranged) as simulator, pytest.raises(SceneError, match="cube_1 has no body"):
        simulator.use(replace(ranged, shapes={**ranged.shapes, "cube_1": Shape("box", (0.1, 0.1, 0.1))}))


def test_a_proof_holds_for_every_size_of_a_range():
    wide = {"kind": "box", "size": {"low": [0.09, 0.09, 0.09], "high": [0.12, 0.12, 0.12]}}
    some = {"kind": "box", "size": {"low": [0.05, 0.05, 0.05], "high": [0.12, 0.12, 0.12]}}
    verdict = validate_task(stacking(), scene_with("tabletop", {"cube": wide}), seed=1)
    assert (verdict.status, verdict.reason.split(": ")[1]) == (
        "infeasible", "cube 1 is 90 mm wide, but the gripper opens only to 80 mm",
    )  # fmt: skip
    verdict = validate_task(stacking(), scene_with("tabletop", {"cube": some}), seed=1)
    assert verdict.feasible
    assert min(verdict.witness.sizes["cube_1"]) < 0.08


def test_materials_are_inherited_and_reach_the_simulator():
    scene = scene_with(
        "tabletop", {}, materials={"movable": {"density": 900}, "cube": {"density": 7800, "friction": 0.4}}
    )
    assert scene.material("cube_1") == Material(7800, 0.4)
    assert scene.material("can_1") == Material(900)
    assert scene.material("tray_1") == Material()
    assert mass(scene, "cube_1") == pytest.approx(7800 * 0.05**3)
    with open_simulator(scene) as simulator:
        dynamics = pybullet.getDynamicsInfo(simulator.body("cube_1"), -1, physicsClientId=simulator.client)
        assert dynamics[:2] == pytest.approx((7800 * 0.05**3, 0.4))


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ({"cub": {}}, "scene.materials.cub: unknown class; did you mean cube?"),
        ({"cube": 3}, "scene.materials.cube: needs a table like { density = 700, friction = 0.5 }"),
        ({"cube": {"weight": 3}}, "scene.materials.cube.weight: unknown key"),
        ({"cube": {"density": 0}}, "scene.materials.cube.density: needs a number from 1 to 25000"),
        ({"cube": {"friction": float("inf")}}, "scene.materials.cube.friction: needs a number from 0 to 10"),
        ({"cube": {"rolling": -1}}, "scene.materials.cube.rolling: needs a number from 0 to 0.1 (metres)"),
    ],
)
def test_a_malformed_material_is_refused_with_its_key(table, message):
    with pytest.raises(SceneError) as caught:
        scene_with("tabletop", {}, materials=table)
    assert message in str(caught.value)


def test_no_arm_takes_a_size_that_is_heavier_than_it_carries():
    wide = {"kind": "box", "size": {"low": [0.04, 0.04, 0.04], "high": [0.07, 0.07, 0.07]}}
    heavy = scene_with("tabletop", {"cube": wide}, materials={"cube": {"density": 15_000}})
    limit, weights = 3.0, set()
    for verdict in validate_tasks([stacking()] * 10, heavy, seed=1):
        x, y, z = verdict.witness.sizes["cube_1"]
        weights.add(round(15_000 * x * y * z, 3))
        assert check_witness(stacking(), verdict.witness, heavy) == []
    assert len(weights) > 2 and max(weights) < limit
    light = replace(heavy, materials={**heavy.materials, "cube_1": Material(5_000)})
    large = next(
        verdict.witness
        for verdict in validate_tasks([stacking()] * 40, light, seed=2)
        if 15_000 * verdict.witness.sizes["cube_1"][0] ** 3 > limit
    )
    assert any("cube_1 is heavier than the payload" in text for text in check_witness(stacking(), large, heavy))
