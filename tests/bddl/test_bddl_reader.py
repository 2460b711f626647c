"""Problems of BDDL are read as their dialects mean them, and mistakes are named with their lines."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from hypothesis import given, settings

from prag_asp.bddl import BddlFact, BddlProblem, Connective, Quantifier, bddl_text, parse_bddl, read_bddl
from prag_asp.errors import DomainError
from tests.bddl.problems import CAMP, TIDY, problems
from tests.chance import examples


def test_a_problem_of_libero_is_read() -> None:
    problem = parse_bddl(TIDY)
    assert (problem.name, problem.domain) == ("libero_test_manipulation", "robosuite")
    assert problem.language == "Put the Left mug in the drawer, and close it"
    assert problem.fixtures["white_drawer_1"] == "white_drawer"
    assert problem.objects == {"mug_1": "mug", "mug_2": "mug", "plate_1": "plate"}
    left = problem.region_by_name["kitchen_table_left_region"]
    assert left.ranges == ((-0.1, 0.1, 0.0, 0.2),)
    assert left.yaw == (0.0, math.pi / 2)
    assert problem.initial[0] == (BddlFact("on", ("mug_1", "kitchen_table_left_region")), True)
    assert problem.goal == Connective(
        "and",
        (BddlFact("in", ("mug_1", "white_drawer_1_top_region")), BddlFact("close", ("white_drawer_1_top_region",))),
    )
    assert problem.interest == ("mug_1", "white_drawer_1")


def test_a_problem_of_behavior_is_read() -> None:
    problem = parse_bddl(CAMP)
    assert (BddlFact("open", ("crate.n.02_1",)), False) in problem.initial
    assert isinstance(problem.goal, Connective)
    pairs, every, some, imply = problem.goal.parts
    assert pairs == Quantifier(
        "forpairs",
        (("bottle.n.01", "bottle.n.01"), ("crate.n.02", "crate.n.02")),
        BddlFact("inside", ("?bottle.n.01", "?crate.n.02")),
    )
    assert isinstance(every, Quantifier) and every.kind == "forall"
    assert isinstance(some, Quantifier) and isinstance(some.part, Quantifier) and some.part.number == 1
    assert isinstance(imply, Connective)
    assert imply.parts[0] == BddlFact("inside", ("bottle.n.01_1", "crate.n.02_1"))


@settings(max_examples=examples(20))
@given(problem=problems())
def test_what_is_written_is_read_as_the_same_problem(problem: BddlProblem) -> None:
    assert parse_bddl(bddl_text(problem)) == problem


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("(define", "(defin", "<bddl>:1: not a problem of BDDL"),
        ("    mug_1 mug_2 - mug\n", "    mug_1 mug_2 -\n", "<bddl>:28: no name stands before this '-'"),
        ("(:target flat_stove_1)", "", "<bddl>:19: region cook_region has no target"),
        ("(0.1 0.1 0.2 0.2)", "(0.1 0.1 0.2)", "<bddl>:16: a range has 3 numbers"),
        ("pi/2", "tau", "<bddl>:12: 'tau' is not a number"),
        ("(:obj_of_interest", "(:objects", "<bddl>:30: a second"),
        ("(Open white_drawer_1_top_region)", "(or (Open white_drawer_1_top_region))", "<bddl>:35: the initial state"),
        ("(:goal", "(:goals", "has no .:goal"),
        ("(And (In", "(Not (In", "<bddl>:38: .not \\.\\.\\.. has 2 parts"),
        ("(And (In", "(forall (?x - mug) (In", "<bddl>:38: .forall \\.\\.\\.. has 3 parts"),
        ("(problem LIBERO_Test_Manipulation)", "", "<bddl>:1: the problem has no name"),
    ],
)
def test_a_mistake_is_named_with_its_line(old: str, new: str, message: str) -> None:
    assert TIDY.count(old) == 1
    with pytest.raises(DomainError, match=message):
        parse_bddl(TIDY.replace(old, new))


def test_what_is_ignored_is_remarked_with_its_line() -> None:
    text = TIDY.replace("(:obj_of_interest", "(:obj_of_intrest").replace("plate_1 - plate", "plate_1 - plate p - mug")
    lines = [line for line, _ in parse_bddl(text).remarks]
    assert lines == [30, 28]
    first, second = [remark for _, remark in parse_bddl(text).remarks]
    assert "did you mean :obj_of_interest?" in first
    assert "reads only the last" in second


def test_a_file_that_is_no_text_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "odd.bddl"
    path.write_bytes(b"\xff\xfe(")
    with pytest.raises(DomainError, match=r"odd\.bddl:1: not UTF-8"):
        read_bddl(path)
