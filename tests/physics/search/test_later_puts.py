"""A task that puts objects into one body after another: each leaves room for the later ones, and for the hand."""

from __future__ import annotations

from itertools import combinations
from typing import Any

import pytest

from prag_asp.atom import Atom, parse_atom
from prag_asp.physics import Budget, Verdict, check_witness, validate_task
from prag_asp.physics.search.foresight import foresee_puts
from prag_asp.physics.symbolic_facts import physical_task
from prag_asp.scene.geometry import to_local
from prag_asp.scene.scene import Scene
from prag_asp.scene.scene_loader import parse_scene
from prag_asp.task import Task
from tests.chance import Chance
from tests.physics.scenarios import state

CUBE = {"kind": "box", "size": [0.05, 0.05, 0.05]}
BUDGET = Budget(4, 6)
FINGERS = 0.0655
"""The distance of the outside of an open finger from the middle of the hand, in metres, from the Panda's data sheet."""


def tray_scene(number: int, size: tuple[float, float], yaw: float, thing: dict[str, Any] = CUBE) -> Scene:
    tray = {"kind": "container", "size": [*size, 0.035], "wall": 0.006}
    cubes = {f"c{i}": thing for i in range(number)}
    shapes = {"panda": {"kind": "robot"}, "table": {"kind": "table"}, "tray": tray, **cubes}
    given = {"workspace": {"x": [0.25, 0.72], "y": [-0.5, 0.5]}, "shapes": shapes, "fixed": {"tray": [0.47, 0.25, yaw]}}
    return parse_scene(given, {}, {name: name for name in shapes})


def inserting_all(scene: Scene, names: list[str]) -> Task:
    """The task in which the robot takes objects from the table and puts them into the tray, one after the other."""
    now: dict[Atom, bool] = state(*(f"on_top({name},table)" for name in names))
    initial = now
    actions, states, subgoals = list[Atom](), list[dict[Atom, bool]](), list[dict[Atom, bool]]()
    for name in names:
        facts = (f"on_top({name},table)", f"holding(panda,{name})", f"inside({name},tray)")
        lies, held, lies_in = map(parse_atom, facts)
        for action, subgoal in (
            (f"pick(panda,{name})", {lies: False, lies_in: False, held: True}),
            (f"insert(panda,{name},tray)", {held: False, lies_in: True}),
        ):
            now = {**now, **subgoal}
            actions.append(parse_atom(action))
            states.append(now)
            subgoals.append(subgoal)
    return Task("test", tuple(actions), dict.fromkeys(scene.shapes, ""), initial, tuple(states), tuple(subgoals), {})


def found(scene: Scene, names: list[str], seed: int) -> Verdict:
    request = inserting_all(scene, names)
    verdict = validate_task(request, scene, seed=seed, budget=BUDGET)
    assert verdict.feasible and verdict.witness is not None, verdict.nearest
    assert check_witness(request, verdict.witness, scene) == []
    return verdict


TRAYS = [(8, (0.30, 0.20), 90), (8, (0.30, 0.20), 63), (4, (0.20, 0.15), 90)]


@pytest.mark.parametrize(("number", "size", "yaw"), TRAYS)
def test_cubes_are_put_into_a_tray_in_rows_with_room_for_the_fingers(
    chance: Chance, number: int, size: tuple[float, float], yaw: float
) -> None:
    scene, names = tray_scene(number, size, yaw), [f"c{i}" for i in range(number)]
    for i in range(2):
        witness = found(scene, names, chance.seed(i)).witness
        assert witness is not None
        last = witness.moments[-1].poses
        places = [to_local(last["tray"], *last[name].position[:2]) for name in names]
        for one, two in combinations(places, 2):
            gaps = [abs(a - b) - 0.05 for a, b in zip(one, two, strict=True)]
            assert max(gaps) > 0.001, "cubes touch"
        for one in places:
            # Along one axis or the other, both sides of a cube are free for an open hand.
            beside: tuple[list[float], list[float]] = ([], [])
            for two in places:
                offsets = [abs(a - b) for a, b in zip(one, two, strict=True)]
                for axis in (0, 1):
                    if two != one and offsets[1 - axis] < 0.03:
                        beside[axis].append(offsets[axis] - 0.025)
            assert any(min(there, default=1.0) >= FINGERS for there in beside)


def test_bricks_are_turned_so_that_the_fingers_have_room(chance: Chance) -> None:
    scene = tray_scene(6, (0.30, 0.20), 90, {"kind": "box", "size": [0.09, 0.04, 0.05]})
    verdict = found(scene, [f"c{i}" for i in range(6)], chance.seed(4))
    assert verdict.restarts > BUDGET.restarts, "only the last restarts look ahead"


def test_later_puts_into_one_body_are_listed_until_an_object_is_put_there_again() -> None:
    scene = tray_scene(3, (0.30, 0.20), 0)
    physical = physical_task(inserting_all(scene, ["c0", "c1", "c2", "c0"]), scene)
    later = {key: [name for name, _ in puts] for key, puts in foresee_puts(physical, scene).items()}
    assert later == {(2, "c0"): ["c1", "c2"], (4, "c1"): ["c2", "c0"], (6, "c2"): ["c0"], (8, "c0"): []}
    assert foresee_puts(physical_task(inserting_all(scene, ["c1"]), scene), scene) == {}
