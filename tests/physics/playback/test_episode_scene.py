"""The 3D scene of an episode shows the recorded bodies, with the recorded poses."""

from __future__ import annotations

import math
from dataclasses import replace
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest

from prag_asp import QueryError, load_domain, load_scene
from prag_asp.dataset.jsonl import read_lines
from prag_asp.physics import Demonstration, episode_glb, episode_page
from prag_asp.physics.playback.gltf import LARGEST_SIDE, fitting_image, linear
from prag_asp.physics.playback.mesh_pieces import body_pieces, creased_normals
from prag_asp.physics.playback.tracks import body_tracks
from prag_asp.physics.robot.kinematics import tool_pose
from prag_asp.scene.geometry import Pose, compose
from prag_asp.scene.robots import robot_of
from prag_asp.scene.scene import Look, Solid
from tests.physics.playback.glb import GlbFile, read_glb

EPISODES = Path(__file__).parents[1] / "episodes"


def recorded(name):
    with (EPISODES / f"{name}.jsonl").open() as stream:
        task = next(iter(read_lines(stream, name))).task
    return task, Demonstration.load(EPISODES / f"{name}.npz"), load_scene(load_domain(task.domain))


@pytest.fixture(scope="module")
def one():
    return recorded("one_robot")


@pytest.fixture(scope="module")
def content(one) -> bytes:
    return episode_glb(*one)


@pytest.fixture(scope="module")
def file(content) -> GlbFile:
    return read_glb(content)


def test_every_object_has_its_recorded_pose_in_every_frame(one, file):
    _, shown, _ = one
    for i, entity in enumerate(shown.objects):
        poses = file.poses(entity)
        assert (poses == shown.poses[:, i]).all(), entity
        assert len(poses) in (1, len(shown.times))
    moved = [entity for entity in shown.objects if len(file.poses(entity)) > 1]
    assert "brick_1" in moved and "bin_1" not in moved
    times = file.array(file.json["animations"][0]["samplers"][0]["input"]).ravel()
    assert np.allclose(times, shown.times - shown.times[0])


def test_the_links_of_the_robot_stand_where_forward_kinematics_puts_them(one, file):
    _, shown, scene = one
    robot, hand = robot_of(scene, "panda"), file.poses("panda/panda_hand")
    fingers = [file.poses(f"panda/{name}") for name, _ in robot.finger_names]
    for frame in range(len(shown.times)):
        row = hand[frame].tolist()
        tip = compose(Pose(tuple(row[:3]), tuple(row[3:])), Pose((0.0, 0.0, robot.tool_offset)))
        expected = tool_pose(robot, tuple(shown.joints[frame, 0].tolist()))
        assert np.allclose(tip.position, expected.position, atol=1e-5)
        gap = np.linalg.norm(fingers[0][frame, :3] - fingers[1][frame, :3])
        assert gap == pytest.approx(shown.widths[frame, 0], abs=1e-5)
    assert file.poses("panda/panda_link0").tolist() == [[0, 0, 0, 0, 0, 0, 1]]


def test_objects_have_their_sizes_and_colours(one, file):
    _, shown, scene = one
    for entity, size in zip(shown.objects, shown.sizes, strict=True):
        corners = file.triangles(entity).reshape(-1, 3)
        assert np.allclose(np.ptp(corners, axis=0), size, atol=1e-6)
        mesh = file.json["meshes"][file.json["nodes"][file.node(entity)]["mesh"]]
        material = file.json["materials"][mesh["primitives"][0]["material"]]
        parts = [int(scene.color(entity)[k : k + 2], 16) / 255 for k in (1, 3, 5)]
        assert material["pbrMetallicRoughness"]["baseColorFactor"] == [*map(linear, parts), 1.0]
    assert linear(0.5) == pytest.approx(0.2140, abs=1e-4)


def test_actions_camera_and_light_come_with_the_scene(one, file):
    _, shown, _ = one
    extras = file.json["scenes"][0]["extras"]
    end = (shown.times[shown.ends[1]] - shown.times[0]).item()
    assert extras["actions"] == [{"name": "1. pick brick 1 cube 1", "begin": 0.0, "end": end}]
    assert extras["light"] == [-0.3, 0.8, 1.8]
    camera = file.json["nodes"][file.node("camera")]
    x, y, z, w = camera["rotation"]
    backwards = np.array([2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)])
    away = np.array(camera["translation"]) - camera["extras"]["target"]
    assert np.allclose(backwards, away / np.linalg.norm(away), atol=1e-6)


def test_trimesh_reads_the_file(content, file):
    trimesh = pytest.importorskip("trimesh")
    scene = trimesh.load(BytesIO(content), file_type="glb")
    assert len(scene.geometry) == sum(len(mesh["primitives"]) for mesh in file.json["meshes"])
    low, high = scene.bounds
    assert low[1] == pytest.approx(-0.74, abs=1e-6) and 0.4 < high[1] < 1.5, "y points up, from the floor"


def test_two_robots_zones_and_objects_that_the_task_does_not_name_are_shown():
    _, shown, scene = two = recorded("two_robots")
    file = read_glb(episode_glb(*two))
    assert {"left/panda_hand", "right/panda_hand", "left_side", "middle"} <= {
        each["name"] for each in file.json["nodes"]
    }
    without = read_glb(episode_glb(*two, bystanders=False))
    names, others = ({each["name"] for each in each_file.json["nodes"]} for each_file in (file, without))
    assert names - others == {"plank_1", "bar_1"} and others < names
    for name in shown.robots:
        mount = scene.robots[name]
        assert np.allclose(file.poses(f"{name}/panda_link0")[0, :3], (mount.x, mount.y, 0.0))


@pytest.mark.parametrize(("entity", "opening"), [("drawer_1", 0.1), ("cupboard_1", 1.2)])
def test_the_part_of_furniture_is_where_pybullet_has_it(entity, opening):
    bullet = pytest.importorskip("pybullet")
    from prag_asp.physics.world.furniture_bodies import JOINT, make_furniture, set_opening
    from prag_asp.physics.world.simulator import open_client
    from prag_asp.scene.scene import Material

    scene = load_scene(load_domain("kitchen"))
    turn = (0.0, 0.0, 0.6, 0.8)
    shown = Demonstration.load(EPISODES / "two_robots.npz")
    poses = np.array([[(0.4, 0.1, 0.05, *turn)]] * 2, dtype=np.float32)
    shown = replace(
        shown, robots=(), objects=(entity,), furniture=(entity,), sizes=np.zeros((1, 3), np.float32), poses=poses,
        openings=np.array([[0.0], [opening]], dtype=np.float32),
    )  # fmt: skip
    tracks = {track.name: track for track in body_tracks(shown, scene)}
    part = tracks[f"{entity}/part"]
    corners = np.concatenate([piece.corners.reshape(-1, 3) for piece in part.pieces])
    with open_client() as client:
        body = make_furniture(client, scene.shapes[entity], Material(), (0.0, 0.0, 0.0), None)
        bullet.resetBasePositionAndOrientation(body, (0.4, 0.1, 0.05), turn, physicsClientId=client)
        for row, openness in zip(part.poses, (0.0, opening), strict=True):
            set_opening(client, body, openness)
            at, rotation = bullet.getLinkState(body, JOINT, computeForwardKinematics=True, physicsClientId=client)[4:6]
            assert np.allclose(row[:3], at, atol=1e-6)
            assert abs(np.dot(row[3:], rotation)) == pytest.approx(1.0, abs=1e-6)
    assert corners.shape[0] > 36
    assert len(tracks[entity].poses) == 1, "its body stands still"


def test_flat_faces_have_sharp_edges_and_round_ones_are_smooth():
    (box,) = body_pieces([Solid("box", (0.1, 0.2, 0.3))], (), "#ff0000")
    edges = box.corners[:, 1:] - box.corners[:, :1]
    facing = np.cross(edges[:, 0], edges[:, 1])
    assert np.allclose(box.normals, (facing / np.linalg.norm(facing, axis=1, keepdims=True))[:, None])
    assert (np.einsum("ij,ij->i", facing, box.corners.mean(1)) > 0).all(), "counter-clockwise seen from outside"
    (can,) = body_pieces([Solid("cylinder", (0.1, 0.1, 0.2))], (), "#ff0000")
    side = np.abs(can.normals[..., 2]) < 0.5
    radial = can.corners * (1.0, 1.0, 0.0)
    radial /= np.maximum(np.linalg.norm(radial, axis=-1, keepdims=True), 1e-9)
    assert np.allclose(can.normals[side], radial[side], atol=0.01)
    assert np.allclose(np.abs(can.normals[~side]), (0.0, 0.0, 1.0), atol=1e-9)
    assert np.allclose(creased_normals(np.zeros((1, 3, 3))), (0.0, 0.0, 1.0)), "a triangle without an area"


def test_textures_of_files_are_shown_and_fit_the_format(tmp_path):
    image = pytest.importorskip("PIL.Image")
    image.new("RGB", (4, 4), "#336699").save(tmp_path / "paint.png")
    (tmp_path / "tile.mtl").write_text("newmtl paint\nmap_Kd paint.png\n")
    corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n"
    (tmp_path / "tile.obj").write_text(f"mtllib tile.mtl\nusemtl paint\n{corners}f 1/1 2/2 3/3\n")
    solid = Solid("mesh", (0.2, 0.1, 0.1), (0.0, 0.0, 0.5), (0.0, 0.0, math.pi / 2), str(tmp_path / "tile.obj"))
    (piece,) = body_pieces([], [Look(solid, str(tmp_path))], "#ffffff")
    assert np.allclose(piece.corners[0], [(0.0, 0.0, 0.5), (0.0, 0.2, 0.5), (-0.1, 0.0, 0.5)])
    assert np.allclose(piece.normals, (0.0, 0.0, 1.0))
    assert piece.places is not None and piece.places.tolist() == [[[0, 0], [1, 0], [0, 1]]]
    assert piece.texture == (tmp_path / "paint.png").read_bytes()
    buffer = BytesIO()
    image.new("RGB", (2 * LARGEST_SIDE, 8), "#336699").save(buffer, "BMP")
    content, kind = fitting_image(buffer.getvalue())
    with image.open(BytesIO(content)) as fitted:
        assert (kind, fitted.format, fitted.size) == ("image/jpeg", "JPEG", (LARGEST_SIDE, 4))
    assert fitting_image(content) == (content, "image/jpeg")


def test_the_page_holds_the_scene_and_names_no_host(one):
    page = episode_page(*one, title="A <task>", headings=["take it"])
    assert "A &lt;task&gt;" in page and "default-src &#x27;none&#x27;" in page
    assert "import " not in page.partition('<script type="module">')[2].partition("</script>")[0]
    assert "http:" not in page and "https:" not in page


def test_an_episode_of_another_task_is_refused(one):
    task, shown, scene = one
    with pytest.raises(QueryError, match="2 headings"):
        episode_glb(task, shown, scene, headings=["one", "two"])
    with pytest.raises(QueryError, match="the demonstration has"):
        episode_glb(task, replace(shown, ends=shown.ends[:1]), scene)
