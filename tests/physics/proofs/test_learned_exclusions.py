"""What physics proves impossible leaves the space of plans, and nothing else does."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from shutil import copytree

import pytest
from hypothesis import HealthCheck, given, settings

from prag_asp import TaskSpace, load_domain
from prag_asp.atom import Atom
from prag_asp.dataset.scenes import scene_of
from prag_asp.domain.load import Domain, with_learned
from prag_asp.errors import DomainError
from prag_asp.physics import check_witness, validate_tasks
from prag_asp.physics.proofs.learned_exclusions import prove_exclusions, unproved_exclusions
from prag_asp.physics.proofs.schemas import rules, text_of
from prag_asp.program.sources import Source
from prag_asp.task import Task
from tests.brute_force import Toy, term
from tests.chance import Chance, examples
from tests.commands import run
from tests.domains import domain_of
from tests.strategies import toys

WAREHOUSE = Path(__file__).parents[3] / "examples" / "warehouse"
ITEMS = ("cube_1", "cube_2", "crate_1", "crate_2", "rod_1")
LEARNED = """\
% Y is 100 mm wide, but the gripper opens only to 80 mm
impossible(holding(X,Y), holding(X,Y)) :- fluent(holding(X,Y)), is_a(Y,crate).

% X is larger than the cavity of Y
impossible(inside(X,Y), inside(X,Y)) :- fluent(inside(X,Y)), is_a(X,crate).

% X is larger than the cavity of Y
impossible(inside(X,Y), inside(X,Y)) :- fluent(inside(X,Y)), is_a(X,rod).

% X is on Y and X is within reach, but these facts cannot hold together
impossible(on_top(X,shelf_2), reachable(Z,X)) :- fluent(on_top(X,shelf_2)), fluent(reachable(Z,X)).
"""


def learned_text(domain: Domain) -> str:
    return text_of(rules(prove_exclusions(domain.facts, scene_of(domain)), domain.facts), domain.name)


def learned(domain: Domain) -> Domain:
    return with_learned(domain, (Source(domain.folder / "learned.lp", learned_text(domain)),))


def satisfies(task: Task, fluents: frozenset[Atom]) -> bool:
    """Return whether a state of a task is known to satisfy some fluents."""
    return any(all(state.get(fluent) is True for fluent in fluents) for state in (task.initial, *task.states))


@pytest.fixture(scope="module")
def before() -> Domain:
    return load_domain(WAREHOUSE)


@pytest.fixture(scope="module")
def after(before: Domain) -> Domain:
    return learned(before)


@pytest.fixture(scope="module")
def proved(before: Domain) -> list[frozenset[Atom]]:
    """The fluents that physics proves impossible together."""
    proofs = prove_exclusions(before.facts, scene_of(before))
    return [frozenset(fluents) for fluents, reason in proofs.items() if reason is not None]


def test_proofs_become_readable_rules_with_their_reasons(before: Domain) -> None:
    header, _, body = learned_text(before).partition("\n\n")
    assert header.startswith("% ") and header.count("\n") == 1
    assert body == LEARNED


def test_rules_state_the_proofs_and_nothing_else(after: Domain, proved: list[frozenset[Atom]]) -> None:
    expected = {(f"holding(panda,crate_{i})",) for i in (1, 2)}
    expected |= {(f"inside({item},tray_1)",) for item in ("crate_1", "crate_2", "rod_1")}
    expected |= {(f"on_top({item},shelf_2)", f"reachable(panda,{item})") for item in ITEMS}
    assert {tuple(sorted(map(str, fluents))) for fluents in proved} == expected
    # A crate that is never in the tray may be in a rule, but each pair is stated once.
    assert {tuple(sorted({*map(str, pair)})) for pair in after.learned} == expected
    assert len(after.learned) == len(expected)


@pytest.mark.parametrize("length", range(4))
def test_exactly_the_plans_leave_of_which_a_state_satisfies_a_proof(
    before: Domain, after: Domain, proved: list[frozenset[Atom]], length: int
) -> None:
    plain, space = TaskSpace(before, length), TaskSpace(after, length, engine="automaton")
    tasks = list(plain.tasks_of_plans(plain.enumerate("plan")))
    kept = [task for task in tasks if not any(satisfies(task, fluents) for fluents in proved)]
    assert len(kept) < (len(tasks) if length else 2)
    assert list(space.tasks_of_plans(space.enumerate("plan"))) == kept  # what is known of their states is as before
    for engine in ("automaton", "clingo", "sat"):
        assert TaskSpace(after, length, engine=engine).count("plan") == len(kept)


def test_no_task_with_a_witness_leaves_and_the_pass_rate_rises(before: Domain, after: Domain, chance: Chance) -> None:
    scene, spaces = scene_of(before), (TaskSpace(before, 3), TaskSpace(after, 3))
    passed = []
    for space in spaces:
        tasks = space.sample(30, seed=chance.seed(3), weights={})
        verdicts = list(validate_tasks(tasks, scene, seed=chance.seed(3)))
        passed.append(sum(verdict.feasible for verdict in verdicts))
        for task, verdict in zip(tasks, verdicts, strict=True):
            assert (task not in spaces[1]) == (verdict.status == "infeasible")
            if verdict.feasible:
                assert verdict.witness is not None
                [same] = spaces[1].tasks_of_plans(iter([tuple(map(str, task.actions))]))
                assert replace(task, log_probability=None) == same
    assert passed[0] < 15 and passed[1] >= 28


def test_witnesses_of_tabletop_stand_with_everything_that_can_be_learned(chance: Chance) -> None:
    domain = load_domain("tabletop")
    scene, space = scene_of(domain), TaskSpace(learned(domain), 4)
    tasks = TaskSpace(domain, 4).sample(12, seed=chance.seed(5), weights={})
    verdicts = list(validate_tasks(tasks, scene, seed=chance.seed(5)))
    assert sum(verdict.feasible for verdict in verdicts) >= 11
    for task, verdict in zip(tasks, verdicts, strict=True):
        if verdict.feasible:
            assert verdict.witness is not None and task in space
    assert check_witness(tasks[0], verdicts[0].witness, scene) == []  # type: ignore[arg-type]


@settings(max_examples=examples(30), suppress_health_check=list(HealthCheck))
@given(toys(closed=False))
def test_what_is_impossible_excludes_what_is_known_and_tells_nothing(toy: Toy) -> None:
    plain = TaskSpace(domain_of(replace(toy, impossible=()).text(), "at_most"), 3)
    forbidden = [frozenset(Atom(f"f{f}") for f in pair) for pair in toy.impossible]
    tasks = list(plain.tasks_of_plans(plain.enumerate("plan")))
    kept = [task for task in tasks if not any(satisfies(task, fluents) for fluents in forbidden)]
    space = TaskSpace(domain_of(toy.text(), "at_most"), 3)
    assert list(space.tasks_of_plans(space.enumerate("plan"))) == kept
    assert {tuple(map(str, task.actions)) for task in kept} == {
        tuple(term(toy, i) for i in plan) for plan in toy.plans(3)
    }


def test_exclusions_learned_for_another_scene_are_reported(before: Domain, after: Domain) -> None:
    scene = scene_of(before)
    assert list(unproved_exclusions(after, scene)) == []
    nearer = replace(scene, fixed={**scene.fixed, "shelf_2": (0.6, 0.0, 0.0)})
    expected = {(f"on_top({item},shelf_2)", f"reachable(panda,{item})") for item in ITEMS}
    assert {tuple(map(str, fluents)) for fluents in unproved_exclusions(after, nearer)} == expected


def test_the_command_proposes_measures_and_writes(tmp_path: Path, after: Domain) -> None:
    folder = str(copytree(WAREHOUSE, tmp_path / "warehouse"))
    proposed = run("learn", folder, "-n", "2", "--count", "20", "--seed", "1")
    assert proposed.returncode == 0, proposed.stderr
    (tmp_path / "proposed.lp").write_text(proposed.stdout)
    assert with_learned(load_domain(folder), (Source(tmp_path / "x.lp", proposed.stdout),)).learned == after.learned
    plans = [TaskSpace(domain, 2).count("plan") for domain in (load_domain(folder), after)]
    table = {line.split()[1]: line.split()[2:] for line in proposed.stdout.splitlines()[-9:]}
    assert table["plans"] == [str(count) for count in plans]
    assert table["sampled"] == ["20", "20"] and table["budget"][:4] == ["10", "x", "10,", "kinematics"]
    assert int(table["passed"][0]) < int(table["passed"][3])

    written = run("learn", folder, "-n", "2", "--count", "0", "--write")
    assert written.returncode == 0 and written.stdout.startswith("4 rules from 10 proofs\n")
    assert "10 learned invariants" in run("check", folder).stdout
    for options, count in (([], plans[1]), (["--no-learned"], plans[0])):
        assert run("count", folder, "-n", "2", "--by", "plan", *options).stdout == f"{count}\n"

    settings = tmp_path / "warehouse" / "domain.toml"
    settings.write_text(settings.read_text().replace("[0.95, 0.00]", "[0.55, 0.00]"))
    stale = run("check", folder)
    assert stale.returncode == 2 and stale.stdout == "" and stale.stderr.count("\n") == 1
    assert "learned.lp:1: the scene does not prove that on_top(" in stale.stderr


def test_an_action_that_is_ruled_out_is_explained(tmp_path: Path) -> None:
    folder = copytree(WAREHOUSE, tmp_path / "warehouse")
    (folder / "learned.lp").write_text(LEARNED)
    explained = run("explain", str(folder), "pick(panda,crate_1,table_1)")
    assert explained.returncode == 1
    assert (
        "holding(panda,crate_1) would have to be true, which contradicts the other conditions of that state"
        in explained.stdout
    )


@pytest.mark.parametrize(
    ("text", "line", "problem"),
    [
        ("impossible(holding(panda,cube_1), holding(panda,cube_9)).", 1, "refers to the undeclared fluent"),
        ("% why\nexclusive(holding(panda,cube_1), holding(panda,cube_2)).", 2, "only impossible(F,G) may be stated"),
        ("#program step(t).\n:- occurs(A,t).", 1, "only impossible(F,G) may be stated"),
        ("{ impossible(F,F) : fluent(F) }.", 1, "only impossible(F,G) may be stated"),
        ("impossible(F,F) :- fluent(F), is_a(crate_1,crat).", 1, "no entity, fluent or action has the name crat"),
        ("impossible(F,F :- fluent(F).", 1, "unexpected"),
    ],
)
def test_a_malformed_file_is_refused_in_one_line(tmp_path: Path, text: str, line: int, problem: str) -> None:
    folder = copytree(WAREHOUSE, tmp_path / "warehouse")
    (folder / "learned.lp").write_text(text)
    with pytest.raises(DomainError) as caught:
        load_domain(folder)
    message = str(caught.value)
    assert message.startswith(f"{folder / 'learned.lp'}:{line}: ") and problem in message and "\n" not in message
    assert load_domain(folder, learned=False).learned == ()
