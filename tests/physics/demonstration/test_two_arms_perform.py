"""Demonstrations by two arms in one world: what is recorded, the handover, the arm that stands still."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from prag_asp.domain.load import load_domain
from prag_asp.errors import QueryError
from prag_asp.physics import (
    Budget,
    Demonstration,
    check_demonstration,
    demonstrate,
    film_strip,
    open_validator,
    validate_tasks,
)
from prag_asp.physics.robot.kinematics import inverse, tool_pose
from prag_asp.physics.search.attempt import LOST
from prag_asp.physics.verdict import Verdict
from prag_asp.physics.witness import TRANSIT
from prag_asp.physics.world import dynamics
from prag_asp.scene.robots import robot_of
from prag_asp.scene.scene import BodyModel, Scene, Shape, Solid
from prag_asp.space.task_space import TaskSpace
from prag_asp.task import Task
from tests.physics.random_tasks import shipped_scene
from tests.physics.scenarios import GIVE, HANDOVER

MODELS, BLOCK = Path(__file__).parents[1] / "scenes" / "models", 60.0
"""Models of tests, and the side of the cube in `block.obj` in the unit of the file; its bottom is at 0."""

FINGERS = {robot: [f"{side} finger of {robot}" for side in ("left", "right")] for robot in ("left", "right")}


@pytest.fixture(scope="module")
def scene() -> Scene:
    return shipped_scene("two_arms")


@pytest.fixture(scope="module")
def handover() -> Task:
    [task] = TaskSpace(load_domain("two_arms"), len(HANDOVER)).tasks_of_plans([HANDOVER])
    return task


@pytest.fixture(scope="module")
def verdict(scene: Scene, handover: Task) -> Verdict:
    with open_validator(scene) as validator:
        return validator.validate(handover, seed=1, budget=Budget(5, 10, "demonstration"))


@pytest.fixture(scope="module")
def shown(verdict: Verdict) -> Demonstration:
    assert verdict.demonstration is not None, verdict.causes
    return verdict.demonstration


def _touching(shown: Demonstration, one: str, two: str) -> set[int]:
    """Return the frames in which two bodies press on each other."""
    pair = {shown.bodies.index(one), shown.bodies.index(two)}
    return {frame for frame, *bodies in shown.contacts.tolist() if set(bodies) == pair}


def _tool(shown: Demonstration, scene: Scene, robot: str, frame: int) -> np.ndarray:
    """Return where the tool of a robot is in a frame."""
    return np.array(tool_pose(robot_of(scene, robot), shown.arms(frame)[robot].joints).position)


def test_two_arms_carry_a_bar_from_side_to_side_through_the_air(scene, handover, shown):
    assert shown.success and len(shown.ends) == len(HANDOVER) + 1
    assert check_demonstration(handover, shown, scene) == []
    bar = shown.poses[:, shown.objects.index("bar_1")]
    assert bar[0, 1] > 0.24 and bar[-1, 1] < -0.24
    assert bar[shown.ends[GIVE] : shown.ends[-2], 2].min() > 0.1


def test_the_episode_has_joints_and_grippers_of_every_arm(shown):
    frames = len(shown.times)
    assert shown.robots == ("left", "right") == tuple(shown.arms(0))
    assert shown.bodies[:7] == ("arm of left", *FINGERS["left"], "arm of right", *FINGERS["right"], "table")
    shapes = {name: getattr(shown, name).shape for name in ("joints", "commands", "widths")}
    assert shapes == {"joints": (frames, 2, 7), "commands": (frames, 2, 8), "widths": (frames, 2)}
    assert np.abs(shown.joints - shown.commands[..., :7]).max() < 0.05
    assert shown.arms(3)["right"].joints == tuple(shown.joints[3, 1].tolist())


def test_both_grippers_hold_the_bar_before_the_giver_opens(shown):
    held = {
        robot: set.intersection(*(_touching(shown, finger, "bar_1") for finger in fingers))
        for robot, fingers in FINGERS.items()
    }
    both = held["left"] & held["right"]
    begun, ended = int(shown.ends[GIVE]), int(shown.ends[GIVE + 1])
    assert both and both <= set(range(begun + 1, ended))
    assert max(held["left"]) < ended and max(held["left"]) == max(both)
    # From the grasp to where it is put down there is no moment in which nobody holds the bar.
    assert set(range(int(shown.ends[1]), int(shown.ends[-2]) + 1)) <= held["left"] | held["right"]


def test_the_arm_that_does_not_act_holds_its_place_and_what_it_holds(scene, handover, shown):
    still_arms = {0: "right", 1: "right", 2: "left", 4: "right", 5: "left", 6: "left"}  # at GIVE, both move
    for k, still in still_arms.items():
        first, last = int(shown.ends[k]), int(shown.ends[k + 1])
        places = np.array([_tool(shown, scene, still, frame) for frame in range(first, last + 1)])
        assert np.abs(places - places[0]).max() < 0.002
    bar = shown.poses[shown.ends[2] : shown.ends[3] + 1, shown.objects.index("bar_1"), :3]
    assert np.abs(bar - bar[0]).max() < 0.003


def test_an_arm_in_the_way_is_run_into(scene, handover, verdict):
    tool = tool_pose(robot_of(scene, "left"), verdict.witness.moments[2].arms["left"].joints)
    there = next(inverse(robot_of(scene, "right"), tool))
    last = replace(verdict.witness.motions[2][-1], joints=there)
    motions = list(verdict.witness.motions)
    motions[2] = (replace(last, name=TRANSIT), last)
    shown = demonstrate(handover, replace(verdict.witness, motions=tuple(motions)), scene)
    assert not shown.success
    arms = [[f"arm of {robot}", *FINGERS[robot]] for robot in FINGERS]
    assert any(_touching(shown, one, two) for one in arms[0] for two in arms[1])


def test_without_friction_nothing_changes_hands(scene, handover, verdict, monkeypatch):
    monkeypatch.setattr(dynamics, "FINGER_FRICTION", 0.0)
    shown = demonstrate(handover, verdict.witness, scene)
    assert shown.cause == LOST and len(shown.ends) == 2


@pytest.mark.parametrize(("mass", "seed"), [(0.12, 1), (0.2, 4)], ids=["light", "so heavy that its ends twist"])
def test_a_bar_from_a_mesh_is_handed_over(mass: float, seed: int, scene: Scene):
    plan = HANDOVER[: GIVE + 1]
    [given] = TaskSpace(load_domain("two_arms"), len(plan)).tasks_of_plans([plan])
    size = scene.shapes["bar_1"].size
    x, y, z = (side / BLOCK for side in size)
    solid = Solid("mesh", (x, y, z), (0.0, 0.0, -size[2] / 2), mesh=str(MODELS / "block.obj"))
    a, b, c = (side**2 for side in size)
    moments = (mass * (b + c) / 12, mass * (a + c) / 12, mass * (a + b) / 12)
    bar = Shape("mesh", size, model=BodyModel((solid,), mass, moments=moments))
    made = replace(scene, shapes={**scene.shapes, "bar_1": bar})
    with open_validator(made) as validator:
        verdict = validator.validate(given, seed=seed, budget=Budget(5, 10, "demonstration"))
    assert verdict.demonstration is not None, verdict.nearest
    assert check_demonstration(given, verdict.demonstration, made) == []
    holders = [[robot for robot in ("left", "right") if moment.arms[robot].held] for moment in verdict.witness.moments]
    assert holders[GIVE : GIVE + 2] == [["left"], ["right"]]


def test_an_episode_of_two_arms_comes_back_from_its_file_and_is_drawn(scene, handover, shown, tmp_path: Path):
    shown.save(tmp_path / "it.npz")
    loaded = Demonstration.load(tmp_path / "it.npz")
    assert loaded == shown and loaded.robots == shown.robots
    swapped = replace(shown, joints=shown.joints[:, ::-1], widths=shown.widths[:, ::-1])
    strips = [film_strip(handover, each, scene, frames=2, size=(90, 80)).tobytes() for each in (loaded, swapped)]
    assert strips[0] != strips[1]
    assert check_demonstration(handover, swapped, scene) != []
    replace(shown, robots=("left",)).save(tmp_path / "bad.npz")
    with pytest.raises(QueryError, match=r"joints has the shape \(\d+, 2, 7\) in place of \(\d+, 1, 7\)"):
        Demonstration.load(tmp_path / "bad.npz")


def test_demonstrations_are_the_same_bytes_with_two_workers_and_in_any_order(scene, chance, tmp_path):
    tasks = TaskSpace(load_domain("two_arms"), 3).sample(3, seed=chance.seed(4), weights={})
    budget, seed = Budget(3, 10, "demonstration"), chance.seed(3)
    alone = list(validate_tasks(tasks, scene, seed=seed, budget=budget))
    together = list(validate_tasks(tasks, scene, seed=seed, budget=budget, workers=2))
    with open_validator(scene) as validator:
        again = validator.validate(tasks[1], seed=seed, index=1, budget=budget)
    assert again.demonstration == alone[1].demonstration
    for one, two in zip(alone, together, strict=True):
        assert one == two and one.feasible and one.demonstration == two.demonstration
        one.demonstration.save(tmp_path / "one.npz")
        two.demonstration.save(tmp_path / "two.npz")
        assert (tmp_path / "one.npz").read_bytes() == (tmp_path / "two.npz").read_bytes()
    assert all(one.demonstration != two.demonstration for one, two in pairwise(alone))
