from __future__ import annotations

import re

import numpy as np
import pytest

from prag_asp.physics.bullet import pybullet
from prag_asp.physics.filming.appearance_meshes import Mesh, cluster_corners, low_files, read_parts
from prag_asp.physics.filming.studio import matrices, open_studio
from prag_asp.physics.witness import Arm, Moment
from prag_asp.physics.world.simulator import open_simulator
from prag_asp.scene.cameras import Camera
from prag_asp.scene.robots import ROBOTS
from prag_asp.scene.scene import Mount, Scene, Shape

CUBE = "\n".join(
    [f"v {x} {y} {z}" for x in (0, 1) for y in (0, 1) for z in (0, 1)]
    + ["usemtl red", "f 1 2 4 3", "f 5/1/1 7/2/2 8/3/3 6/4/4", "usemtl blue", "f 1 5 6 2"]
)


def test_a_mesh_is_read_by_materials_and_its_faces_become_triangles():
    parts = read_parts(CUBE)
    assert {name: mesh.triangles.tolist() for name, mesh in parts.items()} == {
        "red": [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5]],
        "blue": [[0, 4, 5], [0, 5, 1]],
    }
    assert parts["red"].corners[7].tolist() == [1, 1, 1]


def test_corners_of_a_cell_become_one_and_triangles_without_area_go():
    corners = np.array([[0, 0, 0], [0.1, 0, 0], [1, 0, 0], [1, 1, 0], [9, 9, 9]], dtype=float)
    mesh = Mesh(corners, np.array([[0, 1, 2], [0, 2, 3], [1, 2, 3]]))
    found = cluster_corners(mesh, 0.5)
    assert sorted(found.corners.tolist()) == [[0.05, 0, 0], [1, 0, 0], [1, 1, 0]]
    assert len(found.triangles) == 1
    assert cluster_corners(mesh, 0.05).triangles.shape == (3, 3)


@pytest.mark.parametrize("kind", ROBOTS)
def test_a_robot_of_few_corners_looks_like_the_whole_one(kind):
    urdf, *meshes = low_files(kind).values()
    assert b"collision" not in urdf and sum(mesh.count(b"\nf ") for mesh in meshes) < 4000
    assert set(re.findall(r'filename="([^"]+)"', urdf.decode())) == {*low_files(kind)} - {f"{kind}.urdf"}
    scene = Scene({"arm": Shape("robot")}, robots={"arm": Mount(kind)})
    moment = Moment({}, {"arm": Arm(ROBOTS[kind].home, 0.06)})
    camera = Camera((1.6, 0.9, 0.7), (0.2, 0.0, 0.45), 45.0, size=(128, 128))
    with open_studio(scene, ()) as studio:
        studio.show(moment)
        low = studio.take(camera)
    with open_simulator(scene, visual=True) as whole:
        whole.show(moment)
        how = {"shadow": 0, "renderer": pybullet.ER_TINY_RENDERER, "physicsClientId": whole.client}
        shades = {"lightDirection": (-0.3, 0.8, 1.8), "lightAmbientCoeff": 0.62, "lightDiffuseCoeff": 0.42}
        result = pybullet.getCameraImage(*camera.size, *matrices(camera, camera.pose), **shades, **how)
        seen = np.asarray(result[4]).reshape(128, 128) == whole.arms["arm"].body
    mine = low.segmentation == studio.legend.index("arm")
    assert (mine & seen).sum() > 0.93 * (mine | seen).sum()
    colors = np.asarray(result[2]).reshape(128, 128, 4)[..., :3].astype(int)
    assert np.median(np.abs(colors - low.rgb)[mine & seen]) < 20
    assert np.abs(colors[mine & seen].mean(axis=0) - low.rgb[mine & seen].mean(axis=0)).max() < 15
