from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from prag_asp.scene.geometry import extents
from prag_asp.scene.scene import Shape
from tests.chance import examples


@settings(max_examples=examples(50))
@given(seed=st.integers(0, 10**6))
def test_the_bounding_box_of_a_turned_body_is_that_of_points_on_it(seed):
    rng = np.random.default_rng(seed)
    quaternion = rng.normal(size=4)
    quaternion = tuple((quaternion / np.linalg.norm(quaternion)).tolist())
    x, y, z, w = quaternion
    turn = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
    corners = np.array([[i, j, k] for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)]) * (0.06, 0.03, 0.02)
    assert extents(Shape("box", (0.12, 0.06, 0.04)), quaternion) == pytest.approx((corners @ turn.T).max(axis=0))
    angles = np.linspace(0, 2 * np.pi, 2000)
    rim = np.stack([0.033 * np.cos(angles), 0.033 * np.sin(angles), np.full(2000, 0.05)], axis=1)
    rims = np.concatenate([rim, rim * (1, 1, -1)])
    assert extents(Shape("cylinder", (0.066, 0.066, 0.1)), quaternion) == pytest.approx(
        (rims @ turn.T).max(axis=0), abs=1e-5
    )
