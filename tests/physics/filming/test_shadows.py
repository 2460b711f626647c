"""Shadows against rays that are traced here, and the textures."""

from __future__ import annotations

import math

import numpy as np

from prag_asp.physics.filming.appearance_meshes import MIDDLE
from prag_asp.physics.filming.room import room_colours
from prag_asp.physics.filming.shadows import blurred
from prag_asp.physics.filming.studio import open_studio
from prag_asp.physics.filming.textures import concrete, wood
from prag_asp.physics.witness import Arm, Moment
from prag_asp.scene.cameras import Camera
from prag_asp.scene.geometry import Pose
from prag_asp.scene.robots import PANDA
from prag_asp.scene.scene import Scene, Shape, TableTop

SIDE = 0.12
LIGHT = (0.0, 0.6, 0.8)
SCENE = Scene({"cube_1": Shape("box", (SIDE, SIDE, SIDE))}, colors={"cube_1": "#2e86ab"})
ABOVE = Camera((0.5, 0.0, 1.0), (0.5, 0.0, 0.0), 50.0, size=(96, 96))


def image(height: float):
    """Return the image from above of a cube whose lowest point is at a height in metres, far from the robot."""
    with open_studio(SCENE, ("cube_1",), LIGHT, MIDDLE) as studio:
        studio.show(Moment({"cube_1": Pose((0.6, -0.1, height + SIDE / 2))}, {"panda": Arm(PANDA.home, 0.08)}))
        return studio.take(ABOVE)


def test_a_cube_shades_the_table_where_a_traced_ray_meets_it():
    """The expected shadow: the ray from a point of the table towards the light passes through the cube."""
    with_cube, without = image(0.0), image(3.0)
    table = (with_cube.segmentation == 1) & (without.segmentation == 1)
    darker = with_cube.rgb.astype(float).sum(axis=-1) < 0.87 * without.rgb.astype(float).sum(axis=-1)
    rows, columns = np.indices(table.shape) + 0.5
    matrix, pose = ABOVE.intrinsics, ABOVE.pose
    rays = np.stack([(columns - matrix[0, 2]) / matrix[0, 0], (rows - matrix[1, 2]) / matrix[1, 1], np.ones_like(rows)])
    ahead = np.einsum("ij,jhw->ihw", pose[:3, :3], rays)
    points = pose[:3, 3, None, None] - ahead * (pose[2, 3] / ahead[2])
    direction = np.array(LIGHT) / math.hypot(*LIGHT)
    expected = np.zeros(table.shape, dtype=bool)
    for step in np.linspace(0.0, 0.3, 120):
        x, y, z = points + step * direction[:, None, None]
        expected |= (np.abs(x - 0.6) < SIDE / 2) & (np.abs(y + 0.1) < SIDE / 2) & (z < SIDE)
    expected &= table
    assert expected.sum() > 60
    both = int((darker & expected).sum())
    assert both > 0.8 * expected.sum() and both > 0.8 * (darker & table).sum(), "but for the soft edge"


def test_shadows_of_bodies_farther_from_the_table_are_softer():
    lit = image(3.0).rgb.astype(float).sum(axis=-1)
    widths = []
    for height in (0.0, 0.25):
        taken = image(height)
        share = (taken.rgb.astype(float).sum(axis=-1) / lit)[taken.segmentation == 1]
        widths.append(((share > 0.75) & (share < 0.93)).sum())
    assert widths[1] > 1.5 * widths[0]


def test_a_blurred_image_keeps_its_mean_and_what_is_even():
    points = np.zeros((20, 24), dtype=np.float32)
    points[9, 11] = 1.0
    assert abs(blurred(points, 2).sum() - 1.0) < 1e-5
    assert np.allclose(blurred(np.full((8, 9), 3.0, np.float32), 3), 3.0)


def test_textures_keep_the_brightness_and_repeat_without_a_seam():
    for texture in (wood(), concrete()):
        for texels in texture.levels:
            assert abs(float(texels.mean()) - 1.0) < 1e-3
        finest = texture.levels[0]
        within = np.abs(np.diff(finest, axis=0)).mean()
        assert np.abs(finest[0] - finest[-1]).mean() < 3 * within
        x = np.linspace(-2.0, 2.0, 50, dtype=np.float32)
        assert np.allclose(texture.at(x, x, 0.01), texture.at(x + np.float32(texture.side), x, 0.01), atol=0.2)
        assert np.ptp(texture.at(x, x, 1.0)) < np.ptp(texture.at(x, x, 0.001)), "large pixels see the mean"


def test_the_room_has_a_floor_below_and_a_wall_ahead():
    eye = np.array([1.5, 0.0, 0.5], dtype=np.float32)
    rays = tuple(np.array(parts, dtype=np.float32) for parts in ((0.3, -1.0, 0.0), (0.0, 0.0, 0.0), (-1.0, 0.1, 1.0)))
    floor, wall, ceiling = room_colours(TableTop(), eye, rays, 100.0, LIGHT).astype(int)
    assert floor.sum() < wall.sum() < ceiling.sum()
