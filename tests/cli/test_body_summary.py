"""What `check` says of bodies from files: their grasps by direction, and containers without a cavity."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

from click.testing import CliRunner, Result

from prag_asp.cli import cli

MODELS = Path(__file__).parents[1] / "physics" / "scenes" / "models"
LOGIC = """
class(robot). class(table). class(cube). class(thing).
entity(panda,robot). entity(table_1,table). entity(cube_1,cube). entity(thing_1,thing).
fluent(inside(O,C)) :- is_a(O,cube), is_a(C,thing). fluent(on_top(O,T)) :- is_a(O,cube), is_a(T,table).
initially(on_top(cube_1,table_1),true). action(put(O,C)) :- is_a(O,cube), is_a(C,thing).
postcondition(put(O,C),inside(O,C),true) :- action(put(O,C)).
"""
SCENE = """
[scene.shapes]
robot = {{ kind = "robot" }}
table = {{ kind = "table" }}
cube = {{ kind = "box", size = [0.05, 0.05, 0.05] }}
thing = {{ kind = "urdf", path = "{name}.urdf" }}
"""


def checked(folder: Path, name: str) -> Result:
    shutil.copy(MODELS / f"{name}.urdf", folder)
    (folder / "domain.lp").write_text(LOGIC)
    (folder / "domain.toml").write_text(SCENE.format(name=name))
    return CliRunner().invoke(cli, ["check", str(folder)])


def test_check_counts_the_grasps_of_a_bowl_and_names_its_cavity(tmp_path: Path) -> None:
    result = checked(tmp_path, "bowl")
    assert result.exit_code == 0 and "warning" not in result.output
    assert "cavity: 136 x 136 x 49 mm" in result.output
    above, slanted, side = map(int, re.findall(r"(\d+) (?:from above|at an angle|from the side)", result.output))
    assert above > 8 and slanted >= 0 and side == 0


def test_check_warns_of_a_ring_into_which_the_logic_puts_things(tmp_path: Path) -> None:
    result = checked(tmp_path, "ring")
    assert result.exit_code == 0
    assert "domain.toml:6: warning: thing_1 is not a container: its file has no cavity" in result.output
    assert result.output.count("no-cavity") == 1
