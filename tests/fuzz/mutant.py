"""A mutant: files, a command line, and what has to hold of the answer."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

OUTSIDE = "outside"
"""The folder beside that of a mutant, with what no command may read or write."""

SECRET = "tell_nobody"
"""A word that is in the files there, and nowhere else."""

SECRETS: Mapping[str, str] = {
    "secret.lp": f"class({SECRET}).\n{SECRET}.\n",
    "secret.toml": f'title = "{SECRET}"\n[{SECRET}]\n',
    "secret.txt": f"{SECRET}\n",
    "secret.jsonl": f'{{"{SECRET}": "{SECRET}"}}\n',
    "secret.npz": SECRET,
    "secret.obj": f"v {SECRET}\n",
    "secret.urdf": f"<{SECRET}/>\n",
}

FIFO, FOLDER = "fifo", "folder"
"""What can lie in place of a file, as can ``link TO``, ``size N`` and ``mode BITS``; ``chmod BITS`` changes one."""

Command = tuple[str, ...]


@dataclass(frozen=True)
class Mutant:
    """An input that is nearly right.

    `files` hold what lies in its folder, `special` what lies there and is no file. The first of the `commands` is run
    first; where it accepts the input, the others are, and have to print the same as each other where they answer.
    With `placed`, an error of the first has to name a file and a line. `variables` are those of the environment.
    """

    kind: str
    number: int
    files: Mapping[str, bytes]
    commands: tuple[Command, ...]
    special: Mapping[str, str] = field(default_factory=dict)
    given: bytes = b""
    placed: bool = False
    variables: Mapping[str, str] = field(default_factory=dict)
    owes_output: bool = True

    @property
    def name(self) -> str:
        """How it is called, and made again."""
        return f"{self.kind}-{self.number}"

    def write(self, folder: Path) -> Path:
        """Write the files into a folder of their own within a folder, with secrets beside it, and return it."""
        outside = folder / OUTSIDE
        outside.mkdir()
        for name, text in SECRETS.items():
            (outside / name).write_text(text, encoding="utf-8")
        own = folder / "own"
        own.mkdir()
        for name, content in self.files.items():
            path = own / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(content)
        for name, what in self.special.items():
            path = own / name
            path.parent.mkdir(parents=True, exist_ok=True)
            _make(path, what)
        return own


def _make(path: Path, what: str) -> None:
    kind, _, told = what.partition(" ")
    if kind == "chmod":
        path.chmod(int(told, 8))
        return
    path.unlink(missing_ok=True)
    if kind == "link":
        path.symlink_to(told)
    elif kind == FIFO:
        os.mkfifo(path)
    elif kind == FOLDER:
        path.mkdir()
    elif kind == "size":
        with path.open("wb") as file:
            file.truncate(int(told))
    elif kind == "mode":
        path.write_bytes(b"")
        path.chmod(int(told, 8))
    else:
        raise ValueError(what)


def secrets_changed(folder: Path) -> str:
    """Return which file outside of a mutant's folder has changed, nothing where none has."""
    outside = folder / OUTSIDE
    found = {path.name: path.read_text(encoding="utf-8", errors="replace") for path in outside.iterdir()}
    wrong = [name for name in sorted({*found, *SECRETS}) if found.get(name) != SECRETS.get(name)]
    return wrong[0] if wrong else ""
