from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from dataclasses import replace

import numpy as np
import pybullet
import pytest

from prag_asp.physics import physical_task
from prag_asp.physics.control.control import FINGERS, STRIDE, Control
from prag_asp.physics.control.names import CONTROLS, USUAL_RATE, ControlName
from prag_asp.physics.situation import Situation
from prag_asp.physics.witness import Witness
from prag_asp.physics.world.bodies import mass_frame
from prag_asp.physics.world.dynamics import ArmCommand, Dynamics, open_dynamics
from prag_asp.rl.arena import Arena
from prag_asp.scene.geometry import compose, rotate
from prag_asp.scene.robots import robot_of
from prag_asp.scene.scene import Scene
from tests.chance import Chance
from tests.rl.conftest import DOMAINS, Given

SECOND = USUAL_RATE

UPRIGHT: ControlName = "ee_delta_upright"


@pytest.mark.parametrize("name", DOMAINS)
def test_every_state_of_a_witness_stands_for_a_second_with_its_facts(
    name: str, scenes: Mapping[str, Scene], given: Mapping[str, list[Given]]
) -> None:
    scene = scenes[name]
    with ExitStack() as resources:
        arena = Arena(scene, Control.of(UPRIGHT, scene), resources)
        for task, witness in given[name]:
            for number, facts in enumerate(physical_task(task, scene).states):
                situation = arena.start(witness, number)
                assert all(fact.is_satisfied(situation) for fact in facts)
                for _ in range(SECOND):
                    situation = arena.act(np.zeros(5 * len(scene.robots)))
                assert all(fact.is_satisfied(situation) for fact in facts), (str(task), number)


@pytest.mark.parametrize("name", DOMAINS)
@pytest.mark.parametrize("control", CONTROLS)
def test_what_follows_a_start_is_the_same_after_any_history(
    name: str, control: ControlName, chance: Chance, scenes: Mapping[str, Scene], given: Mapping[str, list[Given]]
) -> None:
    rng, scene = chance.generator(4), scenes[name]
    starts = [(witness, number) for _, witness in given[name] for number in range(5)]
    convention = Control.of(control, scene)
    low, high = convention.low, convention.high

    def followed(arena: Arena, index: int) -> Situation:
        actions = np.random.default_rng(index).uniform(low, high, (10, len(low)))
        situation = arena.start(*starts[index])
        for action in actions:
            situation = arena.act(action)
        return situation

    with ExitStack() as resources:
        arena = Arena(scene, convention, resources)
        for index in rng.sample(range(len(starts)), 4):
            with ExitStack() as own:
                fresh = followed(Arena(scene, convention, own), index)
            found = followed(arena, index)
            assert (found.poses, found.arms, found.openings) == (fresh.poses, fresh.arms, fresh.openings)
            for _ in range(rng.randrange(20)):
                arena.act(np.array([*map(rng.uniform, low, high)]))


def test_witnesses_of_the_same_objects_share_a_world_in_whatever_order_they_have_them(
    scenes: Mapping[str, Scene], given: Mapping[str, list[Given]], monkeypatch: pytest.MonkeyPatch
) -> None:
    built: list[Sequence[str]] = []
    begin = Dynamics.begin
    monkeypatch.setattr(Dynamics, "begin", lambda own, each, *more: built.append(each) or begin(own, each, *more))
    _, witness = given["tabletop"][0]
    poses = [dict(reversed(moment.poses.items())) for moment in witness.moments]
    turned = replace(witness, moments=tuple(map(lambda each, own: replace(each, poses=own), witness.moments, poses)))
    with ExitStack() as resources:
        arena = Arena(scenes["tabletop"], Control.of(UPRIGHT, scenes["tabletop"]), resources)
        one, two = arena.start(witness, 1), arena.start(turned, 1)
        assert one.poses == two.poses and len(built) == 1
        one, two = (moved(arena, each) for each in (turned, witness))
    assert one == two and len(built) == 1


def moved(arena: Arena, witness: Witness) -> object:
    arena.start(witness, 1)
    situation = arena.act(np.array([0.3, 0.2, -0.5, 0.1, 0.0]))
    return situation.poses, situation.arms


@pytest.mark.parametrize("name", ["tabletop", "two_arms"])
def test_an_action_moves_the_tool_as_it_says_and_keeps_it_upright(
    name: str, scenes: Mapping[str, Scene], given: Mapping[str, list[Given]]
) -> None:
    robots = list(scenes[name].robots)
    with ExitStack() as resources:
        arena = Arena(scenes[name], Control.of(UPRIGHT, scenes[name]), resources)
        for i, robot in enumerate(robots):
            begun = arena.start(given[name][0][1], 0).tool(robot)
            action = np.zeros((len(robots), 5))
            for move in ((0.0, 0.0, 0.6), (0.5, 0.0, 0.0), (0.0, -0.5, 0.0)):
                action[i, :3] = move
                for _ in range(3):
                    situation = arena.act(action.ravel())
            x, y, z = (b - a for a, b in zip(begun.position, situation.tool(robot).position, strict=True))
            assert (x, y, z) == pytest.approx(
                [1.5 * STRIDE / SECOND, -1.5 * STRIDE / SECOND, 1.8 * STRIDE / SECOND], abs=0.012
            )
            assert rotate(situation.tool(robot).quaternion, (0.0, 0.0, 1.0))[2] < -0.999


def test_fingers_open_by_so_much_and_joints_move_no_faster_than_they_may(
    scenes: Mapping[str, Scene], given: Mapping[str, list[Given]]
) -> None:
    scene = scenes["tabletop"]
    robot = robot_of(scene, "panda")
    with ExitStack() as resources:
        arena = Arena(scene, Control.of("joint_delta", scene), resources)
        situation = arena.start(given["tabletop"][0][1], 0)
        width = arena.commanded_openings["panda"]
        arena.act(np.array([0.0] * 7 + [-1.0]))
        assert arena.commanded_openings["panda"] == pytest.approx(width - FINGERS / SECOND)
        for sign in (1.0, -1.0):
            for _ in range(15):
                last, situation = situation, arena.act(np.array([sign] * 8))
                steps = np.subtract(situation.arm("panda").joints, last.arm("panda").joints)
                assert (np.abs(steps) <= np.array(robot.speeds) / SECOND + 0.02).all()
                assert robot.within_limits(situation.arm("panda").joints, tolerance=0.03)


def test_an_arm_that_is_blocked_by_the_table_is_free_at_once(
    scenes: Mapping[str, Scene], given: Mapping[str, list[Given]]
) -> None:
    down, up = np.array([0.0, 0.0, -1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0, 0.0, 0.0])
    with ExitStack() as resources:
        arena = Arena(scenes["tabletop"], Control.of(UPRIGHT, scenes["tabletop"]), resources)
        arena.start(given["tabletop"][0][1], 0)
        for _ in range(60):
            low = arena.act(down).tool("panda").position[2]
        high = arena.act(up).tool("panda").position[2]
    assert low > 0.005 and high - low > STRIDE / SECOND / 3


@pytest.mark.parametrize("name", DOMAINS)
def test_motor_targets_in_a_row_move_the_world_as_single_commands_do_and_all_poses_are_read(
    name: str, chance: Chance, scenes: Mapping[str, Scene], given: Mapping[str, list[Given]]
) -> None:
    _, witness = given[name][0]
    moment, scene = witness.moments[0], scenes[name].with_sizes(witness.sizes)
    rng = np.random.default_rng(chance.seed(0))
    speeds = {robot: rng.uniform(-1.0, 1.0, 7).tolist() for robot in moment.arms}
    commands = {
        robot: [ArmCommand(tuple(rng.normal(arm.joints, 0.05).tolist()), rng.uniform(0.0, 0.08)) for _ in range(40)]
        for robot, arm in moment.arms.items()
    }
    with open_dynamics(scene) as one, open_dynamics(scene) as two:
        for world in one, two:
            world.begin(tuple(moment.poses), moment, scene)
            world.restore(moment)
        one.run({robot: [each.motor_targets for each in row] for robot, row in commands.items()}, speeds)
        for number in range(40):
            for robot, row in commands.items():
                two.drive(robot, row[number], speeds[robot])
            two.step()
        assert (one.arms(), one.poses(), one.openings()) == (two.arms(), two.poses(), two.openings())
        assert one.arms() != dict(moment.arms)
        bodies = range(pybullet.getNumBodies(physicsClientId=one.client))
        places = [pybullet.getBasePositionAndOrientation(body, physicsClientId=one.client)[0] for body in bodies]
        for entity, pose in one.poses().items():
            frame = mass_frame(scene, entity)
            at = pose.position if frame is None else compose(pose, frame).position
            assert min(np.abs(np.subtract(places, at)).max(axis=1)) < 1e-12, entity
