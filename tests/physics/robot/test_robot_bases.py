from __future__ import annotations

import math

import pybullet
import pytest

from prag_asp.physics.world.simulator import open_simulator
from prag_asp.scene.geometry import Pose, yaw_quaternion
from prag_asp.scene.read.scene_reader import check_bases
from prag_asp.scene.scene import Mount, Scene, Shape
from prag_asp.tables.report import TableEntry, TableReport
from tests.chance import Chance

CUBE = Shape("box", (0.05, 0.05, 0.05))
BASE = -1


def base_problems(scene: Scene) -> list[str]:
    """Return the problems of fixed bodies that stand on the base of a robot."""
    report = TableReport()
    check_bases(TableEntry(report, ("scene", "fixed")), scene)
    return [str(problem) for problem in report.problems]


@pytest.mark.parametrize("mount", [Mount("panda"), Mount("kuka"), Mount("panda", 0.3, -0.2, 2.0)])
def test_a_fixed_body_stands_on_a_base_where_the_simulator_says_that_the_two_collide(
    mount: Mount, chance: Chance
) -> None:
    rng = chance.generator(3)
    scene = Scene({"arm": Shape("robot"), "cube": CUBE}, robots={"arm": mount})
    touching = deep = 0
    with open_simulator(scene) as simulator:
        for _ in range(chance.examples(150)):
            dx, dy, yaw = rng.uniform(-0.2, 0.2), rng.uniform(-0.2, 0.2), rng.uniform(-math.pi, math.pi)
            x, y = mount.x + dx, mount.y + dy
            simulator.place({"cube": Pose((x, y, 0.025), yaw_quaternion(yaw))})
            points = pybullet.getClosestPoints(
                simulator.arms["arm"].body, simulator.body("cube"), 0.0, BASE, physicsClientId=simulator.client
            )
            depth = -min((point[8] for point in points), default=0.0)
            fixed = Scene(scene.shapes, robots=scene.robots, fixed={"cube": (x, y, yaw)})
            refused = base_problems(fixed)
            assert refused in ([], ["scene.fixed.cube: cube stands on the base of arm; move it"])
            assert not refused or depth > 0.0015
            assert refused or depth < 0.015
            touching, deep = touching + bool(refused), deep + (depth > 0.015)
    assert touching > 40 and deep > 25


def test_a_zone_may_lie_where_a_robot_stands() -> None:
    scene = Scene({"here": Shape("zone", (0.3, 0.3, 0.0))}, fixed={"here": (0.0, 0.0, 0.0)})
    assert base_problems(scene) == []
