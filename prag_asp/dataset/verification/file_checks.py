"""The files of a dataset: each is there and as dataset.json says, and there are no others."""

from __future__ import annotations

from collections.abc import Iterator
from copy import deepcopy
from pathlib import Path
from typing import TYPE_CHECKING

from prag_asp.dataset.pages.dataset_card import NAME as CARD
from prag_asp.dataset.pages.dataset_card import card_text
from prag_asp.dataset.store.domain_snapshot import FileRecord, digest_of
from prag_asp.dataset.store.manifest import NAME, Manifest, ShardFile, derive
from prag_asp.dataset.verification.finding import Finding
from prag_asp.errors import PragError
from prag_asp.safe_reading import is_inside, read_bytes

if TYPE_CHECKING:
    from prag_asp.domain.load import Domain

LARGEST_RECORDING = 1_000_000_000
"""Bytes of a recording, of which no size is told, that are looked at."""

UNSEEN = (".git", ".cache", ".gitattributes")
"""What hubs put beside the files of a dataset."""


def wrong_files(folder: Path, manifest: Manifest, recordings: frozenset[str]) -> Iterator[Finding]:
    """Yield what is wrong with files: those that dataset.json lists, and those that nothing speaks of.

    `recordings` are the files that the tables of recordings name; these say what they are.
    """
    known = {NAME, CARD, *recordings}
    for file in _listed(manifest):
        known.add(file.path)
        yield from wrong_file(folder, file.path, file.sha256, file.bytes)
    for path in sorted(folder.rglob("*")):
        name = path.relative_to(folder).as_posix()
        if name.split("/")[0] not in UNSEEN and name not in known and (path.is_symlink() or not path.is_dir()):
            yield Finding(name, None, "is no file of the dataset")


def wrong_file(folder: Path, name: str, sha256: str, size: int | None = None) -> Iterator[Finding]:
    """Yield what is wrong with a file of which the digest is known, and perhaps the size."""
    path = folder / name
    if not is_inside(path, folder):
        yield Finding(name, None, "leads out of the dataset")
        return
    try:
        bytes_ = path.stat().st_size
        if size is not None and bytes_ != size:
            yield Finding(name, None, f"has {bytes_:,} bytes; dataset.json says {size:,}")
            return
        found = digest_of(path, at_most=None if size else LARGEST_RECORDING)
    except OSError as error:
        yield Finding(name, None, f"cannot be read: {error.strerror or error}")
        return
    if found != sha256:
        yield Finding(name, None, "is not the file that was written: its SHA-256 is another")


def wrong_card(folder: Path, manifest: Manifest, domain: Domain) -> Iterator[Finding]:
    """Yield what is wrong with the card, which follows from dataset.json, whatever that says of its own figures."""
    try:
        found = read_bytes(folder / CARD, within=folder)
    except (OSError, PragError) as error:
        yield Finding(CARD, None, f"cannot be read: {getattr(error, 'strerror', None) or error}")
        return
    figured = deepcopy(manifest)
    derive(figured)
    if found != card_text(figured, domain):
        yield Finding(CARD, None, "does not say what dataset.json says")


def _listed(manifest: Manifest) -> Iterator[FileRecord | ShardFile]:
    yield from manifest.domain.files
    yield from manifest.domain.encodings
    yield from manifest.pictures
    for part in manifest.parts:
        for shard in part.shards:
            yield from shard.files.values()
