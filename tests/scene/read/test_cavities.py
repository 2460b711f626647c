"""Cavities that are found on the geometry of bodies, and what stands in them and on them."""

from __future__ import annotations

import json
import math
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
import trimesh

from prag_asp.dataset.jsonl import Record, write_line
from prag_asp.physics import check_witness, validate_task
from prag_asp.physics.predicates import PREDICATES
from prag_asp.physics.situation import Situation
from prag_asp.physics.world.support import riders, unsupported
from prag_asp.scene.geometry import Pose, yaw_quaternion
from prag_asp.scene.read.cavities import flooding
from prag_asp.scene.read.cavities.flooding import cached_cavity, find_cavity
from prag_asp.scene.read.urdf import read_urdf
from prag_asp.scene.scene import BodyModel, Scene, Shape, Solid
from prag_asp.scene.surfaces import surface
from tests.independent.check import problems
from tests.independent.world import world_of
from tests.physics.random_tasks import scene_with
from tests.physics.scenarios import state, task

PART = "<collision><origin xyz='{} {} {}' rpy='0 0 {}'/><geometry><box size='{} {} {}'/></geometry></collision>"
BODY = "<robot name='x'><link name='a'><inertial><mass value='0.2'/></inertial>{}</link></robot>"


def cup(wall: float = 0.04, handle: float = 0.0, floor: bool = True) -> str:
    """Return a URDF of a square cup, 64 mm wide inside, with a floor of 6 mm, and a handle on its +x side."""
    walls = [(0.035, 0, wall / 2, 0, 0.006, 0.076, wall), (-0.035, 0, wall / 2, 0, 0.006, 0.076, wall)]
    walls += [(0, 0.035, wall / 2, 0, 0.076, 0.006, wall), (0, -0.035, wall / 2, 0, 0.076, 0.006, wall)]
    parts = [*walls, *([(0, 0, 0.003, 0, 0.076, 0.076, 0.006)] if floor else [])]
    parts += [(0.038 + handle / 2, 0, 0.02, 0, handle, 0.01, 0.01)] if handle else []
    return BODY.format("".join(PART.format(*part) for part in parts))


def read(folder, text: str) -> Shape:
    (folder / "m.urdf").write_text(text)
    return read_urdf(folder / "m.urdf", folder)


@pytest.mark.parametrize("handle", [0.0, 0.03])
def test_the_cavity_of_a_cup_is_that_between_its_walls(tmp_path, handle):
    cavity = read(tmp_path, cup(handle=handle)).model.cavity
    assert cavity.sides == pytest.approx((0.064, 0.064, 0.034), abs=1e-6)
    assert cavity.middle == pytest.approx((-handle / 2, 0.0, 0.006 - 0.02), abs=1e-6)


@pytest.mark.parametrize("degrees", [0.0, 30.0, -12.0, 45.0, 88.0])
def test_the_cavity_of_a_box_that_is_turned_in_its_file_is_exact_and_turned(tmp_path, degrees):
    long, wide, wall, height = 0.12, 0.092, 0.004, 0.06
    turn = math.radians(degrees)
    parts = [(0.0, 0.0, wall / 2, long + 2 * wall, wide + 2 * wall, wall)]
    parts += [(side * (long + wall) / 2, 0.0, height / 2, wall, wide + 2 * wall, height) for side in (-1, 1)]
    parts += [(0.0, side * (wide + wall) / 2, height / 2, long + 2 * wall, wall, height) for side in (-1, 1)]
    text = "".join(
        PART.format(x * math.cos(turn) - y * math.sin(turn), x * math.sin(turn) + y * math.cos(turn), z, turn, *size)
        for x, y, z, *size in parts
    )
    shape = read(tmp_path, BODY.format(text))
    cavity = shape.model.cavity
    # Walls have no front: after a turn by more than 45 degrees, the long side is the second.
    straight = abs(degrees) <= 45.0
    assert cavity.sides == pytest.approx((long, wide, 0.056) if straight else (wide, long, 0.056), abs=1e-6)
    assert cavity.yaw == pytest.approx(turn if straight else turn - math.pi / 2, abs=1e-6)
    assert cavity.middle == pytest.approx((0.0, 0.0, wall - height / 2), abs=1e-6)
    for side, feasible in ((0.0915, True), (0.0925, False)):
        block = Shape("box", (side, side, 0.05))
        shapes = {"panda": Shape("robot"), "table_1": Shape("table"), "box_1": shape, "cube_1": block}
        scene = Scene(shapes, fixed={"box_1": (0.5, 0.1, 0.4)})
        inside = task(state("inside(cube_1,box_1)"))
        verdict = validate_task(inside, scene, seed=1)
        assert verdict.feasible == feasible, verdict.reason
        if feasible:
            assert check_witness(inside, verdict.witness, scene) == []
            record = json.loads(write_line(Record(inside, None, verdict.witness.to_json())))
            assert problems(record, record["witness"], world_of(scene)) == []
            # Along the axes of the body itself, which are not those of the cavity, the block is not inside.
            first = verdict.witness.moments[0]
            turned = Pose(first.poses["cube_1"].position, yaw_quaternion(0.4))
            situation = Situation(scene, {**first.poses, "cube_1": turned})
            assert PREDICATES["inside"].holds(situation, ("cube_1", "box_1")) == (degrees == 0.0)


def test_a_box_with_rounded_edges_has_an_exact_cavity_and_one_with_a_step_in_it_is_measured_on_the_grid():
    outline = [(sx * 0.04 + 0.01 * math.cos(a), sy * 0.03 + 0.01 * math.sin(a)) for sx, sy, a in rounded_corners()]
    inner, outer = (np.array(outline) * scale for scale in (1.0, 1.2))
    cavity = find_cavity(trough(inner, outer))
    assert cavity.sides == pytest.approx((0.1, 0.08, 0.05), abs=1e-6)
    step = trimesh.creation.box((0.03, 0.08, 0.05)).apply_translation((0.035, 0.0, 0.035))
    stepped = find_cavity(np.concatenate([trough(inner, outer), step.triangles]))
    assert stepped.sides == pytest.approx((0.07, 0.08, 0.05), abs=0.004)
    assert stepped.yaw == 0.0


def rounded_corners():
    """Yield the quarter of each point of a rectangle with rounded corners, and its angle in the corner's circle."""
    for quarter, (sx, sy) in enumerate(((1, 1), (-1, 1), (-1, -1), (1, -1))):
        for a in np.linspace(0.0, math.pi / 2, 5):
            yield sx, sy, quarter * math.pi / 2 + a


def trough(inner, outer):
    """Return the triangles of a container with given outlines (n, 2), a floor at 10 mm and a rim at 60 mm."""

    def ring(outline, z):
        return np.column_stack([outline, np.full(len(outline), z)])

    rings = [ring(outer, 0.0), ring(outer, 0.06), ring(inner, 0.06), ring(inner, 0.01)]
    triangles = []
    for low, high in pairwise(rings):
        for i in range(len(low)):
            triangles += [(low[i - 1], low[i], high[i]), (low[i - 1], high[i], high[i - 1])]
    for edge, z, sign in ((rings[0], 0.0, -1), (rings[-1], 0.01, 1)):
        for i in range(len(edge)):
            triangles.append((np.array([0.0, 0.0, z]), *((edge[i - 1], edge[i])[::sign])))
    return np.array(triangles)


@pytest.mark.parametrize(
    "text", [cup(floor=False), cup(wall=0.012), BODY.format(PART.format(0, 0, 0, 0.3, 0.05, 0.05, 0.05))]
)
def test_a_ring_a_shallow_dish_and_a_block_have_no_cavity(tmp_path, text):
    assert read(tmp_path, text).model.cavity is None


def test_a_round_cup_has_a_cavity_as_wide_as_its_inner_side(tmp_path):
    sides = 24
    wall = [
        PART.format(0.043 * math.cos(a), 0.043 * math.sin(a), 0.03, a, 0.006, 0.0125, 0.06)
        for a in np.arange(sides) * 2 * math.pi / sides
    ]
    floor = (
        "<collision><origin xyz='0 0 0.003'/><geometry><cylinder radius='0.043' length='0.006'/></geometry></collision>"
    )
    cavity = read(tmp_path, BODY.format("".join(wall) + floor)).model.cavity
    assert cavity.sides[:2] == pytest.approx((0.08, 0.08), abs=0.004)
    assert cavity.sides[2] == pytest.approx(0.054, abs=1e-3)


def test_a_ball_stands_in_a_cup_and_a_board_on_its_rim(tmp_path):
    shapes = {"cup": read(tmp_path, cup()), "ball": Shape("sphere", (0.04,) * 3), "lid": Shape("box", (0.1, 0.1, 0.01))}
    cup_at, within, above = Pose((0.5, 0.0, 0.02)), Pose((0.51, 0.0, 0.026)), Pose((0.5, 0.0, 0.045))
    places = {"cup": cup_at, "ball": within, "lid": above}
    situation = Situation(Scene(shapes), places)
    assert unsupported(situation, list(places)) is None
    assert sorted(riders(situation, "cup", places)) == ["ball", "lid"]
    beside = situation.with_pose("ball", Pose((0.55, 0.0, 0.026)))
    assert unsupported(beside, list(places)) == "ball"


@pytest.mark.parametrize(("cup_size", "feasible"), [(1.0, True), (0.6, False)])
def test_a_cube_is_in_a_cup_where_the_cavity_is_wide_enough(tmp_path, cup_size, feasible):
    # The cube is 50 mm wide, the cavity 64 mm, or 38.4 mm at 60 percent.
    text = cup()
    if cup_size < 1.0:
        text = cup().replace("0.035", "0.0222").replace("0.076", "0.0504")
    (tmp_path / "m.urdf").write_text(text)
    scene = scene_with(
        "tabletop",
        {"bin": {"kind": "urdf", "path": "m.urdf"}},
        folder=tmp_path,
        fixed={"bin_1": [0.5, 0.2]},
    )
    inside = task(state("inside(cube_1,bin_1)", "-holding(panda,cube_1)"))
    verdict = validate_task(inside, scene, seed=1)
    assert verdict.feasible == feasible
    assert not feasible or check_witness(inside, verdict.witness, scene) == []


BASKET = [
    (0, 0, 0.003, 0, 0.2, 0.14, 0.006),
    *((side * 0.097, 0, 0.035, 0, 0.006, 0.14, 0.07) for side in (1, -1)),
    *((0, side * 0.067, 0.035, 0, 0.2, 0.006, 0.07) for side in (1, -1)),
    *((0, side * 0.067, 0.13, 0, 0.014, 0.006, 0.12) for side in (1, -1)),
    (0, 0, 0.183, 0, 0.014, 0.14, 0.014),
]


def test_a_handle_over_a_basket_does_not_divide_its_cavity(tmp_path):
    shape = read(tmp_path, BODY.format("".join(PART.format(*part) for part in BASKET)))
    assert shape.model.cavity.sides == pytest.approx((0.188, 0.128, 0.064), abs=0.005)
    long = task(state("inside(brick,basket)"), ("wait", {}))
    brick = Shape("box", (0.12, 0.06, 0.04))
    made = Scene({"panda": Shape("robot"), "table": Shape("table"), "basket": shape, "brick": brick})
    verdict = validate_task(long, made, seed=1)
    assert verdict.feasible and verdict.witness is not None
    assert check_witness(long, verdict.witness, made) == []


@pytest.mark.parametrize(("gap", "holds"), [(0.005, True), (0.02, False)])
def test_a_floor_of_slats_holds_things_if_its_gaps_are_narrow(tmp_path, gap, holds):
    pitch, wide = 0.02 + gap, 0.02
    count = round(0.1 / pitch)
    slats = [((i - (count - 1) / 2) * pitch, 0, 0.003, 0, wide, 0.112, 0.006) for i in range(count)]
    length = count * pitch - gap
    walls = [(side * (length / 2 - 0.003), 0, 0.03, 0, 0.006, 0.112, 0.06) for side in (1, -1)]
    walls += [(0, side * 0.053, 0.03, 0, length, 0.006, 0.06) for side in (1, -1)]
    shape = read(tmp_path, BODY.format("".join(PART.format(*part) for part in [*slats, *walls])))
    assert (shape.model.cavity is not None) == holds


def test_a_box_with_a_lid_is_no_container(tmp_path):
    lid = (0, 0, 0.043, 0, 0.076, 0.076, 0.006)
    assert read(tmp_path, cup().replace("</link>", PART.format(*lid) + "</link>")).model.cavity is None


def lathe(profile: list[tuple[float, float]], sides: int = 40) -> np.ndarray:
    """Return the triangles of the surface that a profile of radii and heights describes about the z axis."""
    steps = np.linspace(0.0, 1.0, 6)[:-1, None]
    fine = np.concatenate([[*(a + steps * (b - a)), b] for a, b in pairwise(np.array(profile))])
    angles = np.arange(sides + 1) * 2 * np.pi / sides
    rings = [np.stack([r * np.cos(angles), r * np.sin(angles), np.full(sides + 1, z)], 1) for r, z in fine]
    quads = [(a[:-1], a[1:], b[1:], b[:-1]) for a, b in pairwise(rings)]
    return np.concatenate([np.stack(three, 1) for a, b, c, d in quads for three in ((a, b, c), (a, c, d))])


def bowl(width: float, wall: float = 0.03) -> np.ndarray:
    r, t = width / 2, wall * width
    return lathe([(0, 0), (r / 2, 0), (r, 0.8 * r), (r - t, 0.8 * r), (r / 2 - t / 2, t), (0, t)])


def split(triangles: np.ndarray, gap: float) -> np.ndarray:
    """Return triangles with a crack in a plane through the axis."""
    aside = np.where(triangles.mean(1)[:, 1:2] > 0.0, gap / 2, -gap / 2)
    return triangles + np.insert(np.zeros((len(triangles), 2)), [1], aside, axis=1)[:, None]


def cracked(triangles: np.ndarray, gap: float = 0.001) -> np.ndarray:
    """Return triangles with cracks between all of them: each corner is moved towards the middle."""
    inward = triangles.mean(1, keepdims=True) - triangles
    far = np.linalg.norm(inward, axis=2, keepdims=True)
    return triangles + inward / np.maximum(far, 1e-9) * np.minimum(gap / 2, far / 2)


def tangled(triangles: np.ndarray) -> np.ndarray:
    """Return a shell twice, 0.5 mm apart, with every second triangle turned over: not a manifold."""
    double = np.concatenate([triangles, triangles + np.array([0.0, 0.0, 0.0005])])
    return np.where(np.arange(len(double))[:, None, None] % 2 == 0, double, double[:, ::-1])


@pytest.mark.parametrize(
    ("width", "broken"),
    [
        (0.08, lambda t: split(t, 0.003)),
        (0.15, lambda t: cracked(tangled(split(t, 0.002)))),
        (0.08, cracked),
        (0.6, cracked),
    ],
)
def test_cracks_of_3_mm_and_doubled_walls_leave_a_bowl_its_cavity(width, broken):
    whole, found = find_cavity(bowl(width)), find_cavity(broken(bowl(width)))
    slack = 0.004 + width / 32
    assert whole.sides == pytest.approx((0.94 * width, 0.94 * width, 0.37 * width), abs=slack)
    assert found is not None and found.sides == pytest.approx(whole.sides, abs=slack)


@pytest.mark.parametrize("turn", [0.0, 0.3])
def test_walls_thinner_than_a_cell_of_the_grid_hold_a_cavity(turn):
    parts = [(0, 0, 0.001, 0.4, 0.3, 0.002), *((s * 0.19925, 0, 0.06, 0.0015, 0.3, 0.12) for s in (1, -1))]
    parts += [(0, s * 0.14925, 0.06, 0.4, 0.0015, 0.12) for s in (1, -1)]
    shape = Shape("mesh", model=BodyModel(tuple(Solid("box", part[3:], part[:3]) for part in parts), 1.0))
    cosine, sine = math.cos(turn), math.sin(turn)
    cavity = find_cavity(surface(shape) @ np.array([(cosine, sine, 0), (-sine, cosine, 0), (0, 0, 1)]))
    assert cavity.sides == pytest.approx((0.397, 0.297, 0.118), abs=1e-9)
    assert cavity.yaw == pytest.approx(turn)


@pytest.mark.parametrize("broken", [cracked, tangled])
def test_a_torus_a_stool_a_tube_and_a_plate_3_mm_deep_have_no_cavity_even_if_broken(broken):
    ring = [(0.06 + 0.02 * math.cos(a), 0.02 + 0.02 * math.sin(a)) for a in np.linspace(0, 2 * math.pi, 9)]
    tube = [(0.037, 0), (0.04, 0), (0.04, 0.08), (0.037, 0.08), (0.037, 0)]
    plate = [(0, 0), (0.1, 0), (0.1, 0.006), (0.096, 0.006), (0.094, 0.003), (0, 0.003)]
    legs = [Solid("box", (0.02, 0.02, 0.2), (x * 0.09, y * 0.09, 0.1)) for x in (1, -1) for y in (1, -1)]
    stool = BodyModel((Solid("box", (0.2, 0.2, 0.01), (0, 0, 0.205)), *legs), 1.0)
    for triangles in (lathe(ring), lathe(tube), lathe(plate), surface(Shape("mesh", model=stool))):
        assert find_cavity(broken(triangles)) is None


def test_a_cavity_is_found_once_and_then_read_from_the_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PRAG_ASP_CACHE", str(tmp_path))
    searches = []

    def search(triangles):
        searches.append(len(triangles))
        return find_cavity(triangles)

    monkeypatch.setattr(flooding, "find_cavity", search)
    expected = find_cavity(bowl(0.08))
    assert expected is not None
    assert [cached_cavity(bowl(0.08)) for _ in range(3)] == [expected] * 3
    assert [cached_cavity(bowl(0.08)[:2]) for _ in range(3)] == [None] * 3
    assert len(searches) == 2
    for file in tmp_path.glob("*.cavity"):
        file.write_bytes(b"[[0, 0, 0], [9, 9, 9]]")
    assert cached_cavity(bowl(0.08)) == expected and len(searches) == 3
