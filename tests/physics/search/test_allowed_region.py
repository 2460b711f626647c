"""Only facts that hold and that a volume for the object expresses restrict its yaw."""

from __future__ import annotations

import pytest

from prag_asp.physics.predicates import PREDICATES
from prag_asp.physics.search.allowed_region import yaw_ranges
from prag_asp.physics.search.attempt import Failure
from prag_asp.physics.situation import Situation
from prag_asp.physics.symbolic_facts import Fact
from prag_asp.scene.geometry import Pose
from prag_asp.scene.scene import Scene, Shape

SCENE = Scene(
    shapes={name: Shape("box", (0.05, 0.05, 0.05)) for name in ("one", "two")},
    rotations={"straight": 0.0, "turned": 0.5},
)
SITUATION = Situation(SCENE, {"two": Pose((0.4, 0.0, 0.025))})


def fact(name: str, *arguments: str, value: bool = True) -> Fact:
    return Fact(PREDICATES[name], arguments, value)


def test_a_fact_that_does_not_hold_restricts_no_yaw() -> None:
    assert yaw_ranges(SITUATION, "one", [fact("rotated", "one", "straight", value=False)]) is None
    assert yaw_ranges(SITUATION, "one", [fact("on_top", "one", "two")]) is None
    held = yaw_ranges(SITUATION, "one", [fact("rotated", "one", "turned")])
    assert held is not None and [each.centre for each in held] == pytest.approx([0.5])
    denied = fact("rotated", "one", "straight", value=False)
    assert yaw_ranges(SITUATION, "one", [fact("rotated", "one", "turned"), denied]) == held


def test_yaws_that_exclude_each_other_fail() -> None:
    with pytest.raises(Failure):
        yaw_ranges(SITUATION, "one", [fact("rotated", "one", "turned"), fact("rotated", "one", "straight")])


def test_an_aligned_object_may_have_four_yaws_whichever_object_is_named_first() -> None:
    first = yaw_ranges(SITUATION, "one", [fact("aligned", "one", "two")])
    assert first is not None and len(first) == 4
    assert yaw_ranges(SITUATION, "one", [fact("aligned", "two", "one")]) == first
