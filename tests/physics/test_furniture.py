from __future__ import annotations

import json
import math
from dataclasses import replace

import pybullet
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from prag_asp import TaskSpace, load_domain, load_scene
from prag_asp.domain.scene import Shape, parse_scene, scene_problems
from prag_asp.errors import SceneError
from prag_asp.physics import (
    PREDICATES,
    Budget,
    Demonstration,
    Verdict,
    check_demonstration,
    check_witness,
    demonstrate,
    film_strip,
    open_validator,
    settle,
    validate_task,
)
from prag_asp.physics.collisions import arm_collision
from prag_asp.physics.geometry import Pose, compose, multiply, yaw_quaternion
from prag_asp.physics.handling import opened
from prag_asp.physics.kinematics import inverse
from prag_asp.physics.mechanism import around, cavity_pose, mechanism, part_pose, swept
from prag_asp.physics.simulator import open_simulator
from prag_asp.physics.situation import Situation
from tests.physics.scenarios import state, task

DRAWER = Shape("drawer", (0.26, 0.24, 0.1), 0.008)
CUPBOARD = Shape("cupboard", (0.22, 0.2, 0.12), 0.008)
SHAPES = st.sampled_from([DRAWER, CUPBOARD])
POSES = st.builds(
    lambda x, y, yaw: Pose((x, y, 0.05), yaw_quaternion(yaw)), st.floats(-1, 1), st.floats(-1, 1), st.floats(-3, 3)
)
FURNITURE = ("drawer_1", "cupboard_1")
AWAY = Pose((0.0, 0.0, 1.0))


@pytest.fixture(scope="module")
def domain():
    return load_domain("kitchen")


@pytest.fixture(scope="module")
def kitchen(domain):
    return load_scene(domain)


@pytest.fixture(scope="module")
def validator(kitchen):
    with open_validator(kitchen) as opened_validator:
        yield opened_validator


def closed_start(*fluents: str):
    """Return the first state of the kitchen, all that is not named false."""
    inside = {"apple_1": "drawer_1", "apple_2": "drawer_1", "cup_1": "cupboard_1"}
    places = ("drawer_1", "cupboard_1", "table_1", "bowl_1")
    away = [f"-located({item},{place})" for item, home in inside.items() for place in places if place != home]
    at_home = [f"located({item},{home})" for item, home in inside.items()]
    return state("empty(panda)", "-open(drawer_1)", "-open(cupboard_1)", *at_home, *away, *fluents)


def opening_task(furniture: str):
    """Open furniture, and close it again."""
    return task(
        closed_start(),
        (f"open(panda,{furniture})", state(f"open({furniture})")),
        (f"close(panda,{furniture})", state(f"-open({furniture})")),
    )


@pytest.fixture(scope="module")
def two():
    """Open a simulator with a drawer and a cupboard."""
    shapes = {shape.kind: {"kind": shape.kind, "size": list(shape.size), "wall": 0.008} for shape in (DRAWER, CUPBOARD)}
    table = {"shapes": shapes, "fixed": {"drawer": [0.4, -0.4], "cupboard": [0.4, 0.4]}}
    with open_simulator(parse_scene(table, {}, {"drawer": "drawer", "cupboard": "cupboard"})) as simulator:
        yield simulator


@given(SHAPES, POSES, st.floats(0, 1))
@settings(max_examples=60, deadline=None)
def test_the_bounding_box_and_the_part_are_where_the_simulator_has_them(two, shape, pose, share):
    opening = share * mechanism(shape).limit
    two.place({shape.kind: pose}, {shape.kind: opening})
    body = two.body(shape.kind)
    link = pybullet.getLinkState(body, 0, computeForwardKinematics=True, physicsClientId=two.client)
    part = part_pose(shape, pose, opening)
    assert link[4] == pytest.approx(part.position, abs=1e-6)
    assert abs(sum(a * b for a, b in zip(link[5], part.quaternion, strict=True))) == pytest.approx(1.0, abs=1e-6)
    boxes = [pybullet.getAABB(body, i, physicsClientId=two.client) for i in (-1, 0)]
    low, high = around(shape, pose, opening)
    # The simulator's boxes hold the boxes of the body's own frame, so they are larger where it is turned.
    assert all(min(box[0][i] for box in boxes) <= low[i] + 1e-6 for i in range(3))
    assert all(max(box[1][i] for box in boxes) >= high[i] - 1e-6 for i in range(3))


@pytest.mark.parametrize("shape", [DRAWER, CUPBOARD])
def test_the_bounding_box_of_what_is_square_to_the_axes_is_that_of_the_simulator(two, shape):
    for opening in (0.0, mechanism(shape).limit):
        pose = Pose((0.5, 0.2, shape.half[2]))
        two.place({shape.kind: pose}, {shape.kind: opening})
        boxes = [pybullet.getAABB(two.body(shape.kind), i, physicsClientId=two.client) for i in (-1, 0)]
        low, high = around(shape, pose, opening)
        assert low == pytest.approx([min(box[0][i] for box in boxes) for i in range(3)], abs=1e-6)
        assert high == pytest.approx([max(box[1][i] for box in boxes) for i in range(3)], abs=1e-6)


@given(SHAPES, POSES, st.floats(0, 1))
@settings(max_examples=100, deadline=None)
def test_what_furniture_sweeps_holds_it_at_every_opening(shape, pose, share):
    body, part = swept(shape, pose)
    low, high = around(shape, pose, share * mechanism(shape).limit)
    assert all(min(a, c) - 0.002 <= x for a, c, x in zip(body[0], part[0], low, strict=True))
    assert all(max(b, d) + 0.002 >= x for b, d, x in zip(body[1], part[1], high, strict=True))


@pytest.mark.parametrize("shape", [DRAWER, CUPBOARD])
def test_open_furniture_leaves_its_cavity_free_and_closed_furniture_covers_it(shape):
    pose, made = Pose((0.5, 0.0, shape.half[2])), mechanism(shape)
    for opening, free in ((made.limit, True), (0.0, False)):
        middle = cavity_pose(shape, pose, opening)
        covers = [(pose, made.body), (part_pose(shape, pose, opening), made.part)]
        size_x, size_y, _ = made.cavity
        for share_x in (-0.49, 0.0, 0.49):
            for share_y in (-0.49, 0.0, 0.49):
                x, y, z = compose(middle, Pose((share_x * size_x, share_y * size_y, 0.0))).position
                above = [
                    box
                    for frame, boxes in covers
                    for box in boxes
                    if _is_over(compose(frame, Pose(box[0])), box[1], (x, y), z + 0.001)
                ]
                assert bool(above) != free


def _is_over(pose: Pose, half: tuple[float, ...], point: tuple[float, float], height: float) -> bool:
    """Tell whether an upright box is over a point of the plane, above a height."""
    yaw = 2 * math.atan2(pose.quaternion[2], pose.quaternion[3])
    dx, dy = point[0] - pose.position[0], point[1] - pose.position[1]
    along, across = math.cos(yaw) * dx + math.sin(yaw) * dy, math.cos(yaw) * dy - math.sin(yaw) * dx
    return abs(along) < half[0] and abs(across) < half[1] and pose.position[2] + half[2] > height


def test_what_lies_in_a_drawer_moves_with_it_and_what_lies_in_a_cupboard_stays(kitchen):
    poses = {entity: Pose((x, y, kitchen.shapes[entity].half[2])) for entity, (x, y, _) in kitchen.fixed.items()}
    situation = Situation(kitchen, poses, AWAY, 0.08, openings={"drawer_1": 0.0, "cupboard_1": 0.0})
    for item, furniture in (("apple_1", "drawer_1"), ("cup_1", "cupboard_1")):
        x, y, z = situation.floor(furniture).position
        situation = situation.with_pose(item, Pose((x, y, z + kitchen.shapes[item].half[2])))
        assert PREDICATES["inside"].holds(situation, (item, furniture))
    after = opened(situation, "drawer_1", 0.2, list(situation.poses))
    after = opened(after, "cupboard_1", 1.5, list(situation.poses))
    shift = [a - b for a, b in zip(after.poses["apple_1"].position, situation.poses["apple_1"].position, strict=True)]
    assert shift == pytest.approx([-0.2, 0.0, 0.0])
    assert after.poses["cup_1"] == situation.poses["cup_1"]
    assert all(PREDICATES["inside"].holds(after, pair) for pair in (("apple_1", "drawer_1"), ("cup_1", "cupboard_1")))
    assert PREDICATES["is_open"].holds(after, ("cupboard_1",))
    assert not PREDICATES["is_closed"].holds(after, ("drawer_1",))
    assert PREDICATES["is_open"].distance(after, ("drawer_1",)) == pytest.approx(0.9 * 0.234 - 0.2)


@pytest.mark.parametrize(("furniture", "item"), [("drawer_1", "apple_1"), ("cupboard_1", "cup_1")])
def test_the_gripper_reaches_into_open_furniture_and_meets_what_is_closed(kitchen, furniture, item):
    place = kitchen.fixed[furniture]
    half = kitchen.shapes[furniture].half[2]
    poses = {furniture: Pose((place[0], place[1], half), yaw_quaternion(place[2]))}
    for opening in (0.0, mechanism(kitchen.shapes[furniture]).limit):
        situation = Situation(kitchen, poses, AWAY, 0.08, openings={furniture: opening})
        x, y, z = situation.floor(furniture).position
        at = Pose((x, y, z + kitchen.shapes[item].half[2]))
        situation = situation.with_pose(item, at)
        with open_simulator(kitchen) as simulator:
            downs = [Pose(at.position, multiply(yaw_quaternion(yaw), (1.0, 0.0, 0.0, 0.0))) for yaw in (0.0, 0.8, 1.6)]
            reaching = [joints for down in downs for joints in inverse(simulator.robot, down)]
            hits = [arm_collision(simulator, situation, joints, 0.08, item) for joints in reaching]
        assert reaching
        if opening:
            assert None in hits
        else:
            assert all(hit is not None and hit.other == furniture for hit in hits)


@pytest.mark.parametrize("furniture", ["drawer_1", "cupboard_1"])
def test_the_robot_opens_and_closes_furniture_by_its_handle(kitchen, validator, furniture):
    made = opening_task(furniture)
    verdict = validator.validate(made, seed=2)
    assert Verdict.from_json(json.loads(json.dumps(verdict.to_json()))) == verdict
    witness = verdict.witness
    assert check_witness(made, witness, kitchen) == []
    assert settle(made, witness, kitchen) is None
    limit = mechanism(kitchen.shapes[furniture]).limit
    closed, wide, again = (moment.openings[furniture] for moment in witness.moments)
    assert closed <= 0.05 * limit and again <= 0.05 * limit and wide >= 0.9 * limit
    pulls = [waypoint for waypoint in witness.motions[0] if waypoint.name == "pull"]
    assert pulls[-1].opening == wide and len(pulls) >= 3


def test_a_wrong_opening_or_a_leap_of_furniture_is_found(kitchen, validator):
    made = opening_task("drawer_1")
    witness = validator.validate(made, seed=2).witness
    first, *rest = witness.moments
    assert "cannot be open by 0.5" in check_witness(made, _opened(witness, 0, "drawer_1", 0.5), kitchen)[0]
    assert "cannot be open by nan" in check_witness(made, _opened(witness, 0, "drawer_1", math.nan), kitchen)[0]
    assert any(
        "has been opened" in text for text in check_witness(made, _opened(witness, 1, "cupboard_1", 0.05), kitchen)
    )
    without = replace(first, openings={"drawer_1": 0.0})
    assert check_witness(made, replace(witness, moments=(without, *rest)), kitchen)
    motion = witness.motions[0]
    pull = next(i for i, waypoint in enumerate(motion) if waypoint.name == "pull")
    skipped = (motion[:pull] + motion[-2:], *witness.motions[1:])
    assert any(
        "ends open otherwise" in text for text in check_witness(made, replace(witness, motions=skipped), kitchen)
    )
    still = (*motion[:pull], replace(motion[pull], joints=motion[pull - 1].joints), *motion[pull + 1 :])
    told = check_witness(made, replace(witness, motions=(still, *witness.motions[1:])), kitchen)
    assert any("does not hold the handle of drawer_1" in text for text in told)


def _opened(witness, k, furniture, opening):
    """Return a witness with another opening at one moment."""
    moment = witness.moments[k]
    moment = replace(moment, openings={**moment.openings, furniture: opening})
    return replace(witness, moments=(*witness.moments[:k], moment, *witness.moments[k + 1 :]))


def test_what_is_grasped_from_closed_furniture_is_never_found(validator):
    made = task(closed_start(), ("approach(panda,cup_1,cupboard_1)", state("at(panda,cup_1)")))
    verdict = validator.validate(made, seed=1)
    assert verdict.status == "not_found"
    assert verdict.causes["the arm collides"] > 0
    opened_first = task(
        closed_start(),
        ("open(panda,cupboard_1)", state("open(cupboard_1)")),
        ("approach(panda,cup_1,cupboard_1)", state("at(panda,cup_1)")),
    )
    assert validator.validate(opened_first, seed=1).feasible


def test_furniture_of_which_nothing_is_known_is_open_or_closed(kitchen, validator):
    made = task(state("empty(panda)"), ("open(panda,drawer_1)", state("open(drawer_1)")))
    starts = [validator.validate(made, seed=seed).witness.moments[0].openings["drawer_1"] for seed in range(8)]
    limit = mechanism(kitchen.shapes["drawer_1"]).limit
    assert all(start <= 0.05 * limit or start >= 0.9 * limit for start in starts)
    assert min(starts) < 0.05 * limit < max(starts)


def test_tasks_of_the_kitchen_pass_every_tier_short_of_performing(domain, kitchen, validator):
    tasks = TaskSpace(domain, 8).sample(4, seed=3)
    for i, made in enumerate(tasks):
        verdict = validator.validate(made, seed=3, index=i, budget=Budget(tier="settling"))
        assert verdict.feasible
        assert check_witness(made, verdict.witness, kitchen) == []


def test_the_robot_performs_the_opening_and_closing_of_furniture(kitchen, validator, tmp_path):
    made = task(
        closed_start(),
        ("open(panda,drawer_1)", state("open(drawer_1)")),
        ("open(panda,cupboard_1)", state("open(cupboard_1)")),
        ("close(panda,drawer_1)", state("-open(drawer_1)")),
    )
    demonstration = demonstrate(made, validator.validate(made, seed=4).witness, kitchen)
    assert demonstration.success, demonstration.detail
    assert check_demonstration(made, demonstration, kitchen) == []
    drawer, cupboard = (demonstration.openings[:, demonstration.furniture.index(name)] for name in FURNITURE)
    assert drawer[0] < 0.02 and drawer.max() > 0.2 and drawer[-1] < 0.02
    assert cupboard[0] < 0.1 and cupboard[-1] > 1.4
    apple = demonstration.poses[:, demonstration.objects.index("apple_1"), 0]
    assert apple[0] - apple.min() == pytest.approx(drawer.max() - drawer[0], abs=0.03)  # an apple rolls a little
    demonstration.save(tmp_path / "it.npz")
    assert Demonstration.load(tmp_path / "it.npz") == demonstration
    shut = replace(demonstration, openings=0 * demonstration.openings)
    assert any("drawer 1 is open" in text for text in check_demonstration(made, shut, kitchen))
    strips = [film_strip(made, each, kitchen, frames=2, size=(80, 60)).tobytes() for each in (demonstration, shut)]
    assert strips[0] != strips[1]


def test_on_the_table_means_over_nothing_hollow(kitchen):
    poses = {"bowl_1": Pose((0.6, 0.0, 0.025)), "cup_1": Pose((0.4, 0.0, 0.04))}
    situation = Situation(kitchen, poses, AWAY, 0.08)
    assert PREDICATES["located"].holds(situation, ("cup_1", "table_1"))
    assert PREDICATES["located"].holds(situation.with_pose("cup_1", Pose((0.4, 0.0, 0.2))), ("cup_1", "table_1"))
    assert not PREDICATES["located"].holds(situation.with_pose("cup_1", Pose((0.4, 0.0, 0.4))), ("cup_1", "table_1"))
    over = situation.with_pose("cup_1", Pose((0.6, 0.0, 0.1)))
    assert not PREDICATES["located"].holds(over, ("cup_1", "table_1"))
    assert PREDICATES["located"].holds(over, ("cup_1", "bowl_1"))


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ({"fixed": {}}, "scene.fixed.it: missing: it is a drawer, which does not move"),
        ({"shapes": {"box": {"kind": "drawer", "size": [0.05, 0.2, 0.1]}}}, "scene.shapes.box.size: needs one size"),
        (
            {"shapes": {"box": {"kind": "drawer", "size": {"low": [0.2, 0.2, 0.1], "high": [0.3, 0.2, 0.1]}}}},
            "scene.shapes.box.size: needs one size of at least 0.12 x 0.12 x 0.06 m for a drawer",
        ),
    ],
)
def test_furniture_that_cannot_be_built_is_refused_with_its_key(table, message):
    fine = {"shapes": {"box": {"kind": "drawer", "size": [0.26, 0.24, 0.1]}}, "fixed": {"it": [0.5, 0.0]}}
    assert parse_scene(fine, {}, {"it": "box"}).shapes["it"].kind == "drawer"
    with pytest.raises(SceneError) as caught:
        parse_scene({**fine, **table}, {}, {"it": "box"})
    assert message in str(caught.value)


def test_only_furniture_can_be_open(domain):
    table = {**domain.settings.scene, "predicates": {"open": "is_open", "empty": "gripper_open"}}
    shapes = {**table["shapes"], "drawer": {"kind": "container", "size": [0.2, 0.2, 0.1]}}
    entities = {str(entity): name for entity, name in domain.facts.entities.items()}
    fluents = list(state("open(drawer_1)"))
    told = scene_problems({**table, "shapes": shapes}, domain.facts.parents, entities, fluents)
    assert [problem.message for problem in told] == [
        "open(drawer_1) needs drawer_1 to be of the kind drawer or cupboard"
    ]


def test_the_same_seed_gives_the_same_witness_of_the_kitchen(kitchen, validator):
    made = opening_task("cupboard_1")
    assert validate_task(made, kitchen, seed=9) == validator.validate(made, seed=9)


def test_nothing_is_in_what_has_no_cavity(kitchen):
    poses = {"cup_1": Pose((0.4, 0.0, 0.03)), "apple_1": Pose((0.4, 0.0, 0.03))}
    situation = Situation(kitchen, poses, AWAY, 0.08)
    for name in ("inside", "located"):
        assert not PREDICATES[name].holds(situation, ("apple_1", "cup_1"))
