"""The structure of the package: imports go down, heavy packages wait, and the public names are these."""

from __future__ import annotations

import ast
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator, Mapping
from functools import cache
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

import prag_asp
from prag_asp import TaskSpace, load_domain
from prag_asp.cli import cli
from prag_asp.cli.registry import COMMANDS, GROUPS

PACKAGE = Path(prag_asp.__file__).parent

GROUND = frozenset(
    [
        "errors",
        "stop_reason",
        "wording",
        "integers",
        "exact_numbers",
        "atom",
        "task",
        "lazy",
        "output",
        "processes",
        "missing",
        "tables",
        "batches",
    ]
) | {"safe_reading", "array_archive", "random_bits"}
"""What every room may stand on."""

OURS = re.compile(r"prag_asp(\.|$)")

ROOMS: Mapping[str, frozenset[str]] = {
    "": GROUND | {"program", "scene", "domain", "logic", "space", "models", "dataset", "versions", "bounded_call"},
    "errors": frozenset(["stop_reason"]),
    "stop_reason": frozenset(),
    "batches": frozenset(),
    "lazy": frozenset(),
    "versions": frozenset(),
    "processes": frozenset(["errors", "stop_reason"]),
    "missing": frozenset(["errors"]),
    "safe_reading": frozenset(),
    "array_archive": frozenset(),
    "random_bits": frozenset(),
    "html": frozenset(["lazy"]),
    "tables": frozenset(["errors", "wording"]),
    "output": frozenset(["errors", "lazy", "safe_reading"]),
    "wording": frozenset(["errors"]),
    "integers": frozenset(),
    "exact_numbers": frozenset(["errors", "integers"]),
    "atom": frozenset(["errors", "integers"]),
    "task": frozenset(["errors", "atom", "integers", "similarity", "html"]),
    "similarity": GROUND - {"task"},
    "program": GROUND - {"task"},
    "scene": GROUND - {"task"},
    "grammar": (GROUND - {"task"}) | {"program", "scene"},
    "pruning": (GROUND - {"task"}) | {"program"},
    "lint": (GROUND - {"task"}) | {"program", "pruning", "scene", "grammar"},
    "pddl": (GROUND - {"task"}) | {"program"},
    "reduction": (GROUND - {"task"}) | {"program", "lint"},
    "bddl": (GROUND - {"task"}) | {"program", "pddl"},
    "domain": (GROUND - {"task"}) | {"program", "scene", "lint", "pddl", "reduction"},
    "logic": (GROUND - {"task"}) | {"program", "domain"},
    "models": (GROUND - {"task"}) | {"html", "program", "logic"},
    "planners": GROUND | {"program", "domain", "logic"},
    "space": GROUND | {"html", "program", "reduction", "domain", "logic", "similarity"},
    "physics": GROUND | {"html", "program", "scene", "domain"},
    "dataset": GROUND | {"html", "program", "scene", "grammar", "domain", "space", "physics", "analysis", "versions"},
    "rl": GROUND | {"program", "scene", "domain", "logic", "space", "physics", "dataset"},
    "evaluation": GROUND | {"program", "domain", "space", "physics", "dataset", "rl", "versions"},
    "analysis": GROUND | {"html", "program", "domain", "logic", "space", "similarity"},
    "audit": GROUND | {"html", "program", "bddl", "pddl", "domain", "space", "dataset", "similarity", "analysis"},
    "report": GROUND
    | {"html", "program", "domain", "logic", "space", "similarity", "physics", "dataset", "evaluation", "analysis"}
    | {"versions"},
    "explore": GROUND | {"html", "program", "scene", "domain", "logic", "space", "models", "dataset", "physics"},
    "cli": GROUND
    | {"program", "scene", "grammar", "pddl", "bddl", "reduction", "domain", "logic", "space", "models", "planners"}
    | {"physics", "dataset", "evaluation", "analysis", "similarity", "audit", "report", "explore", "versions"},
    "__main__": frozenset(["cli"]),
}
"""The rooms of the package, and what each may import. The wings `space` and `physics` know each other by the task."""

FLOORS: Mapping[str, tuple[str, ...]] = {
    "tables": ("toml_text", "report", "json_fields"),
    "scene": (
        "predicate_names", "boxes", "cameras", "colours", "forms", "shape_kinds", "scene", "geometry",
        "footprint", "furniture", "solids", "mass", "variation", "robots", "read", "surfaces",
        "scene_loader",
    ),
    "logic": ("ground", "step", "diagram", "symmetry", "domain_logic", "formula"),
    "space": (
        "limits", "automaton", "weights", "plans", "parts", "conditions", "engines", "shortest_tasks", "final_states",
        "reduced_count", "explanation", "sampling", "domain_engines", "word_set", "task_sampling", "distinct_sampling",
        "lengths", "task_space", "strata", "without_replacement", "emptiness",
    ),
    "physics": (
        "bullet", "required", "temporary_files", "robot", "grasps", "witness", "extent", "situation", "predicates",
        "symbolic_facts", "world", "control", "proofs", "search", "motion", "checks", "demonstration", "filming",
        "pictures", "playback", "verdict", "witness_search", "tiers", "validator", "validation",
    ),
    "rl": (
        "registration", "arena", "goals", "observations", "rewards", "environment_options", "goal_env",
        "reward_annealing", "state_checksum", "camera_views", "curriculum", "tasks", "environment", "wrappers",
        "scripted_agent", "skill_chains", "episode_replay",
    ),
}  # fmt: skip
"""The rooms within a room, from the ground up: each imports only what stands below it."""

PUBLIC = {
    "AnswerSets", "Atom", "Condition", "Dataset", "Domain", "DomainError", "EngineError", "Estimate", "Explanation",
    "LimitReached", "Limits", "OutputError", "PragError", "QueryError", "Reasons", "Scene", "SceneError", "Task",
    "TaskSpace",
    "__version__", "answer_sets", "bounded", "explain", "fewest_changes", "load_domain", "load_scene",
    "parse_atom", "shipped_domains", "show_progress", "why_empty", "write_new_domain",
}  # fmt: skip
HEAVY = {
    "inflect",
    "pybullet",
    "frankik",
    "msgspec",
    "rich",
    "PIL",
    "matplotlib",
    "plotly",
    "multiprocessing",
    "pysat",
    "pyapproxmc",
    "pyganak",
    "py_d4",
    "pddl",
    "lark",
    "pyarrow",
    "gymnasium",
    "difflib",
    "importlib.metadata",
}
"""What counting does not need."""


@cache
def package_texts() -> dict[str, str]:
    """Return the texts of the modules by their names without ``prag_asp.``; its own is empty."""
    texts = {}
    for path in PACKAGE.rglob("*.py"):
        parts = path.relative_to(PACKAGE).with_suffix("").parts
        texts[".".join(parts).removesuffix("__init__").removesuffix(".")] = path.read_text()
    return texts


def imports(texts: Mapping[str, str]) -> Iterator[tuple[str, str]]:
    """Yield which module imports which: a name of a face is where it lives, a text a module."""
    homes = {name: faces(text) for name, text in texts.items()}

    def found(given: str) -> str:
        """Return the module that a dotted name is, or lies in."""
        while given not in texts:
            given, _, name = given.rpartition(".")
            given = homes[given].get(name, given) if given in texts else given
        return given

    for module, text in texts.items():
        for given in imported(text, texts=not homes[module]):
            yield module, found(given)


@cache
def tree(module: str) -> ast.Module:
    """Return the syntax tree of a module."""
    return ast.parse(module)


def statements(node: ast.AST) -> Iterator[ast.AST]:
    """Yield all statements of a module; expressions import nothing and are most of the tree."""
    for field in ("body", "orelse", "finalbody", "handlers", "cases"):
        inner = getattr(node, field, ())
        for each in inner if isinstance(inner, list) else ():
            yield each
            yield from statements(each)


@cache  # the packages with one more line in a module have all others in common
def imported(module: str, *, texts: bool) -> list[str]:
    """Return the dotted names below ``prag_asp`` that a module imports, by statements or (with `texts`) as texts."""
    found = []
    for node in (ast.walk if texts and re.search(r"""["']prag_asp\.""", module) else statements)(tree(module)):
        given: list[str] = []
        if isinstance(node, ast.ImportFrom):
            assert not node.level, "an import is relative"
            given = [f"{node.module}.{alias.name}" for alias in node.names]
        elif isinstance(node, ast.Import):
            given = [alias.name for alias in node.names]
        elif texts and isinstance(node, ast.Constant) and re.fullmatch(r"prag_asp(\.\w+)+", str(node.value)):
            given = [str(node.value)]
        found += [each.removeprefix("prag_asp").removeprefix(".") for each in given if OURS.match(each)]
    return found


@cache
def faces(module: str) -> dict[str, str]:
    """Return where the names live that a face hands on; a module that is not a face hands on none."""
    for node in tree(module).body if "_HOMES" in module else ():
        if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "_HOMES":
            homes: dict[str, tuple[str, ...]] = ast.literal_eval(node.value)
            return {name: home.removeprefix("prag_asp.") for home, names in homes.items() for name in names}
    return {}


def forbidden(texts: Mapping[str, str]) -> list[str]:
    """Return the imports that run up, or sideways where they may not."""
    wrong = []
    for module, other in sorted(set(imports(texts))):
        (room, *inner), (beside, *within) = module.split("."), other.split(".")
        if room == beside:
            floors = FLOORS.get(room, ())
            above = floors.index(within[0]) > floors.index(inner[0]) if inner and within and floors else False
            if above or (inner and not within and faces(texts[room])):
                wrong.append(f"{module} imports {other}, which stands above it")
        elif beside not in ROOMS[room]:
            wrong.append(f"{module or '__init__'} imports {other or 'the face'}, which {room or 'that'} may not")
    return wrong


def circle(texts: Mapping[str, str]) -> list[str]:
    """Return modules that import each other around, nothing where there are none."""
    graph: dict[str, set[str]] = {}
    for module, other in imports(texts):
        if module != other and not faces(texts[module]):
            graph.setdefault(module, set()).add(other)
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        return list(error.args[1])
    return []


def loaded_by(*arguments: str, package: Path = PACKAGE) -> set[str]:
    code = "import sys; from prag_asp.cli import cli; cli.main(sys.argv[1:]); print(*sys.modules, file=sys.stderr)"
    command = [sys.executable, "-c", code, *arguments]
    environment = {**os.environ, "PYTHONPATH": str(package.parent)}
    run = subprocess.run(command, capture_output=True, text=True, check=True, cwd=package.parent, env=environment)
    return set(run.stderr.split())


def planted(module: str, line: str) -> dict[str, str]:
    """Return the texts of the package with one more line in a module."""
    begin = "from __future__ import annotations\n"
    return {**package_texts(), module: package_texts()[module].replace(begin, f"{begin}\n{line}\n", 1)}


def test_every_module_stands_in_a_room_of_the_plan() -> None:
    for path in PACKAGE.rglob("*.py"):
        room, *inner = path.relative_to(PACKAGE).with_suffix("").parts
        assert room in {*ROOMS, "__init__"}
        if room in FLOORS and inner != ["__init__"]:
            assert inner[0] in FLOORS[room], f"{path} stands on no floor of {room}"


def test_a_room_holds_about_a_dozen_files() -> None:
    lists = {PACKAGE / "physics" / "predicates", PACKAGE / "cli" / "commands"}  # there is a file for each of them
    for folder in {path.parent for path in PACKAGE.rglob("*.py")} - lists:
        assert len(list(folder.glob("*.py"))) <= 16, folder


def test_imports_run_down_and_the_wings_know_each_other_only_by_the_task() -> None:
    assert len(set(imports(package_texts()))) > 500
    assert forbidden(package_texts()) == []


def test_no_modules_import_each_other_around() -> None:
    assert circle(package_texts()) == []


@pytest.mark.parametrize(
    ("module", "line"),
    [
        ("program.facts", "from prag_asp.domain.load import Domain"),
        ("logic.ground.program", "from prag_asp.logic.domain_logic import DomainLogic"),
        ("physics.situation", "from prag_asp.physics.search.attempt import Search"),
        ("space.plans.task_builder", "import prag_asp.physics.verdict"),
        ("physics.validator", "from prag_asp.space.task_space import TaskSpace"),
        ("dataset.physics_filter", "from prag_asp.cli.physics_options import PhysicsOptions"),
        ("scene.scene_loader", "def late():\n    from prag_asp.lint import check"),
        ("space.task_space", "from prag_asp import physics"),
        ("space.task_space", "from prag_asp import dataset as given"),
        ("space.task_space", "import prag_asp"),
        ("physics.validator", "from prag_asp import TaskSpace"),
        ("program.facts", "from prag_asp import load_domain"),
        ("program.facts", "from prag_asp import lint"),
        ("physics.search.attempt", "from prag_asp.physics import validate_tasks"),
        ("physics.search.attempt", "from prag_asp import physics"),
        (
            "logic.ground.ground_step",
            "import importlib\nSPACE = importlib.import_module('prag_asp.space.task_space')",
        ),
        ("dataset", "from prag_asp.cli.physics_options import PhysicsOptions"),
        ("physics", "from prag_asp.space.task_space import TaskSpace"),
        ("", "from prag_asp.cli import cli"),
    ],
)
def test_an_import_that_runs_up_or_sideways_is_found(module: str, line: str) -> None:
    (found,) = forbidden(planted(module, line))
    assert found.startswith(module or "__init__")


def test_a_circle_is_found() -> None:
    texts = planted("program.facts", "from prag_asp.program.composition import composite_actions")
    assert {"program.facts", "program.composition"} <= set(circle(texts))


def test_counting_loads_neither_the_simulator_nor_data_packages() -> None:
    loaded = loaded_by("count", "prag", "--length", "3")
    assert "clingo" in loaded
    assert not loaded & HEAVY


def test_a_heavy_package_in_counting_is_found(tmp_path: Path) -> None:
    package = tmp_path / "prag_asp"
    shutil.copytree(PACKAGE, package, ignore=shutil.ignore_patterns("__pycache__"))
    for data in ("encodings", "domains"):
        if (PACKAGE.parent / data).is_dir():
            (tmp_path / data).symlink_to(PACKAGE.parent / data)
    (package / "space" / "task_space.py").write_text(
        planted("space.task_space", "import multiprocessing")["space.task_space"]
    )
    assert loaded_by("count", "prag", "--length", "3", package=package) & HEAVY == {"multiprocessing"}


def test_counting_loads_only_those_of_our_own_modules_that_count() -> None:
    loaded = loaded_by("count", "prag", "--length", "3", "--by", "skeleton", "--no-cache")
    space = {name.removeprefix("prag_asp.space.") for name in loaded if name.startswith("prag_asp.space.")}
    assert {"task_space", "engines.automaton_engine"} <= space
    assert not {name.partition(".")[0] for name in space} & {"sampling", "parts"}
    assert not space & {
        "automaton.merged_states", "engines.stored_automata", "weights.temperature", "conditions.clause_kinds",
        "plans.task_builder", "plans.readings",
    }  # fmt: skip
    assert "prag_asp.logic.symmetry.canonical_states" not in loaded
    assert not {name for name in loaded if name.startswith(("prag_asp.physics", "prag_asp.dataset"))}


def test_a_count_that_was_kept_loads_no_code_for_merged_states(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PRAG_ASP_CACHE", str(tmp_path))
    monkeypatch.setattr("prag_asp.space.engines.automaton_engine.WORTH_KEEPING", -1.0)
    TaskSpace(load_domain("tabletop"), 5).count("plan")
    assert list(tmp_path.iterdir())
    loaded = loaded_by("count", "tabletop", "--length", "5", "--by", "plan")
    assert "prag_asp.space.engines.stored_automata" in loaded
    assert not loaded & {"prag_asp.space.automaton.merged_states", "prag_asp.logic.symmetry.term_patterns"}


def test_counting_where_there_is_no_scene_loads_nothing_that_reads_one() -> None:
    assert not {name for name in loaded_by("count", "hanoi", "--length", "3") if name.startswith("prag_asp.scene")}


def test_what_computes_no_motion_loads_no_simulator() -> None:
    names = "Budget, Demonstration, PREDICATES, Verdict, Witness, check_demonstration, physical_task"
    code = f"import sys; from prag_asp.physics import {names}; print(*sys.modules)"
    loaded = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.split()
    assert "prag_asp.scene.robots.panda" in loaded
    assert not {"pybullet", "frankik", "PIL"} & set(loaded)
    assert not {"pybullet", "frankik"} & loaded_by("check", "tabletop")


def test_a_data_set_without_physics_loads_no_simulator(tmp_path: Path) -> None:
    loaded = loaded_by("generate", "blocks", "-n", "2", "--tasks", "2", "-o", str(tmp_path / "data"))
    assert "pyarrow" in loaded and not loaded & {"pybullet", "frankik", "PIL"}


def test_asking_for_help_loads_no_solver() -> None:
    assert not loaded_by("--help") & {"clingo", "numpy", "pybullet"}


def test_a_command_loads_no_other_command() -> None:
    for command in ("count", "sample", "stats"):
        own = [name for name in loaded_by(command, "--help") if name.startswith("prag_asp.cli.commands.")]
        assert own == [f"prag_asp.cli.commands.{command}"]


def test_every_file_of_a_command_is_registered_and_every_entry_has_its_command() -> None:
    files = {path.stem for path in (PACKAGE / "cli" / "commands").glob("*.py")} - {"__init__"}
    assert set(COMMANDS.values()) == files
    context = cli.make_context("prag-asp", ["domains"])
    for name in cli.list_commands(context):
        command = cli.get_command(context, name)
        assert command is not None and command.name == name and command.help


def test_the_public_names_are_these_and_all_exist() -> None:
    assert set(prag_asp.__all__) == PUBLIC
    assert all(getattr(prag_asp, name).__module__.startswith("prag_asp.") for name in PUBLIC - {"__version__"})
    assert set(dir(prag_asp)) == PUBLIC


def test_the_help_lists_each_command_once() -> None:
    assert sorted(name for names in GROUPS.values() for name in names) == sorted(COMMANDS)
