"""How sentences and proofs name things: entities in words, and the gripper where there are several."""

from __future__ import annotations

import pytest

from prag_asp.atom import parse_atom
from prag_asp.physics.proofs.prover import Prover
from prag_asp.physics.proofs.schemas import _in_variables
from prag_asp.physics.symbolic_facts import Fact, facts
from prag_asp.scene.scene import Mount, Scene, Shape
from prag_asp.wording import plural

SHAPES = {
    "left_arm": Shape("robot"),
    "right_arm": Shape("robot"),
    "cube_1": Shape("box", (0.05, 0.05, 0.05)),
    "cube_2": Shape("box", (0.05, 0.05, 0.05)),
    "big_box": Shape("box", (0.2, 0.2, 0.2)),
    "red_ball": Shape("sphere", (0.05, 0.05, 0.05)),
    "my_tray": Shape("container", (0.15, 0.15, 0.04), 0.006),
}
ARMS = {"left_arm": Mount("panda", 0.0, 0.4), "right_arm": Mount("panda", 0.0, -0.4)}
ONE = Scene(shapes=SHAPES, rotations={"quarter_turn": 1.57, "straight": 0.0})
TWO = Scene(shapes=SHAPES, robots=ARMS)


def known(scene: Scene, *fluents: str) -> tuple[Fact, ...]:
    return facts(scene, dict.fromkeys(map(parse_atom, fluents), True))


@pytest.mark.parametrize(
    ("fluent", "one", "several"),
    [
        ("holding(left_arm,cube_1)", "cube 1 is held by the gripper", "cube 1 is held by the left arm gripper"),
        ("at(left_arm,cube_1)", "the gripper is at cube 1", "the left arm gripper is at cube 1"),
        ("gripper_open(right_arm)", "the gripper is open", "the right arm gripper is open"),
        ("reachable(right_arm,cube_1)", "cube 1 is within reach", "cube 1 is within reach of the right arm gripper"),
    ],
)
def test_a_sentence_says_which_gripper_it_means_where_there_are_several(fluent: str, one: str, several: str) -> None:
    assert [fact.sentence() for fact in known(ONE, fluent)] == [one]
    assert [fact.sentence() for fact in known(TWO, fluent)] == [several]
    (fact,) = known(TWO, fluent)
    assert fact._replace(value=False).sentence() == several.replace(" is ", " is not ")
    assert known(TWO, fluent) == known(TWO, fluent)


@pytest.mark.parametrize(
    ("fluents", "reason"),
    [
        (("holding(left_arm,big_box)",), "big box is 200 mm wide, but the {}gripper opens only to 80 mm"),
        (
            ("holding(left_arm,cube_1)", "holding(left_arm,cube_2)"),
            "the {}gripper cannot hold cube 1 and cube 2 at once",
        ),
        (("holding(left_arm,cube_1)", "gripper_open(left_arm)"), "the {}gripper cannot be open while it holds cube 1"),
        (("inside(cube_1,cube_2)",), "cube 2 is not a container, so cube 1 cannot be in it"),
        (("inside(big_box,my_tray)",), "big box is larger than the cavity of my tray"),
        (("on_top(cube_1,red_ball)",), "nothing rests on red ball, which is a ball"),
        (("near(cube_1,cube_2)", "far(cube_1,cube_2)"), "cube 1 and cube 2 cannot be near and far at once"),
        (("left_of(cube_1,cube_2)", "left_of(cube_2,cube_1)"), "the relations along y form a cycle: cube 1, cube 2"),
    ],
)
def test_a_proof_names_things_as_sentences_do(fluents: tuple[str, ...], reason: str) -> None:
    for scene, gripper in ((ONE, ""), (TWO, "left arm ")):
        said = Prover(scene).refutation(known(scene, *fluents))
        assert said is not None
        assert said.replace("cube 2, cube 1", "cube 1, cube 2") == reason.format(gripper)


def test_ways_to_be_turned_are_named_in_words() -> None:
    both = known(ONE, "rotated(cube_1,straight)", "rotated(cube_1,quarter_turn)")
    assert Prover(ONE).refutation(both) == "cube 1 cannot be turned straight and quarter turn at once"


def test_variables_replace_whole_names_in_a_reason() -> None:
    reason = "the gripper cannot hold cube and cube 2 at once"
    assert _in_variables(reason, ("cube", "cube_2")) == "the gripper cannot hold X and Y at once"
    assert _in_variables(reason, ("cube_2", "cube")) == "the gripper cannot hold Y and X at once"
    assert _in_variables(reason, ()) == reason


def test_one_of_something_is_singular() -> None:
    assert [plural(number, "task") for number in (0, 1, 2)] == ["0 tasks", "1 task", "2 tasks"]
    assert [plural(number, "entity", "entities") for number in (1, 3)] == ["1 entity", "3 entities"]
