from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest

from prag_asp.scene.colours import apart, from_lab, more_colours, to_lab
from prag_asp.scene.read.scene_reader import DISTINCT
from prag_asp.scene.scene_loader import parse_scene


@pytest.mark.parametrize(
    ("color", "lab"),
    [  # as the published conversion of sRGB has them
        ("#ffffff", (100.0, 0.0, 0.0)),
        ("#000000", (0.0, 0.0, 0.0)),
        ("#ff0000", (53.24, 80.09, 67.20)),
        ("#00ff00", (87.73, -86.18, 83.18)),
        ("#0000ff", (32.30, 79.19, -107.86)),
        ("#808080", (53.59, 0.0, 0.0)),
    ],
)
def test_colours_have_their_place_in_cielab(color, lab):
    assert to_lab(color) == pytest.approx(lab, abs=0.02)
    assert from_lab(to_lab(color)) == color


def test_what_no_screen_shows_becomes_what_one_can():
    assert from_lab(np.array([150.0, 0.0, 0.0])) == "#ffffff"
    assert len(from_lab(np.array([50.0, 300.0, 0.0]))) == 7


def scene(count: int, **colors: str):
    entities = {f"cube_{i}": "cube" for i in range(count)}
    table = {"shapes": {"cube": {"kind": "box", "size": [0.05, 0.05, 0.05]}}, "colors": colors}
    return parse_scene(table, {"cube": ()}, entities)


def least(colors):
    return min(apart(one, two) for one, two in combinations(colors, 2))


def test_the_colours_of_twenty_objects_are_told_apart_and_from_the_table():
    found = scene(20)
    assert len(set(found.colors.values())) == 20
    assert least(found.colors.values()) > 25
    assert min(apart(color, found.table.color) for color in found.colors.values()) > DISTINCT


def test_a_colour_that_is_given_is_not_given_again():
    assert scene(2, cube_1="#e4572e").colors == {"cube_0": "#2e86ab", "cube_1": "#e4572e"}
    nearly = scene(20, cube_7="#e5582f")
    assert nearly.colors["cube_7"] == "#e5582f" and least(nearly.colors.values()) > 20
    assert set(scene(3, cube="#e4572e").colors.values()) == {"#e4572e"}


def test_more_colours_are_as_far_apart_as_colours_can_be():
    assert len(set(more_colours(("#ffffff",), 40))) == 40
    assert more_colours((), 3) == more_colours((), 5)[:3]
