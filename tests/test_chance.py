"""Random tests draw the same in every run, anew where they are asked to, and what they failed for they try again."""

from __future__ import annotations

import ast
import os
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
CONFTEST = "from tests.conftest import *\n"
TOSSES = """
from pathlib import Path
from hypothesis import given, settings, strategies as st
from tests.chance import examples

def test_plain():
    with Path("plain.txt").open("a") as file:
        file.write("run\\n")

def test_own(chance):
    rng = chance.generator(3)
    with Path("own.txt").open("a") as file:
        print(*(rng.randrange(10**9) for _ in range(chance.examples(2))), file=file)

@settings(max_examples=examples(7))
@given(st.integers(0, 10**9))
def test_given(number):
    with Path("given.txt").open("a") as file:
        print(number, file=file)
"""
RARE = """
from hypothesis import given, settings, strategies as st
from tests.chance import examples

@settings(max_examples=examples(1))
@given(st.integers(0, 20))
def test_rare(number):
    {body}
"""


def run(folder: Path, text: str, *options: str, conftest: str = CONFTEST) -> subprocess.CompletedProcess[str]:
    """Run a file of tests with the conftest of these, or another one, in a folder of its own."""
    (folder / "conftest.py").write_text(conftest)
    (folder / "test_it.py").write_text(text)
    plugins = ("-p", "no:cacheprovider", "-p", "hypothesispytest")
    command = [sys.executable, "-m", "pytest", *plugins, "-c", os.devnull, "--rootdir", str(folder)]
    return subprocess.run(
        [*command, "--found", str(folder / "found"), *options, "test_it.py"],
        cwd=folder,
        # Others that happen to be installed are not loaded: half of the time of a start.
        env={**os.environ, "PYTHONPATH": str(ROOT), "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"},
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )


def drawn(folder: Path, *options: str) -> tuple[list[str], list[str], str]:
    """Return what the tests with chance drew, and what pytest printed."""
    done = run(folder, TOSSES, *options)
    assert done.returncode == 0, done.stdout
    own, given = folder / "own.txt", folder / "given.txt"
    found = own.read_text().split(), given.read_text().split(), done.stdout
    own.unlink()
    given.unlink()
    return found


def test_without_an_option_every_run_draws_the_same_and_runs_everything(tmp_path: Path) -> None:
    one, two = (drawn(tmp_path)[:2] for _ in range(2))
    assert one == two and [*map(len, one)] == [2, 7]
    assert (tmp_path / "plain.txt").read_text() == "run\n" * 2


def test_a_fresh_run_draws_anew_ten_times_as_often_in_random_tests_alone_and_its_seed_repeats_it(
    tmp_path: Path,
) -> None:
    usual = drawn(tmp_path)
    (tmp_path / "plain.txt").unlink()
    fresh, other = drawn(tmp_path, "--fresh", "-p", "xdist", "-n", "2"), drawn(tmp_path, "--fresh")
    for part in (0, 1):
        assert len(fresh[part]) == 10 * len(usual[part])
        # Hypothesis likes to draw a number again, so that not all differ.
        assert len({*fresh[part], *other[part]} - {*usual[part]}) > 2 * len(usual[part])
        assert {*fresh[part]} != {*other[part]}
    seed = re.search(r"again: pytest --seed (\d+)$", fresh[2], re.MULTILINE)
    assert seed is not None
    assert drawn(tmp_path, "--seed", seed[1])[:2] == fresh[:2]
    assert not (tmp_path / "plain.txt").exists()


def test_what_a_fresh_run_finds_is_tried_first_by_every_later_one_and_stays(tmp_path: Path) -> None:
    wrong, right = RARE.format(body="assert number != 13"), RARE.format(body="print('tried', number)")
    assert run(tmp_path, wrong).returncode == 0
    for seed in range(100):
        done = run(tmp_path, wrong, "--seed", str(seed))
        if done.returncode:
            break
    assert f"again: pytest --seed {seed}" in done.stdout.partition("random tests ==")[2]
    (found,) = (tmp_path / "found").rglob("*.*")
    assert found.parent.name == "test_rare"
    content = found.read_text()
    assert "number=13" in run(tmp_path, wrong).stdout
    edited = wrong.replace("assert", "assert number < 500 and")
    assert "number=13" in run(tmp_path, edited).stdout
    for options in ((), ("--seed", "1")):
        passed = run(tmp_path, right, "-s", *options)
        assert passed.returncode == 0 and re.findall(r"tried (\d+)", passed.stdout)[0] == "13"
    assert [*(tmp_path / "found").rglob("*.*")] == [found] and found.read_text() == content


def test_what_is_drawn_does_not_depend_on_the_modules_that_are_there(tmp_path: Path) -> None:
    (tmp_path / "constants.py").write_text(f"NUMBERS = {[*range(123_456, 124_456)]}\n")
    body = "[open('drawn.txt', 'a').write(f'{number} ') for number in numbers]"
    test = RARE.format(body=body).replace("st.integers(0, 20)", "st.lists(st.integers(0, 10**9))")
    test = test.replace("(number)", "(numbers)").replace("examples(1)", "examples(300)")
    found = []
    for module in ("", "import constants\n"):
        assert run(tmp_path, module + test).returncode == 0
        found.append((tmp_path / "drawn.txt").read_text())
        (tmp_path / "drawn.txt").unlink()
    assert found[0] == found[1]


def test_every_random_test_takes_its_seeds_and_its_number_of_examples_from_one_place() -> None:
    makers = {"Random", "default_rng", "SeededBits", "PCG64", "RandomState"}
    for path in (ROOT / "tests").rglob("test_*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if not isinstance(node, ast.Call):
                continue
            name = node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")
            place = f"{path}:{node.lineno}"
            if name == "settings":
                given = {keyword.arg: keyword.value for keyword in node.keywords}
                assert not given.keys() & {"derandomize", "database", "deadline"}, f"{place}: is set for all tests"
                assert isinstance(given.get("max_examples"), ast.Call), f"{place}: write max_examples=examples(...)"
            if name in makers and node.args:
                assert not isinstance(node.args[0], ast.Constant), f"{place}: take the seed from chance"
