"""The files of new domains: one for a robot, and one without. `{name}` is the name of the domain."""

from __future__ import annotations

ROBOT_LOGIC = """\
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

% Physics knows the meaning of these four by their names.
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

% The step is t, and the step before it is t-1. This rule forbids picking up a cube right after putting it down.
#program step(t).
:- occurs(put(R,O,T),t-1), occurs(pick(R,O,T),t).
"""

ROBOT_SETTINGS = """\
title = "{name}"
description = "A panda puts two cubes onto a table and into a tray."

[weights]               # for sampling: of actions, pairs of actions, classes and entities; the default is 1
put = 1
"put>pick" = 1
cube_1 = 1

[language]              # sentences of actions; {{0}}, {{1}}, ... are the arguments
pick = "take {{1}} from {{2}}"
put = "put {{1}}[ back] on {{2}}"

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

PLAIN_LOGIC = """\
% {name}: a ferry takes cars from one bank of a river to the other.
%
% Try:  prag-asp check {name}
%       prag-asp count {name} --length 1..8
%       prag-asp enumerate {name} --length 3

% Classes and entities -------------------------------------------------------------------------------------

class(bank).
class(car).

entity((north; south), bank).
entity((car_1; car_2; car_3), car).

% Fluents --------------------------------------------------------------------------------------------------

fluent(at(C,B))    :- is_a(C,car), is_a(B,bank).
fluent(aboard(C))  :- is_a(C,car).
fluent(ferry_at(B)) :- is_a(B,bank).

% Invariants: a car is at one place, the ferry is at one bank, and it carries one car.
exclusive(at(C,B), aboard(C))          :- fluent(at(C,B)).
exclusive(at(C,north), at(C,south))    :- is_a(C,car).
exclusive(aboard(C), aboard(D))        :- is_a(C,car), is_a(D,car), C < D.
exclusive(ferry_at(north), ferry_at(south)).

% Initial state and goal -----------------------------------------------------------------------------------

initially(at(C,north), true)   :- is_a(C,car).
initially(at(C,south), false)  :- is_a(C,car).
initially(aboard(C), false)    :- is_a(C,car).
initially(ferry_at(north), true).
initially(ferry_at(south), false).

% A goal is optional: plans that do not reach it are not counted.
% goal(at(car_1,south), true).

% Actions --------------------------------------------------------------------------------------------------

% board(C,B): car C drives onto the ferry at bank B.
action(board(C,B))                            :- is_a(C,car), is_a(B,bank).
precondition(board(C,B), at(C,B), true)       :- action(board(C,B)).
precondition(board(C,B), ferry_at(B), true)   :- action(board(C,B)).
precondition(board(C,B), aboard(D), false)    :- action(board(C,B)), is_a(D,car).
postcondition(board(C,B), at(C,B), false)     :- action(board(C,B)).
postcondition(board(C,B), aboard(C), true)    :- action(board(C,B)).

% leave(C,B): car C drives from the ferry to bank B.
action(leave(C,B))                            :- is_a(C,car), is_a(B,bank).
precondition(leave(C,B), aboard(C), true)     :- action(leave(C,B)).
precondition(leave(C,B), ferry_at(B), true)   :- action(leave(C,B)).
postcondition(leave(C,B), aboard(C), false)   :- action(leave(C,B)).
postcondition(leave(C,B), at(C,B), true)      :- action(leave(C,B)).

% cross(A,B): the ferry crosses from bank A to bank B.
action(cross(A,B))                            :- is_a(A,bank), is_a(B,bank), A != B.
precondition(cross(A,B), ferry_at(A), true)   :- action(cross(A,B)).
postcondition(cross(A,B), ferry_at(A), false) :- action(cross(A,B)).
postcondition(cross(A,B), ferry_at(B), true)  :- action(cross(A,B)).

% Rules of a step --------------------------------------------------------------------------------------------

% The step is t, and the step before it is t-1. This rule forbids crossing back right after crossing.
#program step(t).
:- occurs(cross(A,B),t-1), occurs(cross(B,A),t).
"""

PLAIN_SETTINGS = """\
title = "{name}"
description = "A ferry takes three cars across a river."

[weights]               # for sampling: of actions, pairs of actions, classes and entities; the default is 1
board = 1
"leave>board" = 1

[language]              # sentences of actions; {{0}}, {{1}}, ... are the arguments
board = "drive {{0}} onto the ferry at {{1}}[ again]"
leave = "drive {{0}} off the ferry at {{1}}"
cross = "cross from {{0}} to {{1}}"
"""
