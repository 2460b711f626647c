"""Problems of PDDL, datasets and texts of LeRobot go through the same audit as those of BDDL."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from prag_asp import Domain, LimitReached, QueryError, TaskSpace, load_domain
from prag_asp.audit import audit
from prag_asp.audit.audited_problem import AuditedProblem
from prag_asp.audit.auditing import audit_problems
from prag_asp.audit.sources.dataset_suites import task_problem
from prag_asp.bddl.ground_goals import fact_values
from prag_asp.stop_reason import StopKind, StopReason
from tests.audit.test_audit import problem, write
from tests.commands import run

DOMAIN = """(define (domain moves) (:requirements :adl :typing) (:types ball room)
  (:predicates (at-room ?b - ball ?r - room) (glued ?b - ball) (red ?b - ball))
  (:action move :parameters (?b - ball ?from ?to - room) :precondition (and (at-room ?b ?from) (not (glued ?b)))
   :effect (and (at-room ?b ?to) (not (at-room ?b ?from)))))
"""
PROBLEM = """(define (problem {name}) (:domain moves) (:objects b1 b2 - ball r1 r2 - room)
  (:init (at-room b1 r1) (at-room b2 r1) {more}) (:goal {goal}))
"""


def test_problems_of_pddl_are_audited(tmp_path: Path) -> None:
    folder = tmp_path / "balls"
    (folder / "problems").mkdir(parents=True)
    (folder / "domain.pddl").write_text(DOMAIN)
    goals = {
        "one": "(at-room b1 r2)",
        "renamed": "(at-room b2 r2)",
        "all": "(forall (?b - ball) (at-room ?b r2))",
        "both": "(and (at-room b1 r2) (at-room b2 r2) (not (= b1 b2)))",
    }
    for name, goal in goals.items():
        (folder / "problems" / f"{name}.pddl").write_text(PROBLEM.format(name=name, goal=goal, more=""))
    stuck = PROBLEM.format(name="stuck", goal="(at-room b1 r2)", more="(glued b1)")
    (folder / "problems" / "stuck.pddl").write_text(stuck)
    (folder / "problems" / "odd.pddl").write_text(stuck.replace("moves", "moved"))
    found = audit(folder)
    assert (found.total.files, found.total.problems, found.total.goals, found.total.tasks) == (6, 5, 2, 3)
    assert found.same[0] == ("balls/problems/one", "balls/problems/renamed", "balls/problems/stuck")
    kinds = {each.kind: Path(each.place).name for each in found.findings}
    assert kinds == {"unreadable": "odd.pddl:1", "unreachable-goal": "stuck.pddl:1"}
    assert found.combinations.occurring == found.combinations.reachable == frozenset([("ball", "at-room room")])


def test_equal_problems_of_different_domains_have_verdicts_of_their_own(tmp_path: Path) -> None:
    texts = {"one": DOMAIN, "two": DOMAIN.replace("(not (glued ?b))", "(glued ?b)")}
    for name, text in texts.items():
        (tmp_path / name).mkdir()
        (tmp_path / name / "domain.pddl").write_text(text)
        (tmp_path / name / "task.pddl").write_text(PROBLEM.format(name="task", goal="(at-room b1 r2)", more=""))
    for order in (("one", "two"), ("two", "one")):
        found = audit(*(tmp_path / name for name in order))
        assert found.total.tasks == 1
        verdicts = [(each.kind, Path(each.place).parent.name) for each in found.findings]
        assert verdicts == [("unreachable-goal", "two")]


def test_a_domain_that_cannot_be_loaded_does_not_prove_a_goal_unreachable() -> None:
    def load() -> Domain:
        raise LimitReached("the memory limit of 1 GB was reached", 0, StopReason(StopKind.MEMORY))

    (task,) = TaskSpace(load_domain("kitchen"), 8).sample(1, seed=1)
    (finding,) = audit_problems([AuditedProblem("suite", "one", "row 1", task_problem(task, "one"), load)]).findings
    assert (finding.kind, finding.place) == ("unchecked-goal", "row 1")
    assert finding.text.endswith("is not known: the memory limit of 1 GB was reached")


def test_a_task_is_a_problem_whose_goal_is_what_its_plan_changes() -> None:
    (task,) = TaskSpace(load_domain("kitchen"), 8).sample(1, seed=1)
    found = task_problem(task, "one", "do it")
    goal = {each.fact: each.value for each in fact_values(found.goal)}
    assert goal == {fact: value for fact, value in task.states[-1].items() if task.initial.get(fact) != value}
    assert found.true_facts == {fact for fact, value in task.initial.items() if value}


def test_tasks_of_a_dataset_are_audited(tmp_path: Path) -> None:
    made = run("generate", "blocks", "-n", "3", "--tasks", "3", "--trivial", "-o", "data", cwd=tmp_path)
    assert made.returncode == 0
    found = audit(tmp_path / "data")
    assert (found.total.files, found.total.problems) == (3, 3)
    assert 1 <= found.total.goals <= found.total.tasks <= 3
    assert found.combinations.occurring
    assert found.combinations.reachable == found.combinations.present == found.combinations.occurring
    assert found.findings == ()


def test_texts_of_lerobot_are_found_among_other_problems(tmp_path: Path) -> None:
    suite = write(
        tmp_path / "suite",
        KITCHEN_SCENE1_put_the_mug_down=problem("(on mug_1 bowl_1)", language="put the mug on the bowl"),
        other=problem("(on mug_1 plate_1)"),
    )
    lerobot = tmp_path / "recordings"
    (lerobot / "meta").mkdir(parents=True)
    texts = ["put the mug down", "Put the mug on the plate.", "dance"]
    rows = [json.dumps({"task_index": number, "task": text}) for number, text in enumerate(texts)]
    (lerobot / "meta" / "tasks.jsonl").write_text("\n".join(rows))
    found = audit(lerobot, suite, reach=False)
    nearest = {each.problem: each.nearest for each in found.nearest if each.suite == "recordings"}
    assert nearest == {
        "recordings/put the mug down": "suite/KITCHEN_SCENE1_put_the_mug_down",
        "recordings/Put the mug on the plate.": "suite/other",
    }
    assert [str(each) for each in found.findings if each.kind == "unreadable"] == [
        f"{lerobot}/meta/tasks.jsonl:3: 'dance' is the text of no other problem [unreadable]"
    ]
    assert {(each.test, each.tasks) for each in found.overlaps} == {("recordings", 2), ("suite", 2)}
    (lerobot / "meta" / "tasks.jsonl").write_text("[1]")
    with pytest.raises(QueryError, match="not a file of texts"):
        audit(lerobot, suite)
