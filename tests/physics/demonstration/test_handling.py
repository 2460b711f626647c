"""Objects that are moved: they stay in the hand as grasped, and nothing presses on them too hard."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from prag_asp.physics import Budget, Demonstration, Witness, check_demonstration, open_validator, validate_task
from prag_asp.physics.demonstration import planning
from prag_asp.physics.demonstration.contacts import DEEPEST, FACTOR, FIRM, IntendedContacts, Touch, excessive_contacts
from prag_asp.physics.demonstration.demonstration import pose_of
from prag_asp.physics.demonstration.handling import handling_faults
from prag_asp.physics.demonstration.performance import Performer, open_performer
from prag_asp.physics.motion.carried_motion import MOST, bearable_acceleration, peak_acceleration, time_carried
from prag_asp.physics.motion.trajectory import joint_limits, time_path
from prag_asp.physics.predicates.grip_friction import held_load, mean_radius
from prag_asp.physics.robot.kinematics import tool_pose
from prag_asp.physics.search.attempt import NO_GRASP, OVERBEARING, SLIPPED, TWISTS
from prag_asp.physics.situation import Situation
from prag_asp.physics.symbolic_facts import physical_task
from prag_asp.physics.witness import Arm
from prag_asp.physics.world.simulator import open_simulator
from prag_asp.scene.geometry import Pose, compose, invert
from prag_asp.scene.robots import PANDA
from prag_asp.scene.scene import Scene
from prag_asp.scene.scene_loader import parse_scene
from tests.chance import Chance
from tests.independent.frames import standing
from tests.independent.recordings import loosened, overloaded
from tests.independent.robots import ROBOTS, Mounted
from tests.physics.scenarios import stacking, state, task

STEP = 1 / 120
ARM = {"panda": Mounted(ROBOTS["panda"], standing(0.0, 0.0, 0.0, 0.0))}
ROD = task(
    state("on_top(rod,table)", "-holding(panda,rod)"),
    ("pick(panda,rod)", state("-on_top(rod,table)", "holding(panda,rod)")),
    ("put(panda,rod)", state("on_top(rod,table)", "-holding(panda,rod)")),
)


def scene_with(**more: object) -> Scene:
    shapes = {
        "panda": {"kind": "robot"},
        "table": {"kind": "table"},
        "rod": {"kind": "box", "size": [0.40, 0.07, 0.24]},
    }
    given = {"workspace": {"x": [0.45, 0.55], "y": [-0.1, 0.1]}, "shapes": shapes, **more}
    return parse_scene(given, {}, {name: name for name in shapes})


@pytest.fixture(scope="module")
def heavy() -> Scene:
    """A scene with a rod of 2 kg, of which a gripper bears 2.4 kg by friction."""
    return scene_with(materials={"rod": {"density": 300}})


@pytest.fixture(scope="module")
def lifted(heavy: Scene) -> Iterator[tuple[Performer, Witness]]:
    with open_validator(heavy) as validator:
        witness = validator.validate(ROD, seed=1, budget=Budget(tier="transit")).witness
    assert witness is not None
    with open_simulator(heavy) as planner, open_performer(heavy, planner) as performer:
        yield performer, witness


def test_a_rod_of_two_kilograms_does_not_slip_and_is_put_down_gently(heavy: Scene, lifted) -> None:
    performer, witness = lifted
    shown = performer.perform(physical_task(ROD, heavy), witness)
    assert shown.success, shown.detail
    assert check_demonstration(ROD, shown, heavy) == []
    assert shown.forces.max() < 20 + 3 * 2.016 * 9.81
    assert list(overloaded(shown, {"rod": 2.016})) == list(loosened(shown, ARM)) == []


def test_a_rod_that_is_lifted_as_fast_as_the_arm_can_slips_and_is_not_accepted(
    heavy: Scene, lifted, monkeypatch: pytest.MonkeyPatch
) -> None:
    performer, witness = lifted
    monkeypatch.setattr(planning, "bearable_acceleration", lambda *_: MOST)
    shown = performer.perform(physical_task(ROD, heavy), witness)
    assert shown.cause in (SLIPPED, OVERBEARING) and "rod" in shown.detail
    assert any("rod slips by" in fault for fault in check_demonstration(ROD, shown, heavy))
    assert list(overloaded(shown, {"rod": 2.016})) or list(loosened(shown, ARM))


def test_the_acceleration_that_friction_bears_is_that_of_coulomb(heavy: Scene) -> None:
    weighs, rubber = 0.40 * 0.07 * 0.24 * 300, 1.4 * 0.7
    expected = 0.95 * 2 * rubber * 12.0 / weighs - 9.81
    assert bearable_acceleration(heavy, "rod", "panda") == pytest.approx(expected)
    assert bearable_acceleration(scene_with(materials={"rod": {"density": 10}}), "rod", "panda") > MOST


def test_a_carried_motion_keeps_to_an_acceleration_of_the_tool(chance: Chance) -> None:
    limits = joint_limits(PANDA, loaded=True)
    for number in range(chance.examples(4)):
        rng = chance.generator(number)
        path = [tuple(home + rng.uniform(-0.4, 0.4) for home in PANDA.home) for _ in range(3)]
        rows = time_carried(PANDA, path, STEP, limits, 1.2)
        whole = [path[0], path[0], *map(tuple, rows.tolist()), tuple(rows[-1].tolist())]
        at = np.array([tool_pose(PANDA, row).position for row in whole])
        speeds = np.diff(at, axis=0) / STEP
        assert np.linalg.norm(np.diff(speeds, axis=0) / STEP, axis=1).max() <= 1.2 + 1e-6
        assert rows[-1] == pytest.approx(path[-1], abs=1e-9)
        plain = time_path(path, STEP, limits)
        assert (time_carried(PANDA, path, STEP, limits, MOST) == plain).all()
        assert peak_acceleration(PANDA, path[0], plain, STEP) < MOST


@pytest.fixture(scope="module")
def stacked(tabletop: Scene, tabletop_validator) -> Demonstration:
    shown = tabletop_validator.validate(stacking(), seed=1, budget=Budget(tier="demonstration")).demonstration
    assert shown is not None and check_demonstration(stacking(), shown, tabletop) == []
    return shown


@pytest.mark.parametrize(
    ("shift", "degrees", "words"),
    [(0.006, 0.0, "cube 1 slips by 6"), (0.0, 6.0, "cube 1 turns by 6"), (0.003, 3.0, "")],
)
def test_an_object_that_moves_in_the_hand_is_found(
    shift: float, degrees: float, words: str, stacked: Demonstration, tabletop: Scene
) -> None:
    cube, held = stacked.objects.index("cube_1"), stacked.ends[1] - 2
    poses = stacked.poses.copy()
    poses[held, cube, 2] += shift
    half = math.radians(degrees) / 2
    x, y, z, w = poses[held, cube, 3:].tolist()
    turned = (math.cos(half) * x + math.sin(half) * w, math.cos(half) * y - math.sin(half) * z,
              math.cos(half) * z + math.sin(half) * y, math.cos(half) * w - math.sin(half) * x)  # fmt: skip
    poses[held, cube, 3:] = turned
    faults = check_demonstration(stacking(), replace(stacked, poses=poses), tabletop)
    assert len(faults) == bool(words) and all(words in fault for fault in faults)


@pytest.mark.parametrize(
    ("degrees", "shift", "words", "found"),
    [(3.0, 0.0, "", 0), (6.0, 0.0, "turns by 6.0 degrees", 1), (0.0, 0.006, "slips by 6.0 mm", 1)],
)
def test_an_object_with_a_distant_origin_slips_only_if_it_moves_between_the_fingertips(
    degrees: float, shift: float, words: str, found: int, stacked: Demonstration, tabletop: Scene
) -> None:
    cube, held = stacked.objects.index("cube_1"), stacked.ends[1] - 2
    poses, arm = stacked.poses.copy(), {"panda": Mounted(ROBOTS["panda"], standing(0.0, 0.0, 0.0, 0.0))}
    tool = tool_pose(PANDA, tuple(stacked.joints[held, 0].tolist()))
    half = math.radians(degrees) / 2
    # The origin is 20 cm from the fingers along x of the tool, and moves by 10 mm if the cube turns by 3 degrees.
    origin = compose(invert(pose_of(poses[held, cube].tolist())), compose(tool, Pose((0.2, 0.0, 0.0))))
    for k in range(len(poses)):
        pose = compose(pose_of(poses[k, cube].tolist()), origin)
        if k == held:
            about = compose(tool, Pose((0.0, 0.0, shift), (0.0, math.sin(half), 0.0, math.cos(half))))
            pose = compose(about, compose(invert(tool), pose))
        poses[k, cube] = (*pose.position, *pose.quaternion)
    spoilt = replace(stacked, poses=poses)
    faults = [fault.text for fault in handling_faults(spoilt, tabletop)]
    assert len(faults) == found and all(words in fault for fault in faults)
    frames = [text for text in loosened(spoilt, arm) if text.startswith(f"frame {held}:")]
    assert len(frames) == found


def test_a_joint_that_accelerates_too_fast_is_found(stacked: Demonstration, tabletop: Scene) -> None:
    joints = stacked.joints.copy()
    joints[5, 0, 5] += 1.2 * 20.0 * 0.05**2 / 2
    faults = check_demonstration(stacking(), replace(stacked, joints=joints), tabletop)
    assert len(faults) == 1 and faults[0].startswith("joint 6 of panda accelerates with 1.")


def test_a_contact_that_is_asked_for_has_a_bound(stacked: Demonstration, tabletop: Scene) -> None:
    pair = {stacked.bodies.index("cube_1"), stacked.bodies.index("brick_1")}
    [row] = [i for i, (_, *both) in enumerate(stacked.contacts.tolist()) if set(both) == pair][:1]
    forces = stacked.forces.copy()
    # The cube of 5 cm weighs 50 g.
    forces[row] = FIRM + FACTOR * 0.05 * 9.81 + 0.1
    [fault] = check_demonstration(stacking(), replace(stacked, forces=forces), tabletop)
    assert "presses on" in fault and "cube_1" in fault and "brick_1" in fault
    forces[row] -= 0.2
    assert check_demonstration(stacking(), replace(stacked, forces=forces), tabletop) == []


def test_a_contact_that_is_too_deep_is_found_whatever_its_force(tabletop: Scene) -> None:
    intended = IntendedContacts({"panda": frozenset({"cube_1"})}, frozenset({("cube_1", "table")}))
    finger = Touch(3, "left finger of panda", "cube_1", 12.0)
    for depth, found in ((DEEPEST - 1e-4, 0), (DEEPEST + 1e-4, 1)):
        touches = [finger, Touch(3, "table", "cube_1", 5.0, depth), Touch(3, "table", "brick_1", 500.0, depth)]
        excessive = excessive_contacts(touches, intended, tabletop)
        assert len(excessive) == found and all("mm deep" in touch.sentence() for touch in excessive)


def test_a_grip_beside_the_middle_bears_less(chance: Chance) -> None:
    rng = chance.generator(30)
    a, b = 0.0176, 0.011
    points = [(rng.uniform(-a / 2, a / 2), rng.uniform(-b / 2, b / 2)) for _ in range(20_000)]
    assert mean_radius(a, b) == pytest.approx(sum(math.hypot(*point) for point in points) / 20_000, rel=0.01)
    scene = scene_with(materials={"rod": {"density": 200}})
    down = Pose((0.5, 0.0, 0.2), (1.0, 0.0, 0.0, 0.0))
    loads = []
    for beside in (0.0, 0.004, 0.10):
        rod = {"rod": Pose((0.5 + beside, 0.0, 0.12))}
        at = Situation(scene, rod, {"panda": Arm(PANDA.home, 0.07)}, {}, {"panda": down})
        loads.append(held_load(at, "rod", "panda"))
    force, most = 0.40 * 0.07 * 0.24 * 200 * 9.81, 2 * 1.4 * 0.7 * 12.0
    assert loads[0] == pytest.approx(force / most)
    assert loads[1] == pytest.approx(math.hypot(force, force * 0.004 / mean_radius(0.0176, 0.0176)) / most)
    assert loads[2] > 5.0


@pytest.mark.parametrize(("density", "found"), [(100, True), (2000, False)])
def test_a_bar_that_two_robots_grasp_near_its_end_is_refused_where_it_would_turn(density: int, found: bool) -> None:
    shapes = {
        "left": {"kind": "robot"},
        "right": {"kind": "robot"},
        "table": {"kind": "table"},
        "bar": {"kind": "box", "size": [0.30, 0.035, 0.035]},
    }
    table = {
        "workspace": {"x": [0.40, 0.60], "y": [0.1, 0.4]},
        "robots": {"left": {"base": [0, 0.36, 0]}, "right": {"base": [0, -0.36, 0]}},
        "shapes": shapes,
        "materials": {"bar": {"density": density}},
    }
    scene = parse_scene(table, {}, {name: name for name in shapes})
    request = task(state("on_top(bar,table)"), ("pick(left,bar)", state("-on_top(bar,table)", "holding(left,bar)")))
    verdict = validate_task(request, scene, seed=1, budget=Budget(3, 6))
    assert verdict.feasible is found
    if not found:
        assert verdict.reason == TWISTS and {detail.entities for detail in verdict.details if detail.cause != NO_GRASP}
