from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from prag_asp.errors import OutputError, QueryError
from prag_asp.physics import Budget, Demonstration, Verdict, check_demonstration, demonstrate
from prag_asp.physics.demonstration.performance import Performer, open_performer
from prag_asp.physics.demonstration.recording import FRAME_STEPS
from prag_asp.physics.search.attempt import LOST, NOT_REACHED
from prag_asp.physics.symbolic_facts import physical_task
from prag_asp.physics.world import dynamics
from prag_asp.physics.world.bodies import mass
from prag_asp.physics.world.simulator import open_simulator
from prag_asp.scene.geometry import Pose
from prag_asp.scene.robots import PANDA
from prag_asp.scene.scene import Scene
from tests.physics.scenarios import carrying, stacking, state, task, with_arm

GRAVITY = 9.81
FASTEST = 2.0


@pytest.fixture(scope="module")
def performer(tabletop: Scene) -> Iterator[Performer]:
    with open_simulator(tabletop) as planner, open_performer(tabletop, planner) as opened:
        yield opened


@pytest.fixture(scope="module")
def witness(tabletop_validator):
    return tabletop_validator.validate(stacking(), seed=1).witness


@pytest.fixture(scope="module")
def stacked(performer, witness, tabletop) -> Demonstration:
    return performer.perform(physical_task(stacking(), tabletop), witness)


def _touches(demonstration: Demonstration, one: str, two: str) -> dict[int, float]:
    """Return the force between two bodies in every frame in which they touch."""
    pair = {demonstration.bodies.index(one), demonstration.bodies.index(two)}
    rows = zip(demonstration.contacts.tolist(), demonstration.forces.tolist(), strict=True)
    return {frame: force for (frame, *bodies), force in rows if set(bodies) == pair}


def test_the_robot_stacks_a_cube_on_a_brick(stacked, tabletop):
    assert stacked.success and len(stacked.ends) == 3
    assert check_demonstration(stacking(), stacked, tabletop) == []
    cube = stacked.poses[:, stacked.objects.index("cube_1")]
    assert cube[0, 2] == pytest.approx(0.025) and cube[-1, 2] == pytest.approx(0.065, abs=0.001)


def test_the_robot_fetches_turns_drops_and_leaves_an_object(prag, prag_validator):
    made = carrying("can_1")
    demonstration = demonstrate(made, prag_validator.validate(made, seed=1).witness, prag)
    assert demonstration.success, demonstration.detail
    assert check_demonstration(made, demonstration, prag) == []


def test_what_is_recorded_is_a_motion_that_the_robot_can_make(stacked):
    frames = len(stacked.times)
    assert np.diff(stacked.times) == pytest.approx(0.05, abs=1e-5)
    assert stacked.joints.shape == (frames, 1, 7) and stacked.commands.shape == (frames, 1, 8)
    assert stacked.poses.shape == (frames, len(stacked.objects), 7)
    assert stacked.robots == ("panda",) and stacked.widths.shape == (frames, 1)
    assert all(PANDA.within_limits(row, 1e-3) for row in stacked.joints[:, 0].tolist())
    assert np.abs(np.diff(stacked.commands[..., :7], axis=0)).max() <= 0.05 * FASTEST + 1e-6
    assert np.abs(stacked.joints - stacked.commands[..., :7]).max() < 0.05
    assert stacked.widths.min() > 0.045 and stacked.widths.max() < 0.081


def test_an_object_moves_only_while_the_robot_touches_it_and_never_jumps(stacked):
    for i, name in enumerate(stacked.objects):
        steps = np.linalg.norm(np.diff(stacked.poses[:, i, :3], axis=0), axis=1)
        assert steps.max() < 0.05 * FASTEST
        if name != "cube_1":
            assert steps.max() < 0.001
    held = stacked.poses[: stacked.ends[1] + 1, stacked.objects.index("cube_1")]
    moving = np.flatnonzero(np.linalg.norm(np.diff(held[:, :3], axis=0), axis=1) > 0.001)
    left, right = (_touches(stacked, f"{side} finger of panda", "cube_1") for side in ("left", "right"))
    assert len(moving) > 5
    assert all(frame in left and frame in right for frame in moving.tolist())


def test_friction_alone_carries_the_object(stacked, tabletop):
    lifted = int(stacked.ends[1])
    forces = [_touches(stacked, f"{side} finger of panda", "cube_1")[lifted] for side in ("left", "right")]
    assert not any(lifted in _touches(stacked, other, "cube_1") for other in ("table", "brick_1", "arm of panda"))
    friction = tabletop.material("cube_1").friction * dynamics.FINGER_FRICTION
    assert sum(forces) * friction > mass(tabletop, "cube_1") * GRAVITY
    assert max(forces) < 3 * PANDA.grip_force


def test_without_friction_the_object_stays_behind(performer, witness, tabletop, monkeypatch):
    monkeypatch.setattr(dynamics, "FINGER_FRICTION", 0.0)
    failed = performer.perform(physical_task(stacking(), tabletop), witness)
    assert failed.cause == LOST and len(failed.ends) == 2
    assert failed.detail == "after pick(panda,cube_1,table_1), this fact does not hold: cube 1 is held by the gripper"
    assert failed.poses[-1, failed.objects.index("cube_1"), 2] < 0.05


def test_a_grasp_beside_the_object_fails_and_a_motion_that_brings_nothing_about(performer, witness, tabletop):
    physical, (picking, placing) = physical_task(stacking(), tabletop), witness.motions
    high = tuple(replace(each, joints=picking[0].joints) if each.name == "at" else each for each in picking)
    failed = performer.perform(physical, replace(witness, motions=(high, placing)))
    assert failed.cause == LOST
    assert check_demonstration(stacking(), failed, tabletop) == ["2 states are reached; the task has 3"]
    idle = replace(placing[-1], name="stay", joints=witness.moments[1].arms["panda"].joints)
    failed = performer.perform(physical, replace(witness, motions=(picking, (idle,))))
    assert failed.cause == NOT_REACHED and "stack(panda,cube_1,brick_1)" in failed.detail


def test_what_stands_on_a_carried_object_is_carried_along_by_friction(tabletop, tabletop_validator):
    lifting = task(
        state("on_top(cube_1,brick_1)", "on_top(brick_1,table_1)"),
        ("pick(panda,brick_1,table_1)", state("holding(panda,brick_1)", "-on_top(brick_1,table_1)")),
    )
    witness = tabletop_validator.validate(lifting, seed=0, budget=Budget(50, 10)).witness
    demonstration = demonstrate(lifting, witness, tabletop)
    assert demonstration.success, demonstration.detail
    cube, brick = (demonstration.poses[-1, demonstration.objects.index(name), 2] for name in ("cube_1", "brick_1"))
    assert brick > 0.1 and cube - brick == pytest.approx(0.045, abs=0.002)
    assert len(demonstration.times) - 1 in _touches(demonstration, "cube_1", "brick_1")


def test_a_verdict_with_a_demonstration_goes_to_json_without_it(tabletop_validator, monkeypatch):
    verdict = tabletop_validator.validate(stacking(), seed=1, budget=Budget(2, 5, "demonstration"))
    assert verdict.demonstration.success
    assert Verdict.from_json(verdict.to_json()) == replace(verdict, demonstration=None)
    # Where a witness cannot be performed, the search goes on.
    monkeypatch.setattr(dynamics, "FINGER_FRICTION", 0.0)
    verdict = tabletop_validator.validate(stacking(), seed=1, budget=Budget(2, 10, "demonstration"))
    assert (verdict.status, verdict.reason, verdict.causes[LOST]) == ("not_found", LOST, 2)


def test_an_episode_comes_back_from_its_file_as_it_was(stacked, tmp_path):
    stacked.save(tmp_path / "stack.npz")
    loaded = Demonstration.load(tmp_path / "stack.npz")
    assert loaded == stacked and loaded.poses.dtype == np.float32
    assert loaded != replace(stacked, widths=stacked.widths + 1)
    with pytest.raises(OutputError, match="cannot be written"):
        stacked.save(tmp_path / "missing" / "stack.npz")


def test_files_that_hold_no_episode_are_refused(stacked, tmp_path):
    path = tmp_path / "bad.npz"
    stacked.save(path)
    whole = path.read_bytes()
    for content in (b"", b"not a recording", whole[: len(whole) // 2]):
        path.write_bytes(content)
        with pytest.raises(QueryError, match=r"bad.npz: this is not a demonstration"):
            Demonstration.load(path)
    np.savez(path, joints=stacked.joints)
    with pytest.raises(QueryError, match="not a demonstration"):
        Demonstration.load(path)
    replace(stacked, joints=stacked.joints[..., :6]).save(path)
    with pytest.raises(QueryError, match=r"joints has the shape \(\d+, 1, 6\) in place of \(\d+, 1, 7\)"):
        Demonstration.load(path)
    for changed, message in (
        ({"poses": stacked.poses * np.nan}, "poses has to hold finite numbers"),
        ({"ends": stacked.ends + 10_000}, "ends has to hold numbers of frames"),
        ({"contacts": stacked.contacts + len(stacked.bodies)}, "contacts has to hold a frame and the positions"),
        ({"cause": 7}, "cause has to hold a text"),
        ({"times": np.array(3.0)}, r"times has the shape \(\); it has to be a list"),
    ):
        replace(stacked, **changed).save(path)
        with pytest.raises(QueryError, match=rf"bad.npz: this is not a demonstration: {message}"):
            Demonstration.load(path)
    np.save(path.with_suffix(".npy"), np.arange(3))
    with pytest.raises(QueryError, match=r"it is not a \.npz file, or is truncated"):
        Demonstration.load(path.with_suffix(".npy"))
    with pytest.raises(QueryError, match="cannot be read: Is a directory"):
        Demonstration.load(tmp_path)


def test_an_episode_that_was_changed_does_not_pass_the_check(stacked, tabletop):
    poses = stacked.poses.copy()
    poses[-1, stacked.objects.index("cube_1"), 2] += 0.01
    found = check_demonstration(stacking(), replace(stacked, poses=poses), tabletop)
    assert found == [  # what presses on a body that does not rest there does so unasked
        "action 2, stack(panda,cube_1,brick_1): brick_1 presses on cube_1 with 6.2 N",
        "state 2: this fact does not hold: cube 1 is on brick 1",
    ]
    ends = stacked.ends.copy()
    ends[1] = 10_000
    names = tuple("cube_2" if name == "brick_1" else name for name in stacked.objects)
    pair = stacked.bodies.index("arm of panda"), stacked.bodies.index("brick_1")
    contacts = np.concatenate([stacked.contacts, np.array([[int(stacked.ends[1]) + 1, *pair]], dtype=np.int32)])
    forces = np.append(stacked.forces, np.float32(5.7))
    for changes, first in (
        ({"ends": ends}, "state 1: there is no frame 10000"),
        ({"robots": ("somebody",)}, "it shows the robots somebody; the scene has panda"),
        (
            {"contacts": contacts, "forces": forces},
            "action 2, stack(panda,cube_1,brick_1): the arm of panda presses on brick_1 with 5.7 N",
        ),
    ):
        assert check_demonstration(stacking(), replace(stacked, **changes), tabletop) == [first]
    renamed = check_demonstration(stacking(), replace(stacked, objects=names), tabletop)
    assert "brick_1 is not in this situation" in renamed[0]


def test_the_opening_of_the_gripper_is_the_gap_between_its_pads(tabletop, witness):
    from prag_asp.physics.bullet import pybullet

    with dynamics.open_dynamics(tabletop) as world:
        for width in (0.02, 0.05, 0.08):
            world.begin((), replace(with_arm(witness.moments[0], width=width), poses={}))
            arm = world._arms["panda"].body
            points = pybullet.getClosestPoints(arm, arm, 0.1, *PANDA.finger_links, physicsClientId=world.client)
            assert min(point[8] for point in points) == pytest.approx(width, abs=1e-4)
    assert math.isclose(PANDA.opening, 0.08)


@pytest.mark.parametrize("beyond", [-0.004, 0.002])
def test_what_rests_sleeps_and_what_tips_slowly_does_not(tabletop, witness, beyond):
    # A brick is 6 cm long; the centre of the cube on it is 2 mm beyond its edge, or not.
    half_brick, half_cube = tabletop.shapes["brick_1"].half, tabletop.shapes["cube_1"].half
    brick = Pose((0.5, 0.0, half_brick[2]))
    cube = Pose((0.5 + half_brick[0] + beyond, 0.0, 2 * half_brick[2] + half_cube[2]))
    poses = {"brick_1": brick, "cube_1": cube}
    with dynamics.open_dynamics(tabletop) as world:
        world.begin(list(poses), replace(witness.moments[0], poses=poses))
        arm = witness.moments[0].arms["panda"]
        world.drive("panda", dynamics.ArmCommand(arm.joints, arm.width))
        rested, places = [], []
        for _ in range(20):
            for _ in range(FRAME_STEPS):
                world.step()
            rested.append(world.at_rest())
            places.append(world.poses()["cube_1"])
    if beyond < 0:
        assert all(rested[2:]) and len(set(places[8:])) == 1
        assert math.dist(places[-1].position, cube.position) < 0.001
    else:
        assert places[-1].position[2] < cube.position[2] - 0.01
        assert not all(rested)


def test_objects_settle_while_an_arm_moves_but_the_world_is_not_at_rest(tabletop, witness):
    poses = {"cube_1": Pose((0.5, 0.2, tabletop.shapes["cube_1"].half[2]))}
    with dynamics.open_dynamics(tabletop) as world:
        world.begin(list(poses), replace(witness.moments[0], poses=poses))
        arm = witness.moments[0].arms["panda"]
        for i in range(4 * FRAME_STEPS):
            world.drive("panda", dynamics.ArmCommand((arm.joints[0] - 0.005 * i, *arm.joints[1:]), arm.width))
            world.step()
        assert world.settle()
        assert not world.at_rest()
