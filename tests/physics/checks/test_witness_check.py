from __future__ import annotations

import math
import re
from dataclasses import replace

import pytest

from prag_asp.physics import Moment, Witness, check_witness
from prag_asp.physics.robot.kinematics import tool_pose
from prag_asp.physics.witness import TRANSIT, Arm
from prag_asp.scene.geometry import Pose, compose, invert, multiply, yaw_quaternion
from prag_asp.scene.robots import PANDA
from prag_asp.scene.scene import Shape
from tests.physics.scenarios import stacking, with_arm

LEAN = (math.sin(0.01), 0.0, 0.0, math.cos(0.01))


@pytest.fixture(scope="module")
def witness(tabletop_validator) -> Witness:
    return tabletop_validator.validate(stacking(), seed=1).witness


def _with_moment(witness: Witness, k: int, **changes: object) -> Witness:
    """Return a witness with a moment changed: its poses, or fields of its arm."""
    moments = list(witness.moments)
    arm = {name: change for name, change in changes.items() if name in Arm.__dataclass_fields__}
    rest = {name: change for name, change in changes.items() if name not in Arm.__dataclass_fields__}
    moments[k] = replace(with_arm(moments[k], **arm), **rest)
    return replace(witness, moments=tuple(moments))


def _moved(moment: Moment, entity: str, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> dict[str, Pose]:
    (a, b, c), turn = moment.poses[entity]
    return {**moment.poses, entity: Pose((a + x, b + y, c + z), turn)}


def _problems(witness: Witness, tabletop) -> str:
    return "\n".join(check_witness(stacking(), witness, tabletop))


def test_an_honest_witness_passes(witness, tabletop):
    assert check_witness(stacking(), witness, tabletop) == []


def test_a_floating_body_is_caught(witness, tabletop):
    bad = _with_moment(witness, 0, poses=_moved(witness.moments[0], "brick_1", z=0.01))
    assert "state 0: brick_1 would fall" in _problems(bad, tabletop)


def test_bodies_within_each_other_are_caught(witness, tabletop):
    bad = _with_moment(witness, 2, poses=_moved(witness.moments[2], "cube_1", z=-0.004))
    assert "collides with" in _problems(bad, tabletop)


def test_a_fact_that_does_not_hold_is_caught(witness, tabletop):
    bad = _with_moment(witness, 2, poses=_moved(witness.moments[2], "cube_1", z=0.004))
    assert "state 2: it does not hold that cube 1 is on brick 1" in _problems(bad, tabletop)


def test_a_false_fluent_that_holds_is_caught(witness, tabletop):
    bad = replace(witness, moments=(witness.moments[0], witness.moments[0], witness.moments[2]))
    assert "cube 1 is not on table 1" in _problems(bad, tabletop)


def test_a_held_object_out_of_the_hand_is_caught(witness, tabletop):
    bad = _with_moment(witness, 1, poses=_moved(witness.moments[1], "cube_1", x=0.003))
    assert "state 1: cube_1 is not where the gripper holds it" in _problems(bad, tabletop)


def test_an_object_that_leans_in_the_gripper_is_caught(witness, tabletop):
    moment = witness.moments[1]
    arm = moment.arms["panda"]
    grasp = Pose(arm.grasp.position, multiply(arm.grasp.quaternion, LEAN))
    pose = compose(tool_pose(PANDA, arm.joints), grasp)
    bad = _with_moment(witness, 1, grasp=grasp, poses={**moment.poses, "cube_1": pose})
    found = _problems(bad, tabletop)
    assert "state 1: cube_1 does not stand upright in the gripper" in found
    assert "not held from above" not in found and "not where the gripper holds it" not in found


def test_a_grip_that_is_not_from_above_is_caught(witness, tabletop):
    moment = witness.moments[1]
    arm = moment.arms["panda"]
    joints = (*arm.joints[:5], arm.joints[5] + 0.05, arm.joints[6])
    upright = moment.poses["cube_1"].quaternion
    pose = compose(tool_pose(PANDA, joints), arm.grasp)._replace(quaternion=upright)
    grasp = compose(invert(tool_pose(PANDA, joints)), pose)
    bad = _with_moment(witness, 1, joints=joints, grasp=grasp, poses={**moment.poses, "cube_1": pose})
    found = _problems(bad, tabletop)
    assert "state 1: cube_1 is not held from above" in found
    assert "stand upright" not in found and "not where the gripper holds it" not in found


def test_a_held_object_wider_than_the_gripper_opens_is_caught_whichever_way_it_is_held(witness, tabletop):
    wide = replace(tabletop, shapes={**tabletop.shapes, "cube_1": Shape("box", (0.081, 0.081, 0.05))})
    assert "state 1: cube_1 is wider than the gripper opens" in _problems(witness, wide)


def test_a_body_that_nothing_moved_but_moves_is_caught(witness, tabletop):
    bad = _with_moment(witness, 1, poses=_moved(witness.moments[1], "brick_1", x=0.002))
    assert "action 1, pick(panda,cube_1,table_1): brick_1 has moved" in _problems(bad, tabletop)


def test_a_fixed_body_that_stands_elsewhere_in_all_states_is_caught(witness, tabletop):
    moments = tuple(replace(moment, poses=_moved(moment, "bin_1", y=-0.3)) for moment in witness.moments)
    assert "bin_1 is not where the scene has it" in _problems(replace(witness, moments=moments), tabletop)


def test_other_joint_angles_are_caught(witness, tabletop):
    joints = witness.moments[1].arms["panda"].joints
    bad = _with_moment(witness, 1, joints=(joints[0] + 0.01, *joints[1:]))
    assert "cube_1 is not where the gripper holds it" in _problems(bad, tabletop)
    assert "its last waypoint is not the arm of the next state" in _problems(bad, tabletop)


def test_joint_angles_beyond_the_limits_are_caught(witness, tabletop):
    joints = witness.moments[0].arms["panda"].joints
    bad = _with_moment(witness, 0, joints=(*joints[:5], 3.8, joints[6]))
    assert "state 0: the joint angles" in _problems(bad, tabletop)


@pytest.mark.parametrize("joints", [(), (0.0,) * 6, (math.nan,) * 7, (math.inf,) * 7])
def test_joint_angles_that_are_no_configuration_are_caught(witness, tabletop, joints):
    assert "seven finite joint angles" in _problems(_with_moment(witness, 1, joints=joints), tabletop)


def test_a_gripper_that_opens_too_far_is_caught(witness, tabletop):
    assert "the gripper cannot open 0.2000 m" in _problems(_with_moment(witness, 0, width=0.2), tabletop)


def test_a_pose_that_is_not_a_number_is_caught(witness, tabletop):
    bad = _with_moment(witness, 0, poses=_moved(witness.moments[0], "cube_1", x=math.nan))
    assert "the pose of cube_1 is not a finite position and rotation" in _problems(bad, tabletop)


def test_a_missing_body_and_an_unknown_one_are_caught(witness, tabletop):
    poses = dict(witness.moments[0].poses)
    poses["ghost"] = poses.pop("brick_1")
    found = _problems(_with_moment(witness, 0, poses=poses), tabletop)
    assert "brick_1 has no pose" in found and "ghost is not in the scene" in found


def test_a_missing_state_is_caught(witness, tabletop):
    assert "the witness has 2 states, the task 2 actions" in _problems(
        replace(witness, moments=witness.moments[:2]), tabletop
    )


def test_an_arm_through_a_body_is_caught(witness, tabletop):
    low = witness.motions[0][1].joints
    moment = witness.moments[0]
    turned = Pose(
        moment.poses["cube_1"].position,
        multiply(yaw_quaternion(math.pi / 4), moment.poses["cube_1"].quaternion),
    )
    bad = _with_moment(witness, 0, joints=low, width=0.03, poses={**moment.poses, "brick_1": turned})
    assert "collides" in _problems(bad, tabletop)


def test_an_approach_that_is_not_straight_above_is_caught(witness, tabletop):
    first = witness.motions[0]
    tilted = replace(first[0], joints=(first[0].joints[0] + 0.05, *first[0].joints[1:]))
    bad = replace(witness, motions=((tilted, *first[1:]), witness.motions[1]))
    assert "it does not come down by 10 cm straight onto the object" in _problems(bad, tabletop)


def test_a_motion_without_waypoints_is_caught(witness, tabletop):
    assert "it has no waypoint" in _problems(replace(witness, motions=((), witness.motions[1])), tabletop)


def test_an_arm_that_does_not_come_from_above_or_leave_upwards_is_caught(witness, tabletop):
    picking, placing = witness.motions
    assert [waypoint.name for waypoint in picking] == ["approach", "at", "at", "lift"]
    assert [waypoint.name for waypoint in placing] == ["approach", "at", "at", "retreat"]
    for motions, found in (
        ((picking[1:], placing), "action 1, .*: it does not come down by 10 cm straight onto the object"),
        ((picking, placing[1:]), "action 2, .*: it does not come down by 10 cm straight onto the object"),
        (((picking[0], *picking[2:]), placing), "action 1, .*: it takes or lets go of cube_1 on its way"),
        ((picking, (*placing[:2], placing[3])), "action 2, .*: it takes or lets go of cube_1 on its way"),
        ((picking[-1:], placing), "action 1, .*: it takes or lets go of cube_1 on its way"),
        (((*picking[:3], placing[0]), placing), "action 1, .*: it does not leave by 10 cm straight up"),
    ):
        assert re.search(found, _problems(replace(witness, motions=motions), tabletop)), found


def test_no_name_of_a_waypoint_lets_an_arm_take_things_on_its_way(witness, tabletop):
    picking, placing = witness.motions
    hidden = tuple(replace(waypoint, name=TRANSIT) for waypoint in picking)
    for motion in (hidden, hidden[-1:], (*picking[:2], *hidden[2:3], picking[3])):
        bad = _problems(replace(witness, motions=(motion, placing)), tabletop)
        assert re.search("action 1, .*: (it ends on its way|transit: it takes or lets go of cube_1 on its way)", bad)


def test_taking_and_letting_go_elsewhere_or_with_open_fingers_is_caught(witness, tabletop):
    picking, placing = witness.motions
    away = [replace(picking[1], joints=placing[1].joints), replace(picking[2], joints=placing[1].joints)]
    above = replace(picking[0], joints=placing[0].joints)
    back = [replace(placing[1], joints=picking[1].joints), replace(placing[2], joints=picking[1].joints)]
    for motions, found in (
        (((above, *away, picking[3]), placing), "action 1, .*: at: cube_1 is not where the gripper takes it"),
        ((picking, (placing[0], *back, placing[3])), "action 2, .*: at: cube_1 is not where the gripper lets it go"),
        (((*picking[:2], replace(picking[2], width=0.08), picking[3]), placing), "at: the gripper does not close"),
        ((picking, (replace(placing[0], width=0.08), *placing[1:])), "approach: the gripper does not close around"),
    ):
        assert re.search(found, _problems(replace(witness, motions=motions), tabletop)), found
