"""Hand-made tasks of the shipped domains, written from their rules."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from prag_asp.atom import Atom, parse_atom
from prag_asp.physics.witness import Moment
from prag_asp.scene.scene import Shape
from prag_asp.task import Task

STUDIO = Path(__file__).parents[2] / "examples" / "own_predicates"
STUDIO_SHAPES = {
    "panda": Shape("robot"),
    "table_1": Shape("table"),
    "cup_1": Shape("cylinder", (0.06, 0.06, 0.08)),
    "cup_2": Shape("cylinder", (0.06, 0.06, 0.08)),
    "brick_1": Shape("box", (0.11, 0.05, 0.04)),
    "camera_1": Shape("box", (0.1, 0.05, 0.06)),
}

CLASSES = {
    "panda": "robot",
    "table_1": "table",
    "cube_1": "cube",
    "cube_2": "cube",
    "brick_1": "brick",
    "brick_2": "brick",
    "can_1": "can",
    "tray_1": "tray",
    "bin_1": "bin",
    "apple_1": "apple",
    "apple_2": "apple",
    "box_1": "box",
    "bowl_1": "bowl",
    "crate_1": "crate",
    "cup_1": "cup",
    "drawer_1": "drawer",
    "cupboard_1": "cupboard",
}

HANDOVER = (
    "pick(left,bar_1,left_side)",
    "move(left,middle)",
    "move(right,middle)",
    "give(left,right,bar_1)",
    "move(left,left_side)",
    "move(right,right_side)",
    "place(right,bar_1,right_side)",
)
GIVE = HANDOVER.index("give(left,right,bar_1)")
"""A plan of two_arms, and which of its actions hands the bar over."""


def with_arm(moment: Moment, **changes: object) -> Moment:
    """Return a moment of one robot with its arm changed."""
    [(robot, arm)] = moment.arms.items()
    return replace(moment, arms={robot: replace(arm, **changes)})


def state(*fluents: str) -> dict[Atom, bool]:
    """Return a state: fluents that hold, those that do not with a minus in front."""
    return {parse_atom(fluent.lstrip("-")): not fluent.startswith("-") for fluent in fluents}


def task(initial: dict[Atom, bool], *steps: tuple[str, dict[Atom, bool]], forget: tuple[str, ...] = ()) -> Task:
    """Return a task from its initial state, and each action with what it makes known."""
    actions, subgoals, states, known = [], [], [], dict(initial)
    for text, subgoal in steps:
        known = {f: v for f, v in known.items() if str(f) not in forget}
        known.update(subgoal)
        actions.append(parse_atom(text))
        subgoals.append(subgoal)
        states.append(dict(known))
    named = {entity for s in [initial, *states] for fluent in s for entity in fluent.arguments}
    named |= {entity for action in actions for entity in action.arguments}
    entities = {entity: CLASSES[entity] for entity in sorted(named & CLASSES.keys())}
    return Task("test", tuple(actions), entities, initial, tuple(states), tuple(subgoals), {})


def stacking() -> Task:
    """Pick a cube from the table and stack it on a brick."""
    return task(
        state("on_top(cube_1,table_1)", "-holding(panda,cube_1)", "reachable(panda,cube_1)"),
        ("pick(panda,cube_1,table_1)", state("holding(panda,cube_1)", "-on_top(cube_1,table_1)")),
        ("stack(panda,cube_1,brick_1)", state("-holding(panda,cube_1)", "on_top(cube_1,brick_1)")),
    )


def carrying(thing: str = "apple_1") -> Task:
    """Fetch a thing into the bowl, turn it, let it go and leave."""
    gone = state(f"-at(panda,{thing})", "open(panda)")
    return task(
        gone,
        (f"approach(panda,{thing})", state(f"at(panda,{thing})")),
        (f"grasp(panda,{thing})", state(f"holding(panda,{thing})", "-open(panda)")),
        (f"move(panda,{thing},bowl_1)", state(f"located({thing},bowl_1)", f"-located({thing},crate_1)")),
        (f"rotate(panda,{thing},straight)", state(f"rotated({thing},straight)")),
        (f"drop(panda,{thing})", state(f"-holding(panda,{thing})", "open(panda)")),
        (f"withdraw(panda,{thing})", state(f"-at(panda,{thing})")),
    )
