"""Where an action fails, the search returns to an earlier one that may be to blame: another grasp, or another place."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import pytest

from prag_asp.physics import Budget, check_witness, open_validator
from prag_asp.physics.search.attempt import ARM_COLLIDES, OBJECTS_COLLIDE, PhysicsFault
from prag_asp.physics.search.failures import FailureLog
from prag_asp.physics.symbolic_facts import physical_task
from prag_asp.physics.verdict import Verdict
from prag_asp.physics.witness_search import actions_to_blame
from prag_asp.scene.scene import BodyModel, Scene, Shape, Solid
from prag_asp.scene.scene_loader import parse_scene
from prag_asp.task import Task
from tests.physics.scenarios import state, task

SLOT = {"kind": "container", "size": [0.066, 0.178, 0.05], "wall": 0.004}
CUBE = {"kind": "box", "size": [0.05, 0.05, 0.05]}
TROUGH = {"kind": "container", "size": [0.072, 0.152, 0.03], "wall": 0.006}


def scene_of(shapes: dict[str, Any], **more: Any) -> Scene:
    shapes = {"panda": {"kind": "robot"}, "table": {"kind": "table"}, **shapes}
    given = {"workspace": {"x": [0.35, 0.65], "y": [-0.3, 0.3]}, "shapes": shapes, "rotations": {"straight": 0}, **more}
    return parse_scene(given, {}, {name: name for name in shapes})


def as_models(scene: Scene, *names: str) -> Scene:
    """Return the scene with boxes as bodies with a model of one box."""
    shapes = dict(scene.shapes)
    for name in names:
        size = shapes[name].size
        x, y = size[0] / 2, size[1] / 2
        outline = ((-x, -y), (x, -y), (x, y), (-x, y))
        solid = Solid("box", size)
        shapes[name] = Shape(
            "urdf", size, model=BodyModel((solid,), 0.1, moments=(1e-4,) * 3, base=outline, crown=outline)
        )
    return replace(scene, shapes=shapes)


def picked(entity: str) -> tuple[str, dict[Any, bool]]:
    return f"pick(panda,{entity})", state(f"holding(panda,{entity})", f"-on_top({entity},table)")


def put(entity: str, place: str) -> tuple[str, dict[Any, bool]]:
    return f"put(panda,{entity})", state(f"-holding(panda,{entity})", f"inside({entity},{place})")


def verdict_on(request: Task, scene: Scene, seed: int, budget: Budget) -> Verdict:
    with open_validator(scene) as validator:
        verdict = validator.validate(request, seed=seed, budget=budget)
    assert verdict.witness is None or check_witness(request, verdict.witness, scene) == []
    return verdict


@pytest.mark.parametrize("seed", [1, 2])
def test_a_box_that_lies_straight_is_grasped_across_its_other_side_where_the_first_cannot_put_it(seed: int) -> None:
    # Across 50 mm, as is easiest, the fingers would be in the walls of the slot, which are 58 mm apart.
    brick = {"kind": "box", "size": [0.07, 0.05, 0.05]}
    scene = scene_of({"brick": brick, "slot": SLOT}, fixed={"slot": [0.5, 0.2, 0]})
    initial = state("on_top(brick,table)", "rotated(brick,straight)", "-holding(panda,brick)")
    request = task(initial, picked("brick"), put("brick", "slot"), forget=("rotated(brick,straight)",))
    verdict = verdict_on(request, scene, seed, Budget(4, 8))
    assert verdict.feasible and verdict.restarts > 4, "primitives return after the restarts of the budget"
    again = verdict_on(request, as_models(scene, "brick"), seed, Budget(1, 8))
    assert again.feasible and again.restarts == 1, "bodies with a model return at once"


def test_the_place_of_one_thing_is_given_up_where_it_leaves_no_room_for_the_next() -> None:
    # Of 140 mm two bricks of 55 mm leave 30: the first one stands near an end, or the second finds no place.
    brick = {"kind": "box", "size": [0.04, 0.055, 0.05]}
    scene = scene_of({"one": brick, "two": brick, "trough": TROUGH}, fixed={"trough": [0.5, 0.2, 0]})
    scene = as_models(scene, "one", "two")
    initial = state("on_top(one,table)", "on_top(two,table)", "-holding(panda,one)", "-holding(panda,two)")
    request = task(initial, picked("one"), put("one", "trough"), picked("two"), put("two", "trough"))
    found = sum(verdict_on(request, scene, seed, Budget(1, 10)).feasible for seed in range(4))
    assert found >= 3


def test_to_blame_are_the_grasp_of_what_is_put_and_what_put_a_body_that_is_in_the_way() -> None:
    scene = scene_of({"one": CUBE, "two": CUBE, "six": CUBE, "trough": TROUGH})
    steps = [step for name in ("one", "two", "six") for step in (picked(name), put(name, "trough"))]
    physical = physical_task(task(state(*(f"on_top({name},table)" for name in ("one", "two", "six"))), *steps), scene)
    assert actions_to_blame(physical, 5, [PhysicsFault(ARM_COLLIDES, ("itself",))]) == {4}
    assert actions_to_blame(physical, 5, [PhysicsFault(OBJECTS_COLLIDE, ("six", "one"))]) == {1, 4}
    assert actions_to_blame(physical, 5, [PhysicsFault(OBJECTS_COLLIDE, ("six",))]) == {1, 3, 4}, "no room"
    assert actions_to_blame(physical, 2, [PhysicsFault(ARM_COLLIDES, ("one",))]) == {1}
    assert actions_to_blame(physical, 0, [PhysicsFault(ARM_COLLIDES, ("two",))]) == set()


def test_what_came_nearest_to_working_says_by_how_much_it_was_missed() -> None:
    # The gripper opens 80 mm and needs 6 mm to spare.
    scene = scene_of({"brick": {"kind": "box", "size": [0.078, 0.078, 0.05]}})
    verdict = verdict_on(task(state("on_top(brick,table)"), picked("brick")), scene, 1, Budget(1, 2))
    expected = "at action 1 of 1, pick(panda,brick), no grasp fits the object (brick; missed by 4 mm)"
    assert verdict.nearest == expected


def test_of_attempts_that_came_as_far_the_one_that_missed_least_counts() -> None:
    scene = scene_of({"one": CUBE, "two": CUBE})
    facts = physical_task(task(state("left_of(one,two)", "rotated(one,straight)")), scene).initial
    log = FailureLog()
    for fact, missed in ((facts[0], 0.2), (facts[0], 0.012), (facts[0], 0.05)):
        log.add(PhysicsFault("a relation of the state does not hold", (), fact), -1, missed)
    assert log.nearest([]).endswith("(one is to the left of two; missed by 12 mm)")
    log.add(PhysicsFault(OBJECTS_COLLIDE, ("one", "two")), 0)
    log.add(PhysicsFault(OBJECTS_COLLIDE, ("one", "two")), 0, 0.0034)
    log.add(PhysicsFault(OBJECTS_COLLIDE, ("one", "two")), -1, 0.0001)
    assert log.nearest([]) == "after all 0 actions objects collide (one, two; missed by 3.4 mm)"
    turned = FailureLog()
    turned.add(PhysicsFault("a relation of the state does not hold", (), facts[1]), -1, math.radians(7.0))
    assert turned.nearest([]).endswith("; missed by 7 degrees)")
