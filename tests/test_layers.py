"""The structure of the package: imports go down, heavy packages wait, and the public names are these."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import pytest

import prag_asp

PACKAGE = Path(prag_asp.__file__).parent
LAYERS = ("errors", "domain", "logic", "space", "physics", "dataset", "rl", "analysis", "cli")
PUBLIC = {
    "Atom", "Condition", "Domain", "DomainError", "EngineError", "OutputError", "PragError", "QueryError", "Scene",
    "SceneError", "Task", "TaskSpace", "load_domain", "load_scene", "parse_atom",
}  # fmt: skip


def layer_of(module: str) -> int:
    return LAYERS.index(module.split(".")[1])


def test_a_package_imports_only_what_stands_above_it_in_the_layout() -> None:
    checked = 0
    for path in PACKAGE.rglob("*.py"):
        module = "prag_asp." + ".".join(path.relative_to(PACKAGE).with_suffix("").parts)
        if module == "prag_asp.__init__":
            continue
        for node in ast.walk(ast.parse(path.read_text())):
            names = [node.module] if isinstance(node, ast.ImportFrom) and node.module else []
            names += [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            for name in names:
                if name.startswith("prag_asp."):
                    checked += 1
                    assert layer_of(name) <= layer_of(module), f"{module} imports {name}"
    assert checked > 100


def test_physics_knows_of_task_spaces_only_the_task() -> None:
    for path in (PACKAGE / "physics").rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("prag_asp.space"):
                assert node.module == "prag_asp.task"


def loaded_by(*arguments: str) -> set[str]:
    code = "import sys; from prag_asp.cli import cli; cli.main(sys.argv[1:]); print(*sys.modules, file=sys.stderr)"
    run = subprocess.run([sys.executable, "-c", code, *arguments], capture_output=True, text=True, check=True)
    return set(run.stderr.split())


def test_counting_loads_neither_the_simulator_nor_data_packages() -> None:
    loaded = loaded_by("count", "prag", "--length", "3")
    assert "clingo" in loaded
    assert not loaded & {
        "pybullet", "frankik", "pyarrow", "rich", "PIL", "matplotlib", "multiprocessing", "pysat", "pyganak", "difflib",
        "importlib.metadata",
    }  # fmt: skip


def test_counting_loads_only_those_of_our_own_modules_that_count() -> None:
    loaded = loaded_by("count", "prag", "--length", "3", "--by", "skeleton", "--no-cache")
    space = {name.removeprefix("prag_asp.space.") for name in loaded if name.startswith("prag_asp.space.")}
    assert {"task_space", "engines.automaton"} <= space
    assert not {name.partition(".")[0] for name in space} & {
        "drawing", "merged", "narrate", "ranked", "readings", "shuffle", "split", "statistics", "stored", "temperature",
    }  # fmt: skip
    assert not loaded & {"prag_asp.space.conditions.clauses", "prag_asp.logic.symmetry.merging"}


def test_a_count_that_was_kept_loads_no_code_for_merged_states(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PRAG_ASP_CACHE", str(tmp_path))
    count = ("count", "tabletop", "--length", "5", "--by", "plan")
    loaded_by(*count)
    assert list(tmp_path.iterdir())
    loaded = loaded_by(*count)
    assert "prag_asp.space.engines.stored" in loaded
    assert not loaded & {"prag_asp.space.automaton.merged", "prag_asp.logic.symmetry.patterns"}


def test_counting_where_there_is_no_scene_loads_nothing_that_reads_one() -> None:
    assert not {name for name in loaded_by("count", "hanoi", "--length", "3") if name.startswith("prag_asp.scene")}


def test_what_computes_no_motion_loads_no_simulator() -> None:
    names = "Budget, Demonstration, PREDICATES, Verdict, Witness, check_demonstration, physical_task"
    code = f"import sys; from prag_asp.physics import {names}; print(*sys.modules)"
    loaded = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.split()
    assert "prag_asp.physics.robot.panda" in loaded
    assert not {"pybullet", "frankik", "PIL"} & set(loaded)
    assert not {"pybullet", "frankik"} & loaded_by("check", "tabletop")


def test_asking_for_help_loads_no_solver() -> None:
    assert not loaded_by("--help") & {"clingo", "numpy", "pybullet"}


def test_the_public_names_are_these_and_all_exist() -> None:
    assert set(prag_asp.__all__) == PUBLIC
    assert all(getattr(prag_asp, name).__module__.startswith("prag_asp.") for name in PUBLIC)
    assert set(dir(prag_asp)) == PUBLIC
