"""What the linter warns of, what it refuses, and the comments that quiet it."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import prag_asp.grammar
import prag_asp.lint
from prag_asp import DomainError, QueryError, TaskSpace, load_domain
from prag_asp.program.problem import SHOWN, WARNINGS, Problem, first_of_each

PICK = """\
class(robot). class(cube).
entity(panda, robot). entity((cube_1; cube_2), cube).
fluent(holding(R,O)) :- is_a(R,robot), is_a(O,cube).
fluent(empty(R))     :- is_a(R,robot).
action(pick(R,O)) :- fluent(holding(R,O)).
precondition(pick(R,O), empty(R), true)      :- action(pick(R,O)).
postcondition(pick(R,O), holding(R,O), true) :- action(pick(R,O)).
postcondition(pick(R,O), empty(R), false)    :- action(pick(R,O)).
action(drop(R,O)) :- fluent(holding(R,O)).
precondition(drop(R,O), holding(R,O), true) :- action(drop(R,O)).
postcondition(drop(R,O), holding(R,O), false) :- action(drop(R,O)).
postcondition(drop(R,O), empty(R), true)    :- action(drop(R,O)).
"""
LINES = PICK.count("\n")


def reported(folder: Path, *more: str, settings: str = "", text: str = PICK) -> list[str]:
    """Return the errors of a domain without the folder, or else its warnings."""
    write(folder, *more, settings=settings, text=text)
    try:
        lines = list(map(str, load_domain(folder).warnings))
    except DomainError as error:
        lines = str(error).splitlines()
    return [line.replace(f"{folder}/", "") for line in lines]


def write(folder: Path, *more: str, settings: str = "", text: str = PICK) -> None:
    """Write a domain, with lines after its text."""
    (folder / "domain.lp").write_text(text + "\n".join(more), encoding="utf-8")
    (folder / "domain.toml").write_text(settings, encoding="utf-8")


WARNED = {
    "class(ball).": "class ball has no entity; add entity(..., ball), or remove it [empty-class]",
    "heavy(cube_1).": "no rule reads heavy/1; read it in the body of a rule, or remove it [unused]",
    "action_cost(pick(R,O), 3) :- action(pick(R,O)).": "unknown predicate action_cost/2; did you mean action? [unused]",
    ":- wet(table).": "no rule defines wet/1; define it in a fact or a rule, or remove it [undefined]",
    "free(A) :- action(A).": "without composites, every action is free; declare a composite, or remove free(...) "
    "[no-effect]",
    "entity(cube, cube).": "cube could be the class or the entity of that name; rename one in the domain [same-name]",
    "class(drop). entity(drop, drop).": "drop could be the class, the entity or the action of that name; "
    "rename one in the domain [same-name]",
    "precondition(pour(R,O), empty(R), false) :- action(pour(R,O)).": "no entity, fluent or action has the name pour; "
    "declare it, or remove the rule [never-holds]",
    "exclusive(empty(R), full(R)) :- fluent(full(R)).": "no entity, fluent or action has the name full; "
    "declare it, or remove the rule [never-holds]",
    "initially(empty(R), true) :- fluent(pick(R,_)).": "fluent(pick(R,_)) never holds; state it, or remove the rule "
    "[never-holds]",
    "precondition(pick_2(R,O), empty(R), false) :- action(pick_2(R,O)).": "no entity, fluent or action has the name "
    "pick_2; did you mean pick? [never-holds]",
    "x. % lint: allow unusd, unused": "unknown warning unusd; did you mean unused? [no-effect]",
    "x. % lint: allow": "this comment allows nothing; name a warning, such as asks-more [no-effect]",
}


@pytest.mark.parametrize("more", WARNED)
def test_what_is_strange_but_well_defined_is_a_warning(tmp_path: Path, more: str) -> None:
    write(tmp_path, more)
    domain = load_domain(tmp_path)
    lines = list(map(str, domain.warnings))
    assert f"{tmp_path}/domain.lp:{LINES + 1}: warning: {WARNED[more]}" in lines
    assert len(lines) == 1 + more.endswith("allow")
    assert TaskSpace(domain, 2).count() > 0


REFUSED = {
    "precondition(dorp(R,O), empty(R), false) :- action(dorp(R,O)).": "no entity, fluent or action has the name dorp; "
    "did you mean drop?",
    "exclusive(empty(R), hlding(R,O)) :- fluent(hlding(R,O)).": "no entity, fluent or action has the name hlding; "
    "did you mean holding?",
    "goal(emty(R), true) :- fluent(emty(R)).": "no entity, fluent or action has the name emty; did you mean empty?",
    "initially(empty(R), true) :- fluent(empty(R)), not is_a(R,robto).": "no entity, fluent or action has the name "
    "robto; did you mean robot?",
    "entity(cube_3, cub) :- is_a(panda, cub).": "no entity, fluent or action has the name cub; did you mean cube?",
    "implies(holding(panda,cube_2), hold(panda)) :- postcondition(drop(R,O), holdng(R,O), false).": "no entity, fluent "
    "or action has the name holdng; did you mean holding?",
    "precondition(pick(O), empty(panda), true) :- action(pick(O)).": "action(pick(O)) never holds: pick takes 2 "
    "arguments there, not 1; fix its arguments, or remove the rule",
    "postconditon(drop(R,O), empty(R), true) :- action(drop(R,O)).": "unknown predicate postconditon/3; "
    "did you mean postcondition?",
    "#program step(t).\n:- occurs(pik(R,O),t).": "no entity, fluent or action has the name pik; did you mean pick?",
    "#program step(t).\n:- occurs(pick(R,O),t), holds(holding(R,cubs),true,t-1).": "no entity, fluent or action has "
    "the name cubs; did you mean cube?",
}


@pytest.mark.parametrize("more", REFUSED)
def test_a_slip_that_would_change_a_count_is_an_error(tmp_path: Path, more: str) -> None:
    assert reported(tmp_path, more) == [f"domain.lp:{LINES + more.count(chr(10)) + 1}: {REFUSED[more]}"]


def test_one_slip_is_reported_once_however_many_rules_fail_to_fire_for_it(tmp_path: Path) -> None:
    (line,) = reported(
        tmp_path, text=PICK.replace("fluent(holding(R,O)) :- is_a(R,robot)", "fluent(holdng(R,O)) :- is_a(R,robot)")
    )
    assert line == "domain.lp:5: no entity, fluent or action has the name holding; did you mean holdng?"
    (line,) = reported(tmp_path, text=PICK.replace("action(drop(R,O)) :- fluent", "action(dorp(R,O)) :- fluent"))
    assert line == "domain.lp:10: no entity, fluent or action has the name drop; did you mean dorp?"


def test_two_rules_that_wait_for_each_other_are_reported(tmp_path: Path) -> None:
    (line,) = reported(
        tmp_path,
        "action(dorp(R,O)) :- precondition(dorp(R,O), _, _).",
        "precondition(dorp(R,O), empty(R), true) :- action(dorp(R,O)).",
    )
    assert line == f"domain.lp:{LINES + 1}: no entity, fluent or action has the name dorp; did you mean drop?"


GENERAL = """
class(door).
fluent(open(D)) :- is_a(D,door).
action(pull(R,D)) :- is_a(R,robot), is_a(D,door).
precondition(pull(R,D), open(D), false) :- action(pull(R,D)).
postcondition(pull(R,D), open(D), true) :- action(pull(R,D)).
exclusive(open(D), holding(R,O)) :- fluent(open(D)), fluent(holding(R,O)).
known_door(D) :- entity(D,door).
initially(open(D), false) :- known_door(D), not goal(open(D),true).
#program step(t).
:- occurs(pull(R,D),t), holds(open(D),true,t-1).
"""


def test_rules_for_what_a_domain_happens_to_lack_are_reported_by_its_empty_class_alone(tmp_path: Path) -> None:
    (line,) = reported(tmp_path, GENERAL)
    assert line.endswith("warning: class door has no entity; add entity(..., door), or remove it [empty-class]")


@pytest.mark.parametrize(
    "more",
    [
        "lid(cover(O)) :- is_a(O,cube). fluent(F) :- lid(F). initially(cover(O),true) :- fluent(cover(O)).",
        "kind(cube). heavy(O) :- is_a(O,C), kind(C). initially(holding(panda,O),false) :- heavy(O).",
        "#const big = cube_1. initially(holding(panda,O),false) :- is_a(O,cube), O != big, fluent(holding(panda,big)).",
        "pair((cube_1,cube_2)). exclusive(holding(R,A),holding(R,B)) :- pair((A,B)), is_a(R,robot), pair((cube_1,B)).",
        'name(O,"cube 1") :- is_a(O,cube). exclusive(holding(R,A),holding(R,B)) :- name(A,"cube 1"), is_a(B,cube), '
        "is_a(R,robot), A < B.",
        "near(X,X+1) :- X = 1..3. initially(holding(panda,cube_1),false) :- near(1,2), near(X,(X+1)).",
        "#defined spare/1. initially(holding(panda,O),false) :- spare(O), spare(cube_9).",
        "initially(holding(panda,cube_1),false) :- 1 <= #count { O : is_a(O,cube) }, not goal(empty(panda),true).",
        "#program step(t).\nlast(pick,t) :- occurs(pick(_,_),t).\n:- last(pick,t-1), occurs(pick(_,_),t).",
    ],
)
def test_names_that_some_atom_may_have_are_not_reported(tmp_path: Path, more: str) -> None:
    assert reported(tmp_path, more) == []


def test_a_comment_on_its_line_quiets_a_warning_and_nothing_else(tmp_path: Path) -> None:
    assert reported(tmp_path, "heavy(cube_1). % lint: allow unused") == []
    assert reported(tmp_path, "class(ball). heavy(cube_1). % so be it; lint: allow unused empty-class") == []
    assert reported(tmp_path, "class(ball). heavy(cube_1). %* lint: allow unused, empty-class *%") == []
    assert len(reported(tmp_path, "heavy(cube_1). % lint: allow empty-class")) == 1
    assert len(reported(tmp_path, "% lint: allow unused", "heavy(cube_1).")) == 1
    assert len(reported(tmp_path, 'heavy("% lint: allow unused").')) == 1
    (line,) = reported(tmp_path, "postconditon(pick(panda,cube_1),empty(panda),true). % lint: allow unused")
    assert "did you mean postcondition?" in line


def test_a_comment_in_the_settings_quiets_as_well(tmp_path: Path) -> None:
    (line,) = reported(tmp_path, settings='author = "me"\n')
    assert line.startswith("domain.toml:1: warning: author: unknown key; known are description, language, scene, ")
    assert reported(tmp_path, settings='author = "me"  # lint: allow no-effect\n') == []
    (line,) = reported(tmp_path, settings='titel = "me"  # lint: allow no-effect\n')
    assert line == "domain.toml:1: titel: unknown key; did you mean title?"
    (line,) = reported(tmp_path, settings='[language]\nshovel = "shovel"\n')
    assert line.endswith("give the name of an action or a fluent [no-effect]")
    assert reported(tmp_path, settings='[language]\nshovel = "shovel" # lint: allow no-effect\n') == []


def test_strict_makes_errors_of_warnings(tmp_path: Path) -> None:
    write(tmp_path, "heavy(cube_1).", "class(ball).")
    assert [warning.name for warning in load_domain(tmp_path).warnings] == ["unused", "empty-class"]
    with pytest.raises(DomainError) as caught:
        load_domain(tmp_path, strict=True)
    lines = str(caught.value).splitlines()
    assert [line.rpartition(" ")[2] for line in lines] == ["[unused]", "[empty-class]"]
    assert not any("warning" in line for line in lines)
    write(tmp_path, "heavy(cube_1). % lint: allow unused")
    load_domain(tmp_path, strict=True)


def test_an_ambiguous_name_is_refused_alike_wherever_it_is_given(tmp_path: Path) -> None:
    write(tmp_path, "entity(cube, cube).")
    space = TaskSpace(load_domain(tmp_path), 1)
    message = "cube could be the class or the entity of that name; rename one in the domain"
    for ask in (
        lambda: space.where("uses cube").count(),
        lambda: space.where("avoids cube").count(),
        lambda: space.hold_out("cube"),
        lambda: space.weights({"cube": 2}),
    ):
        with pytest.raises(QueryError) as caught:
            ask()
        assert str(caught.value) == message
    assert space.where("uses cube_1").count() == 2
    (line,) = reported(tmp_path, "entity(cube, cube).", settings="[weights]\ncube = 2\n")
    assert line == f"domain.toml:2: weights.cube: {message}"


def test_of_many_warnings_of_one_name_the_first_are_shown_with_the_number_of_the_others() -> None:
    many = [Problem(Path("domain.lp"), line, f"strange {line}; fix it", "unused") for line in range(1, SHOWN + 4)]
    other = Problem(Path("domain.lp"), 99, "odd; fix it", "same-name")
    shown = [each.text for each in first_of_each([*many, other])]
    assert shown[-1] == "odd; fix it" and len(shown) == SHOWN + 1
    assert shown[SHOWN - 1] == f"strange {SHOWN}; fix it (and 3 more warnings like it)"
    assert [each.text for each in first_of_each(many[:SHOWN])] == [each.text for each in many[:SHOWN]]


def test_every_warning_that_the_linter_gives_has_a_name_of_the_list() -> None:
    lint = Path(prag_asp.lint.__file__).parent
    proofs = lint.parent / "physics" / "proofs"
    grammar = Path(prag_asp.grammar.__file__).parent / "problems.py"
    bodies = lint.parent / "cli" / "body_summary.py"
    files = [*lint.rglob("*.py"), grammar, proofs / "grips.py", proofs / "reaching.py", bodies]
    text = "\n".join(path.read_text(encoding="utf-8") for path in files)
    reading = "".join(path.read_text(encoding="utf-8") for path in (lint.parent / "pddl" / "reading").rglob("*.py"))
    named = {*re.findall(r'"([a-z]+(?:-[a-z]+)+)"', text), *re.findall(r'else "(un[a-z]+)"', text)}
    assert named | set(re.findall(r'warn\(.*"([a-z]+)"\)', reading)) == set(WARNINGS)
