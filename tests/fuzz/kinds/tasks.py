"""Mutants of files of tasks, and of recordings."""

from __future__ import annotations

import io
import json
import zipfile
from random import Random
from typing import Any

import numpy as np

from tests.fuzz.kinds.domains import files_of
from tests.fuzz.kinds.texts import CHARACTERS, NUMBERS, SEEDS, broken, changed, exchanged
from tests.fuzz.mutant import Command, Mutant

LINES = (SEEDS / "tasks.jsonl").read_text(encoding="utf-8").splitlines()
RENDER = ("render", "tasks.jsonl", "1", "--as", "state", "--size", "16x16", "-o", "one.png")


def tasks(chance: Random, number: int) -> Mutant:
    """Change a line of a file of tasks by its types, by tokens or by bytes."""
    lines = [chance.choice(LINES)]
    line = lines[0]
    way = chance.random()
    if way < 0.7:
        value = json.loads(line)
        part = chance.choice([None, None, "witness", "verdict"])
        for _ in range(chance.choice([1, 1, 2])):
            value = exchanged(value, chance) if part is None else {**value, part: exchanged(value[part], chance)}
        content = json.dumps(value).encode()
    elif way < 0.85:
        content = changed(
            line, chance, ["NaN", "null", "1e999", "[" * 5000, '{"a":' * 3000, "\\ud800", *CHARACTERS, *NUMBERS]
        ).encode()
    else:
        content = broken(line.encode(), chance)
    files = {**files_of(SEEDS / "scene", "scene"), "tasks.jsonl": content + b"\n"}
    commands: tuple[Command, ...] = (
        ("validate", "tasks.jsonl", "--witness-only"),
        ("validate", "tasks.jsonl", "--budget", "1x1"),
        ("validate", "tasks.jsonl", "--witness-only", "--domain", "scene"),
        RENDER,
    )
    return Mutant("tasks", number, files, (chance.choice(commands),), placed=True)


def recording(chance: Random, number: int) -> Mutant:
    """Change an array of a recording, or the bytes of the file."""
    which = chance.randrange(2)
    path = SEEDS / "recordings" / f"{which + 1:06d}.npz"
    if chance.random() < 0.7:
        with np.load(path) as archive:
            arrays: dict[str, Any] = {name: archive[name] for name in archive.files}
        for _ in range(chance.choice([1, 1, 2])):
            _change(arrays, chance)
        buffer = io.BytesIO()
        np.savez_compressed(buffer, **arrays)
        content = buffer.getvalue()
    else:
        content = broken(path.read_bytes(), chance) if chance.random() < 0.7 else _archive(path.read_bytes(), chance)
    line = json.loads(LINES[which])
    names = [
        "000001.npz",
        "000001.npz",
        "000001.npz",
        "../../outside/secret.npz",
        "/etc/passwd",
        "a\x1b[1m.npz",
        "",
        ".",
    ]
    line["verdict"]["demonstration"] = chance.choice(names)
    files = {
        **files_of(SEEDS / "scene", "scene"),
        "tasks.jsonl": json.dumps(line).encode() + b"\n",
        "recordings/000001.npz": content,
    }
    return Mutant("recording", number, files, ((*RENDER, "--recordings", "recordings"),), placed=True)


def _change(arrays: dict[str, Any], chance: Random) -> None:
    """Give one array another type, shape or value, or another name."""
    name = chance.choice(sorted(arrays))
    array = arrays[name]
    match chance.randrange(9):
        case 0:
            del arrays[name]
        case 1:
            arrays[chance.choice(["extra", "a/b", "../x", name + "_"])] = arrays.pop(name)
        case 2:
            arrays[name] = np.array([{"a": 1}, None], dtype=object)
        case 3:
            arrays[name] = array[..., None]
        case 4:
            arrays[name] = array[:-1] if array.ndim else array[None]
        case 5:
            arrays[name] = (
                array.astype(chance.choice(["U3", "S5", "f8", "i8", "c16", "?", "M8[s]"]), casting="unsafe")
                if array.dtype.kind in "fiub"
                else np.arange(array.size).reshape(array.shape)
            )
        case 6:
            arrays[name] = np.zeros((chance.choice([0, 1, 7]),) * chance.randrange(4), array.dtype)
        case 7 if array.dtype.kind in "fiu" and array.size:
            copy = array.copy()
            odd = [np.nan, np.inf, -1, 1e30] if array.dtype.kind == "f" else [-1, 2**31 - 1, 10**6]
            copy.flat[chance.randrange(copy.size)] = chance.choice(odd)
            arrays[name] = copy
        case _:
            if array.dtype.kind == "U":
                arrays[name] = np.full(array.shape, chance.choice(["", "\x1b[31m", "x" * 1000, "é\n"]))
            else:
                arrays[name] = np.zeros(array.shape, [("a", "f4"), ("b", "U3")])


def _archive(content: bytes, chance: Random) -> bytes:
    """Return an archive with members that are too large, named twice, or no arrays."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(content)) as old, zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as new:
        names = old.namelist()
        odd = chance.choice(names)
        for name in names:
            member = old.read(name)
            if name == odd:
                kind = chance.randrange(3)
                if kind == 2:
                    member = broken(member, chance)
                else:
                    header, size = io.BytesIO(), (3 * 10**9, 75 * 10**6)[kind]
                    table = {"descr": "<f4", "fortran_order": False, "shape": (size,)}
                    np.lib.format.write_array_header_1_0(header, table)
                    member = header.getvalue() + (bytes(4 * size) if kind else member)
            plain = name == odd and chance.random() < 0.2
            new.writestr(name.removesuffix(".npy") if plain else name, member)
    return buffer.getvalue()
