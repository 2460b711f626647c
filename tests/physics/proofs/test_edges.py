"""Each proof at its edge, from both sides: just impossible, and just feasible with a witness."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from prag_asp.physics import Budget, check_witness, open_validator, validate_task
from prag_asp.physics.predicates import grip_geometry
from prag_asp.physics.predicates.grip_friction import GRAVITY, SLIPS, bearable
from prag_asp.physics.proofs.prover import Impossibility, Prover
from prag_asp.physics.robot.kinematics import tool_pose
from prag_asp.physics.search import moving
from prag_asp.physics.symbolic_facts import physical_task
from prag_asp.scene.robots.panda import PANDA
from prag_asp.scene.scene import Material, Scene, Shape
from prag_asp.task import Task
from tests.chance import Chance
from tests.physics.scenarios import state, task

PICK = ("pick(panda,cube_1)", state("holding(panda,cube_1)", "-on_top(cube_1,table_1)"))
LIFTED = task(state("on_top(cube_1,table_1)", "-holding(panda,cube_1)"), PICK)
GRASPED = task(state("on_top(cube_1,table_1)"), ("grasp(panda,cube_1)", state("holding(panda,cube_1)")))


def scene(size: tuple[float, float, float] = (0.05, 0.05, 0.05), **changes: object) -> Scene:
    """Return a scene of a table, a cube of a size and a shelf."""
    shapes = {
        "panda": Shape("robot"),
        "table_1": Shape("table"),
        "cube_1": Shape("box", size),
        "shelf_1": Shape("box", (0.2, 0.2, 0.1)),
    }
    return replace(Scene(shapes, fixed={"shelf_1": (0.5, 0.35, 0.0)}), **changes)


def of_mass(kilograms: float, friction: float = 0.3, **changes: object) -> Scene:
    """Return a scene with a cube of a mass and a coefficient of friction."""
    return scene(materials={"cube_1": Material(kilograms / 0.05**3, friction)}, **changes)


def with_zones(**zones: tuple[tuple[float, float], tuple[float, float, float]]) -> Scene:
    """Return a scene with zones, each of a size at a pose."""
    made = scene()
    shapes = {name: Shape("zone", (*size, 0.0)) for name, (size, _) in zones.items()}
    fixed = {name: pose for name, (_, pose) in zones.items()}
    return replace(made, shapes={**made.shapes, **shapes}, fixed={**made.fixed, **fixed})


def proof_of(asked: Task, made: Scene) -> Impossibility | None:
    return Prover(made).impossibility(physical_task(asked, made))


def reason(asked: Task, made: Scene) -> str | None:
    proof = proof_of(asked, made)
    return None if proof is None else str(proof)


@pytest.mark.parametrize(("height", "held"), [(0.00249, False), (0.0026, True), (0.01099, True), (0.011, True)])
def test_what_the_pads_do_not_overlap_is_proved_never_held_and_what_is_higher_is_held(
    height: float, held: bool
) -> None:
    made = scene((0.05, 0.05, height))
    verdict = validate_task(LIFTED, made, seed=1)
    assert verdict.status == ("feasible" if held else "infeasible")
    if verdict.witness is None:
        assert verdict.reason.endswith(
            "cube 1 is 2.49 mm high, but the gripper holds only bodies that are at least 2.5 mm high"
        )
    else:
        assert check_witness(LIFTED, verdict.witness, made) == []


@pytest.mark.parametrize("height", [0.003, 0.007, 0.0105])
def test_the_fingertips_are_just_above_the_table_at_a_flat_body_and_the_pads_overlap_it(height: float) -> None:
    verdict = validate_task(LIFTED, scene((0.05, 0.05, height)), seed=1)
    assert verdict.witness is not None
    taken = next(waypoint for waypoint in verdict.witness.motions[0] if waypoint.name == "at")
    tips = tool_pose(PANDA, taken.joints).position[2] - PANDA.fingertip
    assert tips == pytest.approx(0.0005, abs=1e-4) and height - tips >= 0.002


def test_a_body_of_which_some_size_can_be_held_is_not_proved_too_low_or_too_heavy() -> None:
    flat = [Shape("box", (0.05, 0.05, height)) for height in (0.002, 0.003)]
    cubes = [Shape("box", (side, side, side)) for side in (0.03, 0.06)]
    for made, possible, impossible in (
        (scene((0.05, 0.05, 0.003)), flat, flat[:1]),
        (of_mass(1.7), cubes, cubes[1:]),
    ):
        assert reason(LIFTED, replace(made, ranges={"cube_1": tuple(possible)})) is None
        assert reason(LIFTED, replace(made, ranges={"cube_1": tuple(impossible)})) is not None


def test_the_check_of_a_witness_demands_that_the_fingers_stay_above_what_they_hold(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    made = scene((0.05, 0.05, 0.013))
    witness = validate_task(LIFTED, made, seed=1).witness
    assert witness is not None and check_witness(LIFTED, witness, made) == []
    monkeypatch.setattr(grip_geometry, "TIP_ROOM", grip_geometry.TIP_ROOM + 0.001)
    assert any("the fingers reach below cube_1" in text for text in check_witness(LIFTED, witness, made))


def test_friction_bears_what_coulomb_says() -> None:
    # Two fingers of 12 N, rubber of 1.4 on a body of 0.3.
    assert bearable(of_mass(1.0), "cube_1", "panda") == pytest.approx(2 * 12.0 * 1.4 * 0.3 / 9.81)
    assert GRAVITY == 9.81 and SLIPS > 1.0


@pytest.mark.parametrize(("share", "proved"), [(SLIPS - 0.001, False), (SLIPS + 0.001, True)])
def test_what_friction_does_not_bear_is_proved_to_slip_where_it_is_lifted(share: float, proved: bool) -> None:
    made = of_mass(share * bearable(of_mass(1.0), "cube_1", "panda"))
    proof = reason(LIFTED, made)
    assert (proof is not None) == proved
    assert proof is None or proof.startswith("the state after pick(panda,cube_1): cube 1 weighs 1.0")
    assert reason(GRASPED, made) is None
    verdict = validate_task(LIFTED, made, seed=1)
    assert verdict.status == ("infeasible" if proved else "feasible")


@pytest.mark.parametrize(
    ("steps", "initial", "proved"),
    [
        ([PICK], ["on_top(cube_1,table_1)"], True),
        ([PICK], [], False),  # it may have been in the air already, or on the shelf, or in the gripper
        ([("put", state("-holding(panda,cube_1)", "on_top(cube_1,shelf_1)"))],
         ["holding(panda,cube_1)", "-on_top(cube_1,shelf_1)"], True),
        ([("put", state("-holding(panda,cube_1)", "on_top(cube_1,shelf_1)"))], ["holding(panda,cube_1)"], False),
        ([("drop", state("-holding(panda,cube_1)"))], ["holding(panda,cube_1)", "on_top(cube_1,table_1)"], False),
        ([("carry", state("-on_top(cube_1,table_1)"))], ["holding(panda,cube_1)", "on_top(cube_1,table_1)"], True),
        ([("wait", state("-on_top(cube_1,table_1)"))], ["on_top(cube_1,table_1)"], False),
    ],
)  # fmt: skip
def test_only_what_leaves_or_comes_to_a_place_in_the_gripper_is_lifted(
    steps: list[tuple[str, dict]], initial: list[str], proved: bool
) -> None:
    named = [(f"{name.partition('(')[0]}(panda,cube_1)", subgoal) for name, subgoal in steps]
    asked = task(state(*initial), *named)
    proof = proof_of(asked, of_mass(1.7))
    assert (proof is not None) == proved
    if steps == [PICK] and proof is not None:  # it names the facts of both states
        assert proof.state == 1
        assert [(f.predicate.name, f.arguments, f.value) for f in proof.facts] == [
            ("on_top", ("cube_1", "table_1"), True),
            ("holding", ("panda", "cube_1"), True),
            ("on_top", ("cube_1", "table_1"), False),
        ]


def test_the_check_of_a_witness_demands_that_friction_bears_what_is_in_the_air() -> None:
    light, heavy = of_mass(0.1), of_mass(1.7)
    witness = validate_task(LIFTED, light, seed=1).witness
    assert witness is not None and check_witness(LIFTED, witness, light) == []
    assert any("cube_1 slips out of the gripper" in text for text in check_witness(LIFTED, witness, heavy))
    grasped = validate_task(GRASPED, heavy, seed=1).witness
    assert grasped is not None and check_witness(GRASPED, grasped, heavy) == []


@pytest.mark.parametrize(("share", "held"), [(0.6, True), (SLIPS, False)])
def test_the_robot_holds_what_friction_bears_with_some_to_spare_and_never_what_is_proved(
    share: float, held: bool, chance: Chance, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Prover, "impossibility", lambda self, physical: None)
    monkeypatch.setattr(moving, "slips", lambda scene, entity, robot: None)
    rng, budget, done = chance.generator(31), Budget(2, 5, "demonstration"), 0
    for index in range(chance.examples(2)):
        friction = rng.uniform(0.2, 0.5)
        most = bearable(of_mass(1.0, friction), "cube_1", "panda")
        with open_validator(of_mass(min(share * most, 2.9), friction)) as validator:
            done += validator.validate(LIFTED, seed=1, index=index, budget=budget).feasible
    assert (done > 0) == held


def test_no_long_search_finds_what_a_zone_and_the_table_exclude(
    chance: Chance, monkeypatch: pytest.MonkeyPatch
) -> None:
    rng, found, proved = chance.generator(32), 0, 0
    for _ in range(chance.examples(12)):
        zones = {
            name: (
                (rng.uniform(0.05, 0.4), rng.uniform(0.05, 0.4)),
                (rng.uniform(0.4, 0.6), rng.uniform(-0.2, 0.2), rng.uniform(-3, 3)),
            )
            for name in ("a", "b")
        }
        made = with_zones(**zones)
        signs = {place: rng.choice(["", "-"]) for place in ("a", "b", "table_1")}
        asked = task(state(*(f"{sign}on_top(cube_1,{place})" for place, sign in signs.items())))
        proof = reason(asked, made)
        with monkeypatch.context() as patch, open_validator(made) as validator:
            patch.setattr(Prover, "impossibility", lambda self, physical: None)
            verdict = validator.validate(asked, seed=1, budget=Budget(4 * chance.times, 10))
        found, proved = found + verdict.feasible, proved + (proof is not None)
        assert proof is None or not verdict.feasible, (proof, zones, signs)
    assert found > 0 and proved > 0


@pytest.mark.parametrize(("gap", "proved"), [(1e-4, True), (-1e-3, False)])
def test_two_zones_exclude_each_other_exactly_where_they_have_no_part_in_common(gap: float, proved: bool) -> None:
    reach = 0.1 * math.sqrt(2.0)  # from the middle to a corner
    size = (0.2, 0.2)
    made = with_zones(a=(size, (0.5, 0.0, math.pi / 4)), b=(size, (0.5, 2 * reach + gap, math.pi / 4)))
    both = task(state("on_top(cube_1,a)", "on_top(cube_1,b)"))
    assert (reason(both, made) is not None) == proved
    beside = task(state("on_top(cube_1,a)", "-on_top(cube_1,b)", "on_top(cube_1,table_1)"))
    assert reason(beside, made) is None


@pytest.mark.parametrize(("out", "proved"), [(0.0, True), (1e-4, False), (0.02, False)])
def test_a_zone_excludes_that_a_body_is_not_on_another_exactly_where_it_lies_within_that(
    out: float, proved: bool
) -> None:
    made = with_zones(outer=((0.4, 0.4), (0.5, 0.0, 0.0)), inner=((0.2, 0.2), (0.5, 0.1 + out, 0.0)))
    beside = task(state("on_top(cube_1,inner)", "-on_top(cube_1,outer)"))
    proof = reason(beside, made)
    assert (proof is not None) == proved
    assert proof is None or proof.endswith("cube 1 cannot be on inner and not on outer, which covers all of inner")
    if out > 0.01:
        verdict = validate_task(beside, made, seed=1)
        assert verdict.witness is not None and check_witness(beside, verdict.witness, made) == []


def test_three_zones_that_meet_by_pairs_but_nowhere_all_three_exclude_each_other() -> None:
    places = {"a": (0.5, 0.0, 0.0), "b": (0.45, 0.1, math.pi / 3), "c": (0.55, 0.1, -math.pi / 3)}
    made = with_zones(**{name: ((0.4, 0.01), place) for name, place in places.items()})
    facts = {name: f"on_top(cube_1,{name})" for name in places}
    for left_out in places:
        pair = task(state(*(fact for name, fact in facts.items() if name != left_out)))
        assert reason(pair, made) is None
    proof = reason(task(state(*facts.values())), made)
    assert proof is not None and "no part in common" in proof
