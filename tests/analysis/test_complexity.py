"""The complexity of a task is what a reader of its plan and a list of all plans find."""

from __future__ import annotations

import json
from math import log2
from pathlib import Path

import pytest

from prag_asp import QueryError, TaskSpace, load_domain
from prag_asp.analysis import ComplexityMeasure, complexity_of
from tests.analysis.orbit_spaces import orbit_spaces
from tests.chance import Chance
from tests.commands import ok, run

BLOCKS = TaskSpace(load_domain("blocks"), 6)


def test_choices_are_those_of_a_list_of_all_plans(chance: Chance) -> None:
    for case, space, _ in orbit_spaces(chance, 4, 3):
        plans, measure = set(space.enumerate("plan")), ComplexityMeasure(space)
        for task in space:
            plan = tuple(map(str, task.actions))
            expected = tuple(len({each[: k + 1] for each in plans if each[:k] == plan[:k]}) for k in range(3))
            found = measure.of(task)
            assert found.choices == expected, case.text()
            assert found.bits == pytest.approx(sum(map(log2, expected)))
            assert 0 <= found.detour == 3 - found.shortest


def test_changes_that_are_undone_and_the_detour_are_those_of_a_plan_in_words() -> None:
    plan = ["pick_up(a)", "put_down(a)", "pick_up(b)", "stack(b,c)", "pick_up(a)", "stack(a,d)"]
    found = complexity_of(BLOCKS[BLOCKS.index(plan)], BLOCKS)
    assert (found.length, found.entities, found.shortest, found.detour) == (6, 4, 4, 2)
    # a: clear 4 times, on_table 3, holding 4; b: clear 2, on_table 1, holding 2; the hand 6; clear(c), clear(d), on: 1
    assert found.undone == 3 + 2 + 3 + 1 + 0 + 1 + 5
    assert complexity_of(BLOCKS.at(1)[0], BLOCKS).undone == 0


def test_conditions_restrict_the_choices_but_not_the_shortest_plans() -> None:
    space = TaskSpace(load_domain("prag"), 4).where("begins grasp", "lacks follow", "has at least 2 rotate")
    found = complexity_of(space[0], space)
    assert found.choices[0] == 4 and found.shortest < 4 and found.detour > 0


def test_a_task_of_another_space_is_refused_and_the_command_prints_the_figures() -> None:
    for other in (TaskSpace(load_domain("blocks"), 6).where("begins pick_up(b)"), BLOCKS.where("uses at most 0 block")):
        with pytest.raises(QueryError, match="no task of blocks"):
            ComplexityMeasure(other).of(BLOCKS[0])
    assert "detour             4" in ok("task", "blocks", "-n", "4", "--index", "0", "--complexity")
    refused = run("task", "blocks", "-n", "4", "--rank-of", "pick_up(a)", "--complexity")
    assert refused.returncode == 2 and "--complexity goes with --index" in refused.stderr


def test_the_complexity_of_all_tasks_of_a_file_is_summed_up(tmp_path: Path) -> None:
    file, space = tmp_path / "tasks.jsonl", ("blocks", "-n", "4")
    file.write_text(ok("enumerate", *space, "--format", "jsonl"))
    rows = json.loads(ok("diversity", *space, "--tasks", str(file), "--complexity", "--format", "json"))["tasks"]
    measure = ComplexityMeasure(BLOCKS.at(4))
    assert [row["detour"] for row in rows] == [measure.of(task).detour for task in BLOCKS.at(4)]
    lines = ok("diversity", *space, "--tasks", str(file), "--complexity").splitlines()
    assert lines[0].split() == ["11", "tasks", "min", "mean", "max"]
    mean = sum(row["detour"] for row in rows) / 11
    assert lines[-1].split() == ["detour", "0", f"{mean:.2f}", "4"]
    verdict = {"status": "feasible", "restarts": 3, "causes": {"the arm collides": 5}}
    first = {**json.loads(file.read_text().splitlines()[0]), "verdict": verdict, "witness": None}
    file.write_text(f"{json.dumps(first)}\n")
    text = ok("diversity", *space, "--tasks", str(file), "--complexity")
    assert "initial states tried" in text and text.splitlines()[-1].split() == ["the", "arm", "collides", "5"]
    assert run("diversity", *space, "--complexity").returncode == 2
