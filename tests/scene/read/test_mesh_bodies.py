"""The kind ``mesh``: what is read of files in several formats, how it stands, and of which convex parts it consists."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pybullet
import pytest
import trimesh

from prag_asp.errors import SceneError
from prag_asp.physics.world.simulator import open_simulator
from prag_asp.scene.geometry import Pose
from prag_asp.scene.read import mesh_body
from prag_asp.scene.read.convex import separate_solids
from prag_asp.scene.read.mesh import file_parts, mesh_parts
from prag_asp.scene.read.stability import falls, settle
from prag_asp.scene.scene import Scene, Shape
from tests.chance import Chance
from tests.physics.random_tasks import scene_with

SIDES = (0.05, 0.04, 0.03)


def body(folder: Path, **table: object) -> Shape:
    """Return the shape of a class of the kind ``mesh``."""
    return scene_with("tabletop", {"cube": {"kind": "mesh", **table}}, folder=folder).shapes["cube_1"]


def write(folder: Path, mesh: trimesh.Trimesh | trimesh.Scene, name: str) -> str:
    """Write a mesh, and return the name of its file."""
    mesh.export(folder / name)
    return name


def angled() -> trimesh.Trimesh:
    """Return an L of 60 x 20 x 60 mm, 20 mm thick: a foot and a wall on its end."""
    outline = np.array([(0, 0), (60, 0), (60, 20), (20, 20), (20, 60), (0, 60)]) / 1000
    front, back = (np.column_stack([outline[:, 0], np.full(6, y), outline[:, 1]]) for y in (0.0, 0.02))
    caps = [(0, 1, 2), (0, 2, 3), (0, 3, 4), (0, 4, 5)]
    sides = [(i, 6 + i, (i + 1) % 6) for i in range(6)] + [((i + 1) % 6, 6 + i, 6 + (i + 1) % 6) for i in range(6)]
    mesh = trimesh.Trimesh(
        np.concatenate([front, back]), [*caps, *((6 + c, 6 + b, 6 + a) for a, b, c in caps), *sides], process=False
    )
    mesh.fix_normals()
    return mesh


@pytest.mark.parametrize("suffix", ["obj", "stl", "ply", "off", "glb", "gltf", "dae"])
def test_a_box_is_the_same_in_every_format(tmp_path, suffix):
    box = trimesh.creation.box(SIDES)
    name = _gltf(tmp_path) if suffix == "gltf" else write(tmp_path, box, f"b.{suffix}")
    shape = body(tmp_path, path=name, mass=0.2, up="z")
    assert shape.size == pytest.approx(SIDES)
    assert shape.model.mass == 0.2
    x, y, z = SIDES
    assert shape.model.moments == pytest.approx([0.2 * (b * b + c * c) / 12 for b, c in ((y, z), (x, z), (x, y))])


def _gltf(folder: Path) -> str:
    """Write a .gltf with its buffers in files beside it."""
    for name, content in trimesh.Scene(trimesh.creation.box(SIDES)).export(file_type="gltf").items():
        (folder / name).write_bytes(content)
    (folder / "model.gltf").rename(folder / "b.gltf")
    return "b.gltf"


def test_a_buffer_outside_the_folder_of_a_gltf_is_not_read(tmp_path):
    folder = tmp_path / "domain"
    folder.mkdir()
    name = _gltf(folder)
    buffer = next(folder.glob("*.bin"))
    buffer.rename(tmp_path / buffer.name)
    (folder / name).write_text((folder / name).read_text().replace(buffer.name, f"../{buffer.name}"))
    with pytest.raises(SceneError, match=r"b\.gltf: not a mesh"):
        body(folder, path=name)


@pytest.mark.parametrize(
    ("table", "size"),
    [
        ({"scale": 2}, (0.1, 0.08, 0.06)),
        ({"scale": [1, 2, 0.5]}, (0.05, 0.08, 0.015)),
        ({"up": "y"}, (0.05, 0.03, 0.04)),
        ({"up": "-x"}, (0.03, 0.04, 0.05)),
        ({"rotation": [90, 0, 0]}, (0.05, 0.03, 0.04)),
        ({"rotation": [0, 0, 90]}, (0.04, 0.05, 0.03)),
        ({"up": "y", "rotation": [0, 0, 90]}, (0.03, 0.05, 0.04)),
        ({"rests": "any", "up": "x"}, (0.05, 0.04, 0.03)),
        ({"rests": "lying", "up": "x"}, (0.05, 0.04, 0.03)),
        ({"rests": "lying"}, (0.05, 0.03, 0.04)),
    ],
)
def test_a_mesh_is_scaled_and_turned_as_its_table_says(tmp_path, table, size):
    shape = body(tmp_path, path=write(tmp_path, trimesh.creation.box(SIDES), "b.stl"), **table)
    assert shape.size[2] == pytest.approx(size[2])
    assert sorted(shape.size) == pytest.approx(sorted(size))


def test_a_file_of_the_format_glb_has_its_y_axis_upwards(tmp_path):
    assert body(tmp_path, path=write(tmp_path, trimesh.creation.box(SIDES), "b.glb")).size[2] == pytest.approx(0.04)


def test_without_a_mass_it_is_that_of_the_volume_and_the_material(tmp_path):
    name = write(tmp_path, angled(), "l.obj")
    shapes = {"cube": {"kind": "mesh", "path": name}}
    scene = scene_with("tabletop", shapes, folder=tmp_path, materials={"cube": {"density": 1000}})
    model = scene.shapes["cube_1"].model
    assert model.mass == pytest.approx(0.06 * 0.02 * 0.02 * 1000 + 0.04 * 0.02 * 0.02 * 1000)
    own = scene_with("tabletop", {"cube": {**shapes["cube"], "density": 500}}, folder=tmp_path).shapes["cube_1"].model
    assert own.mass == pytest.approx(model.mass / 2)
    assert own.moments == pytest.approx([moment / 2 for moment in model.moments])
    # The foot has its middle at (30, 10), the wall at (10, 40): 3 to 2 by volume; the middle of the box is at 30.
    assert model.centre == pytest.approx((-0.008, 0.0, -0.008))


def test_a_concave_mesh_consists_of_convex_parts_and_the_same_ones_from_the_cache(tmp_path, monkeypatch):
    monkeypatch.setenv("PRAG_ASP_CACHE", str(tmp_path / "cache"))
    name = write(tmp_path, angled(), "l.obj")
    shape = body(tmp_path, path=name, mass=0.1)
    first = mesh_parts(str(tmp_path / name))
    assert len(file_parts(str(tmp_path / name))) == 1
    assert len(first) >= 2
    assert len(list((tmp_path / "cache").glob("mesh-*"))) >= 1
    (tmp_path / "again.obj").write_bytes((tmp_path / name).read_bytes())
    assert mesh_parts(str(tmp_path / "again.obj")) == first
    # A ball of 30 mm in the corner of the L touches neither the foot nor the wall; 6 mm further down it does.
    with open_simulator(Scene({"thing": shape, "ball": Shape("sphere", (0.03,) * 3)})) as simulator:
        bodies = simulator.body("thing"), simulator.body("ball")
        for height, apart in ((0.04, True), (0.029, False)):
            simulator.place({"thing": Pose((0.5, 0.0, 0.03)), "ball": Pose((0.51, 0.0, height))})
            points = pybullet.getClosestPoints(*bodies, 0.1, physicsClientId=simulator.client)
            assert (min(point[8] for point in points) > -0.0015) == apart


def crossed() -> trimesh.Trimesh:
    """Return two boxes that cross each other, as one mesh."""
    return trimesh.util.concatenate([trimesh.creation.box((0.04, 0.04, 0.1)), trimesh.creation.box((0.1, 0.03, 0.03))])


def test_closed_convex_solids_in_one_object_are_parts_without_a_decomposition(tmp_path, monkeypatch):
    monkeypatch.setattr("prag_asp.scene.read.decomposition.decomposed", lambda _: pytest.fail("decomposed"))
    write(tmp_path, crossed(), "cross.stl")
    parts = [np.array(part).reshape(-1, 3) for part in mesh_parts(str(tmp_path / "cross.stl"))]
    extents = sorted(tuple(np.ptp(part, axis=0).round(6)) for part in parts)
    assert extents == [pytest.approx((0.04, 0.04, 0.1)), pytest.approx((0.1, 0.03, 0.03))]
    assert body(tmp_path, path="cross.stl", mass=0.2).size == pytest.approx((0.1, 0.04, 0.1))


def test_a_hollow_space_and_an_open_surface_are_no_solids() -> None:
    outer, inner, boxes = trimesh.creation.box((0.1,) * 3), trimesh.creation.box((0.08,) * 3), crossed()
    assert len(separate_solids(boxes.triangles)) == 2
    inner.invert()
    assert separate_solids(trimesh.util.concatenate([outer, inner]).triangles) == []
    assert separate_solids(boxes.triangles[:-1]) == []
    assert separate_solids(outer.triangles) == []


def cubes(*places: tuple[float, float, float]) -> trimesh.Trimesh:
    """Return cubes of 40 mm at places, as one mesh."""
    boxes = [trimesh.creation.box((0.04,) * 3) for _ in places]
    return trimesh.util.concatenate([box.apply_translation(at) for box, at in zip(boxes, places, strict=True)])


@pytest.mark.parametrize(
    "place", [(0.04, 0.04, 0.0), (0.04, 0.0, 0.0), (0.04, 0.04, 0.04)], ids=["edge", "face", "corner"]
)
def test_solids_that_touch_are_separate_and_count_with_their_own_volume(tmp_path, monkeypatch, place):
    monkeypatch.setattr("prag_asp.scene.read.decomposition.decomposed", lambda _: pytest.fail("decomposed"))
    there = cubes((0.0, 0.0, 0.0), place, (0.0, 0.0, 0.04))
    solids = separate_solids(there.triangles)
    assert sorted(tuple(solid.mean((0, 1)).round(9) + 0.0) for solid in solids) == sorted(
        [(0.0, 0.0, 0.0), place, (0.0, 0.0, 0.04)]
    )
    shape = body(tmp_path, path=write(tmp_path, there, "cubes.obj"), density=1000.0)
    assert shape.model.mass == pytest.approx(3 * 0.04**3 * 1000)
    parts = [np.array(part) for part in mesh_parts(str(tmp_path / "cubes.obj"))]
    assert [np.ptp(part.reshape(-1, 3), axis=0) for part in parts] == [pytest.approx([0.04] * 3)] * 3


def test_solids_about_an_edge_are_separated_by_the_wedges_between_their_faces(chance: Chance) -> None:
    rng = np.random.default_rng(chance.seed(1))
    for _ in range(chance.examples(20)):
        # Wedges about a common edge, some of which share a face: their volumes are known.
        turns = np.sort(rng.uniform(0.0, 2 * math.pi, 7))
        turns = turns[np.diff(turns, append=turns[0] + 2 * math.pi) > 0.05]
        begins = range(0, len(turns) - 1, int(rng.integers(1, 3)))
        ends = [(math.cos(turn), math.sin(turn)) for turn in turns]
        wedges = []
        for i in begins:
            if turns[i + 1] - turns[i] < 3.0:
                outline = [(0.0, 0.0), ends[i], ends[i + 1]]
                wedges.append(trimesh.convex.convex_hull([(*at, z) for at in outline for z in (0.0, 1.0)]))
        rows = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        rows *= np.sign(np.linalg.det(rows))
        mesh = trimesh.util.concatenate(wedges)
        mesh.vertices = mesh.vertices @ rows.T
        found = separate_solids(mesh.triangles)
        volumes = [trimesh.Trimesh(**trimesh.triangles.to_kwargs(solid)).volume for solid in found]
        assert len(wedges) == 1 or sorted(volumes) == pytest.approx(sorted(wedge.volume for wedge in wedges))


def test_without_the_extra_a_concave_mesh_is_refused_with_the_remedy(tmp_path, monkeypatch):
    monkeypatch.setattr(mesh_body, "can_decompose", lambda: False)
    name = write(tmp_path, angled(), "l.obj")
    with pytest.raises(SceneError, match=r"l\.obj: the mesh is not convex; pip install \"prag_asp\[meshes\]\""):
        body(tmp_path, path=name)
    assert body(tmp_path, path=write(tmp_path, trimesh.creation.box(SIDES), "b.obj")).model.mass > 0.0


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ({}, "cube.path: missing; write the path of a mesh in the folder of the domain"),
        ({"path": "none.obj"}, "none.obj: there is no such file"),
        ({"path": "folder.stl"}, "folder.stl: is a folder; give the path of a file in it"),
        ({"path": "../b.stl"}, "lies outside the domain"),
        ({"path": "b.stl", "scale": -1}, "cube.scale: "),
        ({"path": "b.stl", "scale": [1, 2]}, "cube.scale: "),
        (
            {"path": "b.stl", "scale": 100},
            "m long; give its lengths in metres (at most 2), or give a mesh a smaller",
        ),
        ({"path": "b.stl", "scale": 0.001}, "m thin; make it at least"),
        ({"path": "b.stl", "up": "w"}, "cube.up: "),
        ({"path": "b.stl", "rotation": 90}, "cube.rotation: "),
        ({"path": "b.stl", "mass": 0}, "cube.mass: "),
        ({"path": "b.stl", "density": 0}, "cube.density: "),
        ({"path": "b.stl", "density": 500, "mass": 1}, "a mass or a density; leave one of them out"),
        ({"path": "b.stl", "rests": "leaning"}, "cube.rests: "),
        ({"path": "b.stl", "colour": "red"}, "cube.colour: "),
        ({"path": "b.fbx"}, "a mesh of unknown format; known are .obj, .stl, .ply"),
        ({"path": "broken.glb"}, "broken.glb: not a mesh: "),
    ],
)
def test_a_wrong_table_is_refused_by_its_key(tmp_path, table, message):
    folder = tmp_path / "domain"
    folder.mkdir()
    write(tmp_path, trimesh.creation.box(SIDES), "b.stl")
    write(folder, trimesh.creation.box(SIDES), "b.stl")
    (folder / "b.fbx").write_text("")
    (folder / "folder.stl").mkdir()
    (folder / "broken.glb").write_bytes(b"glTF" + bytes(60))
    with pytest.raises(SceneError) as caught:
        body(folder, **table)
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_rod_of_many_faces_lies_on_one_of_them(tmp_path):
    rod = trimesh.creation.cylinder(radius=0.01, height=0.12)
    lying = body(tmp_path, path=write(tmp_path, rod, "rod.ply"), rests="lying")
    assert lying.size[2] == pytest.approx(0.02, rel=0.01)
    assert math.isclose(max(lying.size), 0.12, rel_tol=0.2)


def test_a_mesh_that_is_too_costly_to_divide_is_refused_by_its_file(tmp_path, monkeypatch):
    # CoACD does not end on some tangles of triangles; here no time at all is left for it.
    monkeypatch.setattr("prag_asp.scene.read.decomposition.LONGEST", 0.0)
    monkeypatch.setenv("PRAG_ASP_CACHE", "")
    write(tmp_path, angled(), "costly.stl")
    with pytest.raises(
        SceneError,
        match=r"costly\.stl: dividing the mesh .* too costly: it was stopped by the time limit of 0 s; simplify",
    ):
        mesh_parts(str(tmp_path / "costly.stl"))


def test_an_egg_that_is_laid_aslant_rolls_until_it_lies_on_its_belly() -> None:
    angles, heights = np.linspace(0, 2 * np.pi, 24, endpoint=False), np.linspace(-1, 1, 25)
    rings = [(h, c * np.cos(a), c * np.sin(a)) for h in heights for c in [math.sqrt(1 - h * h)] for a in angles]
    tilt = math.radians(12)
    rows = np.array([[math.cos(tilt), 0, math.sin(tilt)], [0, 1, 0], [-math.sin(tilt), 0, math.cos(tilt)]])
    aslant = (np.array(rings) * (0.035, 0.02, 0.02)) @ rows.T
    assert falls(aslant, np.zeros(3))
    turned = settle(aslant, np.zeros(3))
    assert turned is not None
    assert abs((turned @ rows)[2, 0]) < math.sin(math.radians(4)) and not falls(aslant @ turned.T, np.zeros(3))
