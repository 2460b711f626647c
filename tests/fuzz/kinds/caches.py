"""Mutants of what is kept for the next run: whatever is done to it, counts are the same."""

from __future__ import annotations

import io
import os
import tempfile
from functools import cache as once
from pathlib import Path
from random import Random
from unittest.mock import patch

import numpy as np

from prag_asp.domain.load import load_domain
from prag_asp.output.cache_files import checksum
from prag_asp.space.engines import automaton_engine
from prag_asp.space.task_space import TaskSpace
from tests.fuzz.kinds.domains import files_of
from tests.fuzz.kinds.texts import SEEDS, broken
from tests.fuzz.mutant import Mutant

COUNT = ("count", "own", "-n", "4")
OTHERS_MAY_WRITE = "chmod 777"


def cache(chance: Random, number: int) -> Mutant:
    """Change what is kept of a domain, which is then counted with and without it.

    A forgery that fits together is believed in a folder of the user's, so it lies in one that others can write.
    """
    name = chance.choice(("closed", "timed"))
    files = files_of(SEEDS / name)
    special = {}
    for file, content in kept(SEEDS / name).items():
        way = chance.random()
        if way < 0.5:
            files[f"kept/{file}"] = broken(content, chance)
        elif way < 0.8:
            files[f"kept/{file}"] = forged(content, chance)
            special[chance.choice(["kept", f"kept/{file}"])] = OTHERS_MAY_WRITE
        else:
            special[f"kept/{file}"] = chance.choice(
                ["fifo", "folder", "link /dev/zero", "size 40000000000", "link ../../outside/secret.txt"]
            )
    commands = (("check", "own"), (*COUNT, "--no-cache"), COUNT)
    return Mutant("cache", number, files, commands, special, variables={"PRAG_ASP_CACHE": "kept"})


@once
def kept(domain: Path) -> dict[str, bytes]:
    """Return the files that a count of a domain keeps."""
    with (
        tempfile.TemporaryDirectory() as folder,
        patch.dict(os.environ, {"PRAG_ASP_CACHE": folder}),
        patch.object(automaton_engine, "WORTH_KEEPING", -1.0),
    ):
        TaskSpace(load_domain(domain), 4).count()
        return {path.name: path.read_bytes() for path in Path(folder).iterdir()}


def forged(content: bytes, chance: Random) -> bytes:
    """Return an entry that fits together, but in which other words are accepted."""
    with np.load(io.BytesIO(content)) as archive:
        arrays = {name: archive[name] for name in archive.files}
    arrays["accepting"] = ~arrays["accepting"] if chance.random() < 0.5 else np.ones_like(arrays["accepting"])
    buffer = io.BytesIO()
    np.savez(buffer, **arrays)
    return buffer.getvalue() + checksum(buffer.getvalue())
