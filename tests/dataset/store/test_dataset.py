"""Datasets as they are read: lazily, by number, rank and condition, and by the loaders that people use."""

from __future__ import annotations

import json
import os
import pickle
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pyarrow.parquet as pq
import pytest

from prag_asp import Dataset, Domain, DomainError, QueryError, TaskSpace, load_domain
from prag_asp.dataset import generate
from prag_asp.dataset.scenes import scene_of
from prag_asp.dataset.store import shards, tables
from prag_asp.dataset.store.manifest import FOLDERS
from prag_asp.dataset.store.schema import SCHEMAS
from prag_asp.errors import DatasetsMissingError
from prag_asp.physics import check_witness
from tests.commands import run


def test_tasks_come_back_as_they_were_drawn(small: Dataset, spaces: TaskSpace) -> None:
    tasks = list(small.tasks())
    assert [small.task(number) for number in range(12)] == tasks == [small.task(number - 12) for number in range(12)]
    for entry in small.entries():
        expected = replace(spaces.at(len(entry.task))[entry.rank], log_probability=entry.task.log_probability)
        assert entry.task == expected and hash(entry.task.initial) == hash(expected.initial)
        assert small.by_rank(len(entry.task), entry.rank) == entry
    with pytest.raises(IndexError, match="task 12 of 12"):
        small.task(12)
    free = next(rank for rank in range(99) if rank not in {e.rank for e in small.entries() if len(e.task) == 2})
    with pytest.raises(QueryError, match=f"no task of length 2 with the rank {free}"):
        small.by_rank(2, free)
    for length, rank in ((2, 10**30), (2, -1), (77, 0)):
        with pytest.raises(QueryError, match="no task of length"):
            small.by_rank(length, rank)


def test_a_task_is_read_without_physics(small: Dataset) -> None:
    code = "import sys; from prag_asp import Dataset; Dataset.open(sys.argv[1]).task(5); print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", code, small.folder], check=True, capture_output=True, text=True)
    loaded = done.stdout.split()
    assert "prag_asp.dataset.store.tables" in loaded
    assert not [name for name in loaded if name.startswith(("pybullet", "frankik", "clingo"))]
    values = {"verdict", "witness", "demonstration", "filming"}  # the types of a manifest and of its verdicts
    assert {name.split(".")[2] for name in loaded if name.startswith("prag_asp.physics.")} <= values


def test_tasks_drawn_by_weight_are_found_by_rank_too(numbers: Path) -> None:
    data = Dataset.open(numbers)
    for entry in data.entries():
        assert data.by_rank(len(entry.task), entry.rank) == entry
        assert entry.verdict is None and entry.starts == 0 and entry.number is not None
    with pytest.raises(QueryError, match="no row for the initial state 0 in witnesses"):
        data.witness(0)


def test_each_task_has_two_different_witnesses_that_hold(small: Dataset, tabletop: Domain) -> None:
    scene, found = scene_of(tabletop), list(small.witnesses())
    assert len(found) == sum(entry.starts for entry in small.entries()) > 12
    for entry, start, witness in found:
        assert check_witness(entry.task, witness, scene) == []
        assert witness.moments[0] != small.witness(0, 1).moments[0] or start == 1
    assert found[1][2] == small.witness(0, 1) != small.witness(0, 0)
    assert [start for entry, start, _ in found if entry.number == 0 and entry.part == "train"] == [0, 1]


def test_parts_and_conditions_choose_tasks(small: Dataset) -> None:
    train, test = small.part("train"), small.part("test")
    assert [*train.tasks(), *test.tasks()] == list(small.tasks())
    assert test.count() == 3 and test.task(0) == small.task(9)
    chosen = small.where("uses cube", "has place")
    expected = [task for task in small.tasks() if "cube" in str(task) and "place" in task.skeleton]
    assert list(chosen.tasks()) == expected and 0 < chosen.count() < 12
    assert chosen.task(0) == expected[0] and chosen.task(-1) == expected[-1]
    assert {entry.task for entry, _, _ in chosen.witnesses()} == {*expected}
    with pytest.raises(QueryError, match="no part 'dev'"):
        small.part("dev")
    with pytest.raises(QueryError, match="unicorn"):
        small.where("uses unicorn")
    sent = pickle.loads(pickle.dumps(chosen))  # to another process, whatever was read
    assert sent.count() == chosen.count() and sent.task(0) == chosen.task(0)


def test_only_the_shard_of_a_task_is_read(small: Dataset, monkeypatch: pytest.MonkeyPatch) -> None:
    opened: list[str] = []
    open_shard = shards.open_shard
    for module in (shards, tables):
        monkeypatch.setattr(module, "open_shard", lambda *given: opened.append(given[2].path) or open_shard(*given))
    fresh = Dataset.open(small.folder)
    assert opened == [] and fresh.count() == 12
    entry = fresh.entry(5)
    fresh.by_rank(len(entry.task), entry.rank)
    fresh.witness(5)
    assert {*opened} == {"data/train-00001.parquet", "witnesses/train-00001.parquet"}


def test_the_domain_is_in_the_folder(small: Dataset, tabletop: Domain) -> None:
    assert small.domain.name == "tabletop" and small.domain.folder == small.folder / "domain"
    assert small.domain.settings.scene == tabletop.settings.scene
    assert TaskSpace(small.domain, 1).count() == TaskSpace(tabletop, 1).count()


@pytest.mark.parametrize(
    "given",
    [
        {"given": "hanoi", "constants": {"discs": 2}},
        {"given": "blocks", "rules": ("no_undo", "at_most(stack,1)")},
        {"given": "examples/dishes", "constants": {"capacity": 4}, "trust": True},
        {"given": "examples/desk"},
        {"given": "domains/blocks/domain.lp"},
        {"text": "fluent(a). action(go). precondition(go,a,false). postcondition(go,a,true)."},
    ],
    ids=str,
)
def test_every_way_to_give_a_domain_is_kept(given: dict[str, object], tmp_path: Path) -> None:
    named = [given.pop("given")] if "given" in given else []
    root = Path(__file__).parents[3]
    domain = load_domain(*[root / n if "/" in str(n) else n for n in named], **given)  # type: ignore[arg-type]
    made = generate(TaskSpace(domain, 1), tmp_path / "kept", tasks=1, weights={}, physics=False)
    tasks = list(made.tasks())
    shutil.move(tmp_path / "kept", tmp_path / "moved")
    kept = Dataset.open(tmp_path / "moved", trust=domain.trusted).domain
    assert (kept.label, kept.settings.scene) == (domain.label, domain.settings.scene)
    assert [*TaskSpace(kept, 2).enumerate("plan")] == [*TaskSpace(domain, 2).enumerate("plan")]
    assert tasks == list(Dataset.open(tmp_path / "moved").tasks())
    if domain.settings.scene:
        assert scene_of(kept).shapes == scene_of(domain).shapes


def test_a_damaged_dataset_is_refused_in_one_line(copied: Path, tmp_path: Path) -> None:
    def refused(match: str, folder: Path = copied) -> None:
        with pytest.raises((QueryError, DomainError), match=match) as error:
            data = Dataset.open(folder)
            list(data.tasks())
            assert data.domain
        assert len(error.value.lines) == 1

    refused("has no dataset.json; make one with prag-asp generate", tmp_path)
    refused("has no dataset.json", tmp_path / "nowhere")
    refused("cannot be read: Not a directory", copied / "dataset.json")
    text = (copied / "dataset.json").read_text()
    for content, match in (
        ("", "it is not JSON"),
        (text[:500], "it is not JSON"),
        ("[]", "is not a dataset of prag_asp"),
        ('{"format": "other"}', "is not a dataset of prag_asp"),
        (text.replace('"version": 1', '"version": 7', 1), "has version 7, not 1"),
        (text.replace('"complete": true', '"complete": "yes"', 1), "complete: needs true or false"),
        (text.replace('"complete": true', '"complete": false', 1), "has not ended"),
        (text.replace('"name": "test"', '"name": "dev"', 1), "parts: are not those of spec.split"),
        (text.replace('"split": {', '"ignored": {', 1), "spec.split: is missing"),
        (text.replace('"lengths": [', '"ignored": [', 1), "lengths: is missing"),
        (text.replace('"tasks": "', '"tasks": "many ', 1), r"spaces\[0\].tasks: needs "),
        (text.replace("data/train-00000", "../../train-00000", 1), "leads out of the dataset"),
        (text.replace('"rows": 4', '"rows": 5', 1), "has 4 rows, but dataset.json says 5"),
    ):
        (copied / "dataset.json").write_text(content)
        refused(match)
    (copied / "dataset.json").write_text(text)
    shard = copied / "data" / "train-00001.parquet"
    content = shard.read_bytes()
    shard.write_bytes(content[:400] + b"?" * 300 + content[700:])
    refused("train-00001.parquet: cannot be read")
    shard.write_bytes(b"PAR1")
    refused("train-00001.parquet: cannot be read")
    shutil.copy(copied / "witnesses" / "train-00001.parquet", shard)
    refused("its columns are not those of tasks")
    shard.unlink()
    refused("train-00001.parquet: cannot be read: No such file")
    shard.write_bytes(content)
    (copied / "domain" / "domain.lp").write_text("% mine")
    refused("domain.lp: differs from its record in dataset.json")


def test_the_columns_are_the_same_for_every_domain_and_other_programs_read_them(small: Dataset, numbers: Path) -> None:
    import duckdb
    import pandas

    for folder in (small.folder, numbers):
        for table, below in FOLDERS.items():
            for path in (folder / below).glob("*.parquet"):
                assert pq.read_schema(path).equals(SCHEMAS[table])
    frame = pandas.read_parquet(small.folder / "data")
    assert len(frame) == 12 and {*frame["rank"]} == {str(entry.rank) for entry in small.entries()}
    where = f"'{small.folder}/data/*.parquet'"
    query = f"select count(*) from {where} where list_contains(skeleton, 'place') and verdict.status = 'feasible'"
    with duckdb.connect() as connection:
        (row,) = connection.execute(query).fetchall()
        refused = connection.execute(f"select count(*) from '{small.folder}/rejected/*.parquet'").fetchall()
    assert row == (sum("place" in task.skeleton for task in small.tasks()),)
    assert refused == [(sum(1 for _ in small.rejected()),)]


def test_datasets_loads_each_table_with_its_parts_by_the_card(small: Dataset, tmp_path: Path) -> None:
    code = (
        "import json, sys; from datasets import load_dataset; from datasets.utils.logging import disable_progress_bar\n"
        "disable_progress_bar()\n"
        "loaded = {name: load_dataset(sys.argv[1], name) for name in ('tasks', 'witnesses', 'rejected')}\n"
        "told = {name: {part: rows.num_rows for part, rows in each.items()} for name, each in loaded.items()}\n"
        "print(json.dumps([told, loaded['tasks']['train'][0]['plan'], loaded['tasks']['test'][0]['initial']]))"
    )
    environment = {**os.environ, "HF_HUB_OFFLINE": "1", "HF_HOME": str(tmp_path)}
    done = subprocess.run(
        [sys.executable, "-c", code, str(small.folder)], capture_output=True, text=True, check=True, env=environment
    )
    told, plan, initial = json.loads(done.stdout.splitlines()[-1])
    manifest = small.manifest
    assert told == {
        table: {part.name: part.rows(table) for part in manifest.parts if part.rows(table)}
        for table in ("tasks", "witnesses", "rejected")
    }
    assert plan == [str(action) for action in small.task(0).actions]
    assert {fact["fluent"]: fact["value"] for fact in initial} == {
        str(fluent): value for fluent, value in small.part("test").task(0).initial.items()
    }


def test_without_pyarrow_the_message_says_what_to_install(numbers: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pyarrow.parquet", None)
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    with pytest.raises(DatasetsMissingError, match=r'pip install "prag_asp\[datasets\]"'):
        Dataset.open(numbers)
    done = run("generate", "kitchen", "-n", "2", "--tasks", "1", "-o", str(numbers.parent / "none"))
    assert (done.returncode, done.stdout) == (2, "") and done.stderr.startswith("datasets need pyarrow; install it")
