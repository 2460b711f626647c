"""What a simulator gets of a mesh is what was understood of it, and nothing that could end or mislead it."""

from __future__ import annotations

import struct
from pathlib import Path

import pytest

from prag_asp.errors import SceneError
from prag_asp.scene.read.mesh import read_mesh

POINTS = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"


def written(folder: Path, content: str | bytes, suffix: str = ".obj") -> str:
    path = folder / f"mesh{suffix}"
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    return str(path)


def test_only_points_faces_and_groups_are_handed_on(tmp_path: Path) -> None:
    text = f"mtllib ../../secret.mtl\no {'x' * 9000}\n{POINTS}vn 0 0 1\nusemtl a\ns off\n"
    text += "f 1//1 2//1 3//1\nf -1 -2 -3\ncall x\n"
    mesh = read_mesh(written(tmp_path, text))
    lines = mesh.written.decode().splitlines()
    assert {line.split()[0] for line in lines} == {"o", "v", "vn", "f"}
    assert lines[-2:] == ["f 1//1 2//1 3//1", "f 4 3 2"] and max(map(len, lines)) < 40
    assert mesh.points == [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]


def test_points_of_no_face_are_none_of_the_body(tmp_path: Path) -> None:
    assert read_mesh(written(tmp_path, f"{POINTS}v 9 9 9\nf 1 2 3 4\n")).points[-1] == (0, 0, 1)


def test_a_cloud_of_points_is_taken_whole(tmp_path: Path) -> None:
    mesh = read_mesh(written(tmp_path, POINTS))
    assert len(mesh.points) == 4 and mesh.written.count(b"f ") == 4


@pytest.mark.parametrize(
    "face", ["1 2 99", "1 2 99999999", "-1 -2 -5", "0 1 2", "1 2", "1/9 2/9 3/9", "1//1 2 3", "a b c", "1 2 3.5"]
)
def test_a_face_of_corners_that_are_not_there_is_refused(tmp_path: Path, face: str) -> None:
    with pytest.raises(SceneError, match=r"mesh\.obj: not a mesh: .*; export it anew"):
        read_mesh(written(tmp_path, f"{POINTS}f {face}\n"))


def test_stl_as_text_becomes_a_binary_one(tmp_path: Path) -> None:
    text = "solid x\n" + "vertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0.5\n" * 4
    mesh = read_mesh(written(tmp_path, text, ".stl"))
    assert len(mesh.written) == 84 + 4 * 50 and struct.unpack_from("<I", mesh.written, 80) == (4,)
    assert len(mesh.points) == 12


@pytest.mark.parametrize("content", [b"", b"solid", bytes(84), b"\0" * 80 + b"\xff\xff\xff\xff" + bytes(50)])
def test_an_stl_without_triangles_is_refused(tmp_path: Path, content: bytes) -> None:
    with pytest.raises(SceneError, match="not a mesh"):
        read_mesh(written(tmp_path, content, ".stl"))
