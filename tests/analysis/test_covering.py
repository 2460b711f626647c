"""Covering sets and coverages agree with a list of all plans and their actions."""

from __future__ import annotations

import itertools
import json
from pathlib import Path

import pytest

from prag_asp import LimitReached, Limits, QueryError, TaskSpace, load_domain
from prag_asp.analysis.covering import Combination, combination_text, coverage, covering_set, reachable_combinations
from tests.analysis.orbit_spaces import orbit_spaces
from tests.chance import Chance
from tests.commands import ok, run

PRAG = TaskSpace(load_domain("prag"), 3)


def combined(action: str, entities: dict[str, str], strength: int) -> set[Combination]:
    """Return the combinations of an action, from its text."""
    name, _, rest = action.partition("(")
    arguments = rest.removesuffix(")").split(",") if rest else []
    values = list(enumerate([name, *(entities.get(each, each) for each in arguments)]))
    return set(itertools.combinations(values, min(strength, len(values))))


def test_reachable_combinations_and_covering_sets_are_those_of_a_list(chance: Chance) -> None:
    smaller = 0
    for case, space, _ in orbit_spaces(chance, 15, 2):
        for strength in (1, 2, 3):
            covers = {
                frozenset().union(*(combined(action, case.entities, strength) for action in plan))
                for plan in space.enumerate("plan")
            }
            reachable = set().union(*covers)
            found = covering_set(space, strength)
            assert found.reachable == reachable == reachable_combinations(space, strength), case.text()
            assert not coverage(found.tasks, space, strength).missing and all(task in space for task in found.tasks)
            least = next(
                size
                for size in range(1, len(covers) + 1)
                if any(set().union(*some) == reachable for some in itertools.combinations(covers, size))
            )
            assert found.at_least <= least <= len(found.tasks) <= least + 1, case.text()
            smaller += least > 1
    assert smaller > 2


def test_the_coverage_of_some_tasks_is_a_share_of_what_is_reachable() -> None:
    tasks = [PRAG[rank] for rank in range(5)]
    covered = set().union(*(combined(str(a), PRAG.domain.facts.entity_names, 2) for t in tasks for a in t.actions))
    found = coverage(tasks, PRAG, 2)
    assert found.covered == covered and found.missing == found.reachable - covered
    assert found.share == len(covered) / len(found.reachable)
    lacking = PRAG.where("lacks move", "avoids crate_1")
    assert ((0, "move"),) not in reachable_combinations(lacking, 1) and ((0, "rotate"),) in reachable_combinations(
        lacking, 1
    )
    assert coverage([], PRAG.where("uses at least 5 apple"), 2).share == 1
    assert covering_set(PRAG.where("uses at least 5 apple"), 2).tasks == ()


def test_sets_of_shipped_domains_are_proved_to_be_the_smallest() -> None:
    for name, length, strength, least in (("tabletop", 3, 3, 68), ("tabletop", 4, 2, 13), ("prag", 15, 3, 3)):
        found = covering_set(TaskSpace(load_domain(name), length), strength)
        assert len(found.tasks) == found.at_least == least


def test_combinations_in_words() -> None:
    assert combination_text(((0, "move"), (2, "apple"))) == "move(_,apple)"
    assert combination_text(((2, "apple"), (3, "bowl"))) == "*(_,apple,bowl)"
    assert combination_text(((0, "wait"),)) == "wait"


def test_wrong_requests_and_limits_are_answered(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(QueryError, match="combinations of 9 factors: give a number from 1 to 8"):
        covering_set(PRAG, 9)
    reachable_combinations(PRAG, 2)
    monkeypatch.setattr(PRAG.engines, "limits", Limits(seconds=0, since=0))
    with pytest.raises(LimitReached, match="the time limit of 0 s was reached with 59 combinations left"):
        covering_set(PRAG, 2)


def test_the_commands_choose_tasks_and_name_what_is_missing(tmp_path: Path) -> None:
    space, file = ("prag", "-n", "3"), tmp_path / "tasks.jsonl"
    done = run("sample", *space, "--cover", "2", "--no-physics", "--format", "jsonl", "-o", str(file))
    number = len(file.read_text().splitlines())
    assert f"{number} tasks for all 59 reachable combinations of 2 factors; at least 9 tasks needed" in done.stderr
    assert ok("diversity", *space, "--tasks", str(file), "--coverage", "2") == (
        f"{number} tasks cover 59 of 59 reachable combinations of 2 factors (100.0 %)\n"
    )
    file.write_text("".join(file.read_text().splitlines(keepends=True)[:2]))
    found = json.loads(ok("diversity", *space, "--tasks", str(file), "--coverage", "2", "--format", "json"))
    text = ok("diversity", *space, "--tasks", str(file), "--coverage", "2")
    assert f"missing  {found['missing'][0]}" in text and f"and {len(found['missing']) - 20} more" in text
    done = run("sample", *space, "--count", "50", "--diverse", "4", "--no-physics")
    assert len(set(done.stdout.splitlines())) == 4 and "4 tasks at least 3 apart (levenshtein-classes)" in done.stderr
    for arguments, refused in (
        (("sample", *space, "--cover", "2", "--diverse", "2"), "leave --diverse out"),
        (("sample", *space, "--diverse", "20"), "--diverse 20: chooses from 10 sampled tasks"),
        (("diversity", *space, "--coverage", "2"), "give --tasks FILE"),
        (("diversity", *space, "--coverage", "2", "--near", "x"), "give --near or --tasks"),
    ):
        done = run(*arguments)
        assert done.returncode == 2 and refused in done.stderr
