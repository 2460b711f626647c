"""The table and what is around, against PyBullet's own picture of the same table."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from prag_asp.physics.bullet import pybullet
from prag_asp.physics.filming.backdrop import backdrop, patches
from prag_asp.physics.filming.studio import matrices
from prag_asp.physics.world.bodies import make_table, show_zone
from prag_asp.physics.world.simulator import open_client
from prag_asp.scene.cameras import Camera
from prag_asp.scene.scene import Scene, Shape
from prag_asp.scene.variation import USUAL_LIGHT as LIGHT

ZONE = Shape("zone", (0.3, 0.2, 0.0))
SCENE = Scene({"zone_1": ZONE}, fixed={"zone_1": (0.5, 0.1, 0.7)}, colors={"zone_1": "#2e86ab"})
VIEWS = {
    "in front": Camera((1.6, 0.6, 1.0), (0.4, 0.0, 0.0)),
    "near": Camera((0.4, 0.0, 0.3), (0.5, 0.1, 0.0), 70.0),
    "level": Camera((2.0, 0.3, 0.1), (0.0, 0.0, 0.0)),
    "below": Camera((1.5, -0.8, -0.9), (0.4, 0.0, 0.0)),
    "away": Camera((1.6, 0.6, 1.0), (4.0, 2.0, 1.0)),
}


def drawn(camera: Camera) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return colours, depths in metres and bodies as PyBullet has them: 1 is the table, 0 nothing, 2 the zone."""
    width, height = camera.size
    with open_client() as client:
        make_table(client, SCENE, visual=True)
        show_zone(client, SCENE, "zone_1")
        shades = {
            "lightDirection": LIGHT,
            "lightAmbientCoeff": 0.62,
            "lightDiffuseCoeff": 0.42,
            "lightSpecularCoeff": 0,
        }
        how = {**shades, "shadow": 0, "renderer": pybullet.ER_TINY_RENDERER, "physicsClientId": client}
        result = pybullet.getCameraImage(width, height, *matrices(camera, camera.pose), **how)
    buffer = np.asarray(result[3]).reshape(height, width)
    depth = camera.far * camera.near / (camera.far - (camera.far - camera.near) * buffer)
    return (
        np.asarray(result[2]).reshape(height, width, 4)[..., :3],
        depth,
        np.asarray(result[4]).reshape(depth.shape) + 1,
    )


@pytest.mark.parametrize("name", VIEWS)
def test_each_pixel_shows_what_pybullet_shows_as_far_away(name):
    camera = VIEWS[name]
    rgb, depth, bodies = drawn(camera)
    zones = patches(SCENE, {"zone_1": 2})
    ours = backdrop(SCENE, camera, camera.pose, zones, 1, LIGHT)
    assert (ours.numbers == bodies).mean() > 0.995, "but for pixels at edges"
    same = (ours.numbers == bodies) & (bodies > 0)
    assert (name == "away") == (not same.any())
    if same.any():
        assert np.median(np.abs(ours.depth - depth)[same]) < 0.0002
        assert np.median(np.abs(ours.rgb.astype(int) - rgb)[same]) < 25
    assert np.isinf(ours.depth[ours.numbers == 0]).all()
    assert (2 in ours.numbers) == (name not in ("below", "away")), "a zone is not seen through the table"


def test_brightness_follows_the_light():
    camera = VIEWS["near"]
    scene = replace(SCENE, fixed={}, shapes={})
    above, beside = (
        backdrop(scene, camera, camera.pose, [], 1, light).rgb.astype(int).mean()
        for light in ((0.0, 0.0, 1.0), (1.0, 0.0, 0.0))
    )
    assert above > beside + 40
