"""Episodes of every domain keep to the limits of the robots' joints, and press on nothing that is not asked for.

`python benchmarks/episodes.py --count 500` does the same with more.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from prag_asp import TaskSpace, load_domain, load_scene
from prag_asp.physics import Budget, check_demonstration, open_validator
from prag_asp.physics.bullet import pybullet
from prag_asp.physics.world.dynamics import TIME_STEP, Dynamics
from tests.independent.recordings import LIMITS, above_limits, unwanted

KINDS = (("tabletop", "panda"), ("prag", "kuka"), ("kitchen", "panda"), ("two_arms", "panda"))


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


@pytest.mark.parametrize(("name", "kind"), KINDS)
def test_joints_keep_their_limits_and_nothing_is_pressed_in_episodes_of_random_tasks(name, kind, felt, chance):
    domain = load_domain(name)
    scene = load_scene(domain)
    scene = replace(scene, robots={each: mount._replace(kind=kind) for each, mount in scene.robots.items()})
    tasks = TaskSpace(domain, 3).sample(2, seed=chance.seed(6), weights={})
    kinds = [kind] * len(scene.robots)
    with open_validator(scene) as validator:
        for index, task in enumerate(tasks):
            felt.clear()
            verdict = validator.validate(task, seed=chance.seed(1), index=index, budget=Budget(tier="demonstration"))
            shown = verdict.demonstration
            assert shown is not None, verdict.causes
            assert list(above_limits(shown.joints, kinds)) == []
            assert list(above_limits(shown.commands[..., :7], kinds)) == []
            known = [str(fluent) for fluent, value in task.initial.items() if value]
            assert list(unwanted(shown, list(map(str, task.actions)), known)) == []
            assert check_demonstration(task, shown, scene) == []
            if verdict.restarts == 1:
                speeds = np.array(felt)
                accelerations = np.diff(speeds, axis=0) / TIME_STEP
                assert (np.abs(speeds) <= LIMITS[kind][0]).all() and (np.abs(accelerations) <= LIMITS[kind][1]).all()


def test_a_joint_that_is_too_fast_or_gathers_speed_too_fast_is_seen():
    frames = np.zeros((9, 1, 7))
    frames[4:, 0, 1] = 0.01  # 0.2 rad/s within a frame: 4 rad/s2
    assert list(above_limits(frames, ["panda"])) == []
    frames[4:, 0, 1] = 0.02
    assert [text.split(": ")[1].split()[0] for text in above_limits(frames, ["panda"])] == ["acceleration"] * 2
    frames[:, 0, 5] = np.arange(9) * 0.14  # 2.8 rad/s, where 2.61 are allowed
    assert sum("speed 2.80 of joint 6" in text for text in above_limits(frames, ["panda"])) == 8
