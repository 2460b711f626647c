"""Conditions, ranks and splits on the command line."""

from __future__ import annotations

from math import perm
from pathlib import Path

import pytest

from prag_asp.cli import cli
from prag_asp.cli.exits import Exit
from tests.commands import ok, ok_apart, run


@pytest.mark.parametrize("engine", ["automaton", "clingo", "sat"])
def test_conditions_are_all_satisfied_with_every_engine(engine: str) -> None:
    arguments = ["--where", "uses apple", "--where", "nontrivial", "--engine", engine]
    assert ok("count", "prag", "-n", "3", *arguments) == "708\n"
    listed = ok("enumerate", "prag", "-n", "2", "--where", "begins grasp", "--where", "lacks drop", "--engine", engine)
    assert all(line.startswith("grasp(") and "drop" not in line for line in listed.splitlines())
    assert len(listed.splitlines()) == int(
        ok("count", "prag", "-n", "2", "--where", "begins grasp", "--where", "lacks drop")
    )


def test_a_task_is_shown_by_its_rank_and_found_again() -> None:
    shown = ok("task", "prag", "-n", "9", "--index", "123456789", "--format", "text").strip()
    assert ok("task", "prag", "-n", "9", "--rank-of", shown) == "123456789\n"
    full = ok("task", "prag", "-n", "9", "--index", "123456789").splitlines()
    assert full[0] == "task 123456789 of 599973676"
    assert [line.split()[1] for line in full[2:-1]] == shown.split()
    assert ok("task", "prag", "-n", "3", "--index", "-1") == ok("task", "prag", "-n", "3", "--index", "2091")


def test_a_task_tells_its_readings() -> None:
    lines = ok("task", "kitchen", "-n", "7", "--index", "0", "--where", "begins open, approach").splitlines()
    assert any(line.startswith("read ") and "pick_and_place" in line for line in lines)


def test_a_split_prints_its_sizes_and_writes_different_tasks(tmp_path: Path) -> None:
    folder = tmp_path / "new" / "parts"
    arguments = ["train=0.8", "test=0.2", "--seed", "4"]
    told = ok_apart("split", "prag", "-n", "3", *arguments, "--count", "100", "-o", str(folder))
    assert told.split() == ["train", "1674", "test", "418"]
    parts = {name: (folder / f"{name}.txt").read_text().splitlines() for name in ("train", "test")}
    assert all(len(set(lines)) == 100 for lines in parts.values())
    assert not set(parts["train"]) & set(parts["test"])
    again = tmp_path / "again"
    ok("split", "prag", "-n", "3", *arguments, "--count", "100", "-o", str(again))
    assert (again / "test.txt").read_bytes() == (folder / "test.txt").read_bytes()


def test_skeletons_are_split_and_things_are_held_out(tmp_path: Path) -> None:
    ok("split", "prag", "-n", "3", "a=1/2", "b=1/2", "--skeletons", "--count", "200", "-o", str(tmp_path))
    skeletons = [
        {
            tuple(action.partition("(")[0] for action in line.split())
            for line in (tmp_path / name).read_text().splitlines()
        }
        for name in ("a.txt", "b.txt")
    ]
    assert skeletons[0] and skeletons[1] and not skeletons[0] & skeletons[1]
    assert ok("split", "prag", "-n", "3", "--hold-out", "can_1").split() == ["train", "1388", "test", "704"]


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["count", "prag", "-n", "3", "--where", "hass grasp"], "did you mean has?"),
        (["count", "prag", "-n", "3", "--where", ""], "condition ''"),
        (["task", "prag", "-n", "3"], "give --index or --rank-of"),
        (["task", "prag", "-n", "3", "--index", "2092"], "the space has 2092 tasks, ranked from 0"),
        (["task", "prag", "-n", "3", "--rank-of", "drop(panda,can_1)"], "no task of"),
        (["split", "prag", "-n", "3"], "give shares, such as"),
        (["split", "prag", "-n", "3", "train=0.8"], "add up to 1"),
        (["split", "prag", "-n", "3", "train=0.8", "train=0.2"], "different names"),
        (["split", "prag", "-n", "3", "a/b=0.8", "c=0.2"], "different names"),
        (["split", "prag", "-n", "3", "a=0.8", "c=0.2", "--count", "3"], "--count and --output together"),
        (["split", "prag", "-n", "3", "--hold-out", "apple_1"], "interchangeable with apple_2"),
        (["split", "prag", "-n", "3", "--hold-out", "banana"], "no entity or class 'banana'"),
        (["count", "prag", "-n", "3", "--time", "soon"], "write a time above 0"),
        (["count", "prag", "-n", "3", "--memory", "much"], "write a number of bytes"),
        (["count", "prag", "-n", "3", "--memory", "4000"], "4,000 bytes are too few for any command; write 500MB"),
    ],
)
def test_bad_questions_are_answered_by_one_line(arguments: list[str], told: str) -> None:
    done = run(*arguments)
    assert done.returncode == 2 and done.stdout == ""
    assert told in done.stderr and len(done.stderr.strip().splitlines()) == 1


def test_auto_says_in_one_line_why_it_takes_clingo_and_nothing_where_it_does_not(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(
        "prag_asp.space.engines.auto_engine.PATIENCE", 1e9
    )  # no counter beside clingo, be it ever so slow
    asked = ["count", "prag", "-n", "2..3", "--by", "plan", "--no-cache"]
    assert cli.main(asked) == 0
    assert capsys.readouterr().err == ""
    assert cli.main([*asked, "--where", "loop-free"]) == 0
    told = capsys.readouterr().err
    assert told.startswith("note: engine clingo, because ") and told.count("\n") == 1


def test_what_grounds_all_entities_says_so_before_it_does(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("prag_asp.reduction.reduction.MANY", 600)
    path = tmp_path / "lamps.lp"
    path.write_text(
        "class(lamp). entity(lamp(1..25), lamp). fluent((lit(L);hot(L))) :- is_a(L,lamp). "
        "initially(lit(L),false) :- is_a(L,lamp). initially(hot(L),false) :- is_a(L,lamp). "
        "action(light(L)) :- is_a(L,lamp). "
        "precondition(light(L),lit(L),false) :- is_a(L,lamp). postcondition(light(L),lit(L),true) :- is_a(L,lamp). "
        "exclusive(hot(L),hot(M)) :- is_a(L,lamp), is_a(M,lamp), L != M."
    )
    asked = ["count", str(path), "-n", "1", "--by", "plan", "--no-cache"]
    assert cli.main(asked) == 0
    assert capsys.readouterr() == ("25\n", "")
    for more in (["--where", "uses lamp"], ["--prefix", "light(lamp(7))"]):
        assert cli.main([*asked, *more]) == 0
        out, err = capsys.readouterr()
        assert out == ("25\n" if "--where" in more else "1\n")
        assert err.startswith("note: all entities are ground (25 like lamp(1)): ") and err.count("\n") == 1
    done = run(*asked, "--where", "uses lamp", "--time", "0.001s")
    assert done.returncode == Exit.LIMIT


def test_a_statement_that_has_all_entities_ground_is_told_of(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "lamps.lp"
    path.write_text(
        "class(lamp). entity(lamp(1..150), lamp). fluent((dark;lit(L))) :- is_a(L,lamp). "
        "initially(F,false) :- fluent(F). "
        "action(light(L)) :- is_a(L,lamp). precondition(light(L),lit(M),false) :- is_a(L,lamp), is_a(M,lamp). "
        "postcondition(light(L),lit(L),true) :- is_a(L,lamp). "
        "precondition(light(L),dark,false) :- is_a(L,lamp), #count { M : is_a(M,lamp) } > 2."
    )
    assert cli.main(["count", str(path), "-n", "1", "--by", "plan", "--no-cache"]) == 0
    out, err = capsys.readouterr()
    assert out == "150\n"
    assert err.startswith("note: all entities are ground, though many are alike: ") and err.count("\n") == 1


def test_auto_says_in_one_line_why_it_takes_diagrams(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Twelve lamps, which go out of use together, on a machine that has memory for a few."""
    monkeypatch.setattr("prag_asp.space.engines.auto_engine.usual_memory", lambda: 4_000)
    monkeypatch.setattr(
        "prag_asp.space.engines.auto_engine.Growth.hopeless", lambda self, extent, length: extent.depth > 3
    )
    for name in ("PATIENCE", "MORE_PATIENCE"):
        monkeypatch.setattr(f"prag_asp.space.engines.reachability.{name}", 100)
    (tmp_path / "domain.lp").write_text(
        "fluent((cut;lit(1..12))). initially(F,false) :- fluent(F). action((off;on(1..12))). "
        "precondition(A,cut,false) :- action(A). postcondition(off,cut,true). "
        "precondition(on(I),lit(I),false) :- action(on(I)). postcondition(on(I),lit(I),true) :- action(on(I)).\n"
    )
    assert cli.main(["count", str(tmp_path), "-n", "5..6", "--by", "plan", "--no-cache"]) == 0
    out, err = capsys.readouterr()
    assert [line.split()[-1] for line in out.splitlines()][-2:] == [str(perm(12, n) + perm(12, n - 1)) for n in (5, 6)]
    assert err.startswith("note: engine symbolic, because ") and err.count("\n") == 1


def test_a_distance_that_no_task_has_is_reported() -> None:
    done = run("split", "prag", "--length", "3", "train=1/2", "test=1/2", "--skeletons", "--distance", "50")
    assert (done.returncode, done.stdout) == (0, "train  1051\ntest   0\n")
    assert done.stderr == "test: no task is 50 edits or more from training; give a smaller --distance\n"
