"""The wheel has what it needs and no more, and works from an empty folder of a fresh environment."""

from __future__ import annotations

import subprocess
import sys
from email import message_from_bytes
from email.parser import HeaderParser
from pathlib import Path
from zipfile import ZipFile

import pytest

from tests.docs.test_readme import long_description

ROOT = Path(__file__).parent.parent


def call(*command: str | Path, cwd: Path) -> str:
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True, cwd=cwd, check=False)
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
    extras = {"approximate", "datasets", "docs", "formats", "learning", "pddl", "pictures", "ray", "rl", "sharp"}
    assert set(told.get_all("Provides-Extra", [])) == {*extras, "test"}


def test_a_package_index_shows_the_readme(wheel: Path) -> None:
    assert described(wheel).strip() == long_description().strip()


@pytest.mark.slow
def test_the_wheel_works_in_a_fresh_environment(wheel: Path, tmp_path: Path) -> None:
    empty = tmp_path / "empty"
    empty.mkdir()
    call(sys.executable, "-m", "venv", "--without-pip", tmp_path / "venv", cwd=empty)
    home = tmp_path / "venv" / "bin"
    pip = (sys.executable, "-m", "pip", "--python", home / "python")
    call(*pip, "install", "--quiet", "--no-compile", wheel, cwd=empty)
    assert call(home / "prag-asp", "count", "prag", "-n", "15", "--by", "skeleton", cwd=empty) == "4266036480\n"
    assert "tabletop" in call(home / "prag-asp", "domains", cwd=empty)
    tasks = call(home / "prag-asp", "sample", "tabletop", "-n", "3", "--count", "2", "--rule", "no_undo", cwd=empty)
    assert len(tasks.splitlines()) == 2
    call(home / "prag-asp", "new", "mine", cwd=empty)
    assert call(home / "prag-asp", "check", "mine", cwd=empty).startswith("mine: ok")
