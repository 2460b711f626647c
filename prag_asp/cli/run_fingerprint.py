"""Which runs are the same: those whose bytes are, whatever became of them before."""

from __future__ import annotations

import platform
from collections.abc import Iterable
from hashlib import blake2b
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from prag_asp.errors import PragError
from prag_asp.safe_reading import open_binary

if TYPE_CHECKING:
    from prag_asp.cli.domain_options import Asked
    from prag_asp.dataset.jsonl import Record
    from prag_asp.domain.load import Domain

NO_SAY = frozenset(
    [
        "names", "settings", "encodings", "learned", "trust", "strict", "file", "output", "workers", "memory", "time",
        "cached", "wanted", "limit", "max_draws", "demonstrate",
    ]
)  # fmt: skip
"""Options without a say in the bytes of a line: those of which the domain or the content of a file tells more, where
lines go, how they are computed, and how many there are to be, for more begin as fewer do."""


def run_of(*domains: Domain, told: Iterable[Any] = ()) -> str:
    """Return a digest of the command, of what its domains say, of what else is `told`, and of all versions."""
    from prag_asp.domain.identity import code_digest, domain_digest
    from prag_asp.output.digests import digest
    from prag_asp.versions import versions

    context = click.get_current_context()
    asked = {key: value for key, value in context.params.items() if key not in NO_SAY}
    asked["demonstrate"] = context.params.get("demonstrate") is not None
    codes = sorted({code_digest(domain.encodings) for domain in domains})
    made_by = [versions(), platform.python_version(), platform.machine(), *codes]
    return digest([context.info_name, sorted(asked.items()), [*map(domain_digest, domains)], list(told), made_by])


def run_on_file(asked: Asked, file: str, told: Iterable[Any] = ()) -> str | None:
    """Return the same for a command on a file of tasks, None where that can be read only once.

    Raises:
        PragError: a domain that the file names cannot be loaded.
    """
    if not Path(file).is_file():
        return None
    domains, content = domains_of(asked, file)
    return run_of(*domains, told=[content, *told])


def domains_of(asked: Asked, file: str) -> tuple[list[Domain], str]:
    """Return the domains that the tasks of a file are of, and a digest of it.

    Raises:
        PragError: a domain that the file names cannot be loaded.
    """
    content = blake2b()
    firsts: dict[tuple[Any, ...], Record] = {}
    with open_binary(file) as lines:
        for line in lines:
            content.update(line)
            _take_first(line, file, firsts)
    domains = [asked.of(record, Path(file).parent).domain(tell=False) for record in firsts.values()]
    return domains, content.hexdigest()


def _take_first(line: bytes, file: str, firsts: dict[tuple[Any, ...], Record]) -> None:
    """Add the record of a line where it is the first of its domain and constants; what is none is told in its place."""
    import msgspec

    from prag_asp.dataset.jsonl import read_lines

    try:
        named = msgspec.json.decode(line, type=dict[str, msgspec.Raw])
        key = (bytes(named["domain"]), bytes(named.get("constants", msgspec.Raw(b""))))
        if key not in firsts:
            firsts[key] = next(read_lines([line.decode(errors="replace")], file))
    except (msgspec.MsgspecError, KeyError, RecursionError, PragError, StopIteration):
        return
