"""Bodies that are oblique in their files are measured by their solids: as an independent check measures them."""

from __future__ import annotations

import math

import numpy as np
import pytest

from prag_asp.physics import PREDICATES, Budget, check_witness, validate_task
from prag_asp.physics.extent import extent, least_reach, side_yaw
from prag_asp.physics.predicates.gaps import thinnest
from prag_asp.physics.predicates.volume import Volume
from prag_asp.physics.situation import Situation
from prag_asp.physics.witness import Arm
from prag_asp.scene.boxes import Vector
from prag_asp.scene.geometry import IDENTITY, Pose, Quaternion, matrix, yaw_quaternion
from prag_asp.scene.read.body import body_shape, solid_mass
from prag_asp.scene.scene import Scene, Shape, Solid
from prag_asp.scene.surfaces import surface
from tests.chance import Chance
from tests.independent.frames import Frame, moved
from tests.independent.relations import MEANINGS, Seen
from tests.independent.world import Layout, World, world_of
from tests.physics.scenarios import state, task

QUESTIONS = [
    *((name, ("one", "two")) for name in ("near", "far", "left_of", "in_front_of", "touching", "on_top")),
    *((name, ("one", "crate")) for name in ("inside", "located")),
    ("between", ("one", "two", "crate")),
    ("located", ("one", "table")),
    ("over", ("panda", "one")),
]
SURE = 1e-5
"""Metres and radians from an edge at which both definitions have to agree."""

EIGHTH = math.pi / 4


def made(*solids: Solid) -> Shape:
    return body_shape("mesh", solids, solid_mass(solids).scaled(0.2))


def bar(length: float = 0.2, thick: float = 0.03, yaw: float = EIGHTH) -> Shape:
    return made(Solid("box", (length, thick, thick), turn=(0.0, 0.0, yaw)))


def random_body(rng: np.random.Generator) -> Shape:
    """Return two boxes at random places and angles: seldom symmetric about the centre of their box."""
    size, at = rng.uniform(0.02, 0.12, (2, 3)), rng.uniform(-0.04, 0.04, (2, 3))
    turns = [(0.0, 0.0, rng.uniform(-3, 3)), tuple(rng.uniform(-3, 3, 3).tolist())]
    return made(
        *(Solid("box", tuple(s), tuple(a), t) for s, a, t in zip(size.tolist(), at.tolist(), turns, strict=True))
    )


def seen(situation: Situation, world: World) -> Seen:
    frames = {}
    for name, pose in situation.poses.items():
        frames[name] = Frame(matrix(pose)[:3, :3], np.array(pose.position))
    tools = {name: moved(*tool.position) for name, tool in situation.tools.items()}
    return Seen(Layout(world, frames, {}), tools, dict.fromkeys(tools, 0.08))


def missed(name: str, situation: Situation, arguments: tuple[str, ...]) -> float:
    return max(PREDICATES[name].violations(situation, arguments))


def random_pose(rng: np.random.Generator, shape: Shape) -> Pose:
    turn: Quaternion = yaw_quaternion(rng.uniform(-3.0, 3.0))
    middle, half = extent(shape, turn)
    return Pose((rng.uniform(0.3, 0.7), rng.uniform(-0.3, 0.3), half[2] - middle[2]), turn)


def test_an_extent_is_that_of_the_surface_at_any_orientation(chance: Chance) -> None:
    rng = np.random.default_rng(chance.seed(1))
    for _ in range(chance.examples(4)):
        shape, turn = random_body(rng), rng.normal(size=4)
        x, y, z, w = (turn / np.linalg.norm(turn)).tolist()
        points = surface(shape).reshape(-1, 3) @ matrix(Pose((0.0, 0.0, 0.0), (x, y, z, w)))[:3, :3].T
        middle, half = extent(shape, (x, y, z, w))
        assert np.add(middle, half) == pytest.approx(points.max(0))
        assert np.subtract(middle, half) == pytest.approx(points.min(0))
        # What proofs take for the least reach is no more than the reach in this orientation.
        assert least_reach(shape) == thinnest("b", 0, Scene({"b": shape})) <= points.max(0).min() + 1e-12


def test_predicates_hold_as_the_independent_check_says_at_random_places_and_in_their_volumes(chance: Chance) -> None:
    rng = np.random.default_rng(chance.seed(2))
    crate = Shape("container", (0.2, 0.16, 0.06), 0.006)
    sampled = 0
    for _ in range(chance.examples(3)):
        shapes = {"one": random_body(rng), "two": random_body(rng), "crate": crate, "table": Shape("table")}
        scene = Scene({**shapes, "panda": Shape("robot")})
        world = world_of(scene)
        places = {name: random_pose(rng, shapes[name]) for name in ("one", "two", "crate")}
        quaternion, tools = places["one"].quaternion, {"panda": Pose((0.5, 0.0, 0.3))}
        situation = Situation(scene, places, {"panda": Arm((0.0,) * 7, 0.08)}, tools=tools)
        for name, arguments in QUESTIONS:
            predicate, trials = PREDICATES[name], [situation, situation.with_pose("one", places["two"])]
            for at in _some(predicate.volume(situation, arguments, quaternion), rng):
                sampled += 1
                trial = situation.with_pose("one", Pose(at, quaternion))
                if name == "over":
                    trial = Situation(scene, places, situation.arms, tools={"panda": Pose(at)})
                assert missed(name, trial, arguments) <= SURE, name
                trials.append(trial)
            for trial in trials:
                told = max(MEANINGS[name](seen(trial, world), arguments))
                assert abs(told) < SURE or (told < 0.0) == (missed(name, trial, arguments) <= 0.0), name
    assert sampled > 5 * chance.examples(3)


def _some(volume: Volume, rng: np.random.Generator) -> list[Vector]:
    """Return a point of each of two parts of a volume, where they are not empty."""
    parts, points = volume.parts(), []
    for i in rng.permutation(len(parts))[:2].tolist():
        part, ends = parts[i], ((-0.5, -1.0, 0.0), (1.0, 1.0, 0.5))
        part = part._replace(low=tuple(map(max, part.low, ends[0])), high=tuple(map(min, part.high, ends[1])))
        floor = part.floor()
        at = None if floor is None else part.sample(floor, rng.uniform)
        points += [] if at is None else [at]
    return points


def test_the_sides_of_a_body_are_those_of_the_smallest_rectangle() -> None:
    assert side_yaw(bar(yaw=0.3)) == pytest.approx(0.3)
    assert side_yaw(bar(yaw=-0.3)) == pytest.approx(-0.3)
    assert side_yaw(made(Solid("cylinder", (0.1, 0.1, 0.02)))) == 0.0 == side_yaw(Shape("box", (0.1, 0.02, 0.02)))
    scene = Scene({"one": bar(), "brick": Shape("box", (0.1, 0.04, 0.03))})
    places = {"one": Pose((0.5, 0.2, 0.015), yaw_quaternion(-EIGHTH)), "brick": Pose((0.5, 0.0, 0.015), IDENTITY)}
    assert missed("aligned", Situation(scene, places), ("one", "brick")) <= 0.0


@pytest.mark.parametrize(
    ("thing", "size", "fits"),
    [
        (bar(), (0.23, 0.06, 0.05), True),  # the box of its file is 163 mm wide
        (bar(0.2, 0.02), (0.17, 0.18, 0.05), True),  # only along a diagonal
        (bar(), (0.2, 0.06, 0.05), False),
        (made(Solid("box", (0.12, 0.12, 0.01), turn=(0.0, 0.0, EIGHTH))), (0.14, 0.14, 0.05), True),
    ],
)
def test_what_fits_a_crate_however_it_lies_in_its_file_is_found_in_it(thing, size, fits) -> None:
    crate = Shape("container", size, 0.006)
    scene = Scene({"panda": Shape("robot"), "table": Shape("table"), "crate": crate, "thing": thing})
    stays = task(state("inside(thing,crate)"), ("wait", {}))
    verdict = validate_task(stays, scene, seed=3, budget=Budget(restarts=4))
    assert verdict.feasible == fits
    assert not fits or check_witness(stays, verdict.witness, scene) == []
