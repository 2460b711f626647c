from __future__ import annotations

from prag_asp.physics import Budget
from prag_asp.physics.search.foresight import foresee
from prag_asp.physics.symbolic_facts import physical_task
from tests.physics.scenarios import state, task

ROW = task(
    state("inside(can_1,tray_1)", "inside(cube_2,tray_1)"),
    ("pick(panda,can_1,tray_1)", state("holding(panda,can_1)", "-inside(can_1,tray_1)")),
    (
        "place(panda,can_1,behind,tray_1)",
        state("-holding(panda,can_1)", "on_top(can_1,table_1)", "behind(can_1,tray_1)"),
    ),
    ("pick(panda,cube_2,tray_1)", state("holding(panda,cube_2)", "-inside(cube_2,tray_1)")),
    (
        "place(panda,cube_2,behind,can_1)",
        state("-holding(panda,cube_2)", "on_top(cube_2,table_1)", "behind(cube_2,can_1)"),
    ),
    forget=("on_top(can_1,table_1)",),
)


def test_an_object_leaves_room_for_what_is_put_beside_it_later(tabletop):
    ample, enough = foresee(physical_task(ROW, tabletop), tabletop)[2, "can_1"]
    low = tabletop.workspace[0]
    assert ample.low[0] > enough.low[0] > low + 0.025  # behind is nearer to the robot for a viewer
    assert enough.high == (float("inf"),) * 3


def test_what_nothing_is_put_beside_is_free(tabletop):
    assert (4, "cube_2") not in foresee(physical_task(ROW, tabletop), tabletop)


def test_a_row_that_just_fits_is_found_at_once(tabletop_validator):
    verdicts = [tabletop_validator.validate(ROW, seed=seed, budget=Budget(3, 10)) for seed in range(10)]
    assert sum(verdict.feasible for verdict in verdicts) >= 9
