"""The origin of a task in a file: its domain, its search index, and its location."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from hashlib import blake2b
from pathlib import Path
from typing import TYPE_CHECKING

from prag_asp.errors import DomainError, QueryError, SceneError
from prag_asp.safe_reading import is_inside

if TYPE_CHECKING:
    from prag_asp.dataset.jsonl import Record
    from prag_asp.domain.load import Domain
    from prag_asp.physics import Witness
    from prag_asp.scene.scene import Scene

INDEX_BYTES = 6
"""The number of bytes in an index derived from a plan; every JSON reader represents 6-byte integers exactly."""

MEND = "sample the task again, or set its witness to null"


def named_domain(own: str, place: str, folder: Path) -> str:
    """Return the name of a shipped domain, or the path of a domain in the current folder or in `folder`.

    `place` is the location of the name, for errors. A name that leads outside these folders, even through a link, is
    refused, because a file must not make prag_asp read other folders.

    Raises:
        QueryError: there is no such domain.
    """
    from prag_asp.program.paths import domain_folder, shipped_domains

    if own in shipped_domains():
        return own
    for base in (Path(), folder):
        name = str(base / own)
        with suppress(DomainError, OSError, ValueError):
            if own and is_inside(name, base):
                domain_folder(name)
                return name
    raise QueryError(f"{place}: a task of {own!r}; no such domain is shipped or in this folder; name it with --domain")


def foreign(record: Record, domain: Domain) -> str:
    """Return a message if a record names a domain other than the given one, or "" otherwise."""
    own = record.task.domain
    return (
        "" if own == domain.name else f"the file says that it is of {own!r}, but it is read as one of {domain.name!r}"
    )


def read_witness(record: Record, scene: Scene) -> Witness:
    """Return the witness of a record that has one.

    Raises:
        QueryError: the witness is malformed; the message gives the field, but not the line of the record.
    """
    from prag_asp.physics import Witness

    try:
        return Witness.from_json(record.witness or {})
    except QueryError as error:
        raise QueryError(f"{error}; {MEND}") from None


@contextmanager
def errors_with_place(record: Record, domain: Domain | None = None, advice: str = "") -> Iterator[None]:
    """Add the file and the line of a record to the beginning of an error message, and advice to the end.

    If the record names a domain other than `domain`, the message says so.

    Raises:
        QueryError: the body raises a QueryError.
        SceneError: the body raises a SceneError.
    """
    try:
        yield
    except (QueryError, SceneError) as error:
        other = foreign(record, domain) if domain is not None else ""
        parts = [f"{record.place}: {error}", other, advice if isinstance(error, QueryError) else ""]
        raise type(error)("; ".join(filter(None, parts))) from None


def index_of(record: Record) -> int:
    """Return the search index in the verdict of a record, to repeat the search, or else a hash of the plan."""
    index = (record.verdict or {}).get("index")
    if type(index) is int and index >= 0:
        return index
    plan = " ".join(map(str, record.task.actions))
    return int.from_bytes(blake2b(plan.encode(), digest_size=INDEX_BYTES).digest(), "big")
