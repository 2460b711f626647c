"""URDFs as they are found: paths, what stands before the declaration, several links, and their masses."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pybullet
import pytest

from prag_asp.errors import SceneError
from prag_asp.physics.world.simulator import open_simulator
from prag_asp.scene.geometry import Pose, turn_between
from prag_asp.scene.mass import polyhedron_mass
from prag_asp.scene.read.convex import convex_hull, is_closed, is_convex
from prag_asp.scene.read.urdf import read_urdf
from prag_asp.scene.scene import Scene, Shape

BOX = "".join(f"v {x} {y} {z}\n" for x in (0, 0.05) for y in (0, 0.04) for z in (0, 0.03)) + "".join(
    f"f {face}\n" for face in ("1 2 4 3", "5 7 8 6", "1 5 6 2", "3 4 8 7", "1 3 7 5", "2 6 8 4")
)
LINK = (
    '<link name="{0}"><inertial>{1}<mass value="{2}"/></inertial><collision><geometry>{3}</geometry></collision></link>'
)
MESH = '<robot name="thing">' + LINK.format("a", "", 0.2, '<mesh filename="{}"/>') + "</robot>"
CUBE, ROD = '<box size="0.04 0.04 0.04"/>', '<cylinder radius="0.01" length="0.1"/>'
FIXED = '<joint name="{0}" type="{1}"><parent link="a"/><child link="b"/><origin xyz="{2}" rpy="{3}"/></joint>'


def read(folder: Path, text: str, path: str = "thing.urdf") -> Shape:
    """Return the shape of a URDF in a folder."""
    (folder / path).parent.mkdir(parents=True, exist_ok=True)
    (folder / path).write_text(text, encoding="utf-8")
    return read_urdf(folder / path, folder)


@pytest.mark.parametrize(
    ("mesh", "urdf", "named"),
    [
        ("meshes/b.obj", "urdf/b.urdf", "meshes/b.obj"),
        ("meshes/b.obj", "urdf/b.urdf", "../meshes/b.obj"),
        ("meshes/b.obj", "a/b/c/b.urdf", "meshes/b.obj"),
        ("things/meshes/b.obj", "things/urdf/b.urdf", "package://things/meshes/b.obj"),
        ("meshes/b.obj", "urdf/b.urdf", "package://things/meshes/b.obj"),
        ("things/b.obj", "b.urdf", "package://things/b.obj"),
        ("b.obj", "b.urdf", "package://b.obj"),
        ("cup/meshes/b.obj", "cup/model.urdf", "model://cup/meshes/b.obj"),
        ("meshes/b.obj", "model.urdf", "model://cup/meshes/b.obj"),
        ("meshes/b.obj", "urdf/b.urdf", "package://things//meshes/b.obj"),
    ],
)
def test_a_mesh_is_found_where_simulators_and_packages_find_it(tmp_path, mesh, urdf, named):
    (tmp_path / mesh).parent.mkdir(parents=True, exist_ok=True)
    (tmp_path / mesh).write_text(BOX)
    assert read(tmp_path, MESH.format(named), urdf).size == pytest.approx((0.05, 0.04, 0.03))


def test_the_nearest_folder_comes_first(tmp_path):
    for folder, side in (("", 0.05), ("near", 0.06)):
        (tmp_path / folder).mkdir(exist_ok=True)
        (tmp_path / folder / "b.obj").write_text(BOX.replace("0.05", str(side)))
    assert read(tmp_path, MESH.format("b.obj"), "near/urdf/b.urdf").size[0] == pytest.approx(0.06)


@pytest.mark.parametrize("named", ["../b.obj", "package://../b.obj", "{}/b.obj", "file://{}/b.obj", "link/b.obj"])
def test_no_mesh_is_read_outside_the_domain(tmp_path, named):
    (tmp_path / "b.obj").write_text(BOX)
    folder = tmp_path / "domain"
    folder.mkdir()
    (folder / "link").symlink_to(tmp_path)
    with pytest.raises(SceneError, match=r"lies outside the domain|there is no such file"):
        read(folder, MESH.format(named.format(tmp_path)))


@pytest.mark.parametrize(
    "before", [" ", "\n\n", "\ufeff", "\ufeff\n", "<!-- made by hand -->\n", "\ufeff <!-- a -->\n<!-- b -->"]
)
def test_what_stands_before_the_declaration_does_not_matter(tmp_path, before):
    text = (
        f'{before}<?xml version="1.0" encoding="utf-8"?>\n<robot name="x">' + LINK.format("a", "", 1, CUBE) + "</robot>"
    )
    assert read(tmp_path, text).size == pytest.approx((0.04, 0.04, 0.04))
    broken = text.replace("</robot>", "\n</robots>")
    with pytest.raises(SceneError, match=f"thing.urdf:{broken.count(chr(10)) + 1}: not XML: mismatched tag"):
        read(tmp_path, broken)


def test_a_bare_ampersand_is_a_character_as_in_pybullet(tmp_path):
    (tmp_path / "nut & bolt.obj").write_text(BOX)
    for name in ("nut & bolt.obj", "nut &amp; bolt.obj", "nut &#38; bolt.obj"):
        text = MESH.format(name).replace('name="a"', 'name="a&b &lt; &c;"')
        assert read(tmp_path, text).size == pytest.approx((0.05, 0.04, 0.03))
    entity = '<!DOCTYPE robot [<!ENTITY file "nut &#38;#38; bolt.obj">]>' + MESH.format("&file;")
    assert read(tmp_path, entity).size == pytest.approx((0.05, 0.04, 0.03))


def test_links_with_fixed_joints_are_one_body_like_that_of_pybullet(tmp_path):
    tip = '<link name="tip"/>' + FIXED.format("k", "fixed", "0 0 1", "0 0 0").replace('"b"', '"tip"')
    text = (
        '<robot name="hammer">'
        + LINK.format("b", "", 0.1, ROD)
        + LINK.format("a", '<origin xyz="0.01 0 0"/>', 0.3, CUBE)
        + FIXED.format("j", "fixed", "0.07 0 0.01", "0 1.5707963267948966 0")
        + tip
        + "</robot>"
    )
    shape = read(tmp_path, text)
    # The cube goes from -20 to 20 mm, the rod along x from 20 to 120 mm.
    assert shape.size == pytest.approx((0.14, 0.04, 0.04))
    middle = np.array([0.05, 0.0, 0.0])
    expected = (0.3 * np.array([0.01, 0.0, 0.0]) + 0.1 * np.array([0.07, 0.0, 0.01])) / 0.4
    assert shape.model.centre == pytest.approx(expected - middle)
    assert shape.model.mass == pytest.approx(0.4)
    # Moments of the cube and the rod about the centre, by the parallel axis theorem.
    offset_x = [0.01 - expected[0], 0.07 - expected[0]]
    offset_z = [0.0 - expected[2], 0.01 - expected[2]]
    cube, along, across = 0.3 * 2 * 0.04**2 / 12, 0.1 * 0.01**2 / 2, 0.1 * (3 * 0.01**2 + 0.1**2) / 12
    about_y = cube + across + sum(m * (x * x + z * z) for m, x, z in zip((0.3, 0.1), offset_x, offset_z, strict=True))
    assert min(abs(moment - about_y) for moment in shape.model.moments) < 1e-9
    assert sum(shape.model.moments) == pytest.approx(
        3 * cube
        + along
        + 2 * across
        + 2 * sum(m * (x * x + z * z) for m, x, z in zip((0.3, 0.1), offset_x, offset_z, strict=True))
    )


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            FIXED.format("hinge", "revolute", "0 0 0", "0 0 0"),
            "thing.urdf:3: joint hinge is revolute, and a body is rigid",
        ),
        ("", r"thing.urdf:1: has 2 links \(a in line 1, b in line 2\); give a URDF of one rigid link, or connect them"),
        (FIXED.format("j", "fixed", "0 0", "0 0 0"), "thing.urdf:3: joint j: the xyz of <origin> is '0 0'"),
    ],
)
def test_links_that_are_not_one_body_are_refused_by_line(tmp_path, text, message):
    links = [LINK.format(name, "", 0.1, CUBE) for name in "ab"]
    with pytest.raises(SceneError, match=message):
        read(tmp_path, f'<robot name="x">{links[0]}\n{links[1]}\n{text}</robot>')


def inertial(origin: str, inertia: str) -> str:
    """Return a URDF of a cube of 1 kg with an origin and an inertia."""
    return f'<robot name="x">{LINK.format("a", origin, 1, CUBE)}</robot>'.replace(
        "</inertial>", f"{inertia}</inertial>"
    )


@pytest.mark.parametrize(
    ("inertia", "moments"),
    [
        ('<inertia ixx="2e-4" iyy="3e-4" izz="4e-4"/>', (2e-4, 3e-4, 4e-4)),
        ("", (0.04**2 / 6,) * 3),
        ('<inertia ixx="1" iyy="1" izz="1"/>', (0.04**2 / 6,) * 3),  # no body of 40 mm has that
        ('<inertia ixx="0" iyy="0" izz="0"/>', (0.04**2 / 6,) * 3),
        ('<inertia ixx="1e-4" iyy="1e-4" izz="3e-4"/>', (0.04**2 / 6,) * 3),  # violates the triangle inequality
    ],
)
def test_the_inertia_of_a_file_is_respected_if_a_body_can_have_it(tmp_path, inertia, moments):
    assert read(tmp_path, inertial("", inertia)).model.moments == pytest.approx(moments)


def test_pybullet_has_the_centre_of_mass_and_inertia_and_the_body_stays_where_it_is_put(tmp_path):
    inertia = '<inertia ixx="2e-4" iyy="3e-4" izz="4e-4" ixy="5e-5"/>'
    shape = read(tmp_path, inertial('<origin xyz="0.01 0.005 -0.01" rpy="0.2 0.1 0.5"/>', inertia))
    with open_simulator(Scene({"thing": shape})) as simulator:
        body = simulator.body("thing")
        for pose in (Pose((0.4, 0.1, 0.02)), Pose((0.4, 0.1, 0.3), (0.1, 0.2, 0.3, math.sqrt(0.86)))):
            simulator.place({"thing": pose})
            found = simulator.read("thing")
            assert math.dist(found.position, pose.position) < 1e-12
            assert turn_between(found.quaternion, pose.quaternion) < 1e-7
        simulator.place({"thing": Pose((0.4, 0.1, 0.02))})
        gap = min(p[8] for p in pybullet.getClosestPoints(body, simulator.table, 0.1, physicsClientId=simulator.client))
        assert gap == pytest.approx(0.0, abs=1e-6)
        mass, _, moments, centre, *_ = pybullet.getDynamicsInfo(body, -1, physicsClientId=simulator.client)
    assert mass == 1.0
    assert centre == pytest.approx((0.01, 0.005, -0.01))
    assert sorted(moments) == pytest.approx(
        sorted(np.linalg.eigvalsh([[2e-4, 5e-5, 0], [5e-5, 3e-4, 0], [0, 0, 4e-4]]))
    )


def test_a_hull_and_its_integrals_are_those_of_known_solids(chance):
    random = np.random.default_rng(chance.seed(7))
    turn = np.linalg.qr(random.normal(size=(3, 3)))[0]
    at = random.normal(size=3)
    grid = np.array([(x, y, z) for x in range(5) for y in range(4) for z in range(3)]) * 0.01
    hull = convex_hull(grid @ turn.T + at)
    found = polyhedron_mass(hull)
    sides = np.array([0.04, 0.03, 0.02])
    assert found.mass == pytest.approx(sides.prod())
    assert found.centre == pytest.approx(turn @ (sides / 2) + at)
    squares = sides**2
    assert np.linalg.eigvalsh(found.inertia) == pytest.approx(sorted(found.mass * (squares.sum() - squares) / 12))
    assert is_closed(hull)
    assert is_convex(hull)


@pytest.mark.parametrize("count", [4, 5, 9, 40, 300])
def test_no_point_is_outside_the_hull_of_random_points(chance, count):
    random = np.random.default_rng(chance.seed(count))
    for spread in (1, 2, 1000):  # few values for each coordinate put many points in one plane
        points = random.integers(0, spread + 2, size=(count, 3)) * 0.01
        if np.linalg.matrix_rank(points - points[0]) < 3:
            continue
        hull = convex_hull(points)
        normals = np.cross(hull[:, 1] - hull[:, 0], hull[:, 2] - hull[:, 0])
        assert (np.einsum("nk,npk->np", normals, points[None] - hull[:, :1]) < 1e-9 * np.abs(normals).max()).all()
        assert is_closed(hull)


def test_an_open_or_dented_mesh_is_told_from_a_convex_one():
    cube = convex_hull(np.array([(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]) * 0.05)
    assert not is_closed(cube[:-1])
    tip = np.where(np.all(cube == 0.05, axis=2)[..., None], 0.01, cube)
    assert is_closed(tip)
    assert not is_convex(tip)
