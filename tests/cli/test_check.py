"""What ``prag-asp check`` warns of: bodies that are never grasped though no proof says so."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from tests.commands import run

WAREHOUSE = Path(__file__).parents[2] / "examples" / "warehouse"
LINE = 'crate = { kind = "box", size = [0.10, 0.10, 0.10] }'


def warnings(folder: Path, crate: str) -> list[str]:
    """Return the warnings about the warehouse with crates of another shape; it is a fine domain all the same."""
    shutil.copytree(WAREHOUSE, folder)
    table = folder / "domain.toml"
    table.write_text(table.read_text(encoding="utf-8").replace(LINE, f"crate = {crate}"), encoding="utf-8")
    done = run("check", str(folder))
    assert done.returncode == 0 and done.stdout.startswith("it: ok")
    return done.stderr.splitlines()


@pytest.mark.parametrize(
    ("crate", "width"),
    [
        ('{ kind = "box", size = [0.078, 0.10, 0.02] }', "78"),
        ('{ kind = "cylinder", radius = 0.0375, height = 0.05 }', "75"),
        ('{ kind = "box", size = { low = [0.0755, 0.10, 0.05], high = [0.09, 0.12, 0.05] } }', "75.5"),
        ('{ kind = "container", size = [0.20, 0.08, 0.05] }', "80"),
    ],
)
def test_what_a_gripper_cannot_close_around_is_told_with_its_width_and_the_limit(
    tmp_path: Path, crate: str, width: str
) -> None:
    place = f"warning: {tmp_path / 'it' / 'domain.toml'}:13: "
    told = (
        f"are {width} mm wide and the gripper opens 80 mm; it never closes around more than 74 mm, so make it narrower"
    )
    assert warnings(tmp_path / "it", crate) == [f"{place}crate_1, crate_2 {told}"]


@pytest.mark.parametrize(
    "crate",
    [
        '{ kind = "box", size = [0.074, 0.10, 0.10] }',
        '{ kind = "box", size = [0.078, 0.05, 0.10] }',
        '{ kind = "box", size = [0.05, 0.05, 0.078] }',
        '{ kind = "box", size = { low = [0.07, 0.07, 0.05], high = [0.079, 0.079, 0.05] } }',
        '{ kind = "box", size = [0.081, 0.10, 0.02] }',
    ],
)
def test_what_can_be_grasped_or_is_proved_too_wide_is_no_warning(tmp_path: Path, crate: str) -> None:
    assert warnings(tmp_path / "it", crate) == []
