"""Check the files of a dataset: those listed in dataset.json exist and are unchanged, and there are no others."""

from __future__ import annotations

from collections.abc import Iterator, Set
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
"""The maximum number of bytes of a recording that are read; the table of recordings does not contain their sizes."""

UNSEEN = (".git", ".cache", ".gitattributes")
"""Files and folders that hubs add to a dataset."""


def wrong_files(folder: Path, manifest: Manifest, recordings: Set[str]) -> Iterator[Finding]:
    """Yield findings about the files that dataset.json lists, and about files that do not belong to the dataset.

    `recordings` holds the files listed in the tables of recordings, which also contain the digests of these files.
    """
    expected = {NAME, CARD, *recordings}
    listed: list[FileRecord | ShardFile] = [*manifest.domain.files, *manifest.domain.encodings, *manifest.pictures]
    listed += [file for part in manifest.parts for shard in part.shards for file in shard.files.values()]
    for file in listed:
        expected.add(file.path)
        yield from wrong_file(folder, file.path, file.sha256, file.bytes)
    for path in sorted(folder.rglob("*")):
        name = path.relative_to(folder).as_posix()
        if name.split("/")[0] not in UNSEEN and name not in expected and (path.is_symlink() or not path.is_dir()):
            yield Finding(name, None, "is not a file of the dataset")


def wrong_file(
    folder: Path, name: str, sha256: str, size: int | None = None, note: str = "dataset.json"
) -> Iterator[Finding]:
    """Yield findings about a file, given its digest and, if known, its size in bytes, as recorded in `note`."""
    path = folder / name
    if not is_inside(path, folder):
        yield Finding(name, None, "leads out of the dataset")
        return
    try:
        bytes_ = path.stat().st_size
        if size is not None and bytes_ != size:
            yield Finding(name, None, f"has {bytes_:,} bytes; {note} says {size:,}")
            return
        actual = digest_of(path, at_most=None if size else LARGEST_RECORDING)
    except OSError as error:
        yield Finding(name, None, f"cannot be read: {error.strerror or error}")
        return
    if actual != sha256:
        yield Finding(name, None, "differs from the file that was written: its SHA-256 is different")


def wrong_card(folder: Path, manifest: Manifest, domain: Domain) -> Iterator[Finding]:
    """Yield findings about the card, which must follow from dataset.json."""
    try:
        card = read_bytes(folder / CARD, within=folder)
    except (OSError, PragError) as error:
        yield Finding(CARD, None, f"cannot be read: {getattr(error, 'strerror', None) or error}")
        return
    derived = deepcopy(manifest)
    derive(derived)
    if card != card_text(derived, domain):
        yield Finding(CARD, None, "does not match dataset.json")
