"""Numbers of all kinds, wherever a command takes one: each has its meaning, or a line refuses it."""

from __future__ import annotations

from pathlib import Path

import pytest

from prag_asp.cli.exits import Exit
from tests.commands import run

HUGE = f"1{'0' * 5000}"
ODD = ("-0", "-1", "1e-320", "nan", f"1{'0' * 30}", "1/3", "2.5", "", "1e999999999", HUGE)

OPTIONS = (
    "count prag --length {}",
    "count prag --length 1..{}",
    "count prag --length 1 --memory {}",
    "count prag --length 1 --time {}",
    "count prag --length 1 --rule at_most(grasp,{})",
    "count prag --length 1 --approximate --epsilon {}",
    "count prag --length 1 --approximate --delta {}",
    "sample prag --length 1 --no-physics --count 1 --weight grasp={}",
    "sample prag --length 1 --no-physics --count 1 --weight grasp=2 --temperature {}",
    "sample prag --length 1 --no-physics --count 1 --seed {}",
    "sample prag --length 1 --no-physics --count {}",
    "sample prag --length 1 --count 0 --budget {}x1",
    "sample prag --length 1 --count 0 --workers {}",
    "split prag --length 1 a={} b=1/2",
    "task prag --length 1 --index {}",
    "enumerate prag --length 1 --limit {}",
    "power --effect 0.1 --power {}",
    "power --effect 0.1 --rate {}",
    "power --effect 0.1 --alpha {}",
    "power --effect 0.1 --paired {}",
    "power --scenarios {}",
)


@pytest.mark.parametrize("command", OPTIONS)
def test_each_number_of_an_option_has_its_meaning_or_is_refused_by_a_short_line(command: str) -> None:
    for number in ODD:
        done = run(*(word.replace("{}", number) for word in command.split(" ")))
        assert done.returncode in {Exit.DONE, Exit.BAD_INPUT, Exit.USAGE}, number
        assert (done.returncode == Exit.DONE) == (not done.stderr) or done.stderr.startswith("note: "), number
        if done.returncode:
            assert done.stderr.count("\n") == 1 and len(done.stderr) < 300, done.stderr


SETTINGS = {
    "weights": "open = {}",
    "scene": "balance = {}",
    "scene.shapes": 'cup = { kind = "cylinder", radius = {}, height = 0.06 }',
    "scene.materials": "dish = { density = {} }",
    "scene.fixed": "bowl_1 = [0.60, {}]",
    "scene.rotations": "straight = {}",
    "scene.cameras.side": "at = [0.5, 1.2, 0.5]\nlook_at = [0.45, 0.0, 0.1]\nsize = [{}, 120]",
    "scene.vary": "light = {}",
}
TOML = ("-0.0", "1e-320", "1e308", "nan", f"1{'0' * 30}", '"1/3"', "true", "1e999999999", "1979-05-27", HUGE)


@pytest.mark.parametrize("table", SETTINGS)
def test_each_number_of_a_table_has_its_meaning_or_is_refused_by_its_line(table: str, tmp_path: Path) -> None:
    (tmp_path / "domain.lp").write_text(
        "class(dish). class(cup,dish). entity(cup_1,cup). entity(bowl_1,dish).\n"
        "fluent(open). initially(open,false). action(open). postcondition(open,open,true).\n"
    )
    settings = tmp_path / "domain.toml"
    for number in TOML:
        settings.write_text(f"[{table}]\n{SETTINGS[table].replace('{}', number)}\n")
        done = run("check", str(tmp_path))
        assert done.returncode in {Exit.DONE, Exit.BAD_INPUT}, number
        if done.returncode:
            lines = done.stderr.splitlines()
            assert all(f"{settings}:" in line and len(line) < 400 + len(str(settings)) for line in lines), done.stderr
