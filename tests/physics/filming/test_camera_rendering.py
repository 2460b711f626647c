from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from prag_asp import load_domain, load_scene
from prag_asp.errors import QueryError, SceneError
from prag_asp.physics import Demonstration
from prag_asp.physics.filming import studio
from prag_asp.physics.filming.camera_rendering import moment_of, render_cameras, subgoal_at
from prag_asp.physics.filming.episode_options import Staging
from prag_asp.physics.filming.shadows import ShadowMap
from prag_asp.scene.cameras import Camera
from prag_asp.scene.geometry import Pose, compose
from prag_asp.scene.variation import USUAL_LIGHT

EPISODES = Path(__file__).parents[1] / "episodes"
OBJECTS = ("bin_1", "brick_1", "brick_2", "can_1", "cube_1", "cube_2", "tray_1")


@pytest.fixture(scope="module")
def recorded():
    return Demonstration.load(EPISODES / "one_robot.npz")


@pytest.fixture(scope="module")
def filmed(recorded, tabletop):
    """An episode with a camera in front and one at the wrist, four pictures of 64 x 48 pixels each."""
    return render_cameras(recorded, tabletop, Staging(("front", "wrist"), (64, 48), rate=2))


def test_a_film_has_a_picture_for_every_so_many_frames(filmed):
    footage = filmed.footage
    assert footage.frames.tolist() == [0, 10, 20, 30]
    assert footage.legend == ("nothing", "table_1", "panda", *OBJECTS)
    assert list(footage.videos) == ["front", "wrist"]
    for shot in footage.videos.values():
        assert shot.rgb.shape == (4, 48, 64, 3) and shot.rgb.dtype == np.uint8
        assert shot.depth.shape == (4, 48, 64) and shot.segmentation.shape == (4, 48, 64)
        assert shot.segmentation.max() < len(footage.legend)
        assert ((shot.depth > 0) == (shot.segmentation > 0)).all()
    seen = set(np.unique(footage.videos["front"].segmentation).tolist())
    assert {0, 1, 2} < seen and len(seen) > 6, "nothing, the table, the robot and most objects"


def test_a_film_that_is_taken_again_is_the_same_and_survives_its_file(filmed, recorded, tabletop, tmp_path):
    again = render_cameras(recorded, tabletop, Staging(("front", "wrist"), (64, 48), rate=2))
    assert again == filmed
    filmed.save(tmp_path / "a.npz")
    again.save(tmp_path / "b.npz")
    assert (tmp_path / "a.npz").read_bytes() == (tmp_path / "b.npz").read_bytes()
    assert Demonstration.load(tmp_path / "a.npz") == filmed
    assert filmed != recorded and replace(filmed, footage=None) == recorded
    with np.load(tmp_path / "a.npz") as arrays:
        assert (arrays["front/rgb"] == filmed.footage.videos["front"].rgb).all()
        assert arrays["cameras"].tolist() == ["front", "wrist"]


@pytest.mark.parametrize("light", [USUAL_LIGHT, (0.8, -0.5, 1.2)])
def test_floors_of_containers_by_rays_are_seen_as_those_of_triangles(recorded, tabletop, monkeypatch, light):
    cameras = Staging(("front", "wrist"), (96, 96)).cameras_of(tabletop)
    above = Camera((0.47, 0.20, 0.25), (0.47, 0.28, 0.0), 70.0, size=(96, 96))
    moment = moment_of(recorded, 0)
    pictures = []
    for shadow in ("on_table", "on_bodies"):  # the walls of a floor of triangles cast no shadow on it
        monkeypatch.setattr(ShadowMap, shadow, lambda self, places, *_: np.zeros(len(places.pixels), np.float32))
    for triangles in (False, True):
        with monkeypatch.context() as patch:
            if triangles:
                patch.setattr(studio, "has_still_floor", lambda *_: False)
                patch.setattr(studio, "floors", lambda *_: [])
            with studio.open_studio(recorded.sized_scene(tabletop), recorded.objects, light) as shown:
                shown.show(moment)
                pictures.append([shown.take(camera) for camera in (*cameras.values(), above)])
                tray = shown.legend.index("tray_1")
    for ours, theirs in zip(*pictures, strict=True):
        assert (ours.segmentation != theirs.segmentation).mean() < 0.001
        assert np.abs(ours.depth.astype(float) - theirs.depth).max() < 0.004
        differ = np.abs(ours.rgb.astype(int) - theirs.rgb).max(axis=-1)
        assert (differ > 3).mean() < 0.02
    assert (pictures[0][-1].segmentation == tray).mean() > 0.3, "the last camera looks into the tray"


def test_an_episode_without_cameras_keeps_its_bytes(recorded, filmed, tmp_path):
    for name, episode in (("before", recorded), ("after", replace(filmed, footage=None))):
        episode.save(tmp_path / f"{name}.npz")
    assert (tmp_path / "before.npz").read_bytes() == (tmp_path / "after.npz").read_bytes()
    with np.load(tmp_path / "before.npz") as arrays:
        assert "cameras" not in arrays.files and "frames" not in arrays.files


def test_the_middle_of_an_object_is_where_intrinsics_and_extrinsics_say(filmed):
    footage = filmed.footage
    shot, checked = footage.videos["front"], 0
    for n, frame in enumerate(footage.frames):
        for entity, pose in zip(filmed.objects, filmed.poses[frame], strict=True):
            x, y, z = (np.linalg.inv(shot.extrinsics[n]) @ (*pose[:3], 1.0))[:3]
            u, v, _ = shot.intrinsics @ (x / z, y / z, 1.0)
            shown = shot.segmentation[n] == footage.legend.index(entity)
            if shown.sum() >= 6 and entity not in ("tray_1", "bin_1"):
                rows, columns = np.nonzero(shown)
                assert math.hypot(columns.mean() + 0.5 - u, rows.mean() + 0.5 - v) < 1.0, entity
                assert abs(float(np.median(shot.depth[n][shown])) - z) < 0.07, entity
                checked += 1
    assert checked >= 12


def test_the_camera_at_the_wrist_moves_with_the_tool(filmed, tabletop):
    camera, footage = tabletop.cameras["wrist"], filmed.footage
    for tool, extrinsics in zip(footage.tools[:, 0], footage.videos["wrist"].extrinsics, strict=True):
        pose = compose(Pose(tuple(tool[:3]), tuple(tool[3:])), Pose(camera.at))
        assert extrinsics[:3, 3] == pytest.approx(pose.position, abs=1e-5)
    assert np.ptp(footage.videos["front"].extrinsics, axis=0).max() == 0


def test_what_the_hand_does_from_picture_to_picture_adds_up(filmed):
    footage = filmed.footage
    moved = footage.tools[-1, 0, :3] - footage.tools[0, 0, :3]
    assert footage.deltas[:, 0, :3].sum(axis=0) == pytest.approx(moved, abs=1e-5)
    assert (footage.deltas[-1] == 0).all() and np.abs(footage.deltas[:-1]).max() > 0.01
    assert (footage.grippers == filmed.widths[footage.frames]).all()


def test_each_picture_says_for_which_subgoal_is_worked(recorded):
    ends = np.array([1, 10, 20], dtype=np.int32)
    shown = replace(recorded, ends=ends)
    assert [subgoal_at(shown, frame) for frame in (0, 1, 2, 10, 11, 20, 39)] == [0, 0, 0, 0, 1, 1, 1]


def test_two_robots_have_a_camera_each_and_zones_are_in_the_legend():
    shown = Demonstration.load(EPISODES / "two_robots.npz")
    scene = load_scene(load_domain("two_arms"))
    footage = render_cameras(shown, scene, Staging(("left_wrist", "right_wrist"), (32, 32), rate=2)).footage
    assert footage.tools.shape == (2, 2, 7)
    assert footage.legend[:4] == ("nothing", "table", "left", "right") and "middle" in footage.legend
    poses = [shot.extrinsics[0, :3, 3] for shot in footage.videos.values()]
    assert np.linalg.norm(poses[0] - poses[1]) > 0.3


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"vary": ("color",)}, r"color cannot vary; did you mean colour\?"),
        ({"cameras": ("front", "front")}, "the camera front is named 2 times; name it once"),
        ({"cameras": ("front",), "rate": 3}, "record at 1, 2, 4, 5, 10, 20; got 3"),
        ({"cameras": ("front",), "rate": 0}, "record at 1, 2, 4, 5, 10, 20; got 0"),
        ({"cameras": ("front",), "size": (8, 128)}, "has 16 to 2048 pixels a side; got 8x128"),
    ],
)
def test_options_that_are_impossible_are_refused(options, message):
    with pytest.raises(QueryError, match=message):
        Staging(**options)


def test_an_episode_of_another_scene_is_reported(recorded, prag):
    with pytest.raises(SceneError, match="bin_1 has no shape to render; give its class the shape of an object"):
        render_cameras(recorded, prag, Staging(("front",), (16, 16), rate=1))
    with pytest.raises(SceneError, match="there is no robot panda"):
        render_cameras(recorded, load_scene(load_domain("two_arms")), Staging(("front",), (16, 16), rate=1))


def test_every_camera_has_its_own_size_unless_another_is_requested(tabletop):
    scene = replace(tabletop, cameras={"small": Camera((1, 0, 1), (0, 0, 0), size=(20, 30))})
    assert Staging(("small",)).cameras_of(scene)["small"].size == (20, 30)
    assert Staging(("small",), (40, 50)).cameras_of(scene)["small"].size == (40, 50)
    with pytest.raises(QueryError, match=r"the scene has no camera smal; did you mean small\?"):
        Staging(("smal",)).cameras_of(scene)


def rewritten(path, target, change):
    """Write an archive again with other arrays: `change` is given all of them by their names."""
    with np.load(path) as arrays:
        found = {name: arrays[name] for name in arrays.files}
    change(found)
    np.savez_compressed(target, **found)
    return target


BROKEN = {
    "it has no tools": lambda found: found.pop("tools"),
    "it has no front/rgb": lambda found: found.pop("front/rgb"),
    "it has no wrist/limits": lambda found: found.pop("wrist/limits"),
    "it has no side/intrinsics": lambda found: found.update(cameras=np.array(["front", "side"])),
    "cameras has to hold a list of names": lambda found: found.update(cameras=np.arange(2)),
    "front/depth is not an array of float16": lambda found: found.update(
        {"front/depth": found["front/depth"].astype(np.float32)}
    ),
    "front/segmentation is not an array": lambda found: found.update(
        {"front/segmentation": found["front/segmentation"][:-1]}
    ),
    "front/intrinsics is for images of": lambda found: found.update(
        {"front/intrinsics": found["front/intrinsics"] * 1e6}
    ),
    "front/extrinsics has to hold finite numbers": lambda found: found.update(
        {"front/extrinsics": found["front/extrinsics"] * np.nan}
    ),
    "frames has to hold numbers of frames": lambda found: found.update(frames=found["frames"] + 100),
    "deltas has the shape": lambda found: found.update(deltas=found["deltas"][:, :, :3]),
    "subgoals has to hold whole numbers": lambda found: found.update(subgoals=found["subgoals"] * 0.5),
    "varied.mass.cube_1: needs a positive number": lambda found: found.update(
        varied=np.array('{"mass": {"cube_1": 0}}')
    ),
    "varied has to hold a text": lambda found: found.update(varied=np.arange(3)),
}


@pytest.mark.parametrize("message", BROKEN)
def test_a_film_of_another_form_is_reported_in_a_line(filmed, tmp_path, message):
    filmed.save(tmp_path / "a.npz")
    wrong = rewritten(tmp_path / "a.npz", tmp_path / "b.npz", BROKEN[message])
    with pytest.raises(QueryError) as caught:
        Demonstration.load(wrong)
    (line,) = str(caught.value).splitlines()
    assert line.startswith(f"{wrong}: this is not a demonstration: {message}")


def test_a_film_that_numpy_wrote_again_is_read_as_before(filmed, tmp_path):
    filmed.save(tmp_path / "a.npz")
    again = Demonstration.load(rewritten(tmp_path / "a.npz", tmp_path / "b.npz", lambda found: None))
    for name, shot in filmed.footage.videos.items():
        assert (again.footage.videos[name].rgb == shot.rgb).all()
        assert (again.footage.videos[name].depth == shot.depth).all()


def test_a_file_that_was_cut_off_or_changed_anywhere_is_reported_when_it_is_read(filmed, tmp_path, chance):
    filmed.save(tmp_path / "a.npz")
    content = (tmp_path / "a.npz").read_bytes()
    rng = np.random.default_rng(chance.seed(5))
    for _ in range(chance.examples(25)):
        broken = bytearray(content)
        if rng.uniform() < 0.3:
            broken = broken[: rng.integers(len(content))]
        else:
            broken[rng.integers(len(content))] ^= 1 << rng.integers(8)
        (tmp_path / "b.npz").write_bytes(broken)
        try:
            found = Demonstration.load(tmp_path / "b.npz")
            for shot in found.footage.videos.values() if found.footage else ():
                for _ in shot.images():
                    pass
        except QueryError:
            continue
        assert replace(found, footage=None) == replace(filmed, footage=None), "what nobody reads was changed"
