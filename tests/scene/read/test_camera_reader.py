from __future__ import annotations

import numpy as np
import pytest

from prag_asp import load_domain, load_scene, shipped_domains
from prag_asp.errors import SceneError
from prag_asp.program.settings import read_table
from prag_asp.scene.cameras import Camera, usual_cameras
from prag_asp.scene.scene_loader import parse_scene, scene_problems
from tests.scene.read.test_scene_table import CLASSES, ENTITIES, FINE

FRONT = {"at": [1.2, 0.6, 0.8], "look_at": [0.4, 0.0, 0.1]}
SCENES = [name for name, folder in shipped_domains().items() if "scene" in read_table(folder / "domain.toml")]


def read(**cameras):
    return parse_scene({**FINE, "cameras": cameras}, CLASSES, ENTITIES).cameras


def test_cameras_are_read_with_their_names_in_their_order():
    wrist = {"mount": "panda", "at": [0.08, 0, -0.06], "look_at": [0, 0, 0.04], "field_of_view": 75, "size": [64, 48]}
    found = read(wrist=wrist, front=FRONT)
    assert list(found) == ["wrist", "front"]
    assert found["wrist"] == Camera((0.08, 0, -0.06), (0, 0, 0.04), 75, "panda", (64, 48))
    assert found["front"] == Camera((1.2, 0.6, 0.8), (0.4, 0.0, 0.1))


def test_a_scene_without_the_table_has_a_camera_in_front_that_sees_the_workspace_and_one_at_each_wrist():
    cameras = parse_scene(FINE, CLASSES, ENTITIES).cameras
    assert list(cameras) == ["front", "wrist"]
    assert list(usual_cameras((0.3, 0.7, -0.4, 0.4), ("left", "right"))) == ["front", "left_wrist", "right_wrist"]
    for corner in ((0.3, -0.4, 0), (0.7, -0.4, 0), (0.3, 0.4, 0), (0.7, 0.4, 0)):
        u, v = pixel(cameras["front"], corner)
        assert 0 < u < 128 and 0 < v < 128


def test_a_cube_of_50_mm_below_the_hand_covers_300_of_128_x_128_pixels_of_the_camera_at_the_wrist():
    """The area of the top and of the side towards the camera, from the corners of the cube by the shoelace formula."""
    camera, height, half = usual_cameras((0.3, 0.7, -0.4, 0.4), ("panda",))["wrist"], 0.19, 0.025
    low, high = height + 2 * half, height  # the z axis of the tool points downwards, from the fingers
    top = [(x, y, high) for x, y in ((-half, -half), (half, -half), (half, half), (-half, half))]
    side = [(half, -half, high), (half, half, high), (half, half, low), (half, -half, low)]
    area = 0.0
    for face in (top, side):
        us, vs = np.array([pixel(camera, corner) for corner in face]).T
        assert min(*us, *vs) > 0 and max(*us, *vs) < 128
        area += abs(us @ np.roll(vs, 1) - vs @ np.roll(us, 1)) / 2
    assert area > 300


def pixel(camera: Camera, point: tuple[float, float, float]) -> tuple[float, float]:
    """Return where a point of the scene is in a picture, in pixels."""
    x, y, z = (np.linalg.inv(camera.pose) @ (*point, 1.0))[:3]
    assert z > 0
    u, v, _ = camera.intrinsics @ (x / z, y / z, 1.0)
    return float(u), float(v)


def test_what_a_camera_looks_at_is_in_the_middle_and_what_is_higher_is_above_it():
    camera = read(front=FRONT)["front"]
    assert pixel(camera, (0.4, 0.0, 0.1)) == pytest.approx((64, 64))
    assert pixel(camera, (0.4, 0.0, 0.2))[1] < 64
    assert pixel(camera, (0.4, 0.1, 0.1))[0] > 64, "from in front, the robot's left is on the right"


@pytest.mark.parametrize("mount", ["", "panda"])
def test_a_camera_can_look_straight_along_what_is_upwards_otherwise(mount):
    for target in ((0.0, 0.0, 0.0), (1.0, 0.0, 1.0)):
        pose = Camera((0.0, 0.0, 1.0), target, mount=mount).pose
        assert pose[:3, :3] @ pose[:3, :3].T == pytest.approx(np.eye(3))
        assert np.linalg.det(pose) == pytest.approx(1.0)


@pytest.mark.parametrize("name", SCENES)
def test_every_shipped_scene_has_a_camera_in_front_and_one_at_each_wrist(name):
    scene = load_scene(load_domain(name))
    assert "front" in scene.cameras
    assert {camera.mount for camera in scene.cameras.values()} - {""} == set(scene.robots)


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ({"front": 3}, "scene.cameras.front: needs a table like { at = [1.2, 0.6, 0.8]"),
        ({"Front": FRONT}, "scene.cameras.Front: is not a valid name of a camera; use a lower-case letter"),
        ({"front": {"look_at": [0, 0, 0]}}, "scene.cameras.front.at: missing; write x, y and z in metres"),
        ({"front": {**FRONT, "at": [1, 2]}}, "scene.cameras.front.at: needs x, y and z in metres, within 10 m"),
        ({"front": {**FRONT, "at": [1, 2, float("nan")]}}, "scene.cameras.front.at: needs x, y and z"),
        ({"front": {**FRONT, "at": [1e300, 0, 0]}}, "scene.cameras.front.at: needs x, y and z"),
        ({"front": {**FRONT, "look_at": FRONT["at"]}}, "scene.cameras.front.look_at: is the position of the camera"),
        ({"front": {**FRONT, "lookat": [0, 0, 0]}}, "front.lookat: unknown key; did you mean look_at?"),
        ({"front": {**FRONT, "field_of_view": 180}}, "field_of_view: needs a number from 5 to 150 (degrees); got 180"),
        ({"front": {**FRONT, "mount": "pandora"}}, "front.mount: needs a robot of the scene; did you mean panda?"),
        ({"front": {**FRONT, "mount": []}}, "front.mount: needs a robot of the scene"),
        (
            {"front": {**FRONT, "size": [0, 128]}},
            "size: needs width and height in pixels, from 16 to 2048; got [0, 128]",
        ),
        ({"front": {**FRONT, "size": 128}}, "front.size: needs width and height in pixels"),
        ({"front": {**FRONT, "near": 2, "far": 1}}, "front.far: is 1 m, not farther than near, 2 m"),
        ({"front": {**FRONT, "near": 0}}, "front.near: needs a number from 0.005 to 100 (metres); got 0"),
    ],
)
def test_one_mistake_gives_one_line(table, message):
    (fault,) = scene_problems({**FINE, "cameras": table}, CLASSES, ENTITIES)
    assert message in str(fault)


def test_a_table_that_is_none_is_reported():
    with pytest.raises(SceneError, match=r"scene\.cameras: needs a table"):
        parse_scene({**FINE, "cameras": [1]}, CLASSES, ENTITIES)
