"""What a simulator gets of a mesh is what was understood of it, and nothing that could end or mislead it."""

from __future__ import annotations

from pathlib import Path

import pytest

from prag_asp.errors import SceneError
from prag_asp.physics.world.primitives import mesh_file
from prag_asp.scene.read.mesh import file_parts, mesh_parts, mesh_points
from prag_asp.scene.scene import Solid

POINTS = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"


def written(folder: Path, content: str | bytes, suffix: str = ".obj") -> str:
    path = folder / f"mesh{suffix}"
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    return str(path)


def test_only_points_faces_and_groups_are_handed_on(tmp_path: Path) -> None:
    text = f"mtllib ../../secret.mtl\no {'x' * 9000}\n{POINTS}vn 0 0 1\nusemtl a\ns off\n"
    mesh = written(tmp_path, text + "f 1//1 2//1 3//1\nf -1 -2 -3\ncall x\n")
    lines = mesh_file(Solid("mesh", (1.0, 1.0, 1.0), mesh=mesh))[1].decode().splitlines()
    assert {line.split()[0] for line in lines} == {"o", "v", "f"}
    assert lines[-2:] == ["f 1 2 3", "f 4 3 2"] and max(map(len, lines)) < 40
    assert mesh_points(mesh) == [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]


def test_points_of_no_face_are_none_of_the_body(tmp_path: Path) -> None:
    assert mesh_points(written(tmp_path, f"{POINTS}v 9 9 9\nf 1 2 3 4\n"))[-1] == (0, 0, 1)


@pytest.mark.parametrize("face", ["1 2 99", "1 2 99999999", "-1 -2 -5", "0 1 2", "1 2", "a b c", "1 2 3.5", "", "1"])
def test_a_face_of_corners_that_are_not_there_is_refused(tmp_path: Path, face: str) -> None:
    with pytest.raises(SceneError, match=r"mesh\.obj: not a mesh: .*; export it anew"):
        mesh_points(written(tmp_path, f"{POINTS}f {face}\n"))


@pytest.mark.parametrize("content", ["", "v 1 2\n", "v a b c\n", b"\xff\xfe", POINTS, f"v 1 2 nan\n{POINTS}f 1 2 3\n"])
def test_a_mesh_without_faces_or_with_points_that_are_not_finite_is_refused(
    tmp_path: Path, content: str | bytes
) -> None:
    with pytest.raises(SceneError, match=r"mesh\.obj: not a mesh: .*; export it anew"):
        mesh_points(written(tmp_path, content))


def test_stl_as_text_is_read_by_its_corners(tmp_path: Path) -> None:
    text = "solid x\n" + "vertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0.5\n" * 4
    assert mesh_parts(written(tmp_path, text, ".stl")) == ((((0, 0, 0), (1, 0, 0), (0, 1, 0.5)),) * 4,)


@pytest.mark.parametrize("content", [b"", b"solid", bytes(84), b"\0" * 80 + b"\xff\xff\xff\xff" + bytes(50)])
def test_an_stl_without_triangles_is_refused(tmp_path: Path, content: bytes) -> None:
    with pytest.raises(SceneError, match="not a mesh"):
        mesh_points(written(tmp_path, content, ".stl"))


def test_a_mesh_that_is_no_regular_file_or_too_large_is_refused(tmp_path: Path) -> None:
    large = tmp_path / "large.stl"
    with large.open("wb") as file:
        file.truncate(33_000_000)
    for path in (str(large), "/dev/zero.stl"):
        with pytest.raises(SceneError, match="cannot be read"):
            mesh_points(path)


@pytest.mark.parametrize(("thin", "parts"), [(0.001, 2), (0.0002, 1)])
def test_a_part_is_one_as_long_as_its_hull_has_a_thickness(tmp_path: Path, thin: float, parts: int) -> None:
    thick = "o one\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"
    flat = f"o two\nv 2 0 0\nv 3 0 0\nv 2 1 0\nv 2 0 {thin * 2}\nf 5 7 6\nf 5 6 8\nf 6 7 8\nf 7 5 8\n"
    assert len(file_parts(written(tmp_path, thick + flat))) == parts


@pytest.mark.parametrize("suffix", ["obj", "stl", "ply", "glb"])
def test_an_empty_file_is_named_as_empty(tmp_path, suffix):
    path = tmp_path / f"empty.{suffix}"
    path.write_bytes(b"")
    with pytest.raises(SceneError, match=r"empty\.\w+: not a mesh: the file is empty; export it anew"):
        mesh_parts(str(path))
