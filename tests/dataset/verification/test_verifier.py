"""Each of many corruptions of a dataset is found where it is, and nothing on a clean one."""

from __future__ import annotations

import json
import re
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import msgspec
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from prag_asp import Dataset, Domain, QueryError, TaskSpace
from prag_asp.dataset import generate, instruction_writer_of, verify
from prag_asp.dataset.store.schema import SCHEMAS
from prag_asp.dataset.store.shards import shard_name, write_shard
from prag_asp.dataset.verification import row_checks, verifier
from prag_asp.dataset.verification.row_checks import clingo_spaces
from prag_asp.physics import Staging
from tests.commands import run
from tests.dataset.conftest import Change, with_json

Table = list[dict[str, Any]]
TRAIN, TEST = "data/train-00000.parquet", "data/test-00000.parquet"


def noted(change: Callable[[Any], object]) -> Change:
    return with_json("dataset.json", change)


def forged(change: Callable[[Table], object], table: str = "tasks", part: str = "train") -> Change:
    """Return what changes the rows of a part's first shard, and makes dataset.json say that it is to be so."""

    def changed(folder: Path) -> None:
        rows = rows_of(folder, table, part)
        change(rows)
        found = write_shard(folder, table, part, 0, pa.Table.from_pylist(rows, SCHEMAS[table]))
        noted(lambda told: shard_of(told, part)["files"].update({table: msgspec.to_builtins(found)}))(folder)

    return changed


def rows_of(folder: Path, table: str, part: str) -> Table:
    found: Table = pq.read_table(folder / shard_name(table, part, 0)).to_pylist()
    return found


def part_of(manifest: Any, part: str) -> Any:
    return next(each for each in manifest["parts"] if each["name"] == part)


def shard_of(manifest: Any, part: str) -> Any:
    return part_of(manifest, part)["shards"][0]


def with_bytes(name: str, change: Callable[[bytes], bytes]) -> Change:
    def changed(folder: Path) -> None:
        (folder / name).write_bytes(change((folder / name).read_bytes()))

    return changed


def flipped(content: bytes) -> bytes:
    middle = len(content) // 2
    return content[:middle] + bytes([content[middle] ^ 1]) + content[middle + 1 :]


def linked(folder: Path) -> None:
    shutil.move(folder / TEST, folder.parent / "elsewhere.parquet")
    (folder / TEST).symlink_to(folder.parent / "elsewhere.parquet")


def of_another_part(folder: Path) -> None:
    row = rows_of(folder, "tasks", "train")[0]
    forged(lambda rows: rows.__setitem__(0, {**row, "draw": rows[0]["draw"]}), part="test")(folder)


def refused_as_task(folder: Path) -> None:
    row = rows_of(folder, "rejected", "train")[0]
    forged(lambda rows: rows[0].update(verdict=row["verdict"]))(folder)


def in_row(**values: Callable[[Any], Any]) -> Change:
    """Return what changes values of the second row of the first part."""
    return forged(lambda rows: rows[1].update({name: change(rows[1][name]) for name, change in values.items()}))


def other_value(facts: list[dict[str, Any]]) -> list[dict[str, Any]]:
    return [{**facts[0], "value": not facts[0]["value"]}, *facts[1:]]


def told_otherwise(words: list[dict[str, str]]) -> list[dict[str, str]]:
    return [{**each, "text": each["text"].replace("red", "blue").replace("yellow", "green")} for each in words]


FILES: dict[str, tuple[Change, str]] = {
    "a changed byte": (with_bytes(TRAIN, flipped), rf"{TRAIN}: differs from the file that was written"),
    "a file cut off": (with_bytes(TEST, lambda content: content[:-9]), rf"{TEST}: has [\d,]+ bytes; dataset.json says"),
    "a file missing": (lambda folder: (folder / TEST).unlink(), rf"{TEST}: cannot be read: No such file"),
    "a file too many": (
        lambda folder: shutil.copy(folder / TRAIN, folder / "data/train-00009.parquet"),
        r"data/train-00009.parquet: is not a file of the dataset",
    ),
    "a link out of the folder": (linked, rf"{TEST}: leads out of the dataset"),
    "an edited domain": (with_bytes("domain/domain.lp", lambda text: text + b"\n"), r"domain/domain.lp: has"),
    "an edited encoding": (with_bytes("encodings/step.lp", flipped), r"encodings/step.lp: differs from the file"),
    "another picture": (with_bytes("pictures/000.png", flipped), r"pictures/000.png: differs from the file"),
    "an edited card": (with_bytes("README.md", lambda text: text + b"more\n"), r"README.md: does not match"),
}
FIGURES: dict[str, tuple[Change, str]] = {
    "a number of tasks": (noted(lambda told: part_of(told, "train").update(tasks=8)), "train: tasks is not what"),
    "a number of draws": (noted(lambda told: part_of(told, "test").update(draws=99)), "test: draws is not what"),
    "a share": (noted(lambda told: told["covered"].update(numerator="7")), "covered is not the share"),
    "a pass rate": (
        noted(lambda told: part_of(told, "train")["lengths"][0].update(pass_rate=0.5)), "train: lengths is not what"
    ),
    "a size": (noted(lambda told: told["spaces"][1].update(tasks="361")), "there are 360 tasks of length 2, not 361"),
    "the size of a part": (noted(lambda told: part_of(told, "test").update(size="7")), r"test: has \d+ tasks to draw"),
    "an identity": (noted(lambda told: told.update(identity="0" * 40)), "identity is not that of"),
    "a length beyond all counting": (
        noted(lambda told: told.update(lengths=[1, 10**9])), "spaces do not have the requested lengths"
    ),
    "another seed": (noted(lambda told: told["spec"].update(seed=6)), rf"{TRAIN}: row 0: its .*plan.* are not"),
    "a tally": (noted(lambda told: shard_of(told, "train")["tally"][0].update(drawn=77)), "the tally of shard 0"),
    "a cause": (
        noted(lambda told: shard_of(told, "train")["tally"][-1].update(causes=[{"cause": "x", "count": 1}])),
        "the tally of shard 0 of train does not match its rows",
    ),
    "a gap of draws": (noted(lambda told: shard_of(told, "train").update(end=1)), r"shard 1 begins at draw \d+, not"),
    "fewer wanted": (noted(lambda told: part_of(told, "train").update(requested=1)), "more tasks than the 1 requested"),
}  # fmt: skip

ROWS: dict[str, tuple[Change, str]] = {
    "a dropped row": (forged(lambda rows: rows.pop(2)), rf"{TRAIN}: draw \d+ is missing"),
    "a row twice": (forged(lambda rows: rows.append(rows[0])), rf"{TRAIN}: row 4: draw \d+ occurs twice"),
    "rows in another order": (forged(lambda rows: rows.reverse()), rf"{TRAIN}: row 1: draw \d+ comes after draw"),
    "another plan": (forged(lambda rows: rows[1].update(plan=rows[0]["plan"])), rf"{TRAIN}: row 1: its .*plan"),
    "no plan": (in_row(plan=lambda plan: plan[:1] * len(plan) + plan[:1]), rf"{TRAIN}: row 1: it is not a plan of"),
    "no text in a plan": (in_row(plan=lambda plan: ["(", *plan[1:]]), rf"{TRAIN}: row 1: "),
    "words of another task": (in_row(instruction=told_otherwise), rf"{TRAIN}: row 1: its text"),
    "no value": (in_row(goal=lambda facts: [{**facts[0], "fluent": None}]), rf"{TRAIN}: row 1: has no value in goal"),
    "no verdict": (in_row(verdict=lambda _: None), rf"{TRAIN}: row 1: has no verdict"),
    "no words": (in_row(instruction=lambda _: []), rf"{TRAIN}: row 1: has no text at the level default"),
    "a sentence less": (in_row(subgoal_instructions=lambda told: told[1:]), rf"{TRAIN}: row 1: its texts are not"),
    "a name too many": (in_row(named=lambda _: ["cube_1"]), rf"{TRAIN}: row 1: its texts are not"),
    "a refused task": (refused_as_task, rf"{TRAIN}: row 0: is not_found, which belongs in another table"),
    "a task of two parts": (of_another_part, rf"{TEST}: row 0: has the same task as {TRAIN}, row 0"),
}

VALUES: dict[str, tuple[Callable[[Any], Any], str]] = {
    "rank": (lambda rank: str(int(rank) + 1), "its .*rank"),
    "log_probability": (lambda found: found / 2, "its .*log_probability"),
    "initial": (other_value, "its .*initial"),
    "states": (lambda states: [states[0][1:], *states[1:]], "its .*states"),
    "subgoals": (lambda states: [[], *states[1:]], "its .*subgoals"),
    "goal": (other_value, "its .*goal"),
    "skeleton": (lambda names: names[1:], "its .*skeleton"),
    "entities": (lambda known: known[1:], "its .*entities"),
    "domain": (lambda _: "blocks", "its .*domain"),
    "task": (lambda number: number + 1, "has the number 2, not 1"),
    "verdict": (lambda told: {**told, "seed": 9, "budget": {**told["budget"], "samples": 9}}, "has the seed 9"),
}
"""Changes of the values of columns, each of which is told by the name of the column."""

WITNESSES = "witnesses/train-00000.parquet"
STARTS: dict[str, tuple[Change, str]] = {
    "a witness of another task": (
        forged(lambda rows: rows[0].update(witness=rows[2]["witness"]), "witnesses"),
        rf"{WITNESSES}: row 0: the witness fails",
    ),
    "a witness less": (forged(lambda rows: rows.pop(0), "witnesses"), rf"{TRAIN}: row 0: says that 2 initial states"),
    "a witness of another search": (
        forged(lambda rows: rows[1].update(index=7), "witnesses"), rf"{WITNESSES}: row 1: has the index 7"
    ),
    "a first state twice": (
        forged(lambda rows: rows[1].update(witness=rows[0]["witness"]), "witnesses"),
        rf"{WITNESSES}: row 1: has the same initial state as another",
    ),
    "a first state left out": (
        forged(lambda rows: rows[1].update(start=2), "witnesses"), rf"{WITNESSES}: row 1: belongs to initial state 2,"
    ),
    "no witness": (forged(lambda rows: rows[1].update(witness="{"), "witnesses"), rf"{WITNESSES}: row 1: is not a wit"),
    "a witness for nothing": (
        forged(lambda rows: rows[-1].update(task=99), "witnesses"), rf"{WITNESSES}: row \d: belongs to task 99"
    ),
}  # fmt: skip


@pytest.fixture(scope="module")
def quick(small: Dataset, spaces: TaskSpace) -> Callable[[pytest.MonkeyPatch], None]:
    """Return a function that saves reading the domain once more for each corruption that is not in its files."""
    domain = small.domain
    clingo, writer = clingo_spaces(small.manifest, domain), instruction_writer_of(domain)

    def patch(monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr(Dataset, "domain", property(lambda _: domain))
        monkeypatch.setattr(verifier, "TaskSpace", lambda *_: spaces)
        monkeypatch.setattr(row_checks, "clingo_spaces", lambda *_: clingo)
        monkeypatch.setattr(row_checks, "instruction_writer_of", lambda *_, **__: writer)

    return patch


@pytest.mark.parametrize("name", FILES | FIGURES | ROWS | STARTS)
def test_each_defect_is_found_at_its_place(
    copied: Path, quick: Callable[[pytest.MonkeyPatch], None], name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    change, told = (FILES | FIGURES | ROWS | STARTS)[name]
    change(copied)
    if name not in FILES:
        quick(monkeypatch)
    if name in STARTS:  # its rows are not checked
        monkeypatch.setattr(row_checks.RowChecks, "wrong", lambda *_: iter(()))
    found = []
    for finding in map(str, verify(copied, physics=name in STARTS)):
        assert "\n" not in finding
        if re.search(told, finding):
            return
        found.append(finding)
    pytest.fail(f"{told} is not among {found}")


def test_each_wrong_value_is_reported_by_its_column(
    copied: Path, quick: Callable[[pytest.MonkeyPatch], None], monkeypatch: pytest.MonkeyPatch
) -> None:
    quick(monkeypatch)
    in_row(**{name: change for name, (change, _) in VALUES.items()})(copied)
    found = [str(finding) for finding in verify(copied, physics=False) if finding[:2] == (TRAIN, 1)]
    for name, (_, told) in VALUES.items():
        assert any(re.search(told, line) for line in found), (name, found)
    assert any("its verdict has a different budget" in line for line in found)


def test_nothing_is_found_on_clean_datasets(
    small: Dataset, numbers: Path, quick: Callable[[pytest.MonkeyPatch], None]
) -> None:
    with pytest.MonkeyPatch.context() as patch:
        quick(patch)
        assert list(verify(small.folder)) == []
    done = run("verify", str(numbers))
    assert (done.returncode, done.stdout) == (0, f"{numbers}: ok; 6 tasks\n")


def test_recordings_are_the_files_that_were_written_and_show_their_tasks(
    tabletop: Domain, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A condition on the initial state holds for witnesses, too."""
    folder, space = tmp_path / "shown", TaskSpace(tabletop, 1).where("starts not inside(cube_1,bin_1)", "uses cube_1")
    generate(space, folder, tasks=2, seed=3, demonstrate=True, staging=Staging(("front",), (32, 32), rate=1))
    assert list(verify(folder)) == []
    one, other = (folder / f"demonstrations/train/{number:06d}.npz" for number in (1, 2))
    shutil.copy(other, one)
    other.write_bytes(b"none")
    monkeypatch.setattr(row_checks.RowChecks, "wrong", lambda *_: iter(()))
    found = [str(finding) for finding in verify(folder)]
    assert any("demonstrations/train/000001.npz: differs from the file" in line for line in found)
    assert any("demonstrations/train/000002.npz: is not a recording" in line for line in found)


def test_a_command_prints_what_is_wrong_and_says_so_by_its_code(copied: Path, tmp_path: Path) -> None:
    FILES["another picture"][0](copied)
    done = run("verify", str(copied), "--no-physics")
    assert (
        done.returncode == 1
        and done.stdout == "pictures/000.png: differs from the file that was written: its SHA-256 is different\n"
    )
    for folder, told in ((tmp_path, "is not a dataset"), (copied / "data", "is not a dataset")):
        done = run("verify", str(folder))
        assert done.returncode == 2 and told in done.stderr and done.stderr.count("\n") == 1
    (copied / "dataset.json").write_text("{")
    with pytest.raises(QueryError, match="not JSON"):
        list(verify(copied))


def test_several_processes_find_the_same_in_the_same_order(
    copied: Path, quick: Callable[[pytest.MonkeyPatch], None], monkeypatch: pytest.MonkeyPatch
) -> None:
    quick(monkeypatch)
    monkeypatch.setattr(row_checks.RowChecks, "wrong", lambda *_: iter(()))

    def moved(rows: Table) -> None:
        for number in (0, 2):
            told = json.loads(rows[number]["witness"])
            first = next(iter(told["moments"][0]["poses"].values()))
            first[0][2] += 0.3
            rows[number]["witness"] = json.dumps(told)

    forged(moved, "witnesses")(copied)
    alone, several = ([str(each) for each in verify(copied, workers=workers)] for workers in (1, 2))
    assert alone == several and [each.partition(": ")[0] for each in alone].count("witnesses/train-00000.parquet") == 2
