"""Where PyBullet, frankik and Pillow are not installed, all of logic works, and the rest says in a line what to do."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Sequence
from pathlib import Path

import pytest

from prag_asp import TaskSpace, load_domain
from prag_asp.errors import PhysicsMissingError
from prag_asp.missing import NEWEST, advice, needed
from tests.bare import LINUX, ROOT, bare_python, required
from tests.commands import Done

ABSENT = ("pybullet", "frankik", "PIL", "matplotlib", "pyganak", "py_d4", "pyapproxmc")
LOGIC = (
    "tests/dataset/test_jsonl.py", "tests/program", "tests/lint", "tests/domain", "tests/logic", "tests/test_task.py",
    "tests/space/engines/test_engines.py", "tests/space/test_limits.py",
)  # fmt: skip
COMPUTING = (
    "tests/logic/step/test_needs.py::test_of_hundreds_of_moves_only_those_that_can_begin_are_prepared",
    "tests/logic/ground/test_ground_step.py::test_a_counter_without_a_bound_is_told_with_its_line_and_left_to_clingo",
    "tests/logic/ground/test_ground_step.py::test_a_counter_with_a_bound_is_carried_as_far_as_that",
    "tests/logic/ground/test_ground_step.py::test_a_counter_of_the_author_is_carried_or_told_within_seconds",
    "tests/logic/ground/test_ground_step.py::test_a_bound_on_occurrences_takes_work_in_proportion_or_is_left_to_clingo",
    "tests/logic/symmetry/test_unit_symmetry.py::test_tasks_are_orbits_under_renamings_of_what_belongs_together",
    "tests/logic/diagram/test_functions.py::test_a_function_of_too_many_conjunctions_is_refused_though_its_diagram_is_small",
    "tests/pruning/test_pruned.py::test_hundreds_of_actions_of_which_half_never_occur_are_left_out",
    "tests/pruning/test_reachability.py::test_a_thousand_actions_that_are_reached_one_after_the_other_are_all_kept",
    "tests/pruning/test_reachability.py::test_of_a_card_game_only_what_can_be_played_is_tried",
    "tests/pruning/test_reachability.py::test_a_rule_over_time_that_only_reads_leaves_out_as_much_and_counts_the_same",
    "tests/domain/test_constants.py::test_every_engine_counts_what_the_edited_text_has",
    "tests/domain/test_constants.py::test_the_clauses_of_an_export_and_a_condition_see_the_value",
    "tests/domain/test_constants.py::test_a_cached_automaton_of_one_value_is_never_used_for_another",
    "tests/domain/test_everyday_names.py",
    "tests/space/test_limits.py::test_a_time_limit_gives_a_lower_bound_on_the_count",
    "tests/space/test_limits.py::test_a_long_count_says_how_far_it_is",
)
"""Tests that load, count and export as others do that are run: they cannot miss a package that those do not miss."""

CHEAP = ("-m", "not slow and not hypothesis", "-k", "not sharp", *(f"--deselect={each}" for each in COMPUTING))
"""Tests of logic that take a quarter of a minute together; random input would find the same with PyBullet as without.

The engine sharp needs a package that is not there either.
"""


@pytest.fixture(scope="module")
def python(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return bare_python(tmp_path_factory.mktemp("bare") / "venv", "pytest", "hypothesis")


def run(python: Path, *arguments: str | Path, cwd: Path = ROOT) -> subprocess.CompletedProcess[str]:
    command = [str(python), "-I", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, cwd=cwd, timeout=3000, check=False)


PRAG = """
import json, sys
from tests.commands import run
print(json.dumps([run(*arguments) for arguments in json.loads(sys.argv[1])]))
"""


def prag(python: Path, *commands: Sequence[str | Path], cwd: Path = ROOT) -> list[Done]:
    """Run commands one after the other in one process of that environment."""
    done = run(python, "-c", PRAG, json.dumps(commands, default=str), cwd=cwd)
    assert done.returncode == 0, done.stderr
    return [Done(*each) for each in json.loads(done.stdout)]


def test_the_environment_lacks_what_it_is_to_lack(python: Path) -> None:
    for name in ABSENT:
        assert f"No module named '{name}'" in run(python, "-c", f"import {name}").stderr


@pytest.mark.slow
def test_the_suite_of_logic_passes(python: Path) -> None:
    plugins = ("-p", "no:cacheprovider", "-p", "tests.first_cases")
    done = run(python, "-m", "pytest", "-q", "-x", *CHEAP, "-o", "addopts=", *plugins, *LOGIC)
    assert done.returncode == 0, done.stdout + done.stderr
    assert int(done.stdout.split(" passed")[0].split()[-1]) > 300


def test_check_reads_a_scene_and_learns_which_grips_fail(python: Path) -> None:
    names = ("tabletop", "kitchen", "two_arms", "blocks")
    for name, done in zip(names, prag(python, *(("check", name) for name in names)), strict=True):
        assert (done.returncode, done.stderr) == (0, "") and done.stdout.startswith(f"{name}: ok; ")


def test_draws_are_the_same_without_physics(python: Path) -> None:
    domain = load_domain("tabletop")
    tasks = TaskSpace(domain, 3).sample(4, seed=7, weights=dict(domain.settings.weights))
    (done,) = prag(python, ("sample", "tabletop", "-n", "3", "--count", "4", "--seed", "7", "--no-physics"))
    assert (done.returncode, done.stdout.splitlines()) == (0, list(map(str, tasks)))


def test_what_needs_pyarrow_says_so_in_a_line(python: Path, tmp_path: Path) -> None:
    (done,) = prag(python, ("generate", "blocks", "-n", "2", "--tasks", "1", "-o", tmp_path / "data"))
    assert done.returncode == 2 and not (tmp_path / "data").exists()
    assert done.stderr == 'datasets need pyarrow; install it: pip install "prag_asp[datasets]"\n'


def test_what_needs_physics_says_so_in_a_line_and_writes_nothing(python: Path, tmp_path: Path) -> None:
    tasks, folder = tmp_path / "tasks.jsonl", tmp_path / "own"
    folder.mkdir()
    commands = [
        ("sample", "tabletop", "-n", "3"),
        ("sample", "tabletop", "-n", "3", "--physics", "--workers", "2", "-o", "drawn.txt"),
        ("sample", "two_arms", "-n", "3", "--demonstrate", "recordings"),
        ("learn", "tabletop", "-n", "2"),
        ("validate", tasks),
        ("validate", tasks, "--witness-only"),
        ("validate", tasks, "--demonstrate", "recordings"),
        ("render", tasks),
    ]
    sample = ("sample", "tabletop", "-n", "2", "--count", "2", "--no-physics", "--format", "jsonl", "-o", tasks)
    sampled, *refused = prag(python, sample, *commands, cwd=folder)
    assert sampled.returncode == 0
    for command, done in zip(commands, refused, strict=True):
        assert (done.returncode, done.stdout) == (2, ""), command
        (line,) = done.stderr.splitlines()
        assert "physics needs PyBullet and frankik; " in line, command
        assert ("--no-physics samples without it" in line) == (command[0] == "sample"), command
    assert not list(folder.iterdir())


def test_a_curve_says_what_draws_it(python: Path) -> None:
    (done,) = prag(python, ("stats", "prag", "-n", "2", "--plot", "curve.png"))
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == "a curve needs matplotlib: pip install 'prag_asp[pictures]'\n"


def test_python_gets_an_error_of_the_packages_own_and_every_name_that_computes_no_motion(python: Path) -> None:
    code = """
from prag_asp import PragError
import prag_asp.physics as physics
for name in physics.__all__:
    try:
        getattr(physics, name)
    except PragError as error:
        assert type(error) is physics.PhysicsMissingError and str(error).count("\\n") == 0
        print(name)
"""
    done = run(python, "-c", code)
    assert done.returncode == 0, done.stderr
    missing = set(done.stdout.split())
    assert {"validate_task", "validate_tasks", "open_validator", "check_witness", "settle", "film_strip"} <= missing
    assert not missing & {
        "PREDICATES", "TIERS", "Budget", "Demonstration", "Moment", "Predicate", "Verdict", "Waypoint", "Witness",
        "check_demonstration", "physical_task", "require_physics",
    }  # fmt: skip


def test_the_advice_fits_the_python() -> None:
    assert advice((3, 11)) == "install them: pip install pybullet frankik"
    assert advice((3, 13)) == "install them: pip install pybullet-arm64 frankik"
    new = advice((3, 14))
    assert new.startswith("there are no wheels for Python 3.14: use Python 3.13, for instance by uv tool install ")
    assert new.endswith("; or build both from source")


def test_a_package_that_is_there_but_broken_is_told_apart(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "torn.py").write_text("raise ImportError('libnothing.so: cannot open\\nshared object file')")
    monkeypatch.syspath_prepend(tmp_path)
    with pytest.raises(PhysicsMissingError, match=r"torn, which cannot be loaded: libnothing.so: cannot open shared "):
        needed("torn")


def test_pip_asks_for_physics_exactly_where_there_are_wheels() -> None:
    simulators = {"pybullet", "pybullet-arm64"}
    for minor in range(10, 17):
        names = set(required(f"3.{minor}"))
        wheels = (3, minor) <= NEWEST
        assert len(names & simulators) == wheels and ("frankik" in names) == wheels
        assert {"clingo", "numpy", "python-sat", "click"} <= names
    assert "pybullet" in required("3.11") and "pybullet-arm64" in required("3.12")
    assert not simulators & set(required("3.12", {**LINUX, "platform_machine": "aarch64"}))
    mac = {"sys_platform": "darwin", "platform_machine": "arm64"}
    assert "pybullet-arm64" in required("3.10", mac) and not simulators & set(required("3.14", mac))
