from __future__ import annotations

import math
import struct
from itertools import combinations
from pathlib import Path

import pybullet
import pytest

from prag_asp.errors import SceneError
from prag_asp.physics import check_witness, demonstrate, settle, validate_task, validate_tasks
from prag_asp.physics.world.bodies import mass
from prag_asp.physics.world.simulator import Simulator, open_simulator
from prag_asp.scene.geometry import Pose, rotate
from prag_asp.scene.read.body import resting
from prag_asp.scene.read.mesh import mesh_parts
from prag_asp.scene.read.urdf import read_urdf
from prag_asp.scene.scene import Scene
from tests.physics.random_tasks import scene_table, scene_with
from tests.physics.scenarios import stacking, state, task

ANGLE, WALL = 0.3, 0.006
BLOCK = """<?xml version="1.0"?>
<robot name="block">
  <link name="body">
    <inertial><mass value="0.15"/></inertial>
    <collision><origin xyz="0.01 0 0.02"/><geometry><box size="0.04 0.05 0.04"/></geometry></collision>
    <collision><origin xyz="0.01 0 0.045" rpy="1.5707963267948966 0 0"/>
      <geometry><cylinder radius="0.01" length="0.03"/></geometry></collision>
  </link>
</robot>
"""
MESH = """<robot name="mesh"><link name="body"><inertial><mass value="0.1"/></inertial><collision>
  <geometry><mesh filename="box{suffix}" scale="0.001 0.001 0.001"/></geometry></collision></link></robot>
"""
ONE_LINK = '<robot name="x"><link name="a"><inertial><mass value="1"/></inertial>{}</link></robot>'
CORNERS = [(x, y, z) for x in (0.0, 40.0) for y in (0.0, 50.0) for z in (-20.0, 20.0)]


def scene_in(folder: Path, path: str = "models/block.urdf") -> Scene:
    """Return the scene of tabletop with cubes from a URDF of a folder."""
    return scene_with("tabletop", {"cube": {"kind": "urdf", "path": path}}, folder=folder)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "models").mkdir()
    (tmp_path / "models" / "block.urdf").write_text(BLOCK)
    return tmp_path


def distance(simulator: Simulator, one: str, two: str) -> float:
    """Return the distance of two bodies in the simulator in metres, at most 0.1."""
    bodies = (simulator.table if name == "table" else simulator.body(name) for name in (one, two))
    return min(point[8] for point in pybullet.getClosestPoints(*bodies, 0.1, physicsClientId=simulator.client))


def mesh_scene(folder: Path, content: bytes | str, suffix: str = ".obj") -> Scene:
    """Return the scene of tabletop with cubes of a mesh in millimetres."""
    (folder / "m.urdf").write_text(MESH.format(suffix=suffix))
    (folder / f"box{suffix}").write_bytes(content if isinstance(content, bytes) else content.encode())
    return scene_in(folder, "m.urdf")


def test_a_urdf_has_the_size_and_mass_of_its_solids_in_the_scene_and_in_the_simulator(folder):
    scene = scene_in(folder)
    shape = scene.shapes["cube_1"]
    assert shape.size == pytest.approx((0.04, 0.05, 0.055))
    centres = [solid.at for solid in shape.model.solids]
    assert centres == [pytest.approx((0.0, 0.0, -0.0075)), pytest.approx((0.0, 0.0, 0.0175))]
    assert mass(scene, "cube_1") == 0.15
    with open_simulator(scene) as simulator:
        simulator.place({"cube_1": Pose((0.5, 0.0, 0.0275)), "cube_2": Pose((0.5, 0.0, 0.0825))})
        assert distance(simulator, "cube_1", "cube_2") == pytest.approx(0.0, abs=1e-4)
        simulator.place({"cube_1": Pose((0.5, 0.0, 0.0275)), "can_1": Pose((0.5, 0.08, 0.06))})
        assert distance(simulator, "cube_1", "can_1") == pytest.approx(0.08 - 0.025 - 0.033, abs=1e-3)
        body = simulator.body("cube_1")
        assert pybullet.getDynamicsInfo(body, -1, physicsClientId=simulator.client)[0] == pytest.approx(0.15)


def test_a_body_from_a_urdf_is_grasped_stacked_settled_and_performed_with(folder):
    scene = scene_in(folder)
    verdict = validate_task(stacking(), scene, seed=1)
    assert check_witness(stacking(), verdict.witness, scene) == []
    assert settle(stacking(), verdict.witness, scene) is None
    assert demonstrate(stacking(), verdict.witness, scene).success
    assert next(v.witness for v in validate_tasks([stacking()] * 2, scene, seed=1, workers=2)) == verdict.witness


def test_a_turned_box_is_measured_at_its_corners(folder):
    half_x, half_y = 0.02, 0.03
    text = BLOCK.replace('xyz="0.01 0 0.02"', f'xyz="0 0 0.1" rpy="0 0 {ANGLE}"').replace(
        "0.04 0.05 0.04", "0.04 0.06 0.04"
    )
    (folder / "models" / "block.urdf").write_text(text.replace("0.045", "0.1"))
    size = scene_in(folder).shapes["cube_1"].size
    expected = [
        2 * (half_x * math.cos(ANGLE) + half_y * math.sin(ANGLE)),
        2 * (half_x * math.sin(ANGLE) + half_y * math.cos(ANGLE)),
    ]
    assert size[:2] == pytest.approx(expected)


def _obj() -> bytes:
    faces = "".join(f"f {a} {b} {c}\n" for a in range(1, 9) for b in range(1, 9) for c in range(1, 9) if a < b < c)
    return ("".join(f"v {x} {y} {z}\n" for x, y, z in CORNERS) + faces).encode()


def _triangles() -> list[tuple[tuple[float, float, float], ...]]:
    return [(CORNERS[a], CORNERS[b], CORNERS[c]) for a in range(8) for b in range(a) for c in range(b)]


def _binary_stl() -> bytes:
    rows = [struct.pack("<12fH", 0, 0, 1, *(v for point in three for v in point), 0) for three in _triangles()]
    return b"solid".ljust(80) + struct.pack("<I", len(rows)) + b"".join(rows)


def _text_stl() -> bytes:
    rows = [f"vertex {x} {y} {z}" for three in _triangles() for x, y, z in three]
    return ("solid x\nfacet\nouter loop\n" + "\n".join(rows) + "\nendsolid").encode()


@pytest.mark.parametrize(("suffix", "content"), [(".obj", _obj()), (".stl", _binary_stl()), (".stl", _text_stl())])
def test_a_mesh_has_the_size_of_its_corners_and_stands_on_the_table_in_the_simulator(tmp_path, suffix, content):
    scene = mesh_scene(tmp_path, content, suffix)
    assert scene.shapes["cube_1"].size == pytest.approx((0.04, 0.05, 0.04), abs=1e-12)
    assert scene.shapes["cube_1"].model.solids[0].at == pytest.approx((-0.02, -0.025, 0.0))
    with open_simulator(scene) as simulator:
        simulator.place({"cube_1": Pose((0.5, 0.0, 0.02))})
        assert distance(simulator, "cube_1", "table") == pytest.approx(0.0, abs=1e-6)
    verdict = validate_task(stacking(), scene, seed=1)
    assert verdict.feasible and settle(stacking(), verdict.witness, scene) is None


@pytest.mark.parametrize(("millimetres", "fits"), [(61.5, True), (59.9, False)])
def test_a_mesh_of_60_mm_fits_into_a_cavity_exactly_where_that_is_wider(tmp_path, millimetres, fits):
    (tmp_path / "m.urdf").write_text(MESH.format(suffix=".obj"))
    text = _obj().decode().replace("40.0", "60.0").replace("50.0", "60.0").replace("-20.0", "-30.0")
    (tmp_path / "box.obj").write_text(text.replace("20.0", "30.0"))
    wide = millimetres / 1000 + 2 * WALL
    bin_1 = {"kind": "container", "size": [wide, wide, 0.03], "wall": WALL}
    scene = scene_with("tabletop", {"cube": {"kind": "urdf", "path": "m.urdf"}, "bin": bin_1}, folder=tmp_path)
    assert scene.shapes["cube_1"].size == pytest.approx((0.06, 0.06, 0.06), abs=1e-12)
    held = state("holding(panda,cube_1)", "-inside(cube_1,bin_1)")
    insertion = task(held, ("insert(panda,cube_1,bin_1)", state("-holding(panda,cube_1)", "inside(cube_1,bin_1)")))
    verdict = validate_task(insertion, scene, seed=1)
    if fits:
        assert check_witness(insertion, verdict.witness, scene) == []
    else:
        assert verdict.status == "infeasible"
        assert verdict.reason.endswith("cube 1 is larger than the cavity of bin 1")


@pytest.mark.parametrize(("group", "gap"), [("o leg", 0.05 - 0.033), ("", -0.033)])
def test_the_objects_of_a_mesh_collide_one_by_one(tmp_path, group, gap):
    text = ""
    for at in (-60.0, 50.0):
        text += "".join(f"v {x} {y} {z}\n" for x in (at, at + 10.0) for y in (-30.0, 30.0) for z in (0.0, 40.0))
        text += f"{group}\n" + "".join(f"f -{a} -{b} -{c}\n" for a, b, c in combinations(range(1, 9), 3))
    scene = mesh_scene(tmp_path, text)
    assert scene.shapes["cube_1"].size == pytest.approx((0.12, 0.06, 0.04), abs=1e-12)
    with open_simulator(scene) as simulator:
        simulator.place({"cube_1": Pose((0.5, 0.0, 0.02)), "can_1": Pose((0.5, 0.0, 0.05))})
        found = distance(simulator, "cube_1", "can_1")
    assert (found > 0.0) == (gap > 0.0)
    assert gap < 0.0 or found == pytest.approx(gap, abs=1e-4)


def test_a_mesh_with_a_group_for_each_side_is_one_hull(tmp_path):
    lines = _obj().decode().splitlines()
    points, faces = [line for line in lines if line[0] == "v"], [line for line in lines if line[0] == "f"]
    (tmp_path / "box.obj").write_text("\n".join([*points, *(f"g side_{i}\n{face}" for i, face in enumerate(faces))]))
    assert len(mesh_parts(str(tmp_path / "box.obj"))) == 1


@pytest.mark.parametrize(
    ("path", "content", "message"),
    [
        ("models/none.urdf", None, "there is no such file"),
        ("../elsewhere.urdf", "<robot/>", "lies outside the domain; copy it into"),
        ("x.urdf", "<robot><link name='a'></robot>", "x.urdf:1: not XML: mismatched tag; fix the line"),
        ("x.urdf", "<?xml version='1.0' encoding='none'?><robot/>", "x.urdf:1: not XML: "),
        (
            "x.urdf",
            "<robot>\n<link name='a'/>\n<link name='b'/></robot>",
            "x.urdf:1: has 2 links (a in line 2, b in line 3); give a URDF of one rigid link",
        ),
        ("x.urdf", "<robot/>", "x.urdf:1: has 0 links; give a URDF"),
        ("x.urdf", ONE_LINK.format(""), "x.urdf:1: link a has no <collision>; add one"),
        (
            "x.urdf",
            "<robot>\n<link><collision/></link></robot>",
            "x.urdf:2: link without a name, collision 1: has no <ge",
        ),
        ("x.urdf", BLOCK.replace('<mass value="0.15"/>', ""), "x.urdf:3: link body has no <mass> in an <inertial>"),
        (
            "x.urdf",
            BLOCK.replace("0.15", "-1"),
            "x.urdf:4: link body: <mass> has the value '-1'; give positive numbers",
        ),
        (
            "x.urdf",
            BLOCK.replace("0.04 0.05 0.04", "0.04 0.05"),
            "x.urdf:5: link body, collision 1: the size of <box> is '0.04 0.05'; give 3 finite numbers",
        ),
        (
            "x.urdf",
            BLOCK.replace("0.01 0 0.045", "nan 0 0"),
            "x.urdf:6: link body, collision 2: the xyz of <origin> is 'nan 0 0'; give 3 finite numbers",
        ),
        ("x.urdf", BLOCK.replace("0.04 0.05 0.04", "40 50 40"), "m long; give its lengths in metres"),
        (
            "x.urdf",
            BLOCK.replace("cylinder", "capsule"),
            "x.urdf:6: link body, collision 2: unknown geometry <capsule>",
        ),
        ("x.urdf", BLOCK.replace("0.04 0.05 0.04", "1 1 1e-9"), "a <box> is 1e-09 m thin; make it at least 0.003 m"),
        ("x.urdf", MESH.format(suffix=".obj"), "box.obj: there is no such file"),
        ("x.urdf", MESH.format(suffix=".dae").replace("box.dae", "x.urdf"), "a mesh of unknown format"),
        ("x.urdf", MESH.format(suffix=".obj").replace("box.obj", "../../etc/passwd"), "lies outside the domain"),
        ("", None, "needs the path of a URDF in the folder of the domain"),
    ],
)
def test_a_urdf_that_cannot_be_used_is_refused_in_one_line(tmp_path, path, content, message):
    folder = tmp_path / "domain"
    folder.mkdir()
    if content is not None:
        (folder / path).write_text(content)
    with pytest.raises(SceneError) as caught:
        scene_in(folder, path)
    text = str(caught.value)
    assert message in text and text.startswith("scene.shapes.cube.path: ") and "\n" not in text


def _turned(points: list[tuple[float, float, float]]) -> bytes:
    """Return an .obj of points turned by 0.7 radians about x and then 0.4 about z, so that no side is along an axis."""
    rows = []
    for x, y, z in points:
        tilted, up = math.cos(0.7) * y - math.sin(0.7) * z, math.sin(0.7) * y + math.cos(0.7) * z
        ahead, left = math.cos(0.4) * x - math.sin(0.4) * tilted, math.sin(0.4) * x + math.cos(0.4) * tilted
        rows.append(f"v {ahead!r} {left!r} {up!r}\n")
    return "".join(rows).encode() + _fan(len(points))


def _fan(count: int) -> bytes:
    """Return faces of an .obj that use so many points."""
    return "".join(f"f 1 {k} {k + 1}\n" for k in range(2, count)).encode()


PLATES = {z: [(x, y, h) for x in (0.0, 50.0) for y in (0.0, 40.0) for h in (0.0, z)] for z in (0.0, 1e-6, 2.9, 3.1)}
THIN = r"box\.obj: the mesh is .* m thin; make it at least 0\.003 m thick"


@pytest.mark.parametrize(
    ("points", "message"),
    [
        *((PLATES[thick], THIN) for thick in (0.0, 1e-6, 2.9)),
        ([(20.0, 0.0, 0.0)] * 4, THIN),
        ([(10.0 * k, 20.0 * k, 0.0) for k in range(4)], THIN),
    ],
)
def test_a_mesh_that_is_flat_a_line_or_a_point_is_refused_however_it_is_turned(tmp_path, points, message):
    with pytest.raises(SceneError, match=message):
        mesh_scene(tmp_path, _turned(points))


ALONE = ONE_LINK.format("<collision><origin rpy='{}'/><geometry>{}</geometry></collision>")
CUBE, ROD, BALL = "<box size='.05 .05 .05'/>", "<cylinder radius='.02' length='.1'/>", "<sphere radius='.03'/>"


@pytest.mark.parametrize(
    ("turn", "solid", "tilt", "size"),
    [
        ("0 0 0.4", CUBE, 0.0, None),
        ("0 0.4 0", CUBE, 0.4, (0.05, 0.05, 0.05)),
        ("0 0.785 0", CUBE, 0.785, (0.05, 0.05, 0.05)),
        ("0.7854 0.6155 0", CUBE, 0.9553, None),  # on its corner: the arctangent of the root of 2
        ("0 0.02 0", CUBE, 0.02, (0.05, 0.05, 0.05)),
        ("0 0 0", ROD, 0.0, None),
        ("0 1.5708 0.3", ROD, 0.0, None),
        ("0 0.3 0", ROD, 0.3, (0.04, 0.04, 0.1)),
        ("0 0 0", BALL, 0.0, None),
        ("0 0 0", "<sphere radius='.45'/>", 0.0, None),
        ("0 1.5708 0.77", "<cylinder radius='.005' length='.14'/>", 0.0, None),
    ],
)
def test_a_body_that_does_not_rest_as_its_file_has_it_comes_to_rest(tmp_path, turn, solid, tilt, size):
    (tmp_path / "m.urdf").write_text(ALONE.format(turn, solid))
    shape = scene_in(tmp_path, "m.urdf").shapes["cube_1"]
    assert shape.model.mass == 1.0
    assert shape.model.settled == pytest.approx(tilt, abs=1e-3)
    assert size is None or sorted(shape.size) == pytest.approx(sorted(size), abs=1e-4)


def test_a_thin_plate_that_leans_comes_to_lie_flat(tmp_path):
    assert mesh_scene(tmp_path, _turned(PLATES[3.1])).shapes["cube_1"].size[2] == pytest.approx(0.0031, abs=1e-6)


def test_a_cone_on_its_tip_comes_to_lie_on_its_side_and_one_on_its_base_stands(tmp_path):
    ring = [(20 * math.cos(i), 20 * math.sin(i)) for i in range(12)]
    for name, tip in (("up", 60.0), ("down", -60.0)):
        points = [(0.0, 0.0, tip), *((x, y, 0.0) for x, y in ring)]
        (tmp_path / f"{name}.obj").write_text(
            "".join(f"v {x} {y} {z}\n" for x, y, z in points) + _fan(len(points)).decode()
        )
        mesh = f"<mesh filename='{name}.obj' scale='0.001 0.001 0.001'/>"
        (tmp_path / f"{name}.urdf").write_text(ALONE.format("0 0 0", mesh))
    assert scene_in(tmp_path, "up.urdf").shapes["cube_1"].size[2] == pytest.approx(0.06)
    lying = scene_in(tmp_path, "down.urdf").shapes["cube_1"]
    assert lying.model.settled == pytest.approx(math.pi / 2 - math.atan2(20, 60), abs=0.05)


def test_a_leaning_body_that_never_moves_stays_as_it_is(tmp_path):
    (tmp_path / "m.urdf").write_text(ALONE.format("0 0.4 0", CUBE))
    shapes = {"can": {"kind": "urdf", "path": "m.urdf"}}
    assert scene_with("tabletop", shapes, folder=tmp_path).shapes["can_1"].model.settled == pytest.approx(0.4)
    fixed = {**scene_table("tabletop")["fixed"], "can_1": [0.47, 0.0]}
    assert scene_with("tabletop", shapes, folder=tmp_path, fixed=fixed).shapes["can_1"].model.settled == 0.0


def test_bodies_come_to_rest_as_in_pybullet(tmp_path, chance):
    """Dropped from half a millimetre, a random tetrahedron ends on the face on which it comes to rest here."""
    random, alike = chance.generator(11), 0
    for number in range(chance.examples(10)):
        corners = [[random.uniform(-40.0, 40.0) for _ in range(3)] for _ in range(4)]
        text = "".join(f"v {x} {y} {z}\n" for x, y, z in corners) + "f 1 2 3\nf 1 2 4\nf 1 3 4\nf 2 3 4\n"
        (tmp_path / f"{number}.obj").write_text(text)
        mesh = f"<mesh filename='{number}.obj' scale='0.001 0.001 0.001'/>"
        (tmp_path / f"{number}.urdf").write_text(ALONE.format("0 0 0", mesh))
        shape = read_urdf(tmp_path / f"{number}.urdf", tmp_path)
        rest = resting(shape)
        assert resting(rest) is rest
        with open_simulator(Scene({"thing": rest})) as simulator:
            simulator.place({"thing": Pose((0.4, 0.0, rest.half[2] + 0.0005))})
            for _ in range(120):
                pybullet.stepSimulation(physicsClientId=simulator.client)
            tilt = rotate(simulator.read("thing").quaternion, (0.0, 0.0, 1.0))[2]
        alike += math.degrees(math.acos(min(1.0, tilt))) < 3.0
    assert alike == chance.examples(10)


def test_a_body_of_far_too_many_parts_is_refused_before_they_are_read(tmp_path: Path) -> None:
    part = '<collision><geometry><box size="0.01 0.01 0.01"/></geometry></collision>\n'
    for number, message in ((1_001, "huge.urdf:1001: more than 1,000 collisions"), (100_000, "larger than 1 MB")):
        (tmp_path / "huge.urdf").write_text(ONE_LINK.format(part * number))
        with pytest.raises(SceneError, match=message):
            read_urdf(tmp_path / "huge.urdf", tmp_path)


def test_a_cube_stands_between_the_legs_of_a_stool_and_not_where_they_are(tmp_path):
    legs = "".join(
        f"<collision><origin xyz='{x} {y} 0.05'/><geometry><box size='.02 .02 .1'/></geometry></collision>"
        for x in (-0.07, 0.07)
        for y in (-0.07, 0.07)
    )
    seat = "<collision><origin xyz='0 0 0.11'/><geometry><box size='.16 .16 .02'/></geometry></collision>"
    (tmp_path / "m.urdf").write_text(ONE_LINK.format(legs + seat))
    # The cube is 50 mm wide, the gaps between the legs 120 mm, the legs at 70 mm from the middle.
    for at, feasible in ((0.0, True), (0.07, False)):
        scene = scene_with(
            "tabletop",
            {"can": {"kind": "urdf", "path": "m.urdf"}},
            folder=tmp_path,
            fixed={**scene_table("tabletop")["fixed"], "can_1": [0.47, 0.0]},
            own={
                "beneath": {
                    "arguments": ["object", "object"],
                    "inside": "centre",
                    "boxes": [{"x": [at - 0.02, at + 0.02], "y": [at - 0.02, at + 0.02], "z": [0.0, 0.09]}],
                    "sentence": "{0} {is} beneath {1}",
                }
            },
        )
        facts = state("on_top(cube_1,table_1)", "beneath(cube_1,can_1)", "-holding(panda,cube_1)")
        assert validate_task(task(facts), scene, seed=1).feasible == feasible
