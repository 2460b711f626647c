"""The models that benchmarks give to the second simulator, MuJoCo."""

from __future__ import annotations

import importlib
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from prag_asp.scene.scene_loader import parse_scene
from tests.independent.world import world_of

mujoco = pytest.importorskip("mujoco")
BENCHMARKS = Path(__file__).parents[2] / "benchmarks"
CUPBOARD = {"kind": "cupboard", "size": [0.24, 0.32, 0.3]}
DRAWER = {"kind": "drawer", "size": [0.3, 0.3, 0.15]}


def test_doors_and_drawers_move_as_far_as_in_the_scene(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    sys.modules.pop("second_simulator", None)
    second = importlib.import_module("second_simulator")

    shapes = {"panda": {"kind": "robot"}, "table": {"kind": "table"}, "cupboard": CUPBOARD, "drawer": DRAWER}
    fixed = {"cupboard": [0.6, 0.3, 180], "drawer": [0.6, -0.3, 180]}
    scene = parse_scene({"shapes": shapes, "fixed": fixed}, {}, {name: name for name in shapes})
    world = world_of(scene)
    shown = SimpleNamespace(objects=("cupboard", "drawer"), robots=("panda",))
    model = mujoco.MjModel.from_xml_string(second._xml(world, scene, shown, second.Change(1.0, 1.0)))
    for name in shown.objects:
        limit = world.furniture[name].limit
        np.testing.assert_allclose(model.joint(f"part:{name}").range, (0.0, limit), rtol=1e-6)
