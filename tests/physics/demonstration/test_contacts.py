"""Contacts for which a task does not ask: an arm that presses where it should not, in a scene made by hand."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import replace

import pytest

from prag_asp.physics import check_demonstration
from prag_asp.physics.demonstration.contacts import IntendedContacts, Touch, intended_contacts, unintended_contacts
from prag_asp.physics.demonstration.performance import Performer, open_performer
from prag_asp.physics.robot.kinematics import inverse
from prag_asp.physics.search.attempt import PRESSED
from prag_asp.physics.situation import Situation, fixed_pose
from prag_asp.physics.symbolic_facts import physical_task
from prag_asp.physics.witness import TRANSIT, Arm, Moment, Waypoint, Witness
from prag_asp.physics.world import dynamics
from prag_asp.physics.world.simulator import Simulator, open_simulator
from prag_asp.scene.geometry import Pose
from prag_asp.scene.robots import PANDA, Joints, robot_of
from prag_asp.scene.scene import Scene
from prag_asp.scene.scene_loader import parse_scene
from prag_asp.task import Task
from tests.independent.recordings import unwanted
from tests.physics.scenarios import stacking, state, task

DOWN = (1.0, 0.0, 0.0, 0.0)
WIDTH, DEEP, STEP = 0.02, 0.004, 0.002
BODIES = {
    "left": {"kind": "robot"},
    "right": {"kind": "robot"},
    "table": {"kind": "table"},
    "plank": {"kind": "box", "size": [0.22, 0.05, 0.025]},
    "drawer": {"kind": "drawer", "size": [0.26, 0.24, 0.10], "wall": 0.008},
}


@pytest.fixture(scope="module")
def scene() -> Scene:
    table = {
        "workspace": {"x": [0.30, 0.70], "y": [-0.62, 0.62]},
        "robots": {"left": {"base": [0, 0.36, 0]}, "right": {"base": [0, -0.36, 0]}},
        "shapes": BODIES,
        "fixed": {"drawer": [0.60, 0.45, 0]},
    }
    return parse_scene(table, {}, {entity: entity for entity in BODIES})


@pytest.fixture(scope="module")
def planner(scene: Scene) -> Iterator[Simulator]:
    with open_simulator(scene) as simulator:
        yield simulator


@pytest.fixture(scope="module")
def performer(scene: Scene, planner: Simulator) -> Iterator[Performer]:
    with open_performer(scene, planner) as opened:
        yield opened


@pytest.fixture(scope="module")
def waiting() -> Task:
    """Do nothing; the plank lies where it is, the drawer stays closed."""
    return task(state("on_top(plank,table)", "is_closed(drawer)"), ("wait", state()))


@pytest.fixture(scope="module")
def start(scene: Scene) -> Moment:
    away = _reach(scene, "right", (0.45, -0.15, 0.30))
    arms = {"left": Arm(PANDA.home, WIDTH), "right": Arm(away, WIDTH)}
    return Moment({"plank": Pose((0.42, 0.16, 0.0125)), "drawer": fixed_pose(scene, "drawer")}, arms, {"drawer": 0.0})


def _reach(scene: Scene, robot: str, at: tuple[float, float, float], near: Joints | None = None) -> Joints:
    return next(inverse(robot_of(scene, robot), Pose(at, DOWN), near))


def _towards(
    planner: Simulator, start: Moment, body: int, begin: tuple[float, float, float], way: tuple[float, float, float]
) -> list[Joints]:
    """Return joint angles of the left arm from where it begins, along a direction, until it is deep in a body."""
    planner.show(start)
    found: list[Joints] = []
    for n in range(200):
        x, y, z = (a + n * STEP * b for a, b in zip(begin, way, strict=True))
        found.append(_reach(planner.scene, "left", (x, y, z), found[-1] if found else None))
        planner.arms["left"].pose(found[-1], WIDTH)
        gaps = [gap for _, gap in planner.arms["left"].contacts(body, PANDA.links[1:])]
        if min(gaps, default=0.0) < -DEEP:
            return found
    raise AssertionError("the arm meets nothing")


def _there_and_back(start: Moment, path: list[Joints]) -> Witness:
    """Return a witness of one action in which the left arm goes along a path and home again."""
    ways = [(path[:-1], path[-1]), (path[-2::-1], PANDA.home)]
    motion = [
        Waypoint(name, "left", joints, WIDTH)
        for way, end in ways
        for name, joints in [*((TRANSIT, each) for each in way), ("move", end)]
    ]
    return Witness((start, start), (tuple(motion),))


PRESSING = {
    "right": ((0.45, 0.25, 0.30), (0.0, -1.0, 0.0)),
    "plank": ((0.42, 0.16, 0.12), (0.0, 0.0, -1.0)),
    "drawer": ((0.60, 0.45, 0.20), (0.0, 0.0, -1.0)),
}
"""From where the left arm goes in which direction until it presses on something."""


@pytest.mark.parametrize("other", PRESSING)
def test_an_arm_that_presses_on_another_on_a_plank_or_on_a_drawer_fails_with_their_names(
    scene, planner, performer, waiting, start, other
):
    body = planner.arms[other].body if other in planner.arms else planner.body(other)
    path = _towards(planner, start, body, *PRESSING[other])
    shown = performer.perform(physical_task(waiting, scene), _there_and_back(start, path))
    assert shown.cause == PRESSED and len(shown.ends) == 2
    part = "the (arm|left finger|right finger) of"
    named = f"{part} {other}" if other in planner.arms else other
    assert re.fullmatch(rf"during wait {part} left presses on {named} with \d+\.\d N", shown.detail), shown.detail
    # All that is known of the states holds: nothing but the contact is wrong.
    assert not any("does not hold" in fault for fault in check_demonstration(waiting, shown, scene))
    assert check_demonstration(waiting, shown, scene)[0].startswith("action 1, wait: ")
    assert list(unwanted(shown, ["wait"], ["is_closed(drawer)", "on_top(plank,table)"], {}))


def test_an_arm_that_stops_short_of_a_body_does_not_press_on_it(scene, planner, performer, waiting, start):
    path = _towards(planner, start, planner.body("plank"), *PRESSING["plank"])
    shown = performer.perform(physical_task(waiting, scene), _there_and_back(start, path[: -round(0.012 / STEP)]))
    assert shown.success, shown.detail
    assert check_demonstration(waiting, shown, scene) == []
    assert list(unwanted(shown, ["wait"], ["is_closed(drawer)", "on_top(plank,table)"], {})) == []


def test_an_arm_that_presses_on_itself_is_reported(scene, start):
    folded = (0.0, 1.2, 0.0, -3.0, 0.0, 3.0, 0.0)
    with dynamics.open_dynamics(scene) as world:
        world.begin((), replace(start, poses={}, openings={}, arms={**start.arms, "left": Arm(folded, WIDTH)}))
        world.drive("left", dynamics.ArmCommand(folded, WIDTH))
        for _ in range(5):
            world.step()
        pressing = {(world.parts[a], world.parts[b]) for (a, b), (force, _) in world.contacts().items() if force > 1}
    assert ("arm of left", "arm of left") in pressing
    touch = Touch(3, "arm of left", "arm of left", 4.0)
    assert unintended_contacts([touch], IntendedContacts({"left": frozenset()}, frozenset())) == [touch]


def _unintended_pairs(touches: Iterable[tuple[str, str]], wanted: IntendedContacts) -> set[tuple[str, str]]:
    """Return the unintended ones among contacts of 5 N in one frame."""
    return {(touch.one, touch.two) for touch in unintended_contacts([Touch(0, *pair, 5.0) for pair in touches], wanted)}


def test_the_definition_pair_by_pair():
    finger, arm = "left finger of panda", "arm of panda"
    resting = frozenset({("cube", "brick"), ("brick", "table"), ("lid", "cube"), ("cup", "drawer"), ("can", "drawer")})
    wanted = IntendedContacts({"panda": frozenset({"cube"}), "other": frozenset()}, resting)
    held = (finger, "cube")
    # What the gripper holds, what that rests on, and what rests on it.
    assert _unintended_pairs([held, ("brick", "cube"), ("cube", "lid"), ("table", "brick")], wanted) == set()
    # What it holds against anything else, and what rides on that.
    against = {("cube", "wall"), ("lid", "wall"), ("table", "cube")}
    assert _unintended_pairs([held, *against], wanted) == against
    # What no robot moves, whichever way it leans.
    assert _unintended_pairs([("brick", "wall"), ("cup", "can")], wanted) == set()
    # Any part of a robot but a finger at what it handles.
    for pair in (
        (arm, "cube"),
        (arm, "table"),
        (arm, "arm of other"),
        (finger, "left finger of other"),
        (finger, "table"),
        (finger, "brick"),
        ("right finger of other", "cube"),
    ):
        assert pair in _unintended_pairs([held, pair], wanted), pair
    # Furniture that is pulled, with what lies in it.
    pulled = IntendedContacts({"panda": frozenset({"drawer"})}, resting)
    handle = (finger, "drawer")
    assert _unintended_pairs([handle, ("drawer", "cup"), ("cup", "can")], pulled) == set()
    against = {("drawer", "wall"), ("cup", "wall"), (arm, "drawer")}
    assert _unintended_pairs([handle, *against], pulled) == against


def test_gentle_contacts_pass_and_of_two_bodies_the_strongest_contact_is_reported():
    wanted = IntendedContacts({"panda": frozenset()}, frozenset())
    touches = [Touch(k, "arm of panda", "can_1", force) for k, force in enumerate((0.9, 1.0, 3.0, 7.0, 2.0))]
    assert unintended_contacts(touches[:2], wanted) == []
    assert [touch.sentence() for touch in unintended_contacts(touches, wanted)] == [
        "the arm of panda presses on can_1 with 7.0 N"
    ]


def test_the_intended_contacts_of_an_action_follow_from_the_task(tabletop, tabletop_validator):
    physical = physical_task(stacking(), tabletop)
    moments = tabletop_validator.validate(stacking(), seed=1).witness.moments
    seen = [Situation(tabletop, moment.poses, moment.arms, moment.openings) for moment in moments]
    assert intended_contacts(physical, 0, seen[0]).handled == {"panda": frozenset()}
    for k in (1, 2):
        assert intended_contacts(physical, k, *seen[k - 1 : k + 1]).handled == {"panda": frozenset({"cube_1"})}
    pick, stack = (intended_contacts(physical, k, *seen[k - 1 : k + 1]).resting for k in (1, 2))
    assert ("cube_1", "table") in pick and ("cube_1", "brick_1") not in pick
    assert ("cube_1", "brick_1") in stack and ("cube_1", "table") not in stack
