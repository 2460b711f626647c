"""The parser of the grammar of the package `pddl`.

Making its tables takes longer than reading most files, so they are kept for the next run: as JSON, for nothing that is
kept is ever run.
"""

from __future__ import annotations

import json
import pickle
from functools import cache
from io import BytesIO
from typing import TYPE_CHECKING, Any

from prag_asp.missing import require_pddl
from prag_asp.output.cache_files import cache_folder, keep, read_kept
from prag_asp.output.digests import digest

if TYPE_CHECKING:
    from lark import Lark

KINDS = ("domain", "problem")
LARGEST = 10_000_000
"""Bytes of tables at most; those of today are a tenth of a megabyte."""

MISMATCHED = (ValueError, KeyError, TypeError, AttributeError, IndexError, AssertionError)
"""What goes wrong with tables that are not those of the parser."""


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
        return _made()
    texts = [path.read_text(encoding="utf-8") for path in sorted(PARSERS_DIRECTORY.glob("*.lark"))]
    key = digest([lark.__version__, *texts])
    path = folder / f"{key}.grammar"
    known = read_kept(path, LARGEST)
    found = None if known is None else _read(known)
    if found is None:
        found = _made()
        keep(path, _written(found))
    return found


def _made() -> Lark:
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
    """Return the tables of a parser, which lark itself writes as a pickle of numbers, texts, lists and mappings."""
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
    """Return a mapping whose keys are numbers again where JSON has made texts of them."""
    return {int(key) if key.isdecimal() else key: value for key, value in table.items()}
