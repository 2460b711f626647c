"""What random placement leaves no room for is packed side by side; what fits nowhere is not found."""

from __future__ import annotations

import math
from itertools import combinations, pairwise
from typing import Any

import numpy as np
import pytest

from prag_asp.atom import parse_atom
from prag_asp.physics import Budget, Verdict, check_witness, validate_task
from prag_asp.physics.search import packing
from prag_asp.physics.search.attempt import Search
from prag_asp.physics.search.packing import Corner, pack
from prag_asp.physics.situation import Situation, fixed_pose
from prag_asp.physics.symbolic_facts import physical_task
from prag_asp.physics.witness_search import PACKED
from prag_asp.physics.world.simulator import open_simulator
from prag_asp.scene.scene import Scene
from prag_asp.scene.scene_loader import parse_scene
from prag_asp.task import Task
from tests.chance import Chance
from tests.physics.scenarios import state

BUDGET = Budget(8, 2)
CUBE = {"kind": "box", "size": [0.05, 0.05, 0.05]}
CAN = {"kind": "cylinder", "radius": 0.03, "height": 0.08}
CRATE = {"kind": "container", "size": [0.202, 0.142, 0.05], "wall": 0.006}


def scene_of(shapes: dict[str, Any], **more: Any) -> Scene:
    shapes = {"panda": {"kind": "robot"}, "table": {"kind": "table"}, **shapes}
    given = {"workspace": {"x": [0.35, 0.65], "y": [-0.2, 0.2]}, "shapes": shapes, **more}
    return parse_scene(given, {}, {name: name for name in shapes})


def looking(scene: Scene, *facts: str) -> Task:
    """The task in which the robot looks at objects between which some facts hold."""
    initial = state(*facts)
    return Task("test", (parse_atom("look(panda)"),), dict.fromkeys(scene.shapes, ""), initial, (initial,), ({},), {})


def inserting(scene: Scene, entity: str, *facts: str) -> Task:
    """The task in which the robot takes an object from the table and puts it into the crate."""
    lies, held, lies_in = (parse_atom(f"{text}") for text in (
        f"on_top({entity},table)", f"holding(panda,{entity})", f"inside({entity},crate)"
    ))  # fmt: skip
    begin = state(*facts, str(lies))
    steps = ({lies: False, held: True}, {held: False, lies_in: True})
    states = (begin | steps[0], begin | steps[0] | steps[1])
    actions = tuple(map(parse_atom, (f"pick(panda,{entity})", f"insert(panda,{entity},crate)")))
    return Task("test", actions, dict.fromkeys(scene.shapes, ""), begin, states, steps, {})


def begun(request: Task, scene: Scene, seed: int) -> tuple[Verdict, Situation]:
    verdict = validate_task(request, scene, seed=seed, budget=BUDGET)
    assert verdict.feasible and verdict.witness is not None, verdict.reason
    assert check_witness(request, verdict.witness, scene) == []
    first = verdict.witness.moments[0]
    return verdict, Situation(scene, first.poses, first.arms, first.openings)


def test_twenty_cubes_stand_in_a_grid_of_five_by_four_with_room_for_a_finger(chance: Chance) -> None:
    names = [f"c{i}" for i in range(20)]
    scene = scene_of(dict.fromkeys(names, CUBE))
    verdict, at = begun(looking(scene, *(f"on_top({name},table)" for name in names)), scene, chance.seed(1))
    assert BUDGET.restarts < verdict.restarts <= BUDGET.restarts + PACKED, "what packing costs is told"
    middles = [at.pose(name).position[:2] for name in names]
    for one, two in combinations(middles, 2):
        assert max(abs(a - b) for a, b in zip(one, two, strict=True)) >= 0.05 + 0.035 - 1e-6
    assert all(0.35 <= x <= 0.65 and -0.2 <= y <= 0.2 for x, y in middles)


@pytest.mark.parametrize("yaw", [0, 25])
def test_six_cans_stand_in_a_crate_with_five_millimetres_to_spare(chance: Chance, yaw: int) -> None:
    names = [f"c{i}" for i in range(6)]
    scene = scene_of({**dict.fromkeys(names, CAN), "crate": CRATE}, fixed={"crate": [0.5, 0.1, yaw]})
    _, at = begun(looking(scene, *(f"inside({name},crate)" for name in names)), scene, chance.seed(2))
    for one, two in combinations(names, 2):
        assert math.dist(at.pose(one).position, at.pose(two).position) >= 0.06 + 0.002 - 1e-6


def test_the_last_can_is_put_where_it_has_room(chance: Chance) -> None:
    names = [f"c{i}" for i in range(5)]
    inner = {**CRATE, "size": [0.242, 0.182, 0.03]}
    scene = scene_of({**dict.fromkeys([*names, "c5"], CAN), "crate": inner}, fixed={"crate": [0.5, 0.1, 0]})
    begun(inserting(scene, "c5", *(f"inside({name},crate)" for name in names)), scene, chance.seed(3))


def test_five_blocks_stand_in_a_row_that_is_a_little_longer_than_they_are(chance: Chance) -> None:
    names = [f"c{i}" for i in range(5)]
    block = {"kind": "box", "size": [0.08, 0.08, 0.05]}
    scene = scene_of(dict.fromkeys(names, block), workspace={"x": [0.4, 0.6], "y": [-0.2, 0.2]})
    row = [f"left_of({one},{two})" for one, two in pairwise(names)]
    _, at = begun(looking(scene, *(f"on_top({name},table)" for name in names), *row), scene, chance.seed(4))
    along = [at.pose(name).position[1] for name in names]
    assert along == sorted(along, reverse=True)


def test_what_fills_a_crate_is_packed_and_cannot_be_picked(chance: Chance) -> None:
    names = [f"c{i}" for i in range(9)]
    crate = {"kind": "container", "size": [0.168, 0.168, 0.056], "wall": 0.006}
    scene = scene_of({**dict.fromkeys(names, CUBE), "crate": crate}, fixed={"crate": [0.5, 0.1]})
    filled = [f"inside({name},crate)" for name in names]
    begun(looking(scene, *filled), scene, chance.seed(5))
    picked = state(*filled), state("-inside(c4,crate)", "holding(panda,c4)")
    entities = dict.fromkeys(scene.shapes, "")
    after = picked[0] | picked[1]
    request = Task("test", (parse_atom("pick(panda,c4)"),), entities, picked[0], (after,), (picked[1],), {})
    verdict = validate_task(request, scene, seed=chance.seed(6), budget=BUDGET)
    assert (verdict.status, verdict.restarts) == ("not_found", BUDGET.restarts + PACKED)
    assert verdict.causes["the arm collides"] > 0


def test_what_has_no_room_at_all_is_not_found(chance: Chance) -> None:
    names = [f"c{i}" for i in range(5)]
    scene = scene_of(dict.fromkeys(names, CUBE), workspace={"x": [0.5, 0.55], "y": [0.0, 0.05]})
    verdict = validate_task(looking(scene, *(f"on_top({name},table)" for name in names)), scene, seed=chance.seed(7))
    assert verdict.status == "not_found"
    assert any(detail.entities for detail in verdict.details)


def test_packed_objects_never_overlap_and_hold_their_facts(chance: Chance) -> None:
    for number in range(chance.examples(6)):
        rng = chance.generator(10 + number)
        shapes: dict[str, Any] = {
            f"b{i}": {
                "kind": "box",
                "size": [round(rng.uniform(0.03, 0.09), 3), round(rng.uniform(0.03, 0.09), 3), 0.05],
            }
            for i in range(rng.randint(2, 9))
        }
        names = [*shapes]
        scene = scene_of({**shapes, "post": CAN}, fixed={"post": [rng.uniform(0.4, 0.6), rng.uniform(-0.1, 0.1)]})
        facts = [f"on_top({name},table)" for name in names] + [f"left_of({names[0]},{names[1]})"]
        physical = physical_task(looking(scene, *facts), scene)
        still = Situation(scene, {"post": fixed_pose(scene, "post")})
        with open_simulator(scene) as simulator:
            search = Search(
                simulator, physical.objects, np.random.default_rng(chance.seed(100 + number)), {}, packs=True
            )
            found = pack(search, still, names, lambda *_, held=physical.initial: held)
        assert all(fact.is_satisfied(found) for fact in physical.initial)
        for one, two in combinations([*names, "post"], 2):
            (ax, ay, _), (bx, by, _) = found.pose(one).position, found.pose(two).position
            (aw, ah, _), (bw, bh, _) = found.body(one).half, found.body(two).half
            assert max(abs(ax - bx) - aw - bw, abs(ay - by) - ah - bh) >= packing.SPACING - 1e-6


@pytest.mark.parametrize("along_x", [True, False])
@pytest.mark.parametrize("y", [1, -1])
@pytest.mark.parametrize("x", [1, -1])
def test_a_corner_orders_places_row_by_row(x: int, y: int, along_x: bool) -> None:
    points = np.array([(a, b) for a in (0.0, 0.1, 0.2) for b in (0.0, 0.1 + 1e-9, 0.1)])
    ordered = Corner(x, y, along_x).order(points).round(6).tolist()
    assert ordered == sorted(ordered, key=lambda at: (y * at[1], x * at[0]) if along_x else (x * at[0], y * at[1]))


@pytest.mark.parametrize("yaw", [0, 10])
def test_four_bricks_fill_a_crate_up_to_a_millimetre(chance: Chance, yaw: int) -> None:
    names = [f"c{i}" for i in range(4)]
    brick = {"kind": "box", "size": [0.1, 0.05, 0.04]}
    crate = {"kind": "container", "size": [0.213, 0.113, 0.05], "wall": 0.006}
    scene = scene_of({**dict.fromkeys(names, brick), "crate": crate}, fixed={"crate": [0.5, 0.1, yaw]})
    begun(looking(scene, *(f"inside({name},crate)" for name in names)), scene, chance.seed(8))
    small = {**crate, "size": [0.2105, 0.113, 0.05]}
    scene = scene_of({**dict.fromkeys(names, brick), "crate": small}, fixed={"crate": [0.5, 0.1, yaw]})
    request = looking(scene, *(f"inside({name},crate)" for name in names))
    assert validate_task(request, scene, seed=chance.seed(9), budget=BUDGET).status == "not_found"
