"""The parser of the grammar of the package `pddl`.

Building its tables takes longer than parsing most files, so they are cached on disk: as JSON, because loading JSON
executes no code.
"""

from __future__ import annotations

import json
import pickle
from functools import cache
from io import BytesIO
from typing import TYPE_CHECKING, Any

from prag_asp.missing import require_pddl
from prag_asp.output.cache_files import cache_folder, read_cached, write_cached
from prag_asp.output.digests import digest

if TYPE_CHECKING:
    from lark import Lark

KINDS = ("domain", "problem")
LARGEST = 10_000_000
"""The maximum size of cached tables in bytes; the current ones take 0.1 MB."""

MISMATCHED = (ValueError, KeyError, TypeError, AttributeError, IndexError, AssertionError)
"""The exceptions that lark raises for tables that are not those of a parser."""


@cache
def grammar() -> Lark:
    """Return the parser.

    Raises:
        PddlMissingError: the package pddl is not installed.
    """
    require_pddl()
    import lark
    from pddl.parser import PARSERS_DIRECTORY

    folder = cache_folder()
    if folder is None:
        return _build_parser()
    texts = [path.read_text(encoding="utf-8") for path in sorted(PARSERS_DIRECTORY.glob("*.lark"))]
    key = digest([lark.__version__, *texts])
    path = folder / f"{key}.grammar"
    cached = read_cached(path, LARGEST)
    parser = None if cached is None else _read(cached)
    if parser is None:
        parser = _build_parser()
        write_cached(path, _written(parser))
    return parser


def _build_parser() -> Lark:
    from lark import Lark
    from pddl.parser import GRAMMAR_FILE, PARSERS_DIRECTORY

    return Lark(
        GRAMMAR_FILE.read_text(encoding="utf-8"),
        parser="lalr",
        import_paths=[PARSERS_DIRECTORY],
        start=list(KINDS),
        propagate_positions=True,
    )


def _written(parser: Lark) -> bytes:
    """Return the tables of a parser as JSON; lark itself writes them as a pickle of plain values."""
    buffer = BytesIO()
    parser.save(buffer, exclude_options=["import_paths"])
    return json.dumps(pickle.loads(buffer.getvalue())).encode()


def _read(content: bytes) -> Lark | None:
    from lark import Lark

    try:
        return Lark.load(BytesIO(pickle.dumps(json.loads(content, object_hook=_numbered))))
    except MISMATCHED:
        return None


def _numbered(table: dict[str, Any]) -> dict[Any, Any]:
    """Return a mapping with integer keys restored, which JSON stores as strings."""
    return {int(key) if key.isdecimal() else key: value for key, value in table.items()}
