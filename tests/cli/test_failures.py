"""A sample that finds too few feasible tasks says why, and what to do about that."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import pytest

from prag_asp.cli.commands.sample import _remedy
from prag_asp.dataset.pass_rates import Tally
from prag_asp.physics.predicates import PREDICATES
from prag_asp.physics.search.attempt import ARM_COLLIDES, NO_GRASP, NOT_REACHED, OBJECTS_COLLIDE, PhysicsFault
from prag_asp.physics.search.failures import FailureLog
from prag_asp.physics.symbolic_facts import Fact, physical_task
from prag_asp.scene.scene_loader import parse_scene
from tests.commands import run
from tests.physics.scenarios import state, task

LOGIC = """
class(robot). class(table). class(thing). class(crate).
entity(panda,robot). entity(table_1,table). entity(crate_1,crate). entity((a;b;c;d),thing).
fluent(inside(O,crate_1)) :- is_a(O,thing).
fluent(holding(R,O)) :- is_a(R,robot), is_a(O,thing).
initially(holding(R,O),false) :- fluent(holding(R,O)).
initially(inside(O,crate_1),true) :- is_a(O,thing).
action(pick(R,O)) :- is_a(R,robot), is_a(O,thing).
precondition(pick(R,O),inside(O,crate_1),true) :- action(pick(R,O)).
postcondition(pick(R,O),holding(R,O),true) :- action(pick(R,O)).
postcondition(pick(R,O),inside(O,crate_1),false) :- action(pick(R,O)).
exclusive(inside(O,C),holding(R,O)) :- fluent(inside(O,C)), fluent(holding(R,O)).
"""
SCENE = """
[scene]
workspace = { x = [0.30, 0.70], y = [-0.40, 0.40] }
[scene.shapes]
robot = { kind = "robot" }
table = { kind = "table" }
thing = { kind = "box", size = [0.05, 0.05, 0.05] }
CRATE
[scene.fixed]
crate_1 = [0.5, 0.1]
"""


def said(folder: Path, crate: str, *more: str) -> str:
    """What a sample of two draws ends with, of four cubes in a crate that is filled with them."""
    (folder / "domain.lp").write_text(LOGIC)
    (folder / "domain.toml").write_text('title = "Crate"\n' + SCENE.replace("CRATE", f"crate = {crate}"))
    done = run(
        "sample",
        str(folder),
        "--length",
        "1",
        "--count",
        "1",
        "--max-draws",
        "2",
        "--seed",
        "1",
        "--budget",
        "4x2",
        *more,
    )
    assert done.returncode == 1 and done.stdout == ""
    return done.stderr.splitlines()[-1]


def test_proofs_are_not_followed_by_the_advice_to_sample_more(tmp_path: Path) -> None:
    last = said(tmp_path, '{ kind = "box", size = [0.2, 0.2, 0.05] }')
    assert last.startswith("only 0 of 1 task found in 2 draws; all are proved infeasible, because ")
    assert "crate 1 is not a container" in last and "--max-draws" not in last


def test_what_came_nearest_to_working_is_told(tmp_path: Path) -> None:
    last = said(tmp_path, '{ kind = "container", size = [0.118, 0.118, 0.056], wall = 0.006 }')
    start = "only 0 of 1 task found in 2 draws; nearest to working: at action 1 of 1, pick(panda,"
    assert last.startswith(start) and f"{ARM_COLLIDES} (" in last
    assert last.endswith("; raise --budget or --max-draws")


def test_without_any_grasp_the_advice_is_to_count_grasps() -> None:
    tally = Tally(seen=2, reasons=Counter({("not_found", "no grasp"): 2}), nearest="at action 1 of 2")
    tally.causes[NO_GRASP] += 48
    assert _remedy(tally).endswith("; see prag-asp check, which counts the grasps of each body from a file")
    tally.causes[ARM_COLLIDES] += 1
    assert _remedy(tally).endswith("; raise --budget or --max-draws")


@pytest.mark.parametrize(
    ("attempts", "expected"),
    [
        ([], ""),
        ([(OBJECTS_COLLIDE, -1), (OBJECTS_COLLIDE, -1)], "in the initial state objects collide (cube_1)"),
        ([(OBJECTS_COLLIDE, -1), (ARM_COLLIDES, 1), (NO_GRASP, 0)], "at action 2 of 2, put(panda,cube_1), "),
        ([(NO_GRASP, 1), (ARM_COLLIDES, 1), (ARM_COLLIDES, 1)], f"put(panda,cube_1), {ARM_COLLIDES} (cube_1)"),
        ([(ARM_COLLIDES, 1), (NOT_REACHED, 2)], f"after all 2 actions {NOT_REACHED} (cube_1)"),
    ],
)  # fmt: skip
def test_the_farthest_attempts_count(attempts: list[tuple[str, int]], expected: str) -> None:
    scene = parse_scene({"shapes": {"panda": {"kind": "robot"}, "cube_1": {"kind": "box", "size": [0.05] * 3}}}, {},
                        {"panda": "panda", "cube_1": "cube_1"})  # fmt: skip
    request = task(
        state("-holding(panda,cube_1)"),
        ("pick(panda,cube_1)", state("holding(panda,cube_1)")),
        ("put(panda,cube_1)", state("-holding(panda,cube_1)")),
    )
    log = FailureLog()
    for cause, done in attempts:
        log.add(PhysicsFault(cause, ("cube_1",)), done)
    nearest = log.nearest(physical_task(request, scene).effects)
    assert expected in nearest and bool(expected) == bool(nearest)
    assert sum(log.faults.values()) == len(attempts)


def test_a_fact_that_failed_is_told_in_words() -> None:
    log = FailureLog()
    log.add(PhysicsFault(NOT_REACHED, ("a", "b"), Fact(PREDICATES["left_of"], ("a", "b"), True)), -1)
    assert log.nearest(()) == f"in the initial state {NOT_REACHED} (a is to the left of b)"
