"""Shipped domains that are read once, and a domain in which little tells things apart.

It has red cubes of two sizes, balls, and trays of one colour to the left and to the right.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

from prag_asp import Domain, TaskSpace, load_domain
from prag_asp.dataset.language import InstructionWriter, instruction_writer_of
from prag_asp.task import Task

LOGIC = """
class(robot).   class(table).   class(tray).   class(item).
class(cube, item).   class(big, cube).   class(ball, item).
entity(panda, robot).   entity(table_1, table).   entity((cube_1; cube_2), cube).   entity(cube_3, big).
entity((ball_1; ball_2), ball).   entity((tray_1; tray_2), tray).

fluent(holding(R,O)) :- is_a(R,robot), is_a(O,item).
rests(on_top(O,T), O, T) :- is_a(O,item), is_a(T,table).
rests(inside(O,T), O, T) :- is_a(O,item), is_a(T,tray).
fluent(F) :- rests(F,_,_).
exclusive(F, G) :- rests(F,O,_), rests(G,O,_), F < G.
exclusive(F, holding(R,O)) :- rests(F,O,_), fluent(holding(R,O)).
exclusive(holding(R,O), holding(R,P)) :- fluent(holding(R,O)), fluent(holding(R,P)), O < P.
initially(holding(R,O), false) :- fluent(holding(R,O)).

action(pick(R,O,P)) :- is_a(R,robot), rests(_,O,P).
precondition(pick(R,O,P), F, true) :- action(pick(R,O,P)), rests(F,O,P).
precondition(pick(R,O,P), holding(R,Q), false) :- action(pick(R,O,P)), fluent(holding(R,Q)).
postcondition(pick(R,O,P), F, false) :- action(pick(R,O,P)), rests(F,O,P).
postcondition(pick(R,O,P), holding(R,O), true) :- action(pick(R,O,P)).
action(put(R,O,P)) :- is_a(R,robot), rests(_,O,P).
precondition(put(R,O,P), holding(R,O), true) :- action(put(R,O,P)).
postcondition(put(R,O,P), holding(R,O), false) :- action(put(R,O,P)).
postcondition(put(R,O,P), F, true) :- action(put(R,O,P)), rests(F,O,P).
"""

SETTINGS = """
[language]
pick = ["take {1} from {2}", "fetch {1} from {2}"]
put = "put {1} on {2}"

[language.en.nouns]
big = "cube"

[scene]
robot = "panda"
frame = "viewer"
[scene.shapes]
robot = { kind = "robot" }
table = { kind = "table" }
cube = { kind = "box", size = [0.04, 0.04, 0.04] }
big = { kind = "box", size = [0.06, 0.06, 0.06] }
ball = { kind = "sphere", radius = 0.03 }
tray = { kind = "container", size = [0.24, 0.20, 0.035] }
[scene.fixed]
tray_1 = [0.5, 0.3, 90]
tray_2 = [0.5, -0.3, 90]
[scene.colors]
cube = "#d7263d"
ball_1 = "#d7263d"
ball_2 = "#2e86ab"
"""


@cache
def shipped(name: str) -> Domain:
    """Read a shipped domain once for all tests."""
    return load_domain(name)


@cache
def writer(name: str, language: str = "en") -> InstructionWriter:
    """Return a writer of a shipped domain, for all tests."""
    return instruction_writer_of(shipped(name), language)


@cache
def space_of(name: str, length: int) -> TaskSpace:
    """Return a space of a shipped domain, for all tests."""
    return TaskSpace(shipped(name), 4) if length == 4 else space_of(name, 4).at(length)


def task_of(name: str, *actions: str) -> Task:
    """Return a task of a shipped domain by its actions."""
    space = space_of(name, len(actions))
    return space[space.index(actions)]


@cache
def twins(settings: str = SETTINGS) -> TaskSpace:
    """Return the tasks of length 4 of that domain, which is read once."""
    with TemporaryDirectory() as folder:
        (Path(folder) / "domain.lp").write_text(LOGIC)
        (Path(folder) / "domain.toml").write_text(settings)
        return TaskSpace(load_domain(folder), 4)
