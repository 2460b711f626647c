"""Which runs are the same: those whose bytes are, whatever became of them before."""

from __future__ import annotations

import json
import platform
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from prag_asp.errors import PragError

if TYPE_CHECKING:
    from prag_asp.cli.asked import Asked
    from prag_asp.domain.load import Domain

NO_SAY = frozenset(
    [
        "names", "settings", "encodings", "learned", "trust", "strict", "file", "output", "workers", "memory", "time",
        "cached", "wanted", "limit", "max_draws", "demonstrate", "recordings",
    ]
)  # fmt: skip
"""Options without a say in the bytes of a line: those of which the domain or the content of a file tells more, where
lines go, how they are computed, and how many there are to be, for more begin as fewer do."""


def run_of(*domains: Domain, told: Iterable[Any] = ()) -> str:
    """Return a digest of the command, of what its domains say, of what else is `told`, and of all versions."""
    from prag_asp.domain.identity import code_digest, digest, domain_digest
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
    path = Path(file)
    if not path.is_file():
        return None
    from prag_asp.domain.identity import digest

    content = path.read_bytes()
    domains = [asked.of(record, path.parent).domain(tell=False) for record in _first_of_each(content, file)]
    return run_of(*domains, told=[digest(content.decode(errors="replace")), *told])


def _first_of_each(content: bytes, file: str) -> Iterator[Any]:
    """Yield the first record of each domain and its constants; what is no record will be told in its place."""
    from prag_asp.dataset.jsonl import read_lines

    seen: set[str] = set()
    for line in content.decode(errors="replace").split("\n"):
        try:
            told = json.loads(line)
            key = json.dumps([told["domain"], told.get("constants")])
            if key not in seen:
                seen.add(key)
                yield next(read_lines([line], file))
        except (ValueError, TypeError, KeyError, AttributeError, RecursionError, PragError):
            continue
