"""Instructions are worded as a native speaker would word them, in any domain."""

from __future__ import annotations

from pathlib import Path

import pytest

from prag_asp import Task, TaskSpace, load_domain, parse_atom
from prag_asp.dataset.language import Instructions, InstructionWriter, instruction_writer_of
from prag_asp.grammar.template import RecurrenceWords
from tests.dataset.language.test_instructions import assert_read_back
from tests.dataset.language.twins import task_of, writer

PAINT = """
class((wall; robot)). entity((north; south), wall). entity(rob, robot).
fluent((painted(W); marked(W))) :- is_a(W,wall).
action((brush(W); roll(W); mark(W); dip(W))) :- is_a(W,wall).
postcondition((brush(W); roll(W); dip(W)), painted(W), true) :- is_a(W,wall).
postcondition(mark(W), marked(W), true) :- is_a(W,wall).
"""

PAINT_WORDS = """
[language]
brush = "paint {0} with the brush[ again]"
roll = "paint {0} with the roller[ again]"
dip = "immerse {0}[ again]"
"""

BOXES = """
class((robot; food; spot)). entity(panda, robot). entity(cake, food). entity((left; right), spot).
fluent(PLACED(O,P)) :- is_a(O,food), is_a(P,spot).   fluent(holding(R,O)) :- is_a(R,robot), is_a(O,food).
action((put(R,O,P); pick(R,O,P))) :- is_a(R,robot), fluent(PLACED(O,P)).
exclusive(PLACED(O,left), PLACED(O,right)) :- is_a(O,food).
precondition(pick(R,O,P), PLACED(O,P), true) :- action(pick(R,O,P)).
precondition(put(R,O,P), holding(R,O), true) :- action(put(R,O,P)).
postcondition(put(R,O,P), PLACED(O,P), true; put(R,O,P), holding(R,O), false) :- action(put(R,O,P)).
postcondition(pick(R,O,P), PLACED(O,P), false; pick(R,O,P), holding(R,O), true) :- action(pick(R,O,P)).
"""


def in_words(text: str, tables: Path, plan: str, settings: str = "") -> tuple[InstructionWriter, Task]:
    """Return the writer of a domain given as text, and the task with a plan."""
    tables.write_text(settings)
    space = TaskSpace(load_domain(text=text, settings=tables), len(plan.split()))
    return instruction_writer_of(space.domain), space[space.index(plan.split())]


def every(writer: InstructionWriter, task: Task, number: int = 8) -> list[Instructions]:
    """Return the instructions for several seeds; all are read back."""
    words = [writer.instructions(task, seed) for seed in range(number)]
    for each in words:
        if len(task.actions) > 1:
            assert_read_back(writer, task, each)
        assert writer.read(task, each.exact).actions == task.actions
    return words


def test_each_clause_of_a_goal_begins_with_that() -> None:
    plan = "pick(panda,can_1,table_1) insert(panda,can_1,bin_1) pick(panda,cube_1,table_1)"
    task = task_of("tabletop", *plan.split())
    for words in every(writer("tabletop"), task):
        assert words.vague.endswith("that the gripper is holding the red cube and that the can is in the bin.")
    comma = "Make sure that the gripper is holding the red cube, and the can is in the bin."
    assert writer("tabletop").read(task, comma).goal == writer("tabletop").goal(task), "people may leave it out"
    plan += " place(panda,cube_1,behind,bin_1) pick(panda,brick_1,table_1)"
    three = task_of("tabletop", *plan.split())
    for words in every(writer("tabletop"), three):
        assert words.vague.count("that ") == 3 and ", and that the " in words.vague


def test_a_comma_precedes_a_clause_after_one_that_has_and_in_it() -> None:
    space = TaskSpace(load_domain("examples/own_predicates"), 4)
    plan = "pick(panda,camera_1,tray_1) set(panda,camera_1,brick_1,cup_1) pick(panda,cup_2,table_1) left(panda,cup_2)"
    for words in every(instruction_writer_of(space.domain), space[space.index(plan.split())]):
        assert "the camera is on the table between the brick and the red cup, and that the blue cup" in words.vague


def test_two_of_several_things_share_a_predicate() -> None:
    plan = "pick(panda,can_1,tray_1) insert(panda,can_1,bin_1) pick(panda,cube_1,tray_1) insert(panda,cube_1,bin_1)"
    task = task_of("tabletop", *plan.split(), "pick(panda,brick_1,table_1)")
    for words in every(writer("tabletop"), task):
        assert "the yellow brick, and that both the can and the red cube are in the bin." in words.vague
    for words in every(writer("tabletop", "de"), task):
        assert "und sowohl die Dose als auch der rote Würfel in der Kiste sind." in words.vague


def test_an_action_that_repeats_another_says_again_at_its_end(tmp_path: Path) -> None:
    said = every(*in_words(PAINT, tmp_path / "domain.toml", "brush(north) brush(north)", PAINT_WORDS))
    assert {each.subgoals[1] for each in said} == {"Paint wall north with the brush again."}
    for plan in ("rotate(panda,can_1,straight) rotate(panda,can_1,straight)", "follow(panda,can_1,bowl_1) " * 2):
        for words in every(writer("prag"), task_of("prag", *plan.split())):
            assert all(
                text.endswith((" position again.", " to the bowl again.")) for text in (words.default, words.exact)
            )


def test_an_action_with_the_aim_of_another_one_says_what_differs(tmp_path: Path) -> None:
    tables = tmp_path / "domain.toml"
    said = every(*in_words(PAINT, tables, "brush(north) roll(north)", PAINT_WORDS))
    assert {each.subgoals[1] for each in said} == {"Paint wall north again, this time with the roller."}
    said = every(*in_words(PAINT, tables, "brush(north) dip(north)", PAINT_WORDS))
    assert {each.subgoals[1] for each in said} == {"Immerse wall north."}, "it was not immersed before"
    said = every(*in_words(PAINT, tables, "brush(north) roll(north)"))
    assert {each.subgoals[1] for each in said} == {"Roll wall north."}
    guided = task_of("prag", "move(panda,can_1,bowl_1)", "follow(panda,can_1,bowl_1)", "transform(panda,can_1,bowl_1)")
    for words in every(writer("prag"), guided):
        assert words.subgoals[1].endswith("the can to the bowl again, this time along the guide.")
        assert words.subgoals[2] == "Carry the can to the bowl again, this time along the preset path."


@pytest.mark.parametrize(
    ("text", "repeated", "varied"),
    [
        (
            "carry {1}[ back] to {2} along it now",
            "carry {1} to {2} along it now again",
            "carry {1} to {2} again: along it now",
        ),
        ("carry {1} on a path[ back] to {2}", "carry {1} on a path to {2} again", "carry {1} to {2} again: on a path"),
        ("put {0} down[ again]", "put {0} down again", "put {0} down again"),
    ],
)
def test_the_manner_of_a_sentence_comes_last_where_it_differs(text: str, repeated: str, varied: str) -> None:
    forms = RecurrenceWords("{action} again", "{action} again: {manner}", frozenset(["again"])).forms(text)
    assert next(form for form, uses in forms.items() if "repeated" in uses) == repeated
    assert next(form for form, uses in forms.items() if "varied" in uses) == varied
    german = RecurrenceWords(" noch einmal").forms(text)
    assert {form for form, uses in german.items() if uses & {"repeated", "varied"}} == {
        text.replace("[ back]", " noch einmal").replace("[ again]", " noch einmal")
    }


@pytest.mark.parametrize(
    ("predicate", "first", "later"),
    [
        ("lies", "Take the food from spot right.", "Take the food from spot right again."),
        ("inside", "Take the food back out of spot right.", "Take the food back out of spot right."),
    ],
)
def test_what_is_taken_from_a_place_for_the_first_time_is_not_taken_again(
    predicate: str, first: str, later: str, tmp_path: Path
) -> None:
    again = "put(panda,cake,right) pick(panda,cake,right)"
    text = BOXES.replace("PLACED", predicate)
    said = every(*in_words(text, tmp_path / "domain.toml", f"pick(panda,cake,left) {again} {again}"))
    assert {each.subgoals[2] for each in said} == {first} and {each.subgoals[4] for each in said} == {later}


def test_what_is_done_for_the_first_time_is_not_done_again(tmp_path: Path) -> None:
    text = """
    class(lamp). class(robot). entity(lamp, lamp). entity(rob, robot).
    fluent(lit(L)) :- is_a(L,lamp).
    action((light(L); dim(L))) :- is_a(L,lamp).
    precondition(light(L), lit(L), false; dim(L), lit(L), true) :- is_a(L,lamp).
    postcondition(light(L), lit(L), true; dim(L), lit(L), false) :- is_a(L,lamp).
    """
    said = every(*in_words(text, tmp_path / "domain.toml", "dim(lamp) light(lamp) dim(lamp)"))
    assert {each.subgoals for each in said} == {("Dim the lamp.", "Light the lamp.", "Dim the lamp again.")}
    sentences = '[language]\ndim = "dim {0}[ again]"\nlight = "light {0}[ again]"'
    said = every(*in_words(text, tmp_path / "domain.toml", "dim(lamp) light(lamp)", sentences))
    assert {each.subgoals[1] for each in said} == {"Light the lamp again."}, "where the author says so"


def test_a_block_is_taken_back_off_another() -> None:
    for words in every(writer("blocks"), task_of("blocks", "pick_up(a)", "stack(a,b)", "unstack(a,b)")):
        assert words.subgoals[2] in {"Take block A back off block B.", "Unstack block A from block B."}
    plan = "open(panda,drawer_1) close(panda,drawer_1)"
    for words in every(writer("kitchen"), task_of("kitchen", *plan.split())):
        assert words.subgoals[1] == "Close the drawer again."


def test_it_is_not_one_of_two_things_of_like_actions(tmp_path: Path) -> None:
    opened = task_of("kitchen", "open(panda,cupboard_1)", "open(panda,drawer_1)", "close(panda,drawer_1)")
    for words in every(writer("kitchen"), opened):
        assert "close the drawer again" in words.default
    again = task_of("kitchen", "open(panda,drawer_1)", "close(panda,drawer_1)", "open(panda,drawer_1)")
    assert all("open it again" in words.default for words in every(writer("kitchen"), again))
    moved = "move(disc(1),left,right) move(disc(2),left,middle) move(disc(2),middle,left)"
    for words in every(writer("hanoi"), task_of("hanoi", *moved.split())):
        assert " it from the right peg" in words.default, "disc 1 cannot be moved from there"
    said = every(*in_words(PAINT, tmp_path / "domain.toml", "brush(north) brush(south) mark(south)"))
    assert all("mark wall south" in each.default for each in said)
    said = every(*in_words(PAINT, tmp_path / "domain.toml", "brush(south) mark(south)"))
    assert all("mark it" in each.default for each in said)


def test_a_rotation_is_a_position_at_its_angle(tmp_path: Path) -> None:
    scene = Path("domains/prag/domain.toml").read_text()
    tables = tmp_path / "domain.toml"
    tables.write_text(scene[scene.index("[scene]") :].replace("quarter_turn = 90", "quarter_turn = -22.5"))
    space = TaskSpace(load_domain("domains/prag/domain.lp", settings=tables), 1)
    said = every(instruction_writer_of(space.domain), space[space.index(["rotate(panda,can_1,quarter_turn)"])])
    assert {each.subgoals for each in said} == {("Rotate the can to the -22.5-degree position.",)}
    for words in every(writer("prag"), task_of("prag", "rotate(panda,can_1,quarter_turn)")):
        assert words.vague.endswith("that the can is turned to the 90-degree position.")


def test_goals_about_the_gripper_and_places_say_what_the_predicates_mean() -> None:
    for words in every(writer("prag"), task_of("prag", "approach(panda,can_1)")):
        assert words.vague.endswith("that the gripper is around the can.") and "so that" not in words.exact
    for words in every(writer("prag"), task_of("prag", "move(panda,can_1,bowl_1)", "drop(panda,can_1)")):
        assert words.vague.endswith("that the can has been brought to the bowl and that the gripper is open.")
        assert "so that" not in words.exact, "what is dropped leaves an open gripper"


def test_a_place_and_what_is_beside_it_need_no_and() -> None:
    plan = "pick(panda,can_1,bin_1) place(panda,can_1,behind,tray_1)"
    for words in every(writer("tabletop"), task_of("tabletop", *plan.split())):
        assert words.vague.endswith("that the can is on the table behind the tray.")
    task = task_of("tabletop", *plan.split())
    both = writer("tabletop").read(task, "Make sure that the can is on the table and behind the tray.")
    assert both.goal == writer("tabletop").goal(task)
    plan += " pick(panda,cube_1,bin_1) place(panda,cube_1,left_of,can_1)"
    for words in every(writer("tabletop"), task_of("tabletop", *plan.split())):
        assert "the red cube is on the table to the left of the can" in words.vague


def test_what_another_fact_implies_or_says_is_no_part_of_a_goal() -> None:
    space = TaskSpace(load_domain("examples/own_predicates"), 2)
    writer_of_space = instruction_writer_of(space.domain)
    tuck = space[space.index(["pick(panda,cup_1,table_1)", "tuck(panda,cup_1,tray_1)"])]
    assert writer_of_space.goal(tuck) == {parse_atom("in_corner(cup_1,tray_1)"): True}, "implied by a state constraint"
    left = space[space.index(["pick(panda,cup_1,tray_1)", "left(panda,cup_1)"])]
    assert writer_of_space.goal(left) == {parse_atom("on_the_left(cup_1)"): True}, "the left side of the table"
    for task in (tuck, left):
        every(writer_of_space, task)


def test_joints_between_actions_do_not_repeat_their_words() -> None:
    plan = ["open(panda,drawer_1)", "close(panda,drawer_1)"] * 3
    for words in every(writer("kitchen"), task_of("kitchen", *plan), 40):
        for sentence in words.default.removeprefix("Your task: ").split(". "):
            assert sentence.count("then ") + sentence.startswith("Then ") <= 2
            assert not (sentence.startswith("Then ") and "then " in sentence)


def test_the_caption_of_an_initial_state_does_not_say_that_something_was_done() -> None:
    plan = "open(panda,cupboard_1) approach(panda,cup_1,cupboard_1) grasp(panda,cup_1) move(panda,cup_1,table_1)"
    end = "drop(panda,cup_1) withdraw(panda,cup_1) close(panda,cupboard_1)"
    task = task_of("kitchen", *plan.split(), *end.split())
    captions = writer("kitchen").captions(task)
    assert captions[0] == ("start", "the cup is in or above the cupboard")
    assert captions[4][1] == "the cup has been brought to the table"
    stated = writer("kitchen").read(task, "Make sure that the cup is on or above the table.")
    assert stated.goal == writer("kitchen").goal(task), "both sentences are read"
