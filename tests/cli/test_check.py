"""What ``prag-asp check`` warns of, and what other commands say of it."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from tests.commands import run

WAREHOUSE = Path(__file__).parents[2] / "examples" / "warehouse"
LINE = 'crate = { kind = "box", size = [0.10, 0.10, 0.10] }  # on purpose; lint: allow too-wide'


def warehouse(folder: Path, *changes: tuple[str, str], more: str = "") -> Path:
    """Copy the warehouse with other lines in its table, and return the table."""
    shutil.copytree(WAREHOUSE, folder)
    table = folder / "domain.toml"
    text = table.read_text(encoding="utf-8")
    for old, new in changes:
        text = text.replace(old, new)
    table.write_text(text + more, encoding="utf-8")
    return table


def warnings(folder: Path, *changes: tuple[str, str], more: str = "") -> list[str]:
    """Return the warnings about the changed warehouse; it is a valid domain all the same."""
    warehouse(folder, *changes, more=more)
    done = run("check", str(folder))
    assert done.returncode == 0 and done.stdout.startswith("it: ok")
    return done.stderr.splitlines()


@pytest.mark.parametrize(
    ("crate", "width"),
    [
        ('{ kind = "box", size = [0.078, 0.10, 0.02] }', "78"),
        ('{ kind = "box", size = [0.10, 0.10, 0.10] }', "100"),
        ('{ kind = "cylinder", radius = 0.0375, height = 0.05 }', "75"),
        ('{ kind = "box", size = { low = [0.0755, 0.10, 0.05], high = [0.09, 0.12, 0.05] } }', "75.5"),
        ('{ kind = "container", size = [0.20, 0.08, 0.05] }', "80"),
    ],
)
def test_what_a_gripper_cannot_close_around_is_told_with_its_width_and_the_limit(
    tmp_path: Path, crate: str, width: str
) -> None:
    place = f"{tmp_path / 'it' / 'domain.toml'}:13: warning: crate_1, crate_2"
    limit = "the gripper closes around at most 74 mm (it opens to 80 mm); make it narrower [too-wide]"
    line = f"crate = {crate}"
    assert warnings(tmp_path / "it", (LINE, line)) == [f"{place} are {width} mm wide, but {limit}"]
    assert warnings(tmp_path / "quiet" / "it", (LINE, f"{line}  # lint: allow too-wide")) == []


@pytest.mark.parametrize(
    ("crate", "material", "told"),
    [
        (
            '{ kind = "box", size = [0.06, 0.06, 0.06] }',
            "crate = { density = 7870, friction = 0.3 }",
            "are too heavy (1.7 kg): with a friction of 0.3, the gripper holds 1.03 kg at rest and lifts about "
            "0.873 kg; make it lighter or rougher [too-heavy]",
        ),
        (
            '{ kind = "box", size = [0.07, 0.07, 0.07] }',
            "crate = { density = 9000, friction = 5 }",
            "are too heavy (3.09 kg): the robot carries at most 3 kg; make it lighter [too-heavy]",
        ),
    ],
)
def test_what_is_too_heavy_is_told_with_the_limit_at_its_line(
    tmp_path: Path, crate: str, material: str, told: str
) -> None:
    found, table = warnings(tmp_path / "it", (LINE, f"crate = {crate}"), more=material), tmp_path / "it" / "domain.toml"
    line = len(table.read_text(encoding="utf-8").splitlines()) if material else 13
    assert found == [f"{table}:{line}: warning: crate_1, crate_2 {told}"]
    assert run("check", str(tmp_path / "it"), "--strict").returncode == 2


def test_a_flat_body_is_not_warned_of(tmp_path: Path) -> None:
    assert warnings(tmp_path / "it", (LINE, 'crate = { kind = "box", size = [0.05, 0.05, 0.003] }')) == []


@pytest.mark.parametrize(
    ("fixed", "told"),
    [
        (
            "shelf_1 = [0.95, 0.35]",
            "shelf_1 is out of reach: it is 0.886 m or more from panda, which reaches 0.28 to 0.76 m",
        ),
        ("shelf_1 = [0.00, 0.25]", ""),
        ("shelf_1 = [0.85, 0.00]", ""),
        ("shelf_1 = [0.86001, 0.00]", "shelf_1 is out of reach: it is 0.76 m or more from panda"),
    ],
)
def test_a_place_that_no_gripper_gets_to_is_told_at_its_line(tmp_path: Path, fixed: str, told: str) -> None:
    second = ("shelf_2 = [0.95, 0.00]", "shelf_2 = [0.50, -0.60]")
    lines = warnings(tmp_path / "it", ("shelf_1 = [0.50, 0.35]", fixed), second)
    assert len(lines) == bool(told), lines
    if told:
        table = tmp_path / "it" / "domain.toml"
        number = table.read_text(encoding="utf-8").splitlines().index(fixed) + 1
        assert lines[0].startswith(f"{table}:{number}: warning: {told}") and lines[0].endswith("[out-of-reach]")


@pytest.mark.parametrize(
    ("shelf", "fixed", "told"),
    [
        (
            '{ kind = "box", size = [0.20, 0.20, 0.36] }',
            "[0.50, 0.35]",
            "its top is 0.36 m high, and panda reaches 0.35 m high",
        ),
        ('{ kind = "zone", size = [0.10, 0.10] }', "[0.50, 0.35]", "no part of it is in the workspace"),
        ('{ kind = "zone", size = [0.10, 0.10] }', "[0.50, 0.15]", ""),
        ('{ kind = "container", size = [0.20, 0.20, 0.36] }', "[0.50, 0.35]", ""),
    ],
)
def test_a_place_that_is_too_high_or_where_nothing_is_put_is_told(
    tmp_path: Path, shelf: str, fixed: str, told: str
) -> None:
    changes = (
        ("shelf_1 = [0.50, 0.35]", f"shelf_1 = {fixed}"),
        ('{ kind = "box", size = [0.20, 0.20, 0.10] }', shelf),
        ("shelf_2 = [0.95, 0.00]", "shelf_2 = [0.50, 0.00]"),
    )
    lines = [line for line in warnings(tmp_path / "it", *changes) if "shelf_1" in line]
    assert len(lines) == bool(told) and told in "".join(lines)


@pytest.mark.parametrize(
    "crate",
    [
        '{ kind = "box", size = [0.074, 0.10, 0.10] }',
        '{ kind = "box", size = [0.078, 0.05, 0.10] }',
        '{ kind = "box", size = [0.05, 0.05, 0.078] }',
        '{ kind = "box", size = [0.05, 0.05, 0.0111] }',
        '{ kind = "box", size = { low = [0.07, 0.07, 0.05], high = [0.079, 0.079, 0.05] } }',
    ],
)
def test_what_can_be_grasped_is_no_warning(tmp_path: Path, crate: str) -> None:
    assert warnings(tmp_path / "it", (LINE, f"crate = {crate}")) == []


STUCK = """\
fluent(on). fluent(jammed). initially(on, false). initially(jammed, false).
action(press). precondition(press, on, false). postcondition(press, on, true).
action(force(left)). precondition(force(left), jammed, true).
action(force(right)). precondition(force(right), jammed, true).
heavy(cube).
"""


def test_check_tells_each_warning_in_a_line_and_how_many_actions_are_left(tmp_path: Path) -> None:
    (tmp_path / "domain.lp").write_text(STUCK, encoding="utf-8")
    done = run("check", str(tmp_path))
    assert done.returncode == 0
    assert done.stdout == f"{tmp_path.name}: ok; closed world, 0 entities, 2 fluents, 1 of 3 actions, no scene\n"
    *never, unused = done.stderr.splitlines()
    assert unused.startswith(f"{tmp_path}/domain.lp:5: warning: ") and unused.endswith("[unused]")
    assert [line.partition(" can never occur: it needs jammed = true, but ")[0] for line in never] == [
        f"{tmp_path}/domain.lp:3: warning: force(left)",
        f"{tmp_path}/domain.lp:4: warning: force(right)",
    ]


def test_other_commands_tell_the_number_of_warnings_in_one_line(tmp_path: Path) -> None:
    (tmp_path / "domain.lp").write_text(STUCK, encoding="utf-8")
    for command in (["count"], ["sample", "--count", "1"], ["stats"], ["enumerate"]):
        done = run(command[0], str(tmp_path), "--length", "1", *command[1:])
        assert done.returncode == 0 and done.stdout
        assert done.stderr == f"3 warnings about {tmp_path.name}; see prag-asp check {tmp_path}\n"


def test_strict_refuses_what_is_warned_of(tmp_path: Path) -> None:
    (tmp_path / "domain.lp").write_text(STUCK, encoding="utf-8")
    for arguments in (["check", str(tmp_path)], ["count", str(tmp_path), "--length", "1"]):
        done = run(*arguments, "--strict")
        assert (done.returncode, done.stdout, len(done.stderr.splitlines())) == (2, "", 3)
        assert "warning" not in done.stderr
    (tmp_path / "domain.lp").write_text("action(go).\n", encoding="utf-8")
    assert run("check", str(tmp_path), "--strict").returncode == 0


def test_strict_refuses_a_body_that_no_gripper_closes_around(tmp_path: Path) -> None:
    warehouse(tmp_path / "it", (LINE, 'crate = { kind = "box", size = [0.078, 0.10, 0.02] }'))
    done = run("check", str(tmp_path / "it"), "--strict")
    assert (done.returncode, done.stdout) == (2, "") and done.stderr.rstrip().endswith("[too-wide]")
