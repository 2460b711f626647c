"""The independent check finds whatever is wrong with how bodies of a model are held, put down or made."""

from __future__ import annotations

import copy
import json
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from prag_asp.dataset.jsonl import Record, write_line
from prag_asp.physics import Budget, open_validator
from tests.independent.check import problems
from tests.independent.frames import Array, Frame, frame, turned
from tests.independent.world import Model, World, world_of
from tests.physics.test_grasps_of_models import BASIN, HELD, MOVED, scene

BOX, _, BAR, KNOB = HELD
Json = dict[str, Any]
Spoil = Callable[[Json, World], World | None]

GRIPS, IN_AIR, SLIPS = "does not grip thing_1", "turns between the pads", "slips out of the gripper"
TILTS = "tilts out of the pads"
MEETS, SINKS, FALLS = "are in each other", "thing_1 is in the table", "thing_1 falls"


@pytest.fixture(scope="module")
def records() -> dict[str, tuple[World, Json]]:
    """Return the world of each body, and the record of a witness that moves it."""
    found = {}
    for name, thing in HELD.items():
        made = scene(thing)
        with open_validator(made) as validator:
            witness = validator.validate(MOVED, seed=1, budget=Budget(4, 8)).witness
        assert witness is not None
        found[name] = world_of(made), json.loads(write_line(Record(MOVED, None, witness.to_json())))
    return found


def test_good_witnesses_pass(records: dict[str, tuple[World, Json]]) -> None:
    for world, record in records.values():
        assert problems(record, record["witness"], world) == []


def _pose(place: Frame) -> list[list[float]]:
    """Return the pose of a frame as a file has it; the quaternion is an eigenvector (Bar-Itzhack, 2000)."""
    turn, trace = place.turn, np.trace(place.turn)
    skew = np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]])
    matrix = np.block([[turn + turn.T - trace * np.eye(3), skew[:, None]], [skew[None], np.array([[trace]])]])
    return [place.at.tolist(), np.linalg.eigh(matrix)[1][:, -1].tolist()]


def held(at: tuple[float, float, float] = (0.0, 0.0, 0.0), turn: Array | None = None, wider: float = 0.0) -> Spoil:
    """Spoil how the body is in the hand, which it stays as the witness has it: moved and turned in the tool's axes."""

    def spoil(record: Json, world: World) -> None:
        moment = record["witness"]["moments"][1]
        arm = moment["arms"]["panda"]
        tool = world.robots["panda"].tool(tuple(arm["joints"]))
        grasp = Frame(np.eye(3) if turn is None else turn, np.array(at)) @ frame(arm["grasp"])
        arm["grasp"], moment["poses"]["thing_1"] = _pose(grasp), _pose(tool @ grasp)
        arm["width"] += wider

    return spoil


def placed(k: int, at: tuple[float, float, float], turn: Array | None = None) -> Spoil:
    """Spoil where the body is in a state, and how it is turned."""

    def spoil(record: Json, world: World) -> None:
        poses = record["witness"]["moments"][k]["poses"]
        place = frame(poses["thing_1"])
        poses["thing_1"] = _pose(Frame(place.turn if turn is None else turn @ place.turn, place.at + np.array(at)))

    return spoil


def shelved(at: tuple[float, float, float]) -> Spoil:
    """Spoil where the body is at the end, from the middle of the shelf's top."""

    def spoil(record: Json, world: World) -> None:
        poses = record["witness"]["moments"][2]["poses"]
        poses["thing_1"][0][:2] = [at[0] + poses["shelf_1"][0][0], at[1] + poses["shelf_1"][0][1]]
        poses["thing_1"][0][2] += at[2]

    return spoil


def weighing(factor: float) -> Spoil:
    """Make the body of the scene heavier."""
    return lambda record, world: replace(world, masses={**world.masses, "thing_1": factor * world.masses["thing_1"]})


def heavy_at(at: tuple[float, float, float], mass: float) -> Spoil:
    """Put the centre of mass of the scene's body elsewhere."""

    def spoil(record: Json, world: World) -> World:
        model = Model(np.array(at), world.models["thing_1"].cavity)
        return replace(world, models={"thing_1": model}, masses={**world.masses, "thing_1": mass})

    return spoil


def swapped(name: str) -> Spoil:
    """Put another body into the scene."""
    return lambda record, world: world_of(scene(HELD[name]))


def rubbed(friction: float) -> Spoil:
    """Make the body of the scene smoother."""
    return lambda record, world: replace(world, frictions={**world.frictions, "thing_1": friction})


def waypoint(k: int, name: str, change: Callable[[Json, World], None]) -> Spoil:
    """Spoil the waypoint of a name in a motion."""

    def spoil(record: Json, world: World) -> None:
        change(next(each for each in record["witness"]["motions"][k] if each["name"] == name), world)

    return spoil


def without(k: int, name: str) -> Spoil:
    """Leave out the waypoint of a name in a motion."""

    def spoil(record: Json, world: World) -> None:
        motion = record["witness"]["motions"][k]
        motion.remove(next(each for each in motion if each["name"] == name))

    return spoil


def _turn_joint(number: int, angle: float) -> Callable[[Json, World], None]:
    def change(each: Json, world: World) -> None:
        each["joints"][number] += angle

    return change


def _widen(by: float) -> Callable[[Json, World], None]:
    def change(each: Json, world: World) -> None:
        each["width"] += by

    return change


def in_the_hand(record: Json, world: World) -> None:
    """Put the body of the first state where the palm is."""
    moment = record["witness"]["moments"][0]
    tool = world.robots["panda"].tool(tuple(moment["arms"]["panda"]["joints"]))
    moment["poses"]["thing_1"][0] = (tool.at - 0.08 * tool.turn[:, 2]).tolist()


FAULTS: tuple[tuple[str, str, Spoil, str], ...] = (
    ("4 mm off to the left", BOX, held((0.0, 0.004, 0.0)), GRIPS),
    ("4 mm off to the right", BOX, held((0.0, -0.004, 0.0)), GRIPS),
    ("a rim 4 mm off", BASIN, held((0.0, 0.004, 0.0)), GRIPS),
    ("a handle 4 mm off", BAR, held((0.0, 0.004, 0.0)), GRIPS),
    ("a knob 4 mm off", KNOB, held((0.0, -0.004, 0.0)), GRIPS),
    ("too wide open", BOX, held(wider=0.005), GRIPS),
    ("too wide open at a rim", BASIN, held(wider=0.004), GRIPS),
    ("too narrow", BOX, held(wider=-0.005), GRIPS),
    ("too narrow at a knob", KNOB, held(wider=-0.003), GRIPS),
    ("a rim below the pads", BASIN, held((0.0, 0.0, 0.06)), GRIPS),
    ("a knob below the pads", KNOB, held((0.0, 0.0, 0.05)), GRIPS),
    ("a box far below the pads", BOX, held((0.0, 0.0, 0.08)), GRIPS),
    ("a knob beside the pads", KNOB, held((0.045, 0.0, 0.0)), GRIPS),
    ("a bar beside the pads", BAR, held((0.2, 0.0, 0.0)), GRIPS),
    ("pads on slanted sides", BOX, held(turn=turned(0.9, "x")), GRIPS),
    ("pads across a corner", BOX, held(turn=turned(0.9, "z")), GRIPS),
    ("a rim that is turned", BASIN, held(turn=turned(0.8, "z")), GRIPS),
    ("a bar that is turned", BAR, held(turn=turned(0.7, "z")), GRIPS),
    ("a knob on a corner", KNOB, held(turn=turned(0.8, "z")), GRIPS),
    ("a smooth body on slanted sides", BOX, rubbed(0.0), SLIPS),
    ("a hand through the rim", BASIN, held((0.0, 0.0, -0.04)), "the arm is in thing_1"),
    ("a palm in the box", BOX, held((0.0, 0.0, -0.06)), "the arm is in thing_1"),
    ("a body in the palm", KNOB, in_the_hand, "the arm is in thing_1"),
    ("a rod that is gripped at its end", BAR, heavy_at((0.0, -0.16, 0.0), 1.0), IN_AIR),
    ("a basin of lead on its far side", BASIN, heavy_at((0.07, 0.07, 0.0), 1.2), IN_AIR),
    ("a basin so heavy that it tilts out of the pads", BASIN, weighing(4.0), TILTS),
    ("too heavy", BOX, weighing(40.0), SLIPS),
    ("a heavy knob", KNOB, weighing(10.0), SLIPS),
    ("another body, a box for a basin", BASIN, swapped(BOX), GRIPS),
    ("another body, a bar for a box", BOX, swapped(BAR), GRIPS),
    ("another body, a basin for a cube", KNOB, swapped(BASIN), GRIPS),
    ("sunk into the table", BOX, placed(0, (0.0, 0.0, -0.004)), SINKS),
    ("a basin sunk into the table", BASIN, placed(0, (0.0, 0.0, -0.003)), SINKS),
    ("over the table", BAR, placed(0, (0.0, 0.0, 0.004)), FALLS),
    ("sunk into the shelf", KNOB, placed(2, (0.0, 0.0, -0.004)), MEETS),
    ("through the shelf", BASIN, shelved((0.0, 0.0, -0.03)), MEETS),
    ("half over the edge of the shelf", BOX, shelved((0.16, 0.0, 0.0)), FALLS),
    ("a bar over the edge of the shelf", BAR, shelved((0.22, 0.0, 0.0)), FALLS),
    ("leaning", KNOB, placed(0, (0.0, 0.0, 0.002), turned(0.08, "x")), FALLS),
    ("over the shelf", BOX, placed(2, (0.0, 0.0, 0.005)), FALLS),
    ("no approach", BASIN, without(0, "approach"), "straight above"),
    ("an approach from beside", BOX, waypoint(0, "approach", _turn_joint(0, 0.02)), "straight above"),
    ("no lift", KNOB, without(0, "lift"), ""),
    ("a lift aside", BAR, waypoint(0, "lift", _turn_joint(0, 0.02)), "straight up"),
    ("fingers that open around what they hold", KNOB, waypoint(0, "lift", _widen(0.004)), "opens or closes around"),
    ("left behind", BOX, placed(2, (0.01, 0.0, 0.0)), "not where it has been left"),
)  # fmt: skip


@pytest.mark.parametrize(("name", "spoil", "words"), [each[1:] for each in FAULTS], ids=[each[0] for each in FAULTS])
def test_a_planted_fault_is_found(name: str, spoil: Spoil, words: str, records: dict[str, tuple[World, Json]]) -> None:
    world, record = records[name]
    changed = copy.deepcopy(record)
    other = spoil(changed, world)
    found = "\n".join(problems(changed, changed["witness"], other or world))
    assert found and words in found, found
