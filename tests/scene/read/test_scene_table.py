from __future__ import annotations

import math
import subprocess
import sys

import pytest

from prag_asp.atom import Atom, parse_atom
from prag_asp.errors import SceneError
from prag_asp.scene.read.scene_values import ancestors
from prag_asp.scene.scene import Shape
from prag_asp.scene.scene_loader import parse_scene, scene_problems
from prag_asp.tables.report import path_text
from tests.physics.random_tasks import rules_of, scene_table, shipped_scene

CLASSES = {"robot": (), "movable": (), "cube": ("movable",), "ball": ("movable",), "tray": ()}
ENTITIES = {"panda": "robot", "cube_1": "cube", "ball_1": "ball", "tray_1": "tray"}
CUBE = {"kind": "box", "size": [0.05, 0.05, 0.05]}
FINE = {"shapes": {"robot": {"kind": "robot"}, "movable": CUBE}}


def test_a_shape_is_inherited_from_the_nearest_ancestor():
    table = {"shapes": {"movable": CUBE, "ball": {"kind": "sphere", "radius": 0.03}}}
    scene = parse_scene(table, CLASSES, ENTITIES)
    assert scene.shapes["cube_1"] == Shape("box", (0.05, 0.05, 0.05))
    assert scene.shapes["ball_1"] == Shape("sphere", (0.06, 0.06, 0.06))
    assert "tray_1" not in scene.shapes


def test_ancestors_end_in_a_cycle_of_classes():
    assert ancestors("a", {"a": ("b",), "b": ("a", "c")}) == ["a", "b", "c"]


def test_degrees_become_radians_and_fluents_get_their_meaning():
    table = {
        **FINE,
        "rotations": {"quarter": 90},
        "fixed": {"cube_1": [0.5, 0.1, 180]},
        "predicates": {"open": "gripper_open"},
    }
    scene = parse_scene(table, CLASSES, ENTITIES)
    assert scene.rotations["quarter"] == pytest.approx(math.pi / 2)
    assert scene.fixed["cube_1"] == pytest.approx((0.5, 0.1, math.pi))
    assert scene.meaning(Atom("open", ("panda",))) == "gripper_open"
    assert scene.meaning(Atom("on_top", ("a", "b"))) == "on_top"
    assert scene.meaning(Atom("painted", ("a",))) is None


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ({"shape": {}}, "scene.shape: unknown key; did you mean shapes?"),
        ({"shapes": []}, "scene.shapes: needs a table"),
        ({"shapes": {"cub": CUBE}}, "scene.shapes.cub: unknown class; did you mean cube?"),
        ({"robot": "robby"}, "scene.robot: needs one of panda, kuka; got 'robby'"),
        ({"frame": "left"}, "scene.frame: needs one of robot, viewer"),
        ({"workspace": {"x": [0.7, 0.3]}}, "scene.workspace.x: needs a low and a high end"),
        ({"workspace": {"z": [0, 1]}}, "scene.workspace.z: unknown key"),
        ({"table": {"size": [1]}}, "scene.table.size: needs two positive lengths"),
        ({"table": {"centre": "here"}}, "scene.table.centre: needs x and y"),
        (
            {**FINE, "colors": {"cube": "red"}},
            "scene.colors.cube: needs a colour like \"#e4572e\"; got 'red'",
        ),
        ({**FINE, "colors": {"cub": "#ffffff"}}, "scene.colors.cub: unknown entity or class"),
        ({**FINE, "fixed": {"cube_1": [0.5]}}, "scene.fixed.cube_1: needs x and y in metres"),
        ({**FINE, "fixed": {"cube_9": [0.5, 0]}}, "scene.fixed.cube_9: unknown entity; did you mean cube_1?"),
        (
            {**FINE, "fixed": {"panda": [0.5, 0]}},
            "scene.fixed.panda: names a robot, which cannot be fixed; fix an entity",
        ),
        (
            {**FINE, "predicates": {"on": "ontop"}},
            "scene.predicates.on: unknown spatial predicate 'ontop'; did you mean on_top?",
        ),
        (
            {**FINE, "fixed": {"cube_1": [0.05, 0.0]}},
            "scene.fixed.cube_1: cube_1 stands on the base of panda; move it",
        ),
        ({**FINE, "rotations": {"straight": "0"}}, "scene.rotations.straight: needs a yaw in degrees"),
    ],
)
def test_a_malformed_table_is_refused_with_its_key(table, message):
    with pytest.raises(SceneError) as caught:
        parse_scene(table, CLASSES, ENTITIES)
    assert message in str(caught.value)


LOW_HIGH = {"low": [0.03, 0.03, 0.04], "high": [0.06, 0.05, 0.04]}


@pytest.mark.parametrize(
    ("shape", "message"),
    [
        (3, ": needs a table"),
        ({"kind": 3}, ".kind: unknown shape 3"),
        ({"kind": "bx"}, ".kind: unknown shape 'bx'; did you mean box?"),
        ({**CUBE, "sise": 1}, ".sise: unknown key; did you mean size?"),
        ({"kind": "box"}, ".size: missing; write three positive lengths"),
        ({"kind": "box", "size": [0.05]}, ".size: needs three positive lengths"),
        ({"kind": "box", "size": [0.05, -1, 0.05]}, ".size: needs three"),
        ({"kind": "box", "size": [0.05, float("nan"), 1]}, ".size: needs"),
        ({"kind": "box", "size": ["a", 1, 1]}, ".size: needs"),
        ({"kind": "box", "size": [0.05, 0.05, 1e-9]}, ".size: needs three positive lengths in metres (at least 0.003"),
        ({"kind": "box", "size": {**LOW_HIGH, "low": [0.0029, 0.05, 0.04]}}, ".size.low: needs three positive lengths"),
        ({"kind": "box", "size": {"low": [0.1, 0.1, 0.1]}}, ".size.high: missing; write three"),
        ({"kind": "box", "size": {**LOW_HIGH, "high": [0.2, 0.02, 0.2]}}, ".size: needs no side of low greater than"),
        ({"kind": "box", "size": {**LOW_HIGH, "middle": 1}}, ".size.middle: unknown key"),
        (
            {"kind": "cylinder", "radius": 0.001, "height": 0.1},
            ".radius: needs a number from 0.0015 to 2 (metres); got",
        ),
        (
            {"kind": "cylinder", "radius": 0.03, "height": 0.002},
            ".height: needs a number from 0.003 to 2 (metres); got",
        ),
        ({"kind": "sphere", "radius": 0}, ".radius: needs a number from 0.0015 to 2"),
        ({"kind": "sphere", "radius": [1e-9, 0.02]}, ".radius: needs two positive lengths in metres (at least 0.0015"),
        ({"kind": "sphere", "radius": [0.04, 0.03]}, ".radius: needs the smaller length first"),
        ({"kind": "sphere", "radius": [0.03, float("nan")]}, ".radius: needs two positive lengths"),
        ({"kind": "sphere", "radius": [0.03, 0.04, 0.05]}, ".radius: needs a number from 0.0015 to 2"),
        ({"kind": "container", "size": [0.1, 0.1, 0.1], "wall": 0.05}, ".wall: needs a thickness"),
        ({"kind": "drawer", "size": [0.05, 0.2, 0.1]}, ".size: needs one size of at least 0.12 x 0.12 x 0.06 m for a"),
        ({"kind": "drawer", "size": {"low": [0.2, 0.2, 0.1], "high": [0.3, 0.2, 0.1]}}, ".size: needs one size of at"),
    ],
)
def test_a_malformed_shape_is_refused_with_its_key(shape, message):
    with pytest.raises(SceneError) as caught:
        parse_scene({"shapes": {"cube": shape}}, CLASSES, ENTITIES)
    assert f"scene.shapes.cube{message}" in str(caught.value)


def test_the_linter_gets_every_problem_at_once():
    table = {"shapes": {"robot": {"kind": "robot"}, "cube": {"kind": "bx"}}, "frame": "left"}
    fluents = [
        parse_atom("on_top(ball_1,tray_1)"),
        parse_atom("rotated(ball_1,up)"),
        parse_atom("holding(ball_1)"),
    ]
    keys = [path_text(problem.keys) for problem in scene_problems(table, CLASSES, ENTITIES, fluents)]
    assert keys == [
        "scene.shapes.cube.kind",
        "scene.frame",
        "scene.shapes.ball",
        "scene.shapes.tray",
        "scene.shapes.ball",
        "scene.rotations.up",
        "scene.predicates.holding",
    ]


@pytest.mark.parametrize("name", ["tabletop", "prag"])
def test_the_shipped_scenes_have_all_shapes_and_rotations_of_their_fluents(name):
    rules, scene = rules_of(name), shipped_scene(name)
    assert {scene.meaning(fluent) for fluent in rules.fluents} - {None}
    assert scene_problems(scene_table(name), rules.classes, rules.entities, rules.fluents) == []


def test_reading_a_scene_loads_no_simulator_and_physics_no_logic_programming(tmp_path):
    (tmp_path / "ball.urdf").write_text(
        '<robot name="x"><link name="a"><inertial><mass value="1"/></inertial>'
        '<collision><geometry><sphere radius="0.03"/></geometry></collision></link></robot>'
    )
    code = (
        "import sys; from pathlib import Path; from prag_asp.scene.read.urdf import read_urdf; "
        f"folder = Path({str(tmp_path)!r}); read_urdf(folder / 'ball.urdf', folder); "
        "assert 'pybullet' not in sys.modules; "
        "import prag_asp.scene.scene_loader; assert not {'pybullet', 'frankik'} & set(sys.modules); "
        "import prag_asp.physics; assert not {'clingo', 'PIL'} & set(sys.modules)"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
