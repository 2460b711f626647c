from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from prag_asp.physics import Demonstration, Staging, Variation, check_footage, render_cameras
from prag_asp.physics.demonstration.packed_arrays import Packer
from prag_asp.scene.scene import Mount

EPISODES = Path(__file__).parents[1] / "episodes"


@pytest.fixture(scope="module")
def filmed(tabletop):
    shown = Demonstration.load(EPISODES / "one_robot.npz")
    drawn = Variation(light=(0.0, 0.0, 1.0), colours={"cube_1": "#112233"})
    return render_cameras(replace(shown, variation=drawn), tabletop, Staging(("front", "wrist"), (48, 32), rate=2))


def changed(filmed, **fields):
    return replace(filmed, footage=replace(filmed.footage, **fields))


def with_film(filmed, camera, **fields):
    videos = {**filmed.footage.videos, camera: replace(filmed.footage.videos[camera], **fields)}
    return changed(filmed, videos=videos)


def repacked(array):
    packer = Packer(len(array), array.shape[1:], array.dtype.str)
    for row in array:
        packer.add(row)
    return packer.finish()


def test_films_are_right_in_the_world_in_which_they_were_taken_and_in_no_other(filmed, tabletop):
    assert check_footage(filmed, tabletop) == []
    assert check_footage(replace(filmed, footage=None), tabletop) == []
    (message, *_) = check_footage(replace(filmed, variation=None), tabletop)
    assert message.startswith("front: picture 0 differs in colours by ")
    assert check_footage(filmed, replace(tabletop, robots={"left": Mount("panda")})) == [
        "it shows the robots panda; the scene has left"
    ]


@pytest.mark.parametrize("name", ["tools", "deltas", "grippers", "subgoals"])
def test_a_list_that_was_changed_is_reported(filmed, tabletop, name):
    wrong = getattr(filmed.footage, name).copy()
    wrong.flat[1] += 1
    assert check_footage(changed(filmed, **{name: wrong}), tabletop) == [f"{name} is not what the episode says"]


def test_a_legend_or_a_camera_that_is_another_is_reported(filmed, tabletop):
    legend = filmed.footage.legend
    assert check_footage(changed(filmed, legend=(*legend[:-2], legend[-1], legend[-2])), tabletop) == [
        "legend is not what the episode says"
    ]
    videos = {"side": filmed.footage.videos["front"]}
    assert check_footage(changed(filmed, videos=videos), tabletop) == ["the scene has no camera side"]
    shot = filmed.footage.videos["front"]
    assert check_footage(with_film(filmed, "front", intrinsics=shot.intrinsics + 1), tabletop) == [
        "front/intrinsics is not that of the camera"
    ]


@pytest.mark.parametrize(("position", "what"), [(0, "colours"), (1, "depth"), (2, "entities")])
def test_a_picture_that_was_changed_is_reported_with_its_camera_and_its_number(filmed, tabletop, position, what):
    packed = list(filmed.footage.videos["wrist"].packed)
    array = packed[position].array()
    array[2] = np.where(array[2] > 1, 0, array[2] + 2)
    packed[position] = repacked(array)
    (message,) = check_footage(with_film(filmed, "wrist", packed=tuple(packed)), tabletop)
    assert message.startswith(f"wrist: picture 2 differs in {what} by ")


def test_a_film_that_was_cut_off_is_reported(filmed, tabletop):
    packed = filmed.footage.videos["front"].packed
    cut = (replace(packed[0], stream=packed[0].stream[:-20]), *packed[1:])
    (message,) = check_footage(with_film(filmed, "front", packed=cut), tabletop)
    assert message == "front: the pictures of an episode were cut off or changed; record it anew"
