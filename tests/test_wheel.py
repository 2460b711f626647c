"""The wheel, installed into a fresh environment, works from an empty folder."""

from __future__ import annotations

import subprocess
import sys
from email import message_from_bytes
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


@pytest.mark.slow
def test_the_wheel_works_in_a_fresh_environment(tmp_path: Path) -> None:
    empty = tmp_path / "empty"
    empty.mkdir()
    call(sys.executable, "-m", "pip", "wheel", "--no-deps", "--quiet", "-w", tmp_path, ROOT, cwd=empty)
    (wheel,) = tmp_path.glob("*.whl")
    assert described(wheel).strip() == long_description().strip()
    call(sys.executable, "-m", "venv", tmp_path / "venv", cwd=empty)
    home = tmp_path / "venv" / "bin"
    call(home / "pip", "install", "--quiet", wheel, cwd=empty)
    assert call(home / "prag-asp", "count", "prag", "-n", "15", "--by", "skeleton", cwd=empty) == "4266036480\n"
    assert "tabletop" in call(home / "prag-asp", "domains", cwd=empty)
    tasks = call(home / "prag-asp", "sample", "tabletop", "-n", "3", "--count", "2", "--rule", "no_undo", cwd=empty)
    assert len(tasks.splitlines()) == 2
    call(home / "prag-asp", "new", "mine", cwd=empty)
    assert call(home / "prag-asp", "check", "mine", cwd=empty).startswith("mine: ok")
