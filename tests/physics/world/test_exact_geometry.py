"""What proofs read of bodies is what the bodies are: exact corners, over random bodies of each kind, and the simulator.

The corners are made here, from numbers drawn here, and share nothing with the package.
"""

from __future__ import annotations

import math
import random
import struct
from collections.abc import Iterator
from itertools import product
from pathlib import Path

import numpy as np
import pybullet
import pytest

from prag_asp.physics.extent import extent
from prag_asp.physics.world.simulator import Simulator, open_simulator
from prag_asp.scene.furniture import bounds, cavity, mechanism
from prag_asp.scene.geometry import Pose, yaw_quaternion
from prag_asp.scene.scene import Scene, Solid
from prag_asp.scene.scene_loader import parse_scene
from prag_asp.scene.solids import solids
from tests.chance import Chance

PLAIN = ("box", "cylinder", "sphere", "container")
SOLIDS = ("box", "cylinder", "sphere", "obj", "text_stl", "binary_stl")
FINE = 720
"""Into how many points a circle is cut: they lie within 1e-5 of its radius of where it is widest."""

ROUND = 2e-5
SIMULATED = 3e-5
"""Metres: PyBullet counts in single precision."""


def length(rng: random.Random) -> float:
    return round(rng.uniform(0.01, 0.15), 5)


def shape_table(kind: str, rng: random.Random) -> dict[str, object]:
    """Return the table of a random body of a kind."""
    if kind == "cylinder":
        return {"kind": kind, "radius": length(rng), "height": length(rng)}
    if kind == "sphere":
        return {"kind": kind, "radius": length(rng)}
    sides = [length(rng), length(rng), length(rng)]
    if kind == "box":
        return {"kind": kind, "size": sides}
    wide = [round(rng.uniform(0.15, 0.4), 5), round(rng.uniform(0.15, 0.4), 5), round(rng.uniform(0.06, 0.2), 5)]
    return {"kind": kind, "size": wide, "wall": round(rng.uniform(0.003, 0.01), 5)}


def turned(points: np.ndarray, rpy: list[float], at: list[float]) -> np.ndarray:
    """Return points turned by roll, pitch and yaw about the fixed axes, then moved."""
    (a, b, c), turn = rpy, np.eye(3)
    for angle, (i, j) in ((a, (1, 2)), (b, (2, 0)), (c, (0, 1))):
        step = np.eye(3)
        step[i, i] = step[j, j] = math.cos(angle)
        step[i, j], step[j, i] = -math.sin(angle), math.sin(angle)
        turn = step @ turn
    return points @ turn.T + at


def circle(radius: float) -> np.ndarray:
    angles = 2 * math.pi * np.arange(FINE) / FINE
    return np.stack([radius * np.cos(angles), radius * np.sin(angles)], axis=1)


def corners(kind: str, sides: tuple[float, ...]) -> np.ndarray:
    """Return points of a box, a cylinder (diameter, height) or a ball (diameter) whose hull it is, or nearly."""
    if kind == "box":
        return np.array([*product(*((-side / 2, side / 2) for side in sides))])
    if kind == "cylinder":
        ring = circle(sides[0] / 2)
        return np.concatenate([np.c_[ring, np.full(FINE, z)] for z in (-sides[-1] / 2, sides[-1] / 2)])
    rings = [np.c_[math.sin(t) * circle(sides[0] / 2), np.full(FINE, math.cos(t) * sides[0] / 2)]
             for t in np.linspace(0.0, math.pi, FINE // 4 + 1)]  # fmt: skip
    return np.concatenate(rings)


def mesh_text(kind: str, points: np.ndarray) -> bytes:
    """Return a mesh of points as an .obj or an .stl: a fan of triangles, for only the hull counts."""
    triangles = [(points[0], points[i], points[i + 1]) for i in range(1, len(points) - 1)]
    if kind == "obj":
        rows = [f"v {x!r} {y!r} {z!r}" for x, y, z in points.tolist()]
        return "\n".join([*rows, *(f"f 1 {i + 1} {i + 2}" for i in range(1, len(points) - 1))]).encode()
    if kind == "text_stl":
        rows = [f"vertex {x!r} {y!r} {z!r}" for three in triangles for x, y, z in (p.tolist() for p in three)]
        return ("solid x\n" + "\n".join(rows)).encode()
    packed = [struct.pack("<12fH", 0, 0, 1, *(v for point in three for v in point), 0) for three in triangles]
    return bytes(80) + struct.pack("<I", len(packed)) + b"".join(packed)


def write_urdf(folder: Path, name: str, rng: random.Random) -> np.ndarray:
    """Write a URDF of one to three random solids, turned and moved, and return their points."""
    collisions, found = [], []
    for number in range(rng.randint(1, 3)):
        kind = rng.choice(SOLIDS)
        at = [round(rng.uniform(-0.05, 0.05), 5) for _ in range(3)]
        rpy = [round(rng.uniform(-3.0, 3.0), 5) for _ in range(3)]
        if kind in PLAIN:
            sides = {"box": (length(rng), length(rng), length(rng)), "cylinder": (length(rng), length(rng)),
                     "sphere": (length(rng),)}[kind]  # fmt: skip
            sizes = {"box": f'size="{" ".join(map(repr, sides))}"',
                    "cylinder": f'radius="{sides[0] / 2!r}" length="{sides[-1]!r}"',
                    "sphere": f'radius="{sides[0] / 2!r}"'}[kind]  # fmt: skip
            geometry, points = f"<{kind} {sizes}/>", corners(kind, sides)
        else:
            scale = [round(rng.uniform(0.5, 2.0), 3) * 1e-3 for _ in range(3)]
            drawn = [[rng.uniform(-50, 50) for _ in range(3)] for _ in range(rng.randint(8, 40))]
            points = np.array(drawn, dtype=np.float32 if kind == "binary_stl" else float)
            file = f"{name}_{number}.{kind.rpartition('_')[2]}"
            (folder / file).write_bytes(mesh_text(kind, points))
            geometry = f'<mesh filename="{file}" scale="{" ".join(map(repr, scale))}"/>'
            points = points.astype(float) * scale
        found.append(turned(points, rpy, at))
        place = f'<origin xyz="{" ".join(map(repr, at))}" rpy="{" ".join(map(repr, rpy))}"/>'
        collisions.append(f"<collision>{place}<geometry>{geometry}</geometry></collision>")
    inertial = '<inertial><mass value="1"/></inertial>'
    (folder / f"{name}.urdf").write_text(
        f'<robot name="x"><link name="a">{inertial}{"".join(collisions)}</link></robot>'
    )
    return np.concatenate(found)


def exact_points(kind: str, table: dict[str, object], points: np.ndarray | None) -> np.ndarray:
    """Return points of a body in its own frame, whose origin is the middle of the box around it."""
    if points is not None:
        return points - (points.min(axis=0) + points.max(axis=0)) / 2
    if kind == "cylinder":
        return corners(kind, (2 * float(str(table["radius"])), float(str(table["height"]))))
    if kind == "sphere":
        return corners(kind, (2 * float(str(table["radius"])),))
    return corners("box", tuple(np.array(table["size"], dtype=float)))


def made(folder: Path, rng: random.Random) -> tuple[Scene, dict[str, np.ndarray]]:
    """Return a scene with a random body of each kind, and their points in their own frames."""
    tables: dict[str, dict[str, object]] = {kind: shape_table(kind, rng) for kind in PLAIN}
    points = {kind: exact_points(kind, table, None) for kind, table in tables.items()}
    for name in ("urdf_1", "urdf_2"):
        points[name] = exact_points("urdf", {}, write_urdf(folder, name, rng))
        tables[name] = {"kind": "urdf", "path": f"{name}.urdf"}
    fixed = {"urdf_1": [0.4, -0.4], "urdf_2": [0.4, 0.4]}  # they need not stand by themselves
    tables["table"] = {"kind": "table"}
    scene = parse_scene({"shapes": tables, "fixed": fixed}, {}, {name: name for name in tables}, folder=folder)
    return scene, points


def lowest_in(simulator: Simulator, entity: str, quaternion: tuple[float, float, float, float]) -> float:
    """Return how far below its frame the simulator has the lowest point of a turned body, by its distance."""
    simulator.place({entity: Pose((0.5, 0.0, 0.3), quaternion)})
    points = pybullet.getClosestPoints(simulator.body(entity), simulator.table, 0.5, physicsClientId=simulator.client)
    return 0.3 - min(point[8] for point in points)


def axes(rng: random.Random) -> Iterator[tuple[float, float, float, float]]:
    """Yield rotations that bring each side of a body down."""
    yield (0.0, 0.0, 0.0, 1.0)
    half = math.sqrt(0.5)
    for x, y in ((1.0, 0.0), (half, 0.0), (-half, 0.0), (0.0, half), (0.0, -half)):
        yield (x, y, 0.0, math.sqrt(max(0.0, 1.0 - x * x - y * y)))


def test_sizes_are_those_of_exact_corners_and_of_the_simulator(
    tmp_path: Path, chance: Chance, monkeypatch: pytest.MonkeyPatch
) -> None:
    # The meshes are fans of random points: of such a tangle only the hull has an exact size.
    monkeypatch.setattr("prag_asp.scene.read.decomposition.can_decompose", lambda: False)
    rng = chance.generator(11)
    for number in range(chance.examples(4)):
        folder = tmp_path / str(number)
        folder.mkdir()
        scene, points = made(folder, rng)
        with open_simulator(scene) as simulator:
            for entity, exact in points.items():
                shape = scene.shapes[entity]
                assert shape.size == pytest.approx(np.ptp(exact, axis=0), abs=ROUND)
                for quaternion in axes(rng):
                    (_, _, middle), (_, _, half) = extent(shape, quaternion)
                    lowest = lowest_in(simulator, entity, quaternion)
                    assert lowest == pytest.approx(half - middle, abs=SIMULATED), entity
                yaw = rng.uniform(-math.pi, math.pi)
                placed = turned(exact, [0.0, 0.0, yaw], [0.0, 0.0, 0.0])
                middle, half = extent(shape, yaw_quaternion(yaw))
                assert np.add(middle, half) == pytest.approx(placed.max(axis=0), abs=ROUND)
                assert np.subtract(middle, half) == pytest.approx(placed.min(axis=0), abs=ROUND)


def test_cavities_and_furniture_are_those_of_their_boxes(chance: Chance) -> None:
    rng = chance.generator(12)
    for _ in range(chance.examples(30)):
        tables = {kind: shape_table(kind, rng) for kind in ("container", "drawer", "cupboard")}
        fixed = {"drawer": [0.5, 0.4], "cupboard": [0.5, -0.4]}
        scene = parse_scene({"shapes": tables, "fixed": fixed}, {}, {name: name for name in tables})
        shape = scene.shapes["container"]
        boxes = [(np.array(solid.at), np.array(solid.size) / 2) for solid in solids(shape)]
        inner = []
        for axis in (0, 1):
            # From the middle to the nearest wall on either side, a little above the floor.
            low = max(at[axis] + half[axis] for at, half in boxes if at[axis] < -1e-6)
            high = min(at[axis] - half[axis] for at, half in boxes if at[axis] > 1e-6)
            inner.append(high - low)
        floor = min(at[2] + half[2] for at, half in boxes)
        top = max(at[2] + half[2] for at, half in boxes)
        assert cavity(shape) == pytest.approx([*inner, top - floor], abs=1e-9)
        for kind in ("drawer", "cupboard"):
            place, closed = Pose((0.5, 0.0, 0.2), yaw_quaternion(rng.uniform(-3, 3))), 0.0
            low_corner, high_corner = bounds(scene.shapes[kind], place, closed)
            yaw = 2 * math.atan2(place.quaternion[2], place.quaternion[3])
            at = list(place.position)
            around = [
                turned(corners("box", tuple(solid.size)) + np.array(solid.at), [0.0, 0.0, yaw], at)
                for solid in _closed(scene, kind)
            ]
            together = np.concatenate(around)
            assert low_corner == pytest.approx(together.min(axis=0), abs=1e-9)
            assert high_corner == pytest.approx(together.max(axis=0), abs=1e-9)


def _closed(scene: Scene, kind: str) -> list[Solid]:
    """Return the solids of closed furniture in its own frame: those of its part stand in the frame of the joint."""
    made_of = mechanism(scene.shapes[kind])
    shift = np.array(made_of.joint)
    parts = [
        solid._replace(at=tuple(np.array(solid.at) + shift))
        for solid in solids(scene.shapes[kind])[len(made_of.body) :]
    ]
    return [*solids(scene.shapes[kind])[: len(made_of.body)], *parts]
