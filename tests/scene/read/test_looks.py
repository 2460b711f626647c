"""What is seen of a body has the materials, textures and colours of its files, in pictures and camera images alike."""

from __future__ import annotations

from dataclasses import replace
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from prag_asp.physics.filming.studio import open_studio
from prag_asp.physics.pictures.camera import picture
from prag_asp.physics.witness import Moment
from prag_asp.scene.cameras import Camera
from prag_asp.scene.geometry import Pose
from prag_asp.scene.read.looks.surfaces import is_painted, look_surfaces, mesh_surfaces
from prag_asp.scene.read.urdf import read_urdf
from prag_asp.scene.scene import Shape
from tests.physics.random_tasks import scene_with

SIDE = 0.1
CORNERS = "".join(f"v {x} {y} {z}\n" for x in (0, SIDE) for y in (0, SIDE) for z in (0, SIDE))
FACES = ("1 3 4 2", "5 6 8 7", "1 2 6 5", "3 7 8 4", "1 5 7 3", "2 4 8 6")
PLACES = "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"


def cube(*materials: str) -> str:
    """Return an .obj of a cube with the faces in turn of some materials, and all of a texture on each face."""
    lines = []
    for number, face in enumerate(FACES):
        corners = " ".join(f"{corner}/{k}" for k, corner in enumerate(face.split(), 1))
        lines += [f"usemtl {materials[number % len(materials)]}", f"f {corners}"]
    return CORNERS + PLACES + "mtllib cube.mtl\n" + "\n".join(lines) + "\n"


def texture(*colours: tuple[int, int, int]) -> bytes:
    """Return a picture of bands of colours, from the top."""
    content = BytesIO()
    Image.fromarray(np.repeat(np.array(colours, np.uint8)[:, None], 4, 1)).save(content, "PNG")
    return content.getvalue()


def textured(folder: Path, *colours: tuple[int, int, int]) -> Shape:
    (folder / "cube.obj").write_text(cube("paint"))
    (folder / "cube.mtl").write_text("newmtl paint\nKd 0.1 0.1 0.1\nmap_Kd -s 1 1 1 bands.png\n")
    (folder / "bands.png").write_bytes(texture(*colours))
    return mesh(folder, "cube.obj")


def mesh(folder: Path, path: str, **table: object) -> Shape:
    """Return the shape of a class of the kind ``mesh``."""
    return scene_with("tabletop", {"cube": {"kind": "mesh", "path": path, **table}}, folder=folder).shapes["cube_1"]


def test_each_material_of_an_obj_is_a_surface_with_its_colour_or_texture(tmp_path: Path) -> None:
    (tmp_path / "cube.obj").write_text(cube("red", "paint"))
    (tmp_path / "cube.mtl").write_text("newmtl red\nKd 1 0 0\nnewmtl paint\nmap_Kd bands.png\n")
    (tmp_path / "bands.png").write_bytes(texture((0, 255, 0)))
    red, paint = mesh_surfaces(str(tmp_path / "cube.obj"), str(tmp_path))
    assert (red.color, red.texture, len(red.corners)) == ("#ff0000", b"", 6)
    assert (paint.color, paint.texture, paint.suffix) == ("", texture((0, 255, 0)), ".png")
    assert paint.places is not None and paint.places.shape == (6, 3, 2)


@pytest.mark.parametrize("library", ["", "newmtl paint\nmap_Kd ../outside.png\n", "newmtl paint\nmap_Kd missing.png\n"])
def test_a_texture_that_is_missing_or_outside_the_domain_is_left_out(tmp_path: Path, library: str) -> None:
    folder = tmp_path / "domain"
    folder.mkdir()
    (tmp_path / "outside.png").write_bytes(texture((0, 255, 0)))
    (folder / "cube.obj").write_text(cube("paint"))
    (folder / "cube.mtl").write_text(library)
    assert not is_painted(mesh(folder, "cube.obj"))


def test_colours_of_vertices_and_textures_of_a_glb_come_along(tmp_path: Path) -> None:
    import trimesh  # takes long, and each process imports all tests

    box = trimesh.creation.box((SIDE, SIDE, SIDE))
    box.visual.face_colors = [(255, 0, 0, 255)] * 6 + [(0, 0, 255, 255)] * 6
    box.export(tmp_path / "faces.ply")
    (faces,) = mesh_surfaces(str(tmp_path / "faces.ply"), str(tmp_path))
    palette = np.asarray(Image.open(BytesIO(faces.texture)).convert("RGB"))
    assert {tuple(colour) for colour in palette.reshape(-1, 3).tolist()} >= {(255, 0, 0), (0, 0, 255)}
    picture_of = trimesh.visual.TextureVisuals(np.zeros((8, 2)), image=Image.open(BytesIO(texture((9, 99, 199)))))
    painted = trimesh.Trimesh(box.vertices, box.faces, visual=picture_of, process=False)
    painted.export(tmp_path / "painted.glb")
    (surface,) = mesh_surfaces(str(tmp_path / "painted.glb"), str(tmp_path))
    assert Image.open(BytesIO(surface.texture)).convert("RGB").getpixel((0, 0)) == (9, 99, 199)


URDF = """<robot name="thing"><material name="blue"><color rgba="0 0 1 1"/></material><link name="thing">
<inertial><mass value="0.1"/></inertial>
<collision><geometry><box size="0.1 0.1 0.1"/></geometry></collision>
<visual><origin xyz="0 0 0.01"/><geometry>{}</geometry><material name="blue"/></visual></link></robot>"""


def test_the_visual_elements_of_a_urdf_are_seen_and_an_unreadable_one_leaves_what_collides(tmp_path: Path) -> None:
    path = tmp_path / "thing.urdf"
    path.write_text(URDF.format('<sphere radius="0.05"/>'))
    (look,) = read_urdf(path, tmp_path).model.looks
    assert (look.solid.kind, look.solid.at, look.color) == ("sphere", (0.0, 0.0, 0.01), "#0000ff")
    (tmp_path / "cube.obj").write_text(CORNERS + "".join(f"f {face}\n" for face in FACES))
    path.write_text(URDF.format('<mesh filename="cube.obj"/>'))
    (look,) = read_urdf(path, tmp_path).model.looks
    assert [surface.color for surface in look_surfaces(look)] == ["#0000ff"]
    path.write_text(URDF.format('<mesh filename="missing.obj"/>'))
    assert read_urdf(path, tmp_path).model.looks == ()


def test_another_mesh_is_seen_where_its_file_has_it_however_the_body_lies(tmp_path: Path) -> None:
    (tmp_path / "cube.obj").write_text(CORNERS + "".join(f"f {face}\n" for face in FACES))
    from trimesh.creation import box

    box((SIDE, SIDE, 3 * SIDE)).export(tmp_path / "tall.stl")
    shape = mesh(tmp_path, "cube.obj", visual="tall.stl", up="x")
    solid = shape.model.looks[0].solid
    assert solid.turn == shape.model.solids[0].turn and solid.at == shape.model.solids[0].at


def test_pictures_and_camera_images_show_a_texture_times_the_colour_of_the_entity(tmp_path: Path) -> None:
    """The top is read counter-clockwise: seen from above, bands lie one beside the other."""
    shape = textured(tmp_path, (255, 255, 255), (0, 255, 0))
    usual = scene_with("tabletop", {}, folder=tmp_path)
    scene = replace(usual, shapes={**usual.shapes, "cube_1": shape}, colors={**usual.colors, "cube_1": "#ff8000"})
    moment = Moment({"cube_1": Pose((0.5, 0.0, SIDE / 2))}, {}, {})
    white, green = (255, 128, 0), (0, 128, 0)
    with open_studio(scene, ["cube_1"]) as studio:
        studio.show(moment)
        shown = np.asarray(picture(studio, (96, 96), ((0.51, 0.0, 0.6), (0.5, 0.0, 0.1))), dtype=float)
        taken = studio.take(Camera((0.51, 0.0, 0.6), (0.5, 0.0, 0.1), size=(96, 96))).rgb.astype(float)
    for image in (shown, taken):
        directions = image / np.maximum(np.linalg.norm(image, axis=2, keepdims=True), 1.0)
        for colour in (white, green):
            likeness = directions @ (np.array(colour) / np.linalg.norm(colour))
            assert (likeness > 0.99).sum() > 20
