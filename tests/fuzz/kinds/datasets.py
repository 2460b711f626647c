"""Mutants of data sets: what dataset.json says, what rows say, the bytes of files, and what lies in their places."""

from __future__ import annotations

import json
import tempfile
from collections.abc import Mapping
from functools import cache as once
from pathlib import Path
from random import Random
from typing import Any

import msgspec
import pyarrow as pa
import pyarrow.parquet as pq

from prag_asp.dataset import generate
from prag_asp.dataset.store.schema import SCHEMAS
from prag_asp.dataset.store.shards import write_shard
from prag_asp.domain.load import load_domain
from prag_asp.space.task_space import TaskSpace
from tests.fuzz.kinds.texts import SEEDS, broken, exchanged
from tests.fuzz.mutant import Mutant

FOLDER, SAID = "data", "data/dataset.json"
TASKS = "data/data/train-00000.parquet"

SPECIAL = (
    "link /dev/zero", "link /proc/self/environ", "link ../../outside/secret.txt", "link nowhere", "fifo", "folder",
    "size 40000000000", "mode 000",
)  # fmt: skip
NAMES = ("more", "a\x1b[2J\nb", "domain/learned.lp", "domain/more.lp", "encodings/more.lp", "data/train-00001.parquet")
"""Files that no data set names."""


def dataset(chance: Random, number: int) -> Mutant:
    """Change a data set, which is then verified; `generate` goes on with it otherwise."""
    files = dict(made())
    special: dict[str, str] = {}
    way = chance.random()
    if way < 0.45:
        said = json.loads(files[SAID])
        for _ in range(chance.choice([1, 1, 2, 4])):
            said = exchanged(said, chance)
        files[SAID] = json.dumps(said).encode()
    elif way < 0.75:
        files |= rewritten(chance)
    elif way < 0.85:
        name = chance.choice(sorted(files))
        files[name] = broken(files[name], chance)
    else:
        name = chance.choice([*sorted(files), *(f"{FOLDER}/{each}" for each in NAMES)])
        files.pop(name, None)
        special[name] = chance.choice(SPECIAL)
    commands = (("verify", FOLDER), ("verify", FOLDER), ("generate", *ASKED, "--tasks", "4", "-o", FOLDER))
    return Mutant("dataset", number, files, (chance.choice(commands),), special)


ASKED = ("own", "-n", "2", "--no-physics")


@once
def made() -> Mapping[str, bytes]:
    """Return the files of a data set, and of the domain that it is of."""
    own = {f"own/{path.name}": path.read_bytes() for path in (SEEDS / "timed").iterdir()}
    with tempfile.TemporaryDirectory() as home:
        for name, content in own.items():
            (Path(home) / name).parent.mkdir(exist_ok=True)
            (Path(home) / name).write_bytes(content)
        folder = Path(home) / FOLDER
        generate(TaskSpace(load_domain(Path(home) / "own"), 2), folder, tasks=3, weights={}, physics=False)
        found = {path.relative_to(home).as_posix(): path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    return {**own, **found}


def rewritten(chance: Random) -> dict[str, bytes]:
    """Return a table with other values in its rows, and dataset.json that says that it is to be so."""
    said = json.loads(made()[SAID])
    with tempfile.TemporaryDirectory() as home:
        rows: list[dict[str, Any]] = pq.read_table(pa.BufferReader(made()[TASKS])).to_pylist()
        for _ in range(chance.choice([1, 1, 3])):
            at = chance.randrange(len(rows))
            rows[at] = exchanged(rows[at], chance)
        try:
            found = write_shard(Path(home), "tasks", "train", 0, pa.Table.from_pylist(rows, SCHEMAS["tasks"]))
        except (pa.ArrowException, TypeError, ValueError, OverflowError, AttributeError):
            return {TASKS: broken(made()[TASKS], chance)}  # no table can hold that
        said["parts"][0]["shards"][0]["files"]["tasks"] = msgspec.to_builtins(found)
        return {TASKS: (Path(home) / found.path).read_bytes(), SAID: json.dumps(said).encode()}
