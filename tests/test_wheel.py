"""The wheel has what it needs and no more, and works from an empty folder of a fresh environment, as pages say."""

from __future__ import annotations

import os
import shlex
import shutil
import subprocess
import sys
from email import message_from_bytes
from email.parser import HeaderParser
from pathlib import Path
from zipfile import ZipFile

import pytest

from tests.bare import PROJECT, link, packages
from tests.docs.pages import FRESH, blocks
from tests.docs.test_readme import long_description

ROOT = Path(__file__).parent.parent

READER = ("__init__.py", "docs/__init__.py", "docs/pages.py")
"""What runs the examples of a page; it imports nothing that the page does not say to install."""

HERE = ("VIRTUAL_ENV", "PYTHONPATH", "PYTHONPYCACHEPREFIX")
"""Variables that lead back to the environment of the tests."""

BEGIN, INSTALL = "python3 -m venv .venv", ".venv/bin/pip install "

RUN = """
import sys
from pathlib import Path
from tests.docs.pages import DOCS, prepare, run_page
for name in sys.argv[1:]:
    folder = Path.cwd() / name
    folder.mkdir()
    prepare(folder)
    print(*[each for each in run_page(DOCS / "guides" / name, folder) if not each.right], sep="\\n", end="")
"""


def call(*command: str | Path, cwd: Path, env: dict[str, str] | None = None) -> str:
    command_line = [str(part) for part in command]
    done = subprocess.run(command_line, capture_output=True, text=True, cwd=cwd, env=env, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


def described(wheel: Path) -> str:
    """Return what a package index shows of a wheel."""
    with ZipFile(wheel) as files:
        (name,) = (name for name in files.namelist() if name.endswith(".dist-info/METADATA"))
        metadata = message_from_bytes(files.read(name))
    assert metadata["Description-Content-Type"] == "text/markdown"
    return metadata.get_payload(decode=True).decode()


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("wheel")
    call(sys.executable, "-m", "pip", "wheel", "--no-deps", "--quiet", "-w", folder, ROOT, cwd=folder)
    (built,) = folder.glob("*.whl")
    return built


def test_the_wheel_has_the_package_its_encodings_and_domains_and_nothing_else(wheel: Path) -> None:
    own = [(path, path.relative_to(ROOT)) for path in (ROOT / "prag_asp").rglob("*")]
    data = [path for room in ("encodings", "domains", "suites") for path in (ROOT / room).rglob("*")]
    places = [*own, *((path, Path("prag_asp", path.relative_to(ROOT))) for path in data)]
    expected = {str(place) for path, place in places if path.is_file() and "__pycache__" not in path.parts}
    with ZipFile(wheel) as archive:
        names = {name for name in archive.namelist() if ".dist-info/" not in name}
    assert names == expected and "prag_asp/py.typed" in names


def test_its_metadata_let_every_python_from_3_10_on_install_it(wheel: Path) -> None:
    with ZipFile(wheel) as archive:
        (name,) = (each for each in archive.namelist() if each.endswith("/METADATA"))
        told = HeaderParser().parsestr(archive.read(name).decode())
    assert told["Requires-Python"] == ">=3.10"
    classifiers = told.get_all("Classifier", [])
    assert {f"Programming Language :: Python :: 3.{minor}" for minor in range(10, 15)} <= set(classifiers)
    extras = {
        "approximate",
        "datasets",
        "docs",
        "formats",
        "learning",
        "lerobot",
        "meshes",
        "pictures",
        "ray",
        "rerun",
        "rl",
        "servers",
        "sharp",
        "similarity",
    }
    assert set(told.get_all("Provides-Extra", [])) == {*extras, "test"}


def test_a_package_index_shows_the_readme(wheel: Path) -> None:
    assert described(wheel).strip() == long_description().strip()


@pytest.fixture(scope="module")
def fresh(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a new environment with the wheel, and what pip installs with it."""
    folder = tmp_path_factory.mktemp("fresh")
    call(sys.executable, "-m", "venv", "--without-pip", folder / "venv", cwd=folder)
    pip = (sys.executable, "-m", "pip", "--python", folder / "venv" / "bin" / "python")
    call(*pip, "install", "--quiet", "--no-compile", wheel, cwd=folder)
    return folder / "venv"


@pytest.mark.slow
def test_the_wheel_works_in_a_fresh_environment(fresh: Path, tmp_path: Path) -> None:
    home = fresh / "bin"
    assert call(home / "prag-asp", "count", "prag", "-n", "15", "--by", "skeleton", cwd=tmp_path) == "4266036480\n"
    assert "tabletop" in call(home / "prag-asp", "domains", cwd=tmp_path)
    tasks = call(home / "prag-asp", "sample", "tabletop", "-n", "3", "--count", "2", "--rule", "no_undo", cwd=tmp_path)
    assert len(tasks.splitlines()) == 2
    call(home / "prag-asp", "new", "mine", cwd=tmp_path)
    assert call(home / "prag-asp", "check", "mine", cwd=tmp_path).startswith("mine: ok")


@pytest.mark.slow
def test_the_pages_on_data_sets_need_what_they_say_and_no_more(fresh: Path, tmp_path: Path) -> None:
    """Word by word as somebody new to them, but that pip installed the wheel: what else they say is linked to it."""
    environment, reader = tmp_path / "venv", tmp_path / "reader"
    beside(fresh, environment)
    for name in READER:
        (reader / "tests" / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / "tests" / name, reader / "tests" / name)
    for name in ("docs", "encodings", "examples"):
        (reader / name).symlink_to(ROOT / name)
    link(environment, *said())
    outside = {name: value for name, value in os.environ.items() if name not in HERE}
    work = tmp_path / "work"
    work.mkdir()
    command = (environment / "bin" / "python", "-c", RUN, *(page.name for page in FRESH))
    own = {"PYTHONPATH": str(reader), "PRAG_ASP_CACHE": str(tmp_path / "cache")}  # which somebody new has too
    wrong = call(*command, cwd=work, env={**outside, **own})
    assert not wrong, f"write them anew: python -m tests.docs.pages\n{wrong}"


def beside(fresh: Path, folder: Path) -> None:
    """Make an environment that has all that another one has, and its program."""
    call(sys.executable, "-m", "venv", "--without-pip", folder, cwd=fresh)
    (packages(folder) / "fresh.pth").write_text(f"{packages(fresh)}\n")
    program = Path(shutil.copy(fresh / "bin" / "prag-asp", folder / "bin"))
    program.write_text(program.read_text().replace(str(fresh), str(folder)))


def said() -> list[str]:
    """Return what the pages say to install into a new environment, beside this package without an extra."""
    lines = "".join(block.text for page in FRESH for block in blocks(page) if block.language == "sh").splitlines()
    assert lines[0].startswith(BEGIN)
    installs = [line.removeprefix(f"{BEGIN} && ") for line in lines]
    assert {line for line in installs if not line.startswith(INSTALL)} == {". .venv/bin/activate"}
    wanted = [each for line in installs if line.startswith(INSTALL) for each in shlex.split(line)[2:]]
    extras = [extra for each in wanted if each.startswith(".") for extra in each[1:].strip("[]").split(",")]
    own = [each for extra in extras for each in PROJECT["optional-dependencies"][extra]]
    return [*own, *(each for each in wanted if not each.startswith("."))]
