"""Write a small domain as a starting point. It passes all checks, and its tasks are feasible."""

from __future__ import annotations

import re
from pathlib import Path

from prag_asp.errors import DomainError
from prag_asp.output import new_folder, replace_file
from prag_asp.program.paths import shipped_domains

NAME = re.compile(r"[A-Za-z][A-Za-z0-9_-]*")

LOGIC = """\
% {name}: a panda puts two cubes onto a table and into a tray.
%
% Try:  prag-asp check {name}
%       prag-asp count {name} --length 4
%       prag-asp sample {name} --length 4 --count 5 --seed 1

% Classes and entities -------------------------------------------------------------------------------------

class(robot).
class(table).
class(cube).
class(tray).

entity(panda, robot).
entity(table_1, table).
entity((cube_1; cube_2), cube).
entity(tray_1, tray).

% Fluents --------------------------------------------------------------------------------------------------

% Physics gives these four a meaning by their names.
fluent(holding(R,O))   :- is_a(R,robot), is_a(O,cube).
fluent(reachable(R,O)) :- is_a(R,robot), is_a(O,cube).
fluent(on_top(O,T))    :- is_a(O,cube), is_a(T,table).
fluent(inside(O,T))    :- is_a(O,cube), is_a(T,tray).

% Invariants: a cube is at one place, and a hand holds one cube.
place(on_top(O,T), O, T) :- fluent(on_top(O,T)).
place(inside(O,T), O, T) :- fluent(inside(O,T)).
exclusive(F, G)                       :- place(F,O,_), place(G,O,_), F < G.
exclusive(F, holding(R,O))            :- place(F,O,_), fluent(holding(R,O)).
exclusive(holding(R,O), holding(R,P)) :- fluent(holding(R,O)), fluent(holding(R,P)), O < P.

% Initial state and goal -----------------------------------------------------------------------------------

% Fluents without an initial value are open: they take the values that the first actions need.
initially(holding(R,O), false) :- fluent(holding(R,O)).

% A goal is optional: plans that do not reach it are not counted.
% goal(inside(cube_1,tray_1), true).

% Actions --------------------------------------------------------------------------------------------------

% pick(R,O,T): robot R takes cube O from T.
action(pick(R,O,T))                             :- is_a(R,robot), place(_,O,T).
precondition(pick(R,O,T), F, true)              :- action(pick(R,O,T)), place(F,O,T).
precondition(pick(R,O,T), reachable(R,O), true) :- action(pick(R,O,T)).
precondition(pick(R,O,T), holding(R,P), false)  :- action(pick(R,O,T)), fluent(holding(R,P)).
postcondition(pick(R,O,T), holding(R,O), true)  :- action(pick(R,O,T)).
postcondition(pick(R,O,T), F, false)            :- action(pick(R,O,T)), place(F,O,T).

% put(R,O,T): robot R puts cube O onto the table or into the tray.
action(put(R,O,T))                              :- is_a(R,robot), place(_,O,T).
precondition(put(R,O,T), holding(R,O), true)    :- action(put(R,O,T)).
postcondition(put(R,O,T), holding(R,O), false)  :- action(put(R,O,T)).
postcondition(put(R,O,T), F, true)              :- action(put(R,O,T)), place(F,O,T).
postcondition(put(R,O,T), reachable(R,O), true) :- action(put(R,O,T)).

% Rules of a step --------------------------------------------------------------------------------------------

% The step is t, and the step before it is t-1. This rule forbids to pick a cube up right after it was put down.
#program step(t).
:- occurs(put(R,O,T),t-1), occurs(pick(R,O,T),t).
"""

SETTINGS = """\
title = "{name}"
description = "A panda puts two cubes onto a table and into a tray."

[weights]               # for sampling: of actions, pairs of actions, classes and entities; the default is 1
put = 1
"put>pick" = 1
cube_1 = 1

[language]              # sentences of actions; {{0}}, {{1}}, ... are the arguments
pick = "pick {{1}} from {{2}}"
put = "put {{1}} to {{2}}"

[scene]                 # for physics; without this table, tasks are not simulated
robot = "panda"
workspace = {{ x = [0.30, 0.70], y = [-0.45, 0.45] }}

[scene.shapes]          # metres
robot = {{ kind = "robot" }}
table = {{ kind = "table" }}
cube = {{ kind = "box", size = [0.05, 0.05, 0.05] }}
tray = {{ kind = "container", size = [0.26, 0.20, 0.035], wall = 0.006 }}

[scene.fixed]           # x, y in metres, yaw in degrees
tray_1 = [0.47, 0.26, 90]
"""


def write_new_domain(name: str, parent: Path = Path()) -> Path:
    """Write a small domain as a starting point into a new folder `name` in `parent`, and return the folder.

    Raises:
        DomainError: the name is invalid, or the folder exists.
        OutputError: the folder cannot be written; in this case it is not created.
    """
    folder = parent / name
    if not NAME.fullmatch(Path(name).name) or name.endswith(("/", "\\")):
        raise DomainError(f"{name!r} cannot name a domain; begin with a letter and go on with letters, digits, - and _")
    if folder.name in shipped_domains():
        raise DomainError(f"{folder.name}: a shipped domain has this name; choose another")
    if folder.exists():
        raise DomainError(f"{folder}: exists already; choose another name, or remove it first")
    texts = {"domain.lp": LOGIC, "domain.toml": SETTINGS}
    with new_folder(folder) as part:
        for file, text in texts.items():
            replace_file(part / file, text.format(name=folder.name).encode(), follow=False)
    return folder
