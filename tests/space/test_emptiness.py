"""Why there is no task, compared with what the definition says of the domain without some of its lines."""

from __future__ import annotations

import itertools
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from prag_asp import EngineError, LimitReached, QueryError, TaskSpace, fewest_changes, load_domain, why_empty
from prag_asp.space import emptiness
from prag_asp.space.emptiness import shortest_length
from tests.brute_force import Action, Toy, term
from tests.chance import examples
from tests.domains import domain_of
from tests.strategies import hierarchies, toys

ROOMS = """\
class(room). class(door). entity((hall;lab;vault), room). entity((wood;steel), door).
leads(wood,hall,lab). leads(steel,lab,vault).
fluent(in(R)) :- is_a(R,room).
fluent(locked(D)) :- is_a(D,door).
fluent(key).
exclusive(in(R),in(S)) :- is_a(R,room), is_a(S,room), R < S.
action(go(R,S)) :- leads(_,R,S).
action(unlock(D)) :- is_a(D,door).
precondition(go(R,S),in(R),true) :- action(go(R,S)).
precondition(go(R,S),locked(D),false) :- leads(D,R,S).
postcondition(go(R,S),in(R),false) :- action(go(R,S)).
postcondition(go(R,S),in(S),true) :- action(go(R,S)).
precondition(unlock(D),key,true) :- action(unlock(D)).
precondition(unlock(D),locked(D),true) :- action(unlock(D)).
postcondition(unlock(D),(locked(D);key),false) :- action(unlock(D)).
initially(in(hall),true).
initially(locked(D),true) :- is_a(D,door).
initially(key,true).
goal(in(vault),true).
"""


EFFECTS = (("pre", "on", "false"), ("post", "on", "true"), ("pre", "off", "true"), ("post", "off", "false"))

RULE = 0
"""The number that stands for the rule ``at_most`` among those of lines."""


def lifted(toy: Toy, kept: set[int], *, loose: bool) -> Toy:
    """Return a domain with just some of the lines that restrict; with `loose`, what others change may be anything."""
    number = itertools.count(1 + toy.fluents + len(toy.actions))
    actions = []
    for action in toy.actions:
        before = {f: v for f, v in action.before.items() if next(number) in kept}
        here = {f: (v, next(number) in kept) for f, v in action.after.items()}
        after = {f: v if known else None for f, (v, known) in here.items() if known or loose}
        actions.append(Action(action.name, before, after))
    initially = {f: v for f, v in toy.initially.items() if next(number) in kept}
    pairs = [
        tuple(pair for pair in each if next(number) in kept) for each in (toy.exclusive, toy.implies, toy.impossible)
    ]
    goal = {f: v for f, v in toy.goal.items() if next(number) in kept}
    at_most = {name: k for name, k in toy.at_most.items() if next(number) in kept and RULE in kept}
    next(number)  # the line of the program part
    never_after = tuple(pair for pair in toy.never_after if next(number) in kept)
    exclusive, implies, impossible = pairs
    return Toy(
        toy.fluents, tuple(actions), initially, exclusive, implies, goal, never_after, at_most, impossible=impossible
    )


MANY = """fluent(f(1..12)). goal(f(I),true) :- fluent(f(I)). initially(f(I),false) :- fluent(f(I)).
action(a(1..12)). postcondition(a(I),f(I),true) :- action(a(I))."""


def some(toy: Toy, length: int, wanted: tuple[int, int] | None) -> bool:
    """Tell whether there is a plan, with an action at a step if that is wanted."""
    return any(wanted is None or plan[wanted[1] - 1] == wanted[0] for plan in toy.plans(length))


@settings(max_examples=examples(80), suppress_health_check=list(HealthCheck))
@given(toys(closed=False), st.integers(0, 3), st.data())
def test_reasons_are_minimal_and_changes_fewest_by_the_definition(toy: Toy, length: int, data: st.DataObject) -> None:
    toy = replace(toy, blocked=())
    wanted = None
    if length and data.draw(st.booleans()):
        wanted = (data.draw(st.integers(0, len(toy.actions) - 1)), data.draw(st.integers(1, length)))
    asked = {"action": term(toy, wanted[0]), "step": wanted[1]} if wanted else {}
    space = TaskSpace(domain_of(toy.text(), "at_most"), length)
    everything = {RULE, *range(1, toy.text().count("\n") + 1)}
    for smallest in (False, True):
        found = why_empty(space, **asked, smallest=smallest)
        assert (found is None) == some(toy, length, wanted)
        if found is None:
            assert fewest_changes(space, **asked) == ((),)
            return
        kept = {line.line if line.path.name == "domain.lp" else RULE for line in found.lines}
        assert len(kept) == len(found.lines) and not found.conditions
        assert not some(lifted(toy, kept, loose=True), length, wanted)
        assert all(some(lifted(toy, kept - {line}, loose=True), length, wanted) for line in kept)
    changes = [{each.line if each.path.name == "domain.lp" else RULE for each in lines}
               for lines in fewest_changes(space, **asked)]  # fmt: skip
    single = [{each} for each in everything if some(lifted(toy, everything - {each}, loose=False), length, wanted)]
    if single:
        assert sorted(map(sorted, changes)) == sorted(map(sorted, single))
    elif changes:
        (together,) = changes
        assert some(lifted(toy, everything - together, loose=False), length, wanted)
    else:
        assert not some(lifted(toy, set(), loose=False), length, wanted)


@settings(max_examples=examples(40), suppress_health_check=list(HealthCheck))
@given(toys(closed=False))
def test_the_shortest_length_is_that_of_the_definition(toy: Toy) -> None:
    found = shortest_length(TaskSpace(domain_of(replace(toy, blocked=()).text(), "at_most"), 0))
    lengths = [length for length in range(1, 5) if some(replace(toy, blocked=()), length, None)]
    assert found == lengths[0] if lengths else found is None or found > 4


def test_the_shortest_task_may_be_far_and_conditions_count(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(emptiness, "LONGEST", (4, 128))
    monkeypatch.setattr(emptiness, "MOST_STATES", 500)
    lamp = "fluent(f). action(a;b). postcondition(a,f,true). goal(f,true). initially(f,false)."
    space = TaskSpace(domain_of(lamp), 2)
    assert shortest_length(space) == 1 and shortest_length(space.where("has at most 0 a")) is None
    assert shortest_length(space.where("has at least 110 b")) == 111
    with pytest.raises(EngineError, match="more than 128 actions"):
        shortest_length(space.where("has at least 150 b"))
    with pytest.raises(LimitReached):
        shortest_length(TaskSpace(domain_of(MANY), 1))


def test_a_smallest_set_of_changes_has_no_fewer_that_do() -> None:
    text = "fluent(f;g). action(a). goal((f;g),true). initially((f;g),false). exclusive(f,g)."
    (found,) = fewest_changes(TaskSpace(domain_of(text), 1))
    assert [line.text for line in found] == ["goal((f;g),true)."]
    text = "fluent(f;g). action(a). goal(f,true). goal(g,true). initially(f,false). initially(g,false)."
    (found,) = fewest_changes(TaskSpace(domain_of(text), 1))
    assert len(found) == 2


@pytest.fixture
def rooms(tmp_path: Path) -> Path:
    path = tmp_path / "rooms.lp"
    path.write_text(ROOMS + '#include "rules/no_undo.lp".\n')
    return path


def test_the_lines_are_those_of_the_file(rooms: Path) -> None:
    space = TaskSpace(load_domain(rooms), 4)
    found = why_empty(space, action="go", step=1)
    assert found is not None
    assert [str(line) for line in found.lines] == [
        f"{rooms}:10: precondition(go(R,S),locked(D),false) :- leads(D,R,S).",
        f"{rooms}:17: initially(locked(D),true) :- is_a(D,door).",
    ]
    assert [line.line for (line,) in fewest_changes(space)] == [13]
    assert why_empty(space.at(3).where("uses lab")) is not None


def test_an_included_rule_is_told_by_the_line_that_includes_it(tmp_path: Path) -> None:
    path = tmp_path / "switch.lp"
    rows = [f"{kind}condition({action},lit,{value})." for kind, action, value in EFFECTS]
    included = ['#include "rules/no_undo.lp".', '#include "rules/closed_world.lp".']
    path.write_text("\n".join([" ".join(["fluent(lit). action(on;off).", *rows]), *included]))
    space = TaskSpace(load_domain(path), 2)
    changes = fewest_changes(space.where("begins on, off"))
    assert ["no_undo" in line.text for (line,) in changes].count(True) == 1
    assert all(line.line == (2 if "no_undo" in line.text else 1) for (line,) in changes)
    found = why_empty(space.at(1), action="off")
    assert found is not None
    assert [line.line for line in found.lines] == [1, 3]


def test_conditions_are_reasons_where_the_space_has_a_task_without_them(rooms: Path) -> None:
    space = TaskSpace(load_domain(rooms), 3).where("has at least 1 go", "begins unlock", "has at least 2 unlock")
    found = why_empty(space)
    assert found is not None and not found.conditions  # there is no plan of this length at all
    text = ROOMS.replace("initially(key,true).", "").replace("(locked(D);key)", "locked(D)")
    space = TaskSpace(load_domain(text=text), 4).where("has at least 1 go", "begins go", "has at least 2 unlock")
    found = why_empty(space)
    assert found is not None
    assert list(map(str, found.conditions)) == ["begins go"]
    assert {9, 10} & {line.line for line in found.lines}


def test_what_is_declared_alone_may_leave_no_task() -> None:
    space = TaskSpace(domain_of("fluent(f). initially(f,true)."), 3)
    found = why_empty(space)
    assert found is not None and not found.lines and not found.conditions
    assert fewest_changes(space) == ()


def test_composites_alone_may_leave_no_task() -> None:
    space = TaskSpace(domain_of("fluent(f). action(a). composite(c). stage(c,1,a). stage(c,2,a)."), 3)
    found = why_empty(space)
    assert found is not None and [line.line for line in found.lines] == [1]
    assert fewest_changes(space) == (found.lines,)


def test_what_is_no_action_and_no_step_is_refused() -> None:
    space = TaskSpace(load_domain("prag"), 2)
    for action, step, told in (("fly", None, "no action 'fly'"), ("grasp", 3, "no step 3"), (None, 1, "which action")):
        with pytest.raises(QueryError, match=told):
            why_empty(space, action=action, step=step)
    assert why_empty(space, action="grasp", step=2) is None


GROUPED = "composite(trip). stage(trip,1,go(hall,lab)). stage(trip,2,go(lab,vault)). free(unlock(wood)).\n"


def test_composites_that_leave_no_task_are_told_by_their_line(tmp_path: Path) -> None:
    """Two doors are locked and one key opens one of them; with a key that stays, they are opened on the way."""
    text = ROOMS.replace("(locked(D);key),false", "locked(D),false") + GROUPED
    (tmp_path / "domain.lp").write_text(text)
    space = TaskSpace(load_domain(tmp_path), 4)
    found = why_empty(space)
    assert found is not None
    line = len(ROOMS.splitlines()) + 1
    (told,) = (each for each in found.lines if each.text.startswith("composite(trip)."))
    assert (told.path, told.line) == (tmp_path / "domain.lp", line)
    assert (told,) in fewest_changes(space)
    assert TaskSpace(load_domain(tmp_path, flat=True), 4).count() > 0


@pytest.mark.slow
@settings(max_examples=examples(25), suppress_health_check=list(HealthCheck))
@given(hierarchies(closed=True), st.integers(1, 3))
def test_composites_are_a_change_where_the_domain_without_them_has_a_plan(toy: Toy, length: int) -> None:
    space = TaskSpace(domain_of(toy.text(), "at_most"), length)
    if next(toy.plans(length), None) is not None:
        assert why_empty(space) is None
        return
    flat = next(replace(toy, composites=()).plans(length), None) is not None
    single = [each[0] for each in fewest_changes(space) if len(each) == 1]
    assert any("as --flat lifts them" in each.text for each in single) == flat
