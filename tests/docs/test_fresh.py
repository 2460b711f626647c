"""The pages on data sets, word by word as somebody new to them: an empty environment, then what they say to install."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

import pytest

from tests.docs.pages import FRESH, ROOT, blocks

NEEDED = ("prag_asp", "encodings", "domains", "suites", "pyproject.toml", "README.md", "LICENSE", "examples", "docs")
READER = ("__init__.py", "docs/__init__.py", "docs/pages.py")
"""What runs the examples of a page; it imports nothing that the page does not say to install."""

HERE = ("VIRTUAL_ENV", "PYTHONPATH", "PYTHONPYCACHEPREFIX")
"""Variables that lead back to the environment of the tests."""

BEGIN, INSTALL = "python3 -m venv .venv", ".venv/bin/pip install "

RUN = """
import sys
from pathlib import Path
from tests.docs.pages import DOCS, prepare, run_page
prepare(Path.cwd())
print(*[each for each in run_page(DOCS / "guides" / sys.argv[1], Path.cwd()) if not each.right], sep="\\n", end="")
"""


@pytest.mark.slow
def test_the_pages_on_data_sets_need_what_they_say_and_no_more(tmp_path: Path) -> None:
    clone, reader = tmp_path / "clone", tmp_path / "reader"
    for name in NEEDED:
        kept = shutil.ignore_patterns("__pycache__")
        if (ROOT / name).is_dir():
            shutil.copytree(ROOT / name, clone / name, ignore=kept)
        else:
            shutil.copy(ROOT / name, clone / name)
    for name in READER:
        (reader / "tests" / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / "tests" / name, reader / "tests" / name)
    for name in ("docs", "encodings", "examples"):
        (reader / name).symlink_to(clone / name)
    said = "".join(block.text for page in FRESH for block in blocks(page) if block.language == "sh").splitlines()
    assert said[0].startswith(BEGIN)
    outside = {name: value for name, value in os.environ.items() if name not in HERE}
    outside["PIP_NO_COMPILE"] = "1"  # most modules of large packages are never imported
    call(["sh", "-ec", f"{BEGIN} && {at_once(said)}"], clone, outside)
    for page in FRESH:
        work = tmp_path / page.stem
        work.mkdir()
        command = [str(clone / ".venv/bin/python"), "-c", RUN, page.name]
        wrong = call(command, work, {**outside, "PYTHONPATH": str(reader)})
        assert not wrong, f"write them anew: python -m tests.docs.pages\n{wrong}"


def at_once(said: list[str]) -> str:
    """Return one installation of all that some lines install one after the other, word by word as they say it.

    What each of them does before it comes to its packages, among it to build this one, is done once.
    """
    installs = [line.removeprefix(f"{BEGIN} && ") for line in said]
    assert {line for line in installs if not line.startswith(INSTALL)} == {". .venv/bin/activate"}
    return " ".join([INSTALL, *(line.removeprefix(INSTALL) for line in installs if line.startswith(INSTALL))])


def call(command: list[str], folder: Path, environment: dict[str, str]) -> str:
    """Return what a command prints, which succeeds."""
    done = subprocess.run(command, capture_output=True, text=True, cwd=folder, env=environment, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout
