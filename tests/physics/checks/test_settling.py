from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from prag_asp.errors import QueryError
from prag_asp.physics import Budget, Moment, Verdict, Witness
from prag_asp.physics.checks.settling import Settling, open_settling
from prag_asp.physics.predicates import PREDICATES
from prag_asp.physics.search.attempt import UNSETTLED, UNSTABLE
from prag_asp.physics.symbolic_facts import Fact, PhysicalTask
from prag_asp.physics.witness import Arm
from prag_asp.scene.geometry import Pose, yaw_quaternion
from prag_asp.scene.robots import PANDA
from prag_asp.scene.scene import Scene
from tests.chance import examples
from tests.physics.scenarios import stacking, state, task

NEAR_THE_EDGE = 0.002


@pytest.fixture(scope="module")
def settling(tabletop: Scene) -> Iterator[Settling]:
    with open_settling(tabletop) as opened:
        yield opened


def _failure(
    settling: Settling, poses: Mapping[str, Pose], facts: tuple[Fact, ...] = (), held: str | None = None
) -> str | None:
    """Return why one arrangement of objects is not stable."""
    arm = Arm(PANDA.home, PANDA.opening, held, Pose((0.0, 0.0, 0.0)) if held else None)
    moment = Moment(poses, {"panda": arm})
    fault = settling.fault(PhysicalTask(tuple(poses), facts, held, ()), Witness((moment,), ()))
    return None if fault is None else fault.cause


@settings(max_examples=examples(50))
@given(beyond=st.floats(-0.03, 0.02), yaw=st.floats(-3.1, 3.1), quarter=st.integers(0, 3))
def test_a_cube_on_a_cube_tips_just_where_its_centre_is_beyond_the_lower_one(settling, beyond, yaw, quarter):
    if abs(beyond) < NEAR_THE_EDGE:
        return
    heading, offset, turned = yaw + quarter * math.pi / 2, 0.025 + beyond, yaw_quaternion(yaw)
    upper = Pose((0.5 + offset * math.cos(heading), offset * math.sin(heading), 0.075), turned)
    poses = {"cube_1": Pose((0.5, 0.0, 0.025), turned), "cube_2": upper}
    assert _failure(settling, poses) == (UNSTABLE if beyond > 0 else None)


def test_what_floats_tips_or_overlaps_does_not_settle_and_what_is_held_or_balanced_does(settling):
    assert _failure(settling, {"brick_1": Pose((0.5, 0.0, 0.02))}) is None
    overlapping = {"cube_1": Pose((0.5, 0, 0.025)), "cube_2": Pose((0.52, 0, 0.025))}
    assert _failure(settling, overlapping) == UNSTABLE
    brick = {"cube_1": Pose((0.5, 0.0, 0.025)), "brick_1": Pose((0.52, 0.0, 0.07))}
    assert _failure(settling, brick) is None
    assert _failure(settling, {**brick, "can_1": Pose((0.55, 0.0, 0.14))}) == UNSTABLE
    balanced = {**brick, "cube_2": Pose((0.475, 0.0, 0.115)), "brick_2": Pose((0.475, 0.0, 0.16))}
    assert _failure(settling, balanced) is None
    floating = {"brick_1": Pose((0.5, 0.0, 0.3)), "cube_1": Pose((0.54, 0.0, 0.345))}
    assert _failure(settling, floating) == UNSTABLE
    assert _failure(settling, floating, held="brick_1") is None
    assert _failure(settling, floating) == UNSTABLE  # what was held has its mass again


def test_a_relation_that_holds_only_while_an_object_floats_is_lost(settling):
    poses = {"brick_1": Pose((0.5, 0.0, 0.02)), "cube_1": Pose((0.5, 0.0, 0.0675))}
    apart, beside = (Fact(PREDICATES[name], ("cube_1", "brick_1"), False) for name in ("on_top", "left_of"))
    assert _failure(settling, poses, (apart, beside)) == UNSETTLED
    assert _failure(settling, poses, (beside,)) is None


def test_the_search_goes_on_where_a_witness_does_not_settle(tabletop, tabletop_validator, monkeypatch):
    """Switch the analytic check of support off, so that settling has to find what it would have refused."""
    from prag_asp.physics.search import moving

    monkeypatch.setattr(moving, "unsupported", lambda *_, **__: None)
    tower = task(
        state("on_top(brick_1,cube_1)", "on_top(can_1,brick_1)", "on_top(cube_1,table_1)", "on_top(cube_2,can_1)"),
        ("x(panda)", state("on_top(cube_1,table_1)")),
    )
    verdicts = [tabletop_validator.validate(tower, seed=seed, budget=Budget(20, 10, "settling")) for seed in range(8)]
    assert sum(verdict.causes.get(UNSTABLE, 0) for verdict in verdicts) >= 3
    assert sum(verdict.feasible for verdict in verdicts) >= 6


def test_a_budget_says_its_tier_and_knows_no_other(tabletop_validator):
    verdict = tabletop_validator.validate(stacking(), seed=1, budget=Budget(2, 3, "settling"))
    assert str(verdict.budget) == "2 x 3, settling" and verdict.feasible
    assert Verdict.from_json(verdict.to_json()).budget == verdict.budget
    with pytest.raises(QueryError, match="unknown tier of checks 'magic'; known are kinematics, settling"):
        Budget(2, 3, "magic")  # type: ignore[arg-type]
