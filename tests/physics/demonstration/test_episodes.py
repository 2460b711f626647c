"""Episodes of every domain succeed, keep to the limits of the robots' joints, and have no unintended contacts.

`python benchmarks/episodes.py --count 500` does the same with more.
"""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from prag_asp import TaskSpace, load_domain, load_scene
from prag_asp.physics import check_demonstration, open_validator
from prag_asp.physics.bullet import pybullet
from prag_asp.physics.demonstration.performance import open_performer
from prag_asp.physics.symbolic_facts import physical_task
from prag_asp.physics.world.dynamics import TIME_STEP, Dynamics
from prag_asp.physics.world.simulator import open_simulator
from prag_asp.scene.geometry import yaw_of
from prag_asp.scene.robots import robot_of
from prag_asp.scene.scene import Scene
from prag_asp.scene.solids import weight
from tests.independent.frames import standing
from tests.independent.recordings import LIMITS, above_limits, loosened, overloaded, unwanted
from tests.independent.robots import ROBOTS, Mounted

CASES = (
    ("tabletop", "panda", (3, 5)),
    ("prag", "panda", (3, 5)),
    ("prag", "kuka", (3,)),
    ("kitchen", "panda", (3,)),
    ("two_arms", "panda", (3, 5)),
)


@pytest.fixture
def felt(monkeypatch: pytest.MonkeyPatch) -> list[np.ndarray]:
    """The speeds of all joints after every time step of every world, shape (robots, 7)."""
    found: list[np.ndarray] = []
    step = Dynamics.step

    def noted(world: Dynamics) -> None:
        step(world)
        arms = [(arm.body, arm.robot.arm_links) for arm in world._arms.values()]
        states = [pybullet.getJointStates(*arm, physicsClientId=world.client) for arm in arms]
        found.append(np.array([[state[1] for state in joints] for joints in states]))

    monkeypatch.setattr(Dynamics, "step", noted)
    return found


@pytest.mark.parametrize(("name", "kind", "lengths"), CASES)
def test_most_witnesses_of_random_tasks_are_performed_within_the_limits_of_joints_and_contacts(
    name, kind, lengths, felt, chance
):
    domain, done = load_domain(name), 0
    scene = load_scene(domain)
    scene = replace(scene, robots={each: mount._replace(kind=kind) for each, mount in scene.robots.items()})
    kinds, count = [kind] * len(scene.robots), chance.examples(2)
    tasks = [task for n in lengths for task in TaskSpace(domain, n).sample(count, seed=chance.seed(6), weights={})]
    with (
        open_validator(scene) as validator,
        open_simulator(scene) as planner,
        open_performer(scene, planner) as performer,
    ):
        for index, task in enumerate(tasks):
            verdict = validator.validate(task, seed=chance.seed(1), index=index)
            assert verdict.witness is not None, verdict.causes
            felt.clear()
            shown = performer.perform(physical_task(task, scene), verdict.witness)
            assert list(above_limits(shown.joints, kinds)) == []
            assert list(above_limits(shown.commands[..., :7], kinds)) == []
            speeds = np.array(felt)
            accelerations = np.diff(speeds, axis=0) / TIME_STEP
            assert (np.abs(speeds) <= LIMITS[kind][0]).all() and (np.abs(accelerations) <= LIMITS[kind][1]).all()
            # Depths are not recorded.
            assert shown.success == (check_demonstration(task, shown, scene) == []) or "mm deep" in shown.detail
            if shown.success:
                arms = {robot: Mounted(ROBOTS[kind], standing(*base)) for robot, base in _bases(scene).items()}
                weights = {entity: weight(scene, entity) for entity in shown.objects}
                assert [*loosened(shown, arms), *overloaded(shown, weights)] == []
                known = [str(fluent) for fluent, value in task.initial.items() if value]
                assert list(unwanted(shown, list(map(str, task.actions)), known, weights)) == []
                done += 1
    assert done >= 0.8 * len(tasks) - 0.6


def _bases(scene: Scene) -> dict[str, tuple[float, float, float, float]]:
    """Return x, y, z and yaw of each robot's base."""
    poses = {robot: robot_of(scene, robot).base for robot in scene.robots}
    return {robot: (*pose.position, yaw_of(pose.quaternion)) for robot, pose in poses.items()}


def test_a_joint_that_is_too_fast_or_gathers_speed_too_fast_is_seen():
    frames = np.zeros((9, 1, 7))
    frames[4:, 0, 1] = 0.01  # 0.2 rad/s within a frame: 4 rad/s2
    assert list(above_limits(frames, ["panda"])) == []
    frames[4:, 0, 1] = 0.02
    assert [text.split(": ")[1].split()[0] for text in above_limits(frames, ["panda"])] == ["acceleration"] * 2
    frames[:, 0, 5] = np.arange(9) * 0.14  # 2.8 rad/s, where 2.61 are allowed
    assert sum("speed 2.80 of joint 6" in text for text in above_limits(frames, ["panda"])) == 8


@pytest.mark.parametrize(
    "forces, fault",
    [((0.85, 1.57), None), ((1.2, 1.9), "right finger of arm and bar, 1.2 N"), ((0.85, 2.4), "table and bar, 2.4 N")],
)
def test_the_weight_that_a_table_bears_is_no_unwanted_contact(forces, fault):
    """A finger presses on a bar of 0.12 kg (1.18 N), and the bar on the table."""
    shown = SimpleNamespace(
        bodies=["table", "right finger of arm", "bar"], contacts=np.array([[3, 1, 2], [3, 0, 2]]),
        forces=np.array(forces), ends=np.array([5]),
    )  # fmt: skip
    faults = list(unwanted(shown, ["place(arm,plank)"], [], {"bar": 0.12}))
    assert faults == ([] if fault is None else [f"frame 3: {fault}"])
