"""Predicates of a domain's own in tasks: searched for, checked, in one process and in two."""

from __future__ import annotations

import math
import pickle
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from prag_asp import Domain, TaskSpace, load_domain
from prag_asp.domain.load import load_scene
from prag_asp.physics import Budget, Validator, check_witness, open_validator, validate_tasks
from prag_asp.physics.predicates import Volume, predicate_of
from prag_asp.physics.search.initial_state import order_of
from prag_asp.physics.search.spans import foresee_spans
from prag_asp.physics.situation import Situation
from prag_asp.physics.symbolic_facts import physical_task
from prag_asp.scene.geometry import Pose, yaw_of
from prag_asp.scene.scene import BoxBounds, Own, Scene, Shape
from tests.chance import Chance
from tests.physics.scenarios import STUDIO, state, task
from tests.physics.scenarios import STUDIO_SHAPES as SHAPES

PAIR = ("object", "object")


@pytest.fixture(scope="module")
def studio() -> Domain:
    return load_domain(STUDIO, trust=True)


@pytest.fixture(scope="module")
def studio_validator(studio: Domain) -> Iterator[Validator]:
    with open_validator(load_scene(studio)) as validator:
        yield validator


def test_tasks_with_own_predicates_are_found_by_workers_too_and_their_witnesses_pass(
    studio: Domain, studio_validator: Validator, chance: Chance
) -> None:
    scene, seed = load_scene(studio), chance.seed(5)
    assert pickle.loads(pickle.dumps(scene)) == scene
    tasks = TaskSpace(studio, 4).sample(16, seed=seed)
    effects = [effect for each in tasks for effect in physical_task(each, scene).effects]
    used = {fact.predicate.name for effect in effects for fact in effect.fresh}
    assert {"in_corner", "on_the_left", "looks_at", "between"} <= used
    verdicts = list(validate_tasks(tasks, scene, seed=seed, workers=2))
    assert verdicts[:5] == [studio_validator.validate(tasks[i], seed=seed, index=i) for i in range(5)]
    assert sum(verdict.feasible for verdict in verdicts) >= 14
    for each, verdict in zip(tasks, verdicts, strict=True):
        if verdict.feasible:
            assert check_witness(each, verdict.witness, scene) == []


def test_what_a_relation_refers_to_is_put_down_before_its_subject_as_far_as_there_is_no_circle() -> None:
    scene = Scene(shapes=SHAPES)

    def order(*fluents: str) -> list[str]:
        return order_of(physical_task(task(state(*fluents)), scene), scene)

    assert order("between(brick_1,cup_1,cup_2)", "on_top(cup_1,camera_1)") == ["camera_1", "cup_1", "cup_2", "brick_1"]
    assert order("near(cup_1,brick_1)", "near(brick_1,cup_2)") == ["brick_1", "cup_1", "cup_2"]
    circle = order("between(brick_1,cup_1,cup_2)", "between(cup_1,brick_1,cup_2)", "on_top(brick_1,cup_1)")
    assert circle.index("cup_1") < circle.index("brick_1")


@pytest.mark.parametrize(("larger", "fits"), [(0.0, True), (0.0035, True), (0.0045, False)])
def test_a_body_as_large_as_its_box_is_in_it_up_to_the_tolerance(larger: float, fits: bool, chance: Chance) -> None:
    box = BoxBounds((0.1, -0.2, 0.0), (0.21 - larger, -0.15, 0.04))  # the brick is 110 x 50 x 40 mm
    own = Own("odd", PAIR, (box,), whole=True, sentence="{0} {is} in {1}")
    predicate = predicate_of(Scene(shapes=SHAPES, own={"odd": own}), "odd")
    turned = (0.0, 0.0, math.sin(0.4), math.cos(0.4))
    poses = {"camera_1": Pose((0.5, 0.1, 0.03), turned)}
    situation = Situation(Scene(shapes=SHAPES), poses)
    floor = (
        predicate.volume(situation, ("brick_1", "camera_1"), turned).meet(Volume((0, -1, 0.02), (1, 1, 0.02))).floor()
    )
    assert (floor is not None) == fits
    if floor is not None:
        at = Volume.sample(floor, chance.generator(1).uniform)
        assert at is not None
        assert predicate.distance(situation.with_pose("brick_1", Pose(at, turned)), ("brick_1", "camera_1")) == 0.0


def test_an_initial_state_goes_back_to_what_leaves_no_room(
    studio_validator: Validator, monkeypatch: pytest.MonkeyPatch
) -> None:
    # The brick and the camera, which are put down first, are seldom near enough for a cup to be near both.
    both = task(state("near(cup_1,brick_1)", "near(camera_1,cup_1)", "-near(brick_1,camera_1)"), ("wait(panda)", {}))

    def found() -> int:
        return sum(studio_validator.validate(both, seed=seed, budget=Budget(1, 1)).feasible for seed in range(40))

    often = found()
    assert often >= 34
    monkeypatch.setattr("prag_asp.physics.search.initial_state.BACKTRACKS", 0)
    assert found() < often


def test_two_objects_leave_room_for_what_comes_between_them_later(studio: Domain, studio_validator: Validator) -> None:
    scene = load_scene(studio)
    row = task(
        state("holding(panda,brick_1)"),
        ("set(panda,brick_1)", state("-holding(panda,brick_1)", "between(brick_1,cup_1,cup_2)")),
        ("pick(panda,camera_1)", state("holding(panda,camera_1)")),
        ("set(panda,camera_1)", state("-holding(panda,camera_1)", "between(camera_1,brick_1,cup_2)")),
        ("pick(panda,cup_1)", state("holding(panda,cup_1)")),
        forget=("between(brick_1,cup_1,cup_2)", "between(camera_1,brick_1,cup_2)"),
    )
    spans = foresee_spans(physical_task(row, scene), scene)
    assert set(spans) == {(0, "cup_1"), (0, "cup_2"), (1, "brick_1")}
    (cups,), (brick,) = spans[0, "cup_1"], spans[1, "brick_1"]
    assert cups.other == brick.other == "cup_2"
    gap = 0.005 + 2 * 0.003
    assert brick.enough == pytest.approx(0.025 + 2 * 0.025 + 0.03 + 2 * gap)
    assert cups.enough == pytest.approx(0.03 + 0.025 + gap + brick.enough)
    assert cups.ample > cups.enough
    verdicts = [studio_validator.validate(row, seed=seed, budget=Budget(2, 10)) for seed in range(20)]
    assert sum(verdict.feasible for verdict in verdicts) >= 18


def test_what_is_held_moves_where_another_is_the_subject_of_the_relation(
    studio: Domain, studio_validator: Validator
) -> None:
    scene = load_scene(studio)
    looked_at = task(
        state("holding(panda,cup_1)", "on_top(camera_1,table_1)"),
        ("show(panda,cup_1)", state("-holding(panda,cup_1)", "on_top(cup_1,table_1)", "looks_at(camera_1,cup_1)")),
    )
    assert physical_task(looked_at, scene).effects[0].moved == ("cup_1",)
    verdict = studio_validator.validate(looked_at, seed=1)
    assert verdict.feasible
    first, second = verdict.witness.moments
    assert first.poses["camera_1"] == second.poses["camera_1"]


def test_nothing_is_in_a_relation_to_itself(studio_validator: Validator) -> None:
    for fluents, words in (
        (["near(cup_1,cup_1)"], "nothing is in a relation to itself"),
        (["near(cup_1,cup_2)", "far(cup_2,cup_1)"], "cannot be near and far at once"),
    ):
        verdict = studio_validator.validate(task(state(*fluents), ("wait(panda)", state("upright(cup_1)"))), seed=0)
        assert verdict.status == "infeasible" and words in verdict.reason
    fine = task(state("-near(cup_1,cup_1)", "near(cup_1,cup_2)"), ("wait(panda)", {}))
    assert studio_validator.validate(fine, seed=0).feasible


def test_relations_are_searched_for_together(studio: Domain, studio_validator: Validator) -> None:
    arranged = task(
        state(
            "aligned(brick_1,camera_1)", "near(brick_1,camera_1)", "far(cup_1,brick_1)", "near(cup_2,cup_1)",
            "upright(cup_1)", "-aligned(cup_2,cup_1)", "-near(cup_2,camera_1)",
        ),
        ("wait(panda)", {}),
    )  # fmt: skip
    verdict = studio_validator.validate(arranged, seed=3)
    assert verdict.feasible and check_witness(arranged, verdict.witness, load_scene(studio)) == []
    poses = verdict.witness.moments[0].poses
    turn = 4 * (yaw_of(poses["brick_1"].quaternion) - yaw_of(poses["camera_1"].quaternion))
    assert math.cos(turn) >= math.cos(math.radians(4 * 5))


@pytest.mark.parametrize("fluent", ["near(apple_1,can_1)", "between(apple_1,can_1,box_1)", "above(apple_1,bowl_1)"])
def test_what_is_carried_is_brought_where_the_relation_holds_in_the_air(fluent: str, prag: Scene) -> None:
    box = BoxBounds((-0.1, -0.1, 0.1), (0.1, 0.1, 0.3))
    scene = replace(prag, own={"above": Own("above", PAIR, (box,), sentence="{0} {is} above {1}")})
    carried = task(
        state("-at(panda,apple_1)", "open(panda)"),
        ("approach(panda,apple_1)", state("at(panda,apple_1)")),
        ("grasp(panda,apple_1)", state("holding(panda,apple_1)", "-open(panda)")),
        ("move(panda,apple_1)", state(fluent)),
    )
    with open_validator(scene) as validator:
        verdict = validator.validate(carried, seed=1)
    assert verdict.feasible and check_witness(carried, verdict.witness, scene) == []
    assert verdict.witness.moments[-1].poses["apple_1"].position[2] > 0.1


LOOKING_AROUND = """
from prag_asp.physics.predicates import Predicate, Volume, states

def _clear(situation, arguments):
    top = situation.top(arguments[0])
    yield max([-1.0, *(0.005 - abs(situation.bottom(other) - top) for other in situation.poses)])

def _anywhere(situation, arguments, quaternion):
    return Volume()

PREDICATES = {
    "clear": Predicate("clear", _clear, _anywhere, states("{0} {is} clear")),
}
"""


def test_a_predicate_that_looks_at_other_bodies_is_neither_proved_of_fixed_ones_nor_passed_over(tmp_path: Path) -> None:
    file = tmp_path / "own.py"
    file.write_text(LOOKING_AROUND)
    shapes = {**SHAPES, "shelf_1": Shape("box", (0.2, 0.2, 0.05))}
    own = {"clear": Own("clear", ("object",), file=str(file))}
    scene = Scene(shapes=shapes, fixed={"shelf_1": (0.5, 0.3, 0.0)}, own=own, trusted=True)
    pick = ("pick(panda,cup_1)", state("holding(panda,cup_1)"))
    put = ("put(panda,cup_1,shelf_1)", state("-holding(panda,cup_1)", "on_top(cup_1,shelf_1)"))
    covered = task(state("clear(shelf_1)"), pick, (put[0], {**put[1], **state("-clear(shelf_1)")}))
    kept_clear = task(state("clear(shelf_1)"), pick, put)
    with open_validator(scene) as validator:
        verdicts = [validator.validate(each, seed=1) for each in (covered, kept_clear)]
    assert [verdict.status for verdict in verdicts] == ["feasible", "not_found"]
    assert check_witness(covered, verdicts[0].witness, scene) == []
