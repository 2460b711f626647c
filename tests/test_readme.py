"""README.md says nothing that is not so: its commands print what it shows, its example counts as the definition says.

After a change of what commands print, ``python -m tests.test_readme`` writes the new output into README.md.
"""

from __future__ import annotations

import doctest
import importlib.util
import itertools
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory
from textwrap import dedent
from typing import NamedTuple

import pytest

from prag_asp import TaskSpace, load_domain
from prag_asp.scene.kinds import KINDS
from prag_asp.scene.read.table import SCENE_KEYS
from prag_asp.scene.vocabulary import PREDICATE_ROLES

ROOT = Path(__file__).parent.parent
README = ROOT / "README.md"
DISHES = ROOT / "examples" / "dishes"

INSTALL = "python3 -m venv .venv && .venv/bin/pip install"
RUN = f"{INSTALL} . && .venv/bin/prag-asp sample tabletop --length 5 --count 3 --seed 7"
TEST = f"{INSTALL} -e '.[test]' && .venv/bin/pytest"


class Fence(NamedTuple):
    """A fenced block: its language, the line of its first line of text, and the text."""

    language: str
    line: int
    text: str


class Command(NamedTuple):
    """A command of a console block, the line that it stands in, and what it is said to print."""

    line: int
    command: str
    printed: str


def fences(language: str) -> list[Fence]:
    """Return the fenced blocks of README.md that are marked with a language."""
    text = README.read_text(encoding="utf-8")
    found = re.finditer(r"^```(\w+)\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)
    blocks = [Fence(each[1], text.count("\n", 0, each.start(2)) + 1, each[2]) for each in found]
    return [block for block in blocks if block.language == language]


def commands() -> list[Command]:
    """Return the commands of all console blocks, in their order."""
    found: list[Command] = []
    for block in fences("console"):
        for line, text in enumerate(block.text.splitlines(keepends=True), block.line):
            if text.startswith("$ "):
                found.append(Command(line, text[2:-1], ""))
            else:
                found[-1] = found[-1]._replace(printed=found[-1].printed + text)
    return found


def says(expected: str, printed: str) -> bool:
    """Tell whether a text is the expected one, in which a line ``...`` stands for any lines."""
    pattern = r"(?:.*\n)*".join(re.escape(part) for part in re.split(r"(?m)^\.\.\.\n", expected))
    return re.fullmatch(pattern, printed) is not None


def prepare(folder: Path) -> None:
    """Give a folder what the README expects of a clone."""
    for name in ("encodings", "examples"):
        shutil.copytree(ROOT / name, folder / name, ignore=shutil.ignore_patterns("__pycache__"))


def run_all(folder: Path) -> Iterator[str]:
    """Run all commands in a folder and yield what each prints."""
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    for each in commands():
        yield subprocess.run(
            ["bash", "-c", each.command],
            cwd=folder,
            env={**os.environ, "PATH": path, "COLUMNS": "110", "LC_ALL": "C.UTF-8"},
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            encoding="utf-8",
            timeout=60,
            check=False,
        ).stdout


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("clone")
    prepare(made)
    return made


@pytest.fixture(scope="module")
def printed(folder: Path) -> dict[int, str]:
    return {each.line: text for each, text in zip(commands(), run_all(folder), strict=True)}


@pytest.mark.parametrize("each", commands(), ids=lambda each: f"line {each.line}: {each.command}")
def test_a_command_prints_what_the_readme_shows(each: Command, printed: dict[int, str]) -> None:
    assert says(each.printed, printed[each.line]), f"{each.command}\nprinted\n{printed[each.line]}"


def test_the_python_of_the_readme_returns_what_it_shows(
    folder: Path, printed: dict[int, str], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(folder)
    text = "\n".join(block.text for block in fences("python"))
    session = doctest.DocTestParser().get_doctest(text, {}, "README.md", str(README), 0)
    assert session.examples
    failed = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS).run(session).failed
    assert not failed, capsys.readouterr().out


def test_the_two_commands_stand_near_the_top_on_one_line_each() -> None:
    top = README.read_text(encoding="utf-8").splitlines()[:40]
    assert RUN in top
    assert TEST in top


def test_the_domain_shown_is_the_one_in_examples() -> None:
    shown = [block.text for block in (*fences("prolog"), *fences("toml"))]
    assert (DISHES / "domain.lp").read_text(encoding="utf-8") in shown
    assert (DISHES / "domain.toml").read_text(encoding="utf-8") in shown


def snippets() -> list[str]:
    """Return the indented blocks of the README: pieces of a domain.lp."""
    text = re.sub(r"(?ms)^```.*?^```$", "", README.read_text(encoding="utf-8"))
    return [dedent(block) for block in re.findall(r"(?m)(?:^ {4}.*\n)+", text)]


@pytest.mark.parametrize("snippet", snippets())
def test_a_piece_of_a_domain_fits_into_the_example(snippet: str, tmp_path: Path) -> None:
    shutil.copytree(DISHES, tmp_path / "dishes")
    with (tmp_path / "dishes" / "domain.lp").open("a", encoding="utf-8") as text:
        text.write(f"#program base.\n{snippet}")
    domain = load_domain(tmp_path / "dishes")
    by_engine = {engine: TaskSpace(domain, 3, engine=engine) for engine in ("automaton", "clingo")}
    assert set(by_engine["automaton"].words("plan")) == set(by_engine["clingo"].words("plan"))
    assert 0 < by_engine["automaton"].count() == by_engine["clingo"].count()


def test_every_link_and_picture_of_the_readme_exists() -> None:
    targets = re.findall(r"\]\(([^)#]+)\)", README.read_text(encoding="utf-8"))
    assert targets
    assert [each for each in targets if not each.startswith("https://") and not (ROOT / each).exists()] == []


def test_the_readme_names_all_that_a_scene_may_say() -> None:
    text = README.read_text(encoding="utf-8")
    names = {*SCENE_KEYS, *KINDS, *itertools.chain(*(kind.keys for kind in KINDS.values())), *PREDICATE_ROLES}
    assert {name for name in names if f"`{name}" not in text and f"{name} =" not in text} == set()


def test_the_readme_names_every_predicate_of_the_contract() -> None:
    text = README.read_text(encoding="utf-8")
    contract = (ROOT / "encodings" / "contract.lp").read_text(encoding="utf-8")
    names = set(re.findall(r"^#defined (\w+)/", contract, re.MULTILINE))
    assert {name for name in names if f"`{name}(" not in text} == set()


def test_the_picture_is_what_its_script_draws(tmp_path: Path) -> None:
    image = pytest.importorskip("PIL.Image")
    chops = pytest.importorskip("PIL.ImageChops")
    stat = pytest.importorskip("PIL.ImageStat")
    script = importlib.util.spec_from_file_location("film_strip", ROOT / "examples" / "film_strip.py")
    assert script is not None
    assert script.loader is not None
    module = importlib.util.module_from_spec(script)
    script.loader.exec_module(module)
    assert module.PICTURE.stat().st_size < 600_000
    with image.open(module.PICTURE) as committed:
        drawn = module.draw()
        assert drawn.size == committed.size
        difference = stat.Stat(chops.difference(drawn, committed.convert("RGB"))).mean
    # A newer Pillow may draw letters a little differently; another witness differs by more than this.
    assert max(difference) < 1.0, "draw it again: python examples/film_strip.py"


# The example domain, written again in Python from the definition of a valid plan: some complete initial state executes
# it. The set of all complete states that are still possible is carried along.

CUPS = ("cup_1", "cup_2")
SPOTS = ("table_1", "sink_1", "rack_1")
CAPACITY = 3
State = frozenset[tuple[str, ...]]
Plan = tuple[tuple[str, ...], ...]


def allowed(state: State) -> bool:
    """Tell whether a state satisfies the invariants."""
    for cup in CUPS:
        if sum((place, cup) in state for place in (*SPOTS, "held")) > 1:
            return False
        if ("rack_1", cup) in state and ("clean", cup) not in state:
            return False
    return not all(("held", cup) in state for cup in CUPS)


def first_states() -> set[State]:
    """Return all complete states that agree with what is said of the start."""
    fluents = [(place, cup) for place in (*SPOTS, "held", "clean") for cup in CUPS]
    subsets = itertools.chain.from_iterable(itertools.combinations(fluents, k) for k in range(len(fluents) + 1))
    states = set(map(frozenset, subsets))
    return {state for state in states if allowed(state) and not any(("held", cup) in state for cup in CUPS)}


def actions() -> list[tuple[str, ...]]:
    """Return all ground actions."""
    moves = itertools.product(("pick", "put"), CUPS, SPOTS)
    return [*moves, *(("wash", cup) for cup in CUPS), ("charge",)]


def results(state: State, action: tuple[str, ...]) -> list[State]:
    """Return the complete states that an action may lead to, none where its preconditions fail."""
    empty = not any(("held", cup) in state for cup in CUPS)
    name, *rest = action
    if name == "charge":
        return [state] if empty else []
    if name == "wash":
        ready = empty and ("sink_1", rest[0]) in state and ("clean", rest[0]) not in state
        return [state | {("clean", rest[0])}] if ready else []
    cup, spot = rest
    if name == "pick":
        after = state - {(spot, cup)} | {("held", cup)}
        return [after] if empty and (spot, cup) in state and allowed(after) else []
    if ("held", cup) not in state:
        return []
    after = state - {("held", cup)} | {(spot, cup)}
    options = [after] if spot != "table_1" else [after - {("clean", cup)}, after | {("clean", cup)}]
    return [option for option in options if allowed(option)]


def plans(length: int) -> list[Plan]:
    """Return all valid plans of a length."""
    found: list[tuple[Plan, set[State], int]] = [((), first_states(), CAPACITY)]
    for _ in range(length):
        longer = []
        for plan, states, battery in found:
            for action in actions():
                if battery == 0 and action != ("charge",):
                    continue
                after = {result for state in states for result in results(state, action)}
                if after:
                    longer.append(((*plan, action), after, CAPACITY if action == ("charge",) else battery - 1))
        found = longer
    return [plan for plan, states, _ in found if any(not any(("held", c) in s for c in CUPS) for s in states)]


def up_to_renaming(plan: Plan) -> Plan:
    """Return the same plan for plans that differ by swapping the two cups."""
    other = dict(zip(CUPS, reversed(CUPS), strict=True))
    return min(plan, tuple(tuple(other.get(part, part) for part in action) for action in plan))


def spelled(plan: Plan) -> tuple[str, ...]:
    return tuple(f"{name}({','.join(('panda', *rest))})" for name, *rest in plan)


@pytest.mark.parametrize("engine", ["automaton", "clingo"])
def test_the_example_counts_as_the_definition_says(engine: str) -> None:
    space = TaskSpace(load_domain(DISHES), 0, engine=engine)
    for length in range(6):
        valid = plans(length)
        assert set(space.at(length).words("plan")) == set(map(spelled, valid))
        assert space.at(length).count("plan") == len(valid)
        assert space.at(length).count("task") == len(set(map(up_to_renaming, valid)))
        assert space.at(length).count("skeleton") == len({tuple(name for name, *_ in plan) for plan in valid})


def updated() -> str:
    """Return README.md with what its commands print now; what is elided stays so where it still fits."""
    lines = README.read_text(encoding="utf-8").splitlines(keepends=True)
    with TemporaryDirectory() as made:
        prepare(Path(made))
        printed = list(run_all(Path(made)))
    for each, text in reversed(list(zip(commands(), printed, strict=True))):
        if not says(each.printed, text):
            lines[each.line : each.line + each.printed.count("\n")] = text.splitlines(keepends=True)
    return "".join(lines)


if __name__ == "__main__":
    README.write_text(updated(), encoding="utf-8")
