"""Instructions that somebody writes: read where they mean one plan, and refused in one line where they do not."""

from __future__ import annotations

import pytest

from prag_asp import QueryError, Task, TaskSpace, parse_atom
from prag_asp.dataset.language import InstructionContext, InstructionWriter, read_instruction
from prag_asp.task import FrozenDict
from tests.dataset.language.twins import shipped, task_of
from tests.dataset.language.twins import writer as instruction_writer_of


@pytest.fixture(scope="module")
def writer() -> InstructionWriter:
    return instruction_writer_of("tabletop")


@pytest.fixture(scope="module")
def task() -> Task:
    return task_of("tabletop", "pick(panda,cube_1,table_1)", "stack(panda,cube_1,brick_1)")


@pytest.mark.parametrize(
    "text",
    [
        "Grab the red cube from the table, then stack it on the yellow brick.",
        "grab the red cube from the table. Then put the red cube on top of the yellow brick.",
        "  Please grab the red block from the table, and then\n stack it on the yellow block. ",
        "Your task: grab the red cube that is on the table from the table, then stack it on the yellow brick.",
        "First, grab the red cube from the table. Second, stack the red cube on the yellow brick.",
        "FIRST, grab the red cube from the table, so that the gripper is holding it. Second, stack the cube on "
        "the table on the yellow brick, so that the red cube is on the yellow brick and that the gripper is not "
        "holding it.",
    ],
)
def test_other_words_for_the_same_are_read(writer: InstructionWriter, task: Task, text: str) -> None:
    state = FrozenDict({**task.initial, parse_atom("on_top(cube_2,table_1)"): False})
    assert writer.read(InstructionContext(frozenset(task.entities), state), text).actions == task.actions


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (
            "Grab the cube from the table.",
            "^'the cube' may be cube_1 or cube_2; state its colour, size or place$",
        ),
        (
            "Grab the purple cube from the table.",
            "^'the purple cube' fits no object that is present; name another one$",
        ),
        (
            "Please grab the can from the table, then insert the cube into the tray.",
            "^'the cube' may be cube_1 or cube_2",
        ),
        ("Make sure that the cube is in the tray.", "^'the cube' may be cube_1 or cube_2"),
        ("First, grab the cube from the table.", "^'the cube' may be cube_1 or cube_2"),
        (
            "Grab the pink cube from the table.",
            "^'Grab the pink cube from the table' is not a sentence of tabletop in English",
        ),
        ("Grab the can from the table, then dance.", "^'dance' is not a sentence of tabletop in English; write one as"),
        ("Grab it from the table.", "^'Grab it from the table' is not a sentence"),
        ("Grab the red cube from the table", "is not an instruction"),
        ("First, grab the red cube from the table, so that the robot is not holding it.", "does not make holding"),
        ("x" * 200_000, "at most 100,000 characters"),
    ],
)
def test_what_means_no_plan_is_told(writer: InstructionWriter, task: Task, text: str, told: str) -> None:
    with pytest.raises(QueryError, match=told) as error:
        writer.read(task, text)
    assert "\n" not in str(error.value)


def test_the_domain_alone_is_enough(task: Task) -> None:
    text = "Make sure that the red cube is on the yellow brick."
    reading = read_instruction(shipped("tabletop"), task, text)
    assert [str(fluent) for fluent in reading.goal] == ["on_top(cube_1,brick_1)"] and not reading.actions
    german = "Sorge dafür, dass der rote Würfel auf dem gelben Klotz ist."
    assert read_instruction(shipped("tabletop"), task, german, language="de") == reading


def test_a_state_of_something_unknown_is_refused(writer: InstructionWriter, task: Task) -> None:
    strange = FrozenDict({**task.entities, "cube_7": "cube"})
    other = Task(task.domain, task.actions, strange, task.initial, task.states, task.subgoals, task.goal)
    with pytest.raises(QueryError, match="tabletop has no entity cube_7; did you mean cube_"):
        writer.read(other, "Grab the red cube from the table.")


def test_a_plan_of_hundreds_of_actions_is_read() -> None:
    space = TaskSpace(shipped("hanoi"), 700)
    (task,) = space.sample(1, seed=5)
    told = instruction_writer_of("hanoi").instructions(task)
    assert instruction_writer_of("hanoi").read(task, told.default).actions == task.actions
    assert instruction_writer_of("hanoi").read(task, told.exact).actions == task.actions


@pytest.mark.parametrize(
    "text",
    ["the " * 20_000, "Place " + "the can to the left of " * 4_000, "grab the can, then " * 5_000, "First, " * 10_000,
     "Make sure that " + "the can is in the tray and that " * 3_000],
)  # fmt: skip
def test_endless_texts_are_refused_at_once(writer: InstructionWriter, task: Task, text: str) -> None:
    with pytest.raises(QueryError, match=r"not a sentence|not an instruction"):
        writer.read(task, text)
