"""Mutants of what lies where a file should: links that lead outside, pipes, devices, folders, files without an end."""

from __future__ import annotations

import json
from random import Random

from tests.fuzz.kinds.domains import NAME, files_of
from tests.fuzz.kinds.texts import SEEDS
from tests.fuzz.mutant import Command, Mutant

SUFFIXES = ("lp", "toml", "jsonl", "npz", "obj", "urdf")

PLACES: tuple[tuple[str, tuple[Command, ...]], ...] = (
    ("own/domain.lp", (("check", NAME), ("count", NAME, "-n", "1"))),
    (
        "own/domain.toml",
        (("check", NAME), ("count", NAME, "-n", "1"), ("sample", NAME, "-n", "1", "--count", "1", "--max-draws", "1")),
    ),
    ("own/learned.lp", (("check", NAME), ("learn", NAME, "-n", "1", "--count", "0", "--write"))),
    ("own/more.lp", (("check", NAME),)),
    ("own/bodies/mug.urdf", (("check", NAME),)),
    ("own/bodies/handle.obj", (("check", NAME),)),
    (
        "recordings/000001.npz",
        (
            (
                "render",
                "tasks.jsonl",
                "1",
                "--recordings",
                "recordings",
                "--as",
                "state",
                "--size",
                "16x16",
                "-o",
                "one.png",
            ),
        ),
    ),
    ("own", (("validate", "tasks.jsonl", "--witness-only"),)),
    ("out/train.txt", (("split", NAME, "-n", "2", "train=0.5", "test=0.5", "--count", "1", "-o", "out"),)),
    ("demonstrations/000001.npz", (("validate", "tasks.jsonl", "--witness-only", "--demonstrate", "demonstrations"),)),
    ("pictures/000001.png", (("render", "tasks.jsonl", "1", "--as", "state", "--size", "16x16", "-o", "pictures"),)),
)


def place(chance: Random, number: int) -> Mutant:
    """Put something else in the place of a file."""
    path, commands = chance.choice(PLACES)
    files = {**files_of(SEEDS / "scene"), "tasks.jsonl": (SEEDS / "tasks.jsonl").read_bytes()}
    line = json.loads(files["tasks.jsonl"].splitlines()[0])
    line["domain"] = NAME
    files["tasks.jsonl"] = json.dumps(line).encode() + b"\n"
    files["own/domain.lp"] += b'#include "more.lp".\n'
    files["own/more.lp"] = b"class(more, item).\n"
    files["recordings/000001.npz"] = (SEEDS / "recordings" / "000001.npz").read_bytes()
    up = "../" * path.count("/")
    suffix = path.rpartition(".")[2] if "." in path else "txt"
    there = f"secret.{suffix if suffix in SUFFIXES else 'txt'}"
    special = chance.choice(
        [
            f"link ../{up}outside/{there}",
            f"link ../{up}outside",
            f"link ../{up}outside/new",
            "link /dev/zero",
            "link /dev/stdin",
            "link /dev/full",
            "link /proc/self/environ",
            "link nowhere",
            "link loop",
            "fifo",
            "folder",
            "size 3000000000",
            "size 40000000000",
            "mode 000",
            f"link {path.rpartition('/')[2]}",
        ]
    )
    if path == "own":
        files = {name: content for name, content in files.items() if not name.startswith("own/")}
        line["domain"] = chance.choice(
            ["own", "../own", "/etc", "../outside", "a\x1b[1mb", "x" * 5000, "", ".", "own/../../outside"]
        )
        files["tasks.jsonl"] = json.dumps(line).encode() + b"\n"
    files.pop(path, None)
    owes = commands[0][0] not in ("split", "render", "learn")
    return Mutant("place", number, files, (chance.choice(commands),), {path: special}, owes_output=owes)
