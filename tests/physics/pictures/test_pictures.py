from __future__ import annotations

import sys
from dataclasses import replace

import numpy as np
import pytest

from prag_asp.errors import QueryError
from prag_asp.physics import PicturesMissingError, film_strip
from prag_asp.physics.pictures.rendering import make_captions
from tests.physics.scenarios import stacking, state, task


@pytest.fixture(scope="module")
def witness(tabletop_validator):
    return tabletop_validator.validate(stacking(), seed=1).witness


def test_a_film_strip_shows_the_first_and_the_last_state_and_given_words(witness, tabletop):
    def strip(**options):
        return np.asarray(film_strip(stacking(), witness, tabletop, frames=2, size=(120, 100), **options))

    plain = strip()
    left, right = plain[14:114, 14:134], plain[14:114, 146:266]
    assert plain.shape[1] == 2 * 120 + 12 + 28
    assert left.std() > 20 and right.std() > 20
    assert np.abs(left.astype(int) - right.astype(int)).mean() > 2
    captions = [("before", "all is there"), ("one", ""), ("two", "done")]
    assert make_captions(stacking(), tabletop, range(3), None, captions)[1:] == captions[1:]
    for options in ({"headings": ["Take it", "Put it"]}, {"captions": captions}):
        assert strip(**options).tobytes() != plain.tobytes()
    with pytest.raises(QueryError, match="1 heading for 2 actions; give one for each"):
        strip(headings=["Take it"])
    with pytest.raises(QueryError, match="2 captions for 3 states; give one for each"):
        strip(captions=captions[1:])


def test_one_frame_is_no_film(witness, tabletop):
    with pytest.raises(QueryError, match="at least 2 frames"):
        film_strip(stacking(), witness, tabletop, frames=1)


def test_without_pillow_the_extra_is_named(witness, tabletop, monkeypatch):
    monkeypatch.setitem(sys.modules, "PIL", None)
    with pytest.raises(PicturesMissingError, match=r"prag_asp\[pictures\]"):
        film_strip(stacking(), witness, tabletop)


def test_the_first_caption_names_what_is_handled_and_whose_sides_are_meant(tabletop):
    known = state("on_top(can_1,table_1)", "on_top(cube_1,table_1)", "on_top(brick_1,table_1)")
    step = ("place(panda,cube_1,left_of,brick_1)", state("left_of(cube_1,brick_1)"))
    for frame, note in (("robot", " (sides are as the robot sees them)"), ("viewer", "")):
        scene = replace(tabletop, frame=frame)
        captions = make_captions(task(known, step), scene, range(2), None)
        assert captions[0] == ("start", f"cube 1 is on table 1, brick 1 is on table 1{note}")
        assert captions[1] == ("1. place cube 1 left of brick 1", "cube 1 is to the left of brick 1")
        assert make_captions(task(known, step), scene, range(2), ["put it there"])[1][0] == "1. put it there"
