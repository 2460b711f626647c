"""A dataset from a stranger leads nowhere else, asks for no endless work, and what is wrong with it is a line."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from prag_asp import Dataset, DomainError, QueryError, TaskSpace, load_domain
from prag_asp.dataset import generate
from prag_asp.dataset.store import shards
from prag_asp.dataset.store.schema import SCHEMAS
from prag_asp.dataset.store.shards import write_shard
from prag_asp.dataset.verification import file_checks
from prag_asp.errors import LONGEST
from tests.commands import run
from tests.dataset.conftest import Change, with_json

ROWS = "data/train-00000.parquet"


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("data") / "made"
    return generate(TaskSpace(load_domain("blocks"), 3), folder, tasks=4, physics=False, shard=2).folder


@pytest.fixture
def strange(made: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(made, tmp_path / "strange"))


def said(change: Callable[[Any], object]) -> Change:
    return with_json("dataset.json", change)


def part(**values: object) -> Change:
    return said(lambda told: told["parts"][0].update(values))


def shard(**values: object) -> Change:
    return said(lambda told: told["parts"][0]["shards"][-1].update(values))


def rows(**values: object) -> Change:
    return said(lambda told: told["parts"][0]["shards"][0]["files"]["tasks"].update(values))


def sparse(folder: Path) -> None:
    os.truncate(folder / ROWS, 10**12)


def pipe(folder: Path) -> None:
    (folder / ROWS).unlink()
    os.mkfifo(folder / ROWS)


FOUND: dict[str, tuple[Change, str]] = {
    "more draws than rows": (shard(end=10**18), "dataset.json: parts, train: shard 1 has too many draws for its rows"),
    "more tasks than a float holds": (
        said(lambda told: told["parts"][0]["shards"][0]["tally"][0].update(feasible=10**400)),
        "dataset.json: parts, train: lengths is not what the shards add up to",
    ),
    "no files": (shard(files={}), "dataset.json: parts, train: the tally of shard 1 has 2 tasks; there are 0"),
    "no share": (said(lambda told: told.update(covered=None)), "dataset.json: covered is not the share"),
    "no share of a part": (part(covered=None), "dataset.json: parts, train: covered is not what the shards add up to"),
    "a share without an end": (
        said(lambda told: told["spec"].update(split={"train": "1e999999999"})),
        "dataset.json: the request cannot be sampled: share of 'train': 1e999999999 is out of range",
    ),
    "a file of 1 TB": (sparse, f"{ROWS}: has 1,000,000,000,000 bytes; dataset.json says "),
    "a pipe": (pipe, f"{ROWS}: has 0 bytes; dataset.json says "),
    "a path out of the folder": (rows(path="/etc/passwd"), "/etc/passwd: leads out of the dataset"),
    "a path with two lines": (rows(path="a\x1b[2J\nb"), r"a\x1b[2J\nb: cannot be read: No such file or directory"),
    "no path": (rows(path="a\0b"), r"a\x00b: leads out of the dataset"),
    "a long path": (rows(path="a" * 9000), "aaaa"),
    "a name with two lines": (lambda folder: (folder / "a\x1b[2J\nok").touch(), r"a\x1b[2J\nok: is not a file of"),
    "a link to a folder": (lambda folder: (folder / "proc").symlink_to("/proc"), "proc: is not a file of the dataset"),
}  # fmt: skip


REFUSED: dict[str, tuple[Change, str]] = {
    "no parts": (said(lambda told: (told.update(parts=[]), told["spec"].update(split={}))), "parts: are not those of"),
    "a number of many digits": (part(size="9" * 1_000_001), "parts[0].size: needs"),
    "deep values": (lambda folder: (folder / "dataset.json").write_text("[" * 10**5), "values are nested too deeply"),
    "a large dataset.json": (lambda folder: os.truncate(folder / "dataset.json", 10**12), "it is larger than 64 MB"),
    "a language elsewhere": (
        said(lambda told: told["spec"].update(language="../../x\x1b")), r"has no sentences in '../../x\x1b'"
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", FOUND | REFUSED)
def test_planted_defects_are_printable_lines(strange: Path, name: str) -> None:
    change, words = (FOUND | REFUSED)[name]
    change(strange)
    done = run("verify", str(strange))
    if name in REFUSED:
        assert done.returncode == 2 and words in done.stderr and done.stderr.count("\n") == 1
        return
    lines = done.stdout.splitlines()
    assert done.returncode == 1 and not done.stderr
    assert any(line.startswith(words) for line in lines), lines
    assert all(line.isprintable() and len(line) <= LONGEST and ": " in line for line in lines)


def test_a_run_does_not_go_on_where_dataset_json_has_lost_its_parts(strange: Path) -> None:
    said(lambda told: told.update(parts=[]))(strange)
    with pytest.raises(QueryError, match=r"parts: are not those of spec\.split"):
        generate(TaskSpace(load_domain("blocks"), 3), strange, tasks=4, physics=False, shard=2)


def test_only_the_files_of_a_domain_that_dataset_json_names_are_read(strange: Path, tmp_path: Path) -> None:
    (strange / "domain" / "learned.lp").write_text("% nothing\n")
    with pytest.raises(DomainError, match=r"learned\.lp: is not listed in dataset\.json"):
        assert Dataset.open(strange).domain
    (strange / "domain" / "learned.lp").unlink()
    said(lambda told: told["domain"].update(files=[]))(strange)
    with pytest.raises(DomainError, match=r"domain\.lp: is not listed in dataset\.json"):
        assert Dataset.open(strange).domain
    shutil.move(strange / "domain", tmp_path / "elsewhere")
    (strange / "domain").symlink_to(tmp_path / "elsewhere")
    with pytest.raises(DomainError, match=r"strange/domain: leads out of the dataset"):
        assert Dataset.open(strange).domain


def test_a_recording_of_which_no_size_is_told_is_not_read_without_an_end(
    strange: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(file_checks, "LARGEST_RECORDING", 1000)
    (strange / "large.npz").write_bytes(bytes(1001))
    (found,) = file_checks.wrong_file(strange, "large.npz", "")
    assert found.what.startswith("cannot be read: it is larger than")


def rewritten(folder: Path, **values: object) -> None:
    """Change the values of the first row, and have dataset.json say that it is to be so."""
    table = pq.read_table(folder / ROWS).to_pylist()
    table[0] = {**table[0], **values}
    found = write_shard(folder, "tasks", "train", 0, pa.Table.from_pylist(table, SCHEMAS["tasks"]))
    rows(bytes=found.bytes, sha256=found.sha256)(folder)


@pytest.mark.parametrize("values", [{"goal": None}, {"rank": "many"}, {"rank": "9" * 2_000_000}, {"plan": ["("]}])
def test_a_row_that_is_no_task_is_an_error_that_can_be_caught(strange: Path, values: dict[str, object]) -> None:
    rewritten(strange, **values)
    with pytest.raises(QueryError):
        list(Dataset.open(strange).entries())


def test_rows_in_groups_of_another_size_and_groups_that_unpack_to_too_much_are_refused(
    strange: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    table = pq.read_table(strange / ROWS)
    pq.write_table(table.cast(SCHEMAS["tasks"]), strange / ROWS, row_group_size=1)
    with pytest.raises(QueryError, match="its rows are not in groups of 256"):
        Dataset.open(strange).task(0)
    rewritten(strange)
    assert Dataset.open(strange).task(0)
    monkeypatch.setattr(shards, "LARGEST_GROUP", 1000)
    with pytest.raises(QueryError, match="256 of its rows are larger than 0 MB"):
        Dataset.open(strange).task(0)
