from __future__ import annotations

import sys

import numpy as np
import pytest

from prag_asp.errors import QueryError
from prag_asp.physics import PicturesMissingError, film_strip
from tests.physics.scenarios import stacking


@pytest.fixture(scope="module")
def witness(tabletop_validator):
    return tabletop_validator.validate(stacking(), seed=1).witness


def test_a_film_strip_shows_the_first_and_the_last_state(witness, tabletop):
    strip = film_strip(stacking(), witness, tabletop, frames=2, size=(120, 100))
    pixels = np.asarray(strip)
    left, right = pixels[14:114, 14:134], pixels[14:114, 146:266]
    assert strip.width == 2 * 120 + 12 + 28
    assert left.std() > 20 and right.std() > 20
    assert np.abs(left.astype(int) - right.astype(int)).mean() > 2


def test_headings_can_be_given(witness, tabletop):
    plain = film_strip(stacking(), witness, tabletop, frames=2, size=(60, 50))
    other = film_strip(stacking(), witness, tabletop, frames=2, size=(60, 50), headings=["Take it", "Put it"])
    assert np.asarray(plain).tobytes() != np.asarray(other).tobytes()
    with pytest.raises(QueryError, match="1 heading for 2 actions; give one for each"):
        film_strip(stacking(), witness, tabletop, headings=["Take it"])


def test_one_frame_is_no_film(witness, tabletop):
    with pytest.raises(QueryError, match="at least 2 frames"):
        film_strip(stacking(), witness, tabletop, frames=1)


def test_without_pillow_the_extra_is_named(witness, tabletop, monkeypatch):
    monkeypatch.setitem(sys.modules, "PIL", None)
    with pytest.raises(PicturesMissingError, match=r"prag_asp\[pictures\]"):
        film_strip(stacking(), witness, tabletop)
