"""Which domain the tasks of a file are of, how their searches are numbered, and how messages say where they stand."""

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
"""So many bytes make a number that every reader of JSON keeps exactly."""

MEND = "draw the task anew, or set its witness to null"


def named_domain(record: Record, folder: Path) -> str:
    """Return the name of the shipped domain that a record names, or the folder of another, here or in `folder`.

    A name that leads elsewhere, by a link too, is none: whoever wrote the file may not have another folder read.

    Raises:
        QueryError: there is neither.
    """
    from prag_asp.program.paths import domain_folder, shipped_domains

    own = record.task.domain
    if own in shipped_domains():
        return own
    for base in (Path(), folder):
        name = str(base / own)
        with suppress(DomainError, OSError, ValueError):
            if own and is_inside(name, base):
                domain_folder(name)
                return name
    raise QueryError(
        f"{record.place}: a task of {own!r}; no such domain is shipped or lies here; say where with --domain"
    )


def foreign(record: Record, domain: Domain) -> str:
    """Return that a record names another domain than one, nothing where it names the same."""
    own = record.task.domain
    return (
        "" if own == domain.name else f"the file says that it is of {own!r}, but it is read as one of {domain.name!r}"
    )


def read_witness(record: Record, scene: Scene) -> Witness:
    """Return the witness of a record that has one, of a task in a scene.

    Raises:
        QueryError: it is of another form; the message names the field, but not the place of the record.
    """
    from prag_asp.physics import Witness

    try:
        return Witness.from_json(record.witness or {})
    except QueryError as error:
        raise QueryError(f"{error}; {MEND}") from None


@contextmanager
def told_with_place(record: Record, domain: Domain | None = None, advice: str = "") -> Iterator[None]:
    """Begin the message of an error with the file and the line of a record, and end it with advice.

    Where the record, read as one of a `domain`, names another, the message says so.

    Raises:
        QueryError: what is done with the record raises one.
        SceneError: the same.
    """
    try:
        yield
    except (QueryError, SceneError) as error:
        other = foreign(record, domain) if domain is not None else ""
        parts = [f"{record.place}: {error}", other, advice if isinstance(error, QueryError) else ""]
        raise type(error)("; ".join(filter(None, parts))) from None


def index_of(record: Record) -> int:
    """Return the index of a record's verdict, so that the same search is done; without one, one of its actions."""
    known = (record.verdict or {}).get("index")
    if type(known) is int and known >= 0:
        return known
    plan = " ".join(map(str, record.task.actions))
    return int.from_bytes(blake2b(plan.encode(), digest_size=INDEX_BYTES).digest(), "big")
