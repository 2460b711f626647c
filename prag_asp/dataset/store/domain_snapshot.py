"""The snapshot of a domain in a dataset: all files on which the tasks and verdicts depend."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import replace
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING

import msgspec

from prag_asp.errors import DomainError
from prag_asp.output import file_in, make_folder, replace_file
from prag_asp.safe_reading import is_inside, open_binary, read_bytes

if TYPE_CHECKING:
    from prag_asp.domain.load import Domain
    from prag_asp.program.sources import Source

DOMAIN, ENCODINGS = "domain", "encodings"
"""The folders in a dataset that hold the domain and the encodings with which it was loaded."""

MEND = "generate the dataset again, or copy it again"
"""The remedy for a damaged file."""

BLOCK = 1 << 20
"""The number of bytes read at a time."""


class FileRecord(msgspec.Struct):
    """A file of a dataset: its path in the folder, its size and its SHA-256."""

    path: str
    bytes: int
    sha256: str


class DomainSnapshot(msgspec.Struct):
    """The record of a snapshot in dataset.json: its files, and the options for loading the domain from them."""

    name: str
    label: str
    constants: dict[str, str]
    flat: bool
    files: list[FileRecord]
    encodings: list[FileRecord]


def snapshot_of(domain: Domain) -> tuple[DomainSnapshot, dict[str, bytes]]:
    """Return the snapshot of a domain, and the contents of its files by their paths in a dataset.

    Raises:
        OSError: a file of the domain can no longer be read.
    """
    own = {f"{DOMAIN}/{name}": content for name, content in _own_files(domain)}
    folder = domain.encodings
    encodings = {
        f"{ENCODINGS}/{path.relative_to(folder).as_posix()}": read_bytes(path) for path in sorted(folder.rglob("*.lp"))
    }
    flat = not domain.facts.composites and any("composite" in source.text for source in _own_sources(domain))
    snapshot = DomainSnapshot(
        domain.name, domain.label, dict(domain.constants), flat, [*_records(own)], [*_records(encodings)]
    )
    return snapshot, {**own, **encodings}


def write_snapshot(folder: Path, files: dict[str, bytes]) -> None:
    """Write the files of a snapshot atomically into the folder of a dataset, unless they exist unchanged.

    Raises:
        OutputError: a file cannot be written.
    """
    for name, content in files.items():
        make_folder((folder / name).parent)
        path = file_in(folder, name)
        if not path.is_file() or read_bytes(path) != content:
            replace_file(path, content, follow=False)


def load_snapshot(folder: Path, snapshot: DomainSnapshot, *, trust: bool = False, note: str = "dataset.json") -> Domain:
    """Load the domain of a dataset from the folder of the dataset only; `note` is the file that holds the record.

    Raises:
        DomainError: a file is missing, differs from its record, or is read although it has no record.
    """
    from prag_asp.domain.load import load_domain, scene_files

    for name in (DOMAIN, ENCODINGS):
        if not is_inside(folder / name, folder):
            raise DomainError(f"{folder / name}: leads out of the dataset; {MEND}")
    for file in (*snapshot.files, *snapshot.encodings):
        path = folder / file.path
        try:
            content = read_bytes(path, within=folder)
        except OSError as error:
            raise DomainError(f"{path}: cannot be read: {error.strerror}; {MEND}") from None
        if sha256(content).hexdigest() != file.sha256:
            raise DomainError(f"{path}: differs from its record in {note}; {MEND}")
    domain = load_domain(
        folder / DOMAIN, constants=snapshot.constants, encodings=folder / ENCODINGS, flat=snapshot.flat, trust=trust
    )
    recorded = {(folder / file.path).resolve() for file in (*snapshot.files, *snapshot.encodings)}
    settings = domain.settings
    files = [source.path for source in domain.program.sources]
    files += [settings.path] if settings.text else []
    for path in (*files, *scene_files(settings.scene, settings.path.parent)):
        if path.resolve() not in recorded:
            raise DomainError(f"{path}: is not listed in {note}; {MEND}")
    return replace(domain, name=snapshot.name)


def digest_of(path: Path, *, at_most: int | None = None) -> str:
    """Return the SHA-256 of a file.

    Raises:
        OSError: the file cannot be read, or has more than `at_most` bytes.
    """
    result = sha256()
    with open_binary(path, at_most=at_most) as file:
        while block := file.read(BLOCK):
            result.update(block)
    return result.hexdigest()


def _records(files: dict[str, bytes]) -> Iterator[FileRecord]:
    for path, content in sorted(files.items()):
        yield FileRecord(path, len(content), sha256(content).hexdigest())


def _own_sources(domain: Domain) -> list[Source]:
    """Return the sources of a domain apart from the core encodings, including requested rules."""
    from prag_asp.program.sources import HIERARCHY, core_sources

    core = {source.path.resolve() for source in core_sources(domain.encodings)}
    core.add((domain.encodings / HIERARCHY).resolve())
    return [source for source in domain.program.sources if source.path.resolve() not in core]


def _own_files(domain: Domain) -> Iterator[tuple[str, bytes]]:
    """Yield files that define the same domain in a folder; if the domain is a folder, these are its own files."""
    from prag_asp.domain.load import LEARNED, scene_files

    sources = _own_sources(domain)
    learned = [source for source in sources if source.path.name == LEARNED]
    logic = [source for source in sources if source not in learned]
    folder = domain.folder.resolve() if domain.folder else None
    if folder is not None and all(source.path.resolve().is_relative_to(folder) for source in logic):
        for source in logic:
            yield source.path.resolve().relative_to(folder).as_posix(), read_bytes(source.path)
    else:
        text, rules = "", domain.encodings.resolve()
        for source in logic:  # predicates of a rule in the encodings are reserved: it is included by name
            path = source.path.resolve()
            is_rule = path.is_relative_to(rules)
            include = f'#include "{path.relative_to(rules).as_posix()}".\n' if is_rule else ""
            text += include or f"#program base.\n{source.text}\n"
        yield "domain.lp", text.encode()
    for source in learned:
        yield LEARNED, source.text.encode()
    settings = domain.settings
    if settings.text:
        yield "domain.toml", settings.text.encode()
    base = settings.path.parent
    for path in scene_files(settings.scene, base):
        yield Path(os.path.relpath(path.resolve(), base.resolve())).as_posix(), read_bytes(path)
