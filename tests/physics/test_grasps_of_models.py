"""Bodies with a model are grasped by their geometry: scenes whose truth is known by construction."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import trimesh

from prag_asp.dataset.jsonl import Record, write_line
from prag_asp.physics import Budget, check_demonstration, check_witness, open_validator, validate_task
from prag_asp.physics.demonstration.acting import SQUEEZE
from prag_asp.physics.grasps.body_grasps import body_grasps, is_hand_free
from prag_asp.physics.grasps.pads import ParallelGripper
from prag_asp.physics.grasps.tilting import grip_tilting
from prag_asp.physics.predicates import PREDICATES
from prag_asp.physics.predicates.grip_friction import finger_force, grip_load, held_load, pad_friction
from prag_asp.physics.predicates.grip_geometry import pad_reach
from prag_asp.physics.proofs.prover import Prover
from prag_asp.physics.robot.kinematics import tool_pose
from prag_asp.physics.search.attempt import NO_GRASP, TWISTS
from prag_asp.physics.situation import Situation
from prag_asp.physics.symbolic_facts import Fact
from prag_asp.physics.verdict import Tier, Verdict
from prag_asp.physics.witness import Arm, Witness
from prag_asp.physics.world.dynamics import ArmCommand, open_dynamics
from prag_asp.scene.geometry import Pose, compose, invert, yaw_of, yaw_quaternion
from prag_asp.scene.read.body import body_shape, solid_mass
from prag_asp.scene.robots.panda import PANDA
from prag_asp.scene.scene import BodyModel, Material, Scene, Shape, Solid
from tests.chance import Chance
from tests.independent.check import problems
from tests.independent.frames import Frame, frame
from tests.independent.grips import grip_faults, points_on
from tests.independent.world import world_of
from tests.physics.grasps.test_grasps_at_edges import prism
from tests.physics.scenarios import state, task

PICK = ("pick(panda,thing_1)", state("holding(panda,thing_1)", "-on_top(thing_1,table_1)"))
LIFTED = task(state("on_top(thing_1,table_1)", "-holding(panda,thing_1)"), PICK)
MOVED = task(
    state("on_top(thing_1,table_1)", "-holding(panda,thing_1)"),
    PICK,
    ("put(panda,thing_1)", state("-holding(panda,thing_1)", "on_top(thing_1,shelf_1)")),
)


def model(size: tuple[float, float, float], mass: float, *solids: Solid) -> Shape:
    """Return a body with a model of boxes, whose bounding box has a size."""
    x, y = size[0] / 2, size[1] / 2
    outline = ((-x, -y), (x, -y), (x, y), (-x, y))
    moment = mass * max(size) ** 2 / 10
    return Shape("urdf", size, model=BodyModel(solids, mass, moments=(moment,) * 3, base=outline, crown=outline))


def walls(side: float, wall: float, height: float) -> tuple[Solid, ...]:
    """Return the floor and four walls of a square basin."""
    out = (side - wall) / 2
    return (
        Solid("box", (side, side, wall), (0.0, 0.0, (wall - height) / 2)),
        *(Solid("box", (wall, side, height), (sign * out, 0.0, 0.0)) for sign in (1.0, -1.0)),
        *(Solid("box", (side, wall, height), (0.0, sign * out, 0.0)) for sign in (1.0, -1.0)),
    )


TURNED = (0.14 / math.sqrt(2),) * 2
BASIN = "a basin at its rim"
HELD = {
    "a box turned in its own frame": model(
        (*TURNED, 0.05), 0.1, Solid("box", (0.04, 0.1, 0.05), turn=(0.0, 0.0, math.pi / 4))
    ),
    BASIN: model((0.15, 0.15, 0.05), 0.15, *walls(0.15, 0.005, 0.05)),
    "a bar with a broad head": model(
        (0.12, 0.2, 0.03),
        0.2,
        Solid("box", (0.02, 0.17, 0.03), (0.0, -0.015, 0.0)),
        Solid("box", (0.12, 0.03, 0.03), (0.0, 0.085, 0.0)),
    ),
    "a cube with a knob": model(
        (0.1, 0.1, 0.13),
        0.3,
        Solid("box", (0.1, 0.1, 0.1), (0.0, 0.0, -0.015)),
        Solid("box", (0.03, 0.03, 0.03), (0.0, 0.0, 0.05)),
    ),
}


def scene(thing: Shape) -> Scene:
    """Return a scene of a table, a thing and a shelf."""
    shapes = {"panda": Shape("robot"), "table_1": Shape("table"), "shelf_1": Shape("box", (0.3, 0.3, 0.05))}
    return Scene({**shapes, "thing_1": thing}, fixed={"shelf_1": (0.5, 0.35, 0.0)}, workspace=(0.35, 0.65, -0.3, 0.1))


@pytest.fixture(scope="module")
def verdicts() -> dict[str, Verdict]:
    """Return a verdict on moving each body that can be held, of the basin by demonstration."""
    found = {}
    for name, thing in HELD.items():
        tier = Tier.DEMONSTRATION if name == BASIN else Tier.KINEMATICS
        with open_validator(scene(thing)) as validator:
            found[name] = validator.validate(MOVED, seed=1, budget=Budget(4, 8, tier))
    return found


def held_at(thing: Shape, witness: Witness) -> tuple[tuple[np.ndarray, np.ndarray], Frame, float]:
    """Return points and normals of the body's surface, the tool and the opening in the state in which it is held."""
    moment = witness.moments[1]
    arm, pose = moment.arms["panda"], moment.poses["thing_1"]
    assert thing.model is not None
    boxes = []
    for solid in thing.model.solids:
        c, s = math.cos(solid.turn[2]), math.sin(solid.turn[2])
        own = Frame(turn=np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]), at=np.array(solid.at))
        boxes.append((np.array(solid.size) / 2, frame(pose) @ own))
    return points_on(boxes), frame(tool_pose(PANDA, arm.joints)), arm.width


@pytest.mark.parametrize("name", HELD)
def test_what_is_narrow_somewhere_is_held_there_and_put_down(name: str, verdicts: dict[str, Verdict]) -> None:
    verdict, made = verdicts[name], scene(HELD[name])
    assert verdict.status == "feasible", verdict.reason
    assert verdict.witness is not None
    assert check_witness(MOVED, verdict.witness, made) == []
    if name == BASIN:
        assert verdict.demonstration is not None
        assert check_demonstration(MOVED, verdict.demonstration, made) == []
    surface, tool, width = held_at(HELD[name], verdict.witness)
    assert list(grip_faults(*surface, tool, width)) == []


@pytest.mark.parametrize("name", HELD)
@pytest.mark.parametrize(
    ("moved", "wider"),
    [((0.0, 0.006, 0.0), 0.0), ((0.0, 0.0, 0.0), 0.006), ((0.0, 0.0, -0.07), 0.0)],
    ids=["shifted", "too wide", "in the air"],
)
def test_a_grip_that_touches_one_side_or_none_is_found_by_both_checks(
    name: str, moved: tuple[float, float, float], wider: float, verdicts: dict[str, Verdict]
) -> None:
    witness = verdicts[name].witness
    assert witness is not None
    moment = witness.moments[1]
    arm = moment.arms["panda"]
    tool = compose(tool_pose(PANDA, arm.joints), Pose(moved))
    situation = Situation(
        scene(HELD[name]), moment.poses, {"panda": replace(arm, width=arm.width + wider)}, tools={"panda": tool}
    )
    assert not PREDICATES["holding"].holds(situation, ("panda", "thing_1"))
    surface, _, width = held_at(HELD[name], witness)
    assert list(grip_faults(*surface, frame(tool), width + wider))


def test_a_ball_wider_than_the_opening_has_no_grasp_and_no_false_proof() -> None:
    ball = model((0.1, 0.1, 0.1), 0.1, Solid("sphere", (0.1, 0.1, 0.1)))
    verdict = validate_task(LIFTED, scene(ball), seed=1, budget=Budget(1, 4))
    assert (verdict.status, verdict.reason) == ("not_found", NO_GRASP)


def test_a_heavy_body_with_a_handle_at_its_end_turns_between_the_pads() -> None:
    solids = Solid("box", (0.24, 0.1, 0.1), (0.03, 0.0, 0.0)), Solid("box", (0.06, 0.02, 0.02), (-0.12, 0.0, -0.04))
    # The centre of mass is the middle of the box, 9 cm or more from what is free of the handle.
    for mass, feasible in ((0.05, True), (2.0, False)):
        verdict = validate_task(LIFTED, scene(model((0.3, 0.1, 0.1), mass, *solids)), seed=1, budget=Budget(2, 8))
        assert verdict.status == ("feasible" if feasible else "not_found"), verdict.reason
        assert feasible or verdict.reason == TWISTS


def test_a_basin_that_tilts_out_of_every_grip_at_its_rim_is_refused_before_it_is_lifted() -> None:
    light, less, heavy = (
        scene(model((0.15, 0.15, 0.05), mass, *walls(0.15, 0.005, 0.05))) for mass in (0.15, 0.4, 0.6)
    )
    verdict = validate_task(LIFTED, light, seed=1, budget=Budget(2, 8))
    assert verdict.witness is not None
    for made in (less, heavy):
        refused = validate_task(LIFTED, made, seed=1, budget=Budget(2, 8))
        assert (refused.status, refused.reason) == ("not_found", TWISTS)
    assert check_witness(LIFTED, verdict.witness, heavy) == ["state 1: thing_1 turns between the pads"]


def test_fingers_hold_a_paper_bowl_with_little_force_and_do_not_press_into_it() -> None:
    bowl = model((0.12, 0.12, 0.05), 0.004, *walls(0.12, 0.0035, 0.05))
    made = scene(bowl)
    assert finger_force(made, "thing_1", "panda") == pytest.approx(50 * 9.81 * 0.004)
    assert finger_force(scene(HELD[BASIN]), "thing_1", "panda") == finger_force(made, None, "panda") == PANDA.grip_force
    verdict = validate_task(MOVED, made, seed=1, budget=Budget(2, 8, Tier.DEMONSTRATION))
    assert verdict.demonstration is not None, verdict.nearest
    assert check_demonstration(MOVED, verdict.demonstration, made) == []
    # A simulation that an agent drives has no witness, and presses as little.
    moment = verdict.witness.moments[1]
    arm, forces = moment.arms["panda"], list[float]()
    with open_dynamics(made) as world:
        world.begin(tuple(moment.poses), moment)
        number = len(world.parts) + list(moment.poses).index("thing_1")
        for _ in range(20):
            world.drive("panda", ArmCommand(arm.joints, arm.width - SQUEEZE))
            world.step()
            forces.append(max((each.force for pair, each in world.contacts().items() if number in pair), default=0.0))
    assert 0.0 < forces[-1] < 2.0 * finger_force(made, "thing_1", "panda")


def test_way_and_volume_of_holding_lead_to_a_grasp(verdicts: dict[str, Verdict]) -> None:
    holding = PREDICATES["holding"]
    witness, made = verdicts[BASIN].witness, scene(HELD[BASIN])
    assert witness is not None and holding.way is not None
    moment, names = witness.moments[1], ("panda", "thing_1")
    arm = moment.arms["panda"]
    tool = tool_pose(PANDA, arm.joints)
    near, far = (
        holding.way(Situation(made, moment.poses, {"panda": replace(arm, width=0.08)}, tools={"panda": at}), names)
        for at in (compose(tool, Pose((0.0, 0.0, -0.02))), compose(tool, Pose((0.0, 0.0, -0.2))))
    )
    assert 0.0 < near < far
    volume = holding.volume(Situation(made, moment.poses, {"panda": arm}), names, (0.0, 0.0, 0.0, 1.0))
    assert volume.low == volume.high and volume.width[0] < 0.005 < volume.width[1]


def test_the_pose_of_a_held_body_goes_with_the_tool(verdicts: dict[str, Verdict]) -> None:
    for verdict in verdicts.values():
        assert verdict.witness is not None
        moment = verdict.witness.moments[1]
        arm: Arm = moment.arms["panda"]
        tool = tool_pose(PANDA, arm.joints)
        expected = compose(invert(tool), moment.poses["thing_1"])
        assert arm.grasp is not None and math.dist(arm.grasp.position, expected.position) < 1e-4


def test_a_put_for_which_the_fingers_have_no_room_is_tried_with_another_grasp() -> None:
    brick = model((0.05, 0.07, 0.05), 0.1, Solid("box", (0.05, 0.07, 0.05)))
    # The slot is 58 mm wide and 170 mm long inside: the brick fits along it, and the fingers at its ends alone.
    slot, there = Shape("container", (0.066, 0.178, 0.05), wall=0.004), {"slot_1": (0.5, 0.25, 0.0)}
    made = scene(brick)
    made = replace(made, shapes={**made.shapes, "slot_1": slot}, fixed=there)
    put = ("put(panda,thing_1)", state("-holding(panda,thing_1)", "inside(thing_1,slot_1)"))
    asked = task(state("on_top(thing_1,table_1)", "-holding(panda,thing_1)"), PICK, put)
    found = 0
    with open_validator(made) as validator:
        for seed in range(6):
            verdict = validator.validate(asked, seed=seed, budget=Budget(1, 12))
            found += verdict.status == "feasible"
            assert verdict.witness is None or check_witness(asked, verdict.witness, made) == []
    assert found >= 5


def test_a_hand_that_is_in_what_it_holds_is_found(verdicts: dict[str, Verdict]) -> None:
    gripper = ParallelGripper.of(PANDA)
    for name, verdict in verdicts.items():
        assert verdict.witness is not None
        moment = verdict.witness.moments[1]
        arm = moment.arms["panda"]
        tool = compose(invert(moment.poses["thing_1"]), tool_pose(PANDA, arm.joints))
        assert is_hand_free(HELD[name], gripper, tool, arm.width)
        assert not is_hand_free(HELD[name], gripper, tool, arm.width - 0.012)


def prism_shape(folder: Path, corners: int, radius: float, height: float, lying: bool) -> Shape:
    """Return a body of 0.1 kg from the file of a prism over a regular polygon, upright or lying on a side."""
    mesh = trimesh.Trimesh(**trimesh.triangles.to_kwargs(prism(corners, radius, height, lying)))
    mesh.export(folder / "prism.stl")
    solid = Solid("mesh", (1.0, 1.0, 1.0), mesh=str(folder / "prism.stl"))
    return body_shape("mesh", [solid], solid_mass([solid]).scaled(0.1))


@pytest.mark.parametrize(
    ("corners", "radius", "height", "lying"), [(3, 0.0404, 0.12, False), (5, 0.035, 0.12, True)], ids=["3", "5 lying"]
)
def test_the_robot_moves_a_prism_that_it_holds_at_an_edge(
    tmp_path: Path, corners: int, radius: float, height: float, lying: bool
) -> None:
    made = scene(prism_shape(tmp_path, corners, radius, height, lying))
    made = replace(made, materials={"thing_1": Material(friction=0.3)})
    verdict = validate_task(MOVED, made, seed=1, budget=Budget(4, 8, Tier.DEMONSTRATION))
    assert verdict.witness is not None and verdict.demonstration is not None, verdict.nearest
    assert check_witness(MOVED, verdict.witness, made) == []
    assert check_demonstration(MOVED, verdict.demonstration, made) == []
    record = json.loads(write_line(Record(MOVED, None, verdict.witness.to_json())))
    assert problems(record, record["witness"], world_of(made)) == []
    # A tool does not hold the body if a pad is off the edge, or if the contacts are not opposite to each other.
    moment = verdict.witness.moments[1]
    arm = moment.arms["panda"]
    held = tool_pose(PANDA, arm.joints)
    for moved in (Pose((0.0, 0.004, 0.0)), Pose((0.0, 0.0, 0.0), yaw_quaternion(0.6))):
        tools = {"panda": compose(held, moved)}
        situation = Situation(made, moment.poses, {"panda": arm}, tools=tools)
        assert not PREDICATES["holding"].holds(situation, ("panda", "thing_1"))


@pytest.mark.parametrize("name", HELD)
def test_every_grasp_of_a_body_holds_it_wherever_it_stands_and_nothing_refutes_that(name: str, chance: Chance) -> None:
    made, gripper = scene(HELD[name]), ParallelGripper.of(PANDA)
    held = Fact(PREDICATES["holding"], ("panda", "thing_1"), True)
    rng = np.random.default_rng(chance.seed(1))
    found = body_grasps(HELD[name], gripper, pad_friction(made, "thing_1"))
    body = HELD[name].model
    assert found and body is not None
    for grasp in found:
        pose = Pose((*rng.uniform(0.3, 0.6, 2), 0.1), yaw_quaternion(rng.uniform(-3.0, 3.0)))
        arm, tool = Arm((0.0,) * 7, grasp.width), compose(pose, grasp.tool)
        situation = Situation(made, {"thing_1": pose}, {"panda": arm}, tools={"panda": tool})
        assert PREDICATES["holding"].holds(situation, held.arguments)
        low, high = situation.body("thing_1").low, situation.body("thing_1").high
        beyond = pad_reach(PANDA)
        assert all(a - beyond <= at <= b + beyond for a, at, b in zip(low, tool.position, high, strict=True))
        here = replace(made, fixed={**made.fixed, "thing_1": (*pose.position[:2], yaw_of(pose.quaternion))})
        assert Prover(here).refutation([held]) is None
        # Search and check judge its load alike: Coulomb's law, with the torque about the line between both pads.
        share = body.mass * 9.81 / (2 * 1.4 * made.material("thing_1").friction * 12.0)
        load = grip_load(made, "thing_1", "panda", grasp.lever, grasp.radius)
        assert load == pytest.approx(share * math.hypot(1.0, grasp.lever / grasp.radius))
        press = body.mass * 9.81 / finger_force(made, "thing_1", "panda")
        tilting = grip_tilting(HELD[name], gripper, pad_friction(made, "thing_1"), grasp.tool).total * press
        assert held_load(situation, "thing_1", "panda") == pytest.approx(max(load, tilting), abs=1e-6)
