from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace

import pytest

from prag_asp.physics import Witness, check_witness, open_witness_check
from prag_asp.physics.robot.kinematics import tool_pose
from prag_asp.physics.witness import TRANSIT, Arm
from prag_asp.scene.geometry import Pose, compose, invert, multiply, yaw_quaternion
from prag_asp.scene.robots import PANDA
from prag_asp.scene.scene import Shape
from tests.physics.scenarios import stacking, with_arm

LEAN = (math.sin(0.01), 0.0, 0.0, math.cos(0.01))
PICK, STACK = "action 1, pick(panda,cube_1,table_1): ", "action 2, stack(panda,cube_1,brick_1): "
NOT_HELD = "cube_1 is not where the gripper holds it"
COMES_DOWN = "it does not approach the object straight by 10 cm"
ON_ITS_WAY = "it grasps or releases cube_1 in transit"


@pytest.fixture(scope="module")
def witness(tabletop_validator) -> Witness:
    return tabletop_validator.validate(stacking(), seed=1).witness


@pytest.fixture(scope="module")
def problems(tabletop) -> Iterator[Callable[[Witness], str]]:
    with open_witness_check(tabletop) as check:
        yield lambda witness: "\n".join(check(stacking(), witness))


def _with_moment(witness: Witness, k: int, **changes: object) -> Witness:
    """Return a witness with a moment changed: its poses, or fields of its arm."""
    moments = list(witness.moments)
    arm = {name: change for name, change in changes.items() if name in Arm.__dataclass_fields__}
    rest = {name: change for name, change in changes.items() if name not in Arm.__dataclass_fields__}
    moments[k] = replace(with_arm(moments[k], **arm), **rest)
    return replace(witness, moments=tuple(moments))


def _moved(witness: Witness, states: tuple[int, ...], entity: str, x: float = 0.0, y: float = 0.0, z: float = 0.0):
    """Return a witness with an object moved in some states."""
    for k in states:
        poses = witness.moments[k].poses
        (a, b, c), turn = poses[entity]
        witness = _with_moment(witness, k, poses={**poses, entity: Pose((a + x, b + y, c + z), turn)})
    return witness


def _joints(witness: Witness, k: int, joint: int, angle: float) -> tuple[float, ...]:
    joints = list(witness.moments[k].arms["panda"].joints)
    joints[joint] += angle
    return tuple(joints)


def _renamed(witness: Witness) -> Witness:
    """Return a witness in which a body has another name in the initial state."""
    poses = dict(witness.moments[0].poses)
    poses["ghost"] = poses.pop("brick_1")
    return _with_moment(witness, 0, poses=poses)


def _pierced(witness: Witness) -> Witness:
    """Return a witness in which the arm is down at the cube, turned across its fingers, in the initial state."""
    poses = witness.moments[0].poses
    at, turn = poses["cube_1"]
    turned = {**poses, "brick_1": Pose(at, multiply(yaw_quaternion(math.pi / 4), turn))}
    return _with_moment(witness, 0, joints=witness.motions[0][1].joints, width=0.03, poses=turned)


BROKEN_STATES = {
    "a body floats": (lambda w: _moved(w, (0,), "brick_1", z=0.01), ["state 0: brick_1 would fall"]),
    "bodies are within each other": (lambda w: _moved(w, (2,), "cube_1", z=-0.004), ["collides with"]),
    "a fact does not hold": (
        lambda w: _moved(w, (2,), "cube_1", z=0.004),
        ["state 2: this fact does not hold: cube 1 is on brick 1"],
    ),
    "a false fluent holds": (
        lambda w: replace(w, moments=(w.moments[0], w.moments[0], w.moments[2])),
        ["cube 1 is not on table 1"],
    ),
    "a held object is out of the hand": (lambda w: _moved(w, (1,), "cube_1", x=0.003), [f"state 1: {NOT_HELD}"]),
    "a body moves that nothing moved": (lambda w: _moved(w, (1,), "brick_1", x=0.002), [f"{PICK}brick_1 has moved"]),
    "a fixed body is elsewhere in all states": (
        lambda w: _moved(w, (0, 1, 2), "bin_1", y=-0.3),
        ["bin_1 is not at its place in the scene"],
    ),
    "the joint angles are others": (
        lambda w: _with_moment(w, 1, joints=_joints(w, 1, 0, 0.01)),
        [NOT_HELD, "its last waypoint differs from the arm in the next state"],
    ),
    "a joint angle is beyond its limits": (
        lambda w: _with_moment(w, 0, joints=_joints(w, 0, 5, 3.8)),
        ["state 0: the joint angles"],
    ),
    "the gripper opens too far": (lambda w: _with_moment(w, 0, width=0.2), ["the gripper cannot open 0.2000 m"]),
    "a pose is not a number": (
        lambda w: _moved(w, (0,), "cube_1", x=math.nan),
        ["the pose of cube_1 is not a finite position and rotation"],
    ),
    "a body is missing and one unknown": (_renamed, ["brick_1 has no pose", "ghost is not in the scene"]),
    "a state is missing": (
        lambda w: replace(w, moments=w.moments[:2]),
        ["the witness has 2 states, the task 2 actions"],
    ),
    "the arm is in a body": (_pierced, ["collides"]),
}


@pytest.mark.parametrize("name", BROKEN_STATES)
def test_a_broken_state_is_caught(witness, problems, name):
    change, messages = BROKEN_STATES[name]
    found = problems(change(witness))
    assert all(message in found for message in messages), found


@pytest.mark.parametrize("joints", [(), (0.0,) * 6, (math.nan,) * 7, (math.inf,) * 7])
def test_joint_angles_that_are_no_configuration_are_caught(witness, problems, joints):
    assert "seven finite joint angles" in problems(_with_moment(witness, 1, joints=joints))


def test_a_good_witness_passes(witness, tabletop):
    assert check_witness(stacking(), witness, tabletop) == []


def test_an_object_that_leans_in_the_gripper_and_a_grip_that_is_not_from_above_are_caught(witness, problems):
    moment = witness.moments[1]
    arm, upright = moment.arms["panda"], moment.poses["cube_1"].quaternion
    leaning = Pose(arm.grasp.position, multiply(arm.grasp.quaternion, LEAN))
    pose = compose(tool_pose(PANDA, arm.joints), leaning)
    found = problems(_with_moment(witness, 1, grasp=leaning, poses={**moment.poses, "cube_1": pose}))
    assert "state 1: cube_1 does not stand upright in the gripper" in found
    assert "not held from above" not in found and NOT_HELD not in found
    joints = _joints(witness, 1, 5, 0.05)
    pose = compose(tool_pose(PANDA, joints), arm.grasp)._replace(quaternion=upright)
    grasp = compose(invert(tool_pose(PANDA, joints)), pose)
    found = problems(_with_moment(witness, 1, joints=joints, grasp=grasp, poses={**moment.poses, "cube_1": pose}))
    assert "state 1: cube_1 is not held from above" in found
    assert "stand upright" not in found and NOT_HELD not in found


def test_a_held_object_wider_than_the_gripper_opens_is_caught_whichever_way_it_is_held(witness, tabletop):
    wide = replace(tabletop, shapes={**tabletop.shapes, "cube_1": Shape("box", (0.081, 0.081, 0.05))})
    assert "state 1: cube_1 is wider than the gripper can open" in "\n".join(check_witness(stacking(), witness, wide))


def test_a_motion_that_does_not_grasp_and_release_straight_from_above_is_caught(witness, problems):
    picking, placing = witness.motions
    assert [waypoint.name for waypoint in picking] == ["approach", "at", "at", "lift"]
    assert [waypoint.name for waypoint in placing] == ["approach", "at", "at", "retreat"]
    tilted = replace(picking[0], joints=(picking[0].joints[0] + 0.05, *picking[0].joints[1:]))
    there, back = (tuple(replace(each, joints=joints) for each in motion[1:3]) for motion, joints in (
        (picking, placing[1].joints), (placing, picking[1].joints)))  # fmt: skip
    above, open_hand = replace(picking[0], joints=placing[0].joints), replace(picking[2], width=0.08)
    for motions, found in (
        (((tilted, *picking[1:]), placing), PICK + COMES_DOWN),
        (((), placing), f"{PICK}it has no waypoint"),
        ((picking[1:], placing), PICK + COMES_DOWN),
        ((picking, placing[1:]), STACK + COMES_DOWN),
        (((picking[0], *picking[2:]), placing), f"{PICK}at: {ON_ITS_WAY}"),
        ((picking, (*placing[:2], placing[3])), f"{STACK}retreat: {ON_ITS_WAY}"),
        ((picking[-1:], placing), f"{PICK}lift: {ON_ITS_WAY}"),
        (((*picking[:3], placing[0]), placing), f"{PICK}it does not retreat straight by 10 cm"),
        (((above, *there, picking[3]), placing), f"{PICK}at: cube_1 is not where the gripper takes it"),
        ((picking, (placing[0], *back, placing[3])), f"{STACK}at: cube_1 is not where the gripper lets it go"),
        (((*picking[:2], open_hand, picking[3]), placing), "at: the gripper does not close"),
        ((picking, (replace(placing[0], width=0.08), *placing[1:])), "approach: the gripper does not close around"),
    ):
        assert found in problems(replace(witness, motions=motions)), found


def test_no_name_of_a_waypoint_lets_an_arm_take_things_on_its_way(witness, problems):
    picking, placing = witness.motions
    hidden = tuple(replace(waypoint, name=TRANSIT) for waypoint in picking)
    for motion in (hidden, hidden[-1:], (*picking[:2], *hidden[2:3], picking[3])):
        found = problems(replace(witness, motions=(motion, placing)))
        assert f"{PICK}it ends in transit" in found or f"{PICK}transit: {ON_ITS_WAY}" in found
