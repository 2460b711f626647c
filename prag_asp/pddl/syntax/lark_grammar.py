"""The parser of the grammar of the package `pddl`.

Building its tables takes longer than parsing most files, so they are cached on disk: as JSON, because loading JSON
executes no code.
"""

from __future__ import annotations

import json
import pickle
from contextlib import suppress
from functools import cache
from io import BytesIO
from typing import TYPE_CHECKING

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
    from lark import Lark, __version__
    from pddl.parser import PARSERS_DIRECTORY

    folder = cache_folder()
    if folder is None:
        return _build_parser()
    texts = [path.read_text(encoding="utf-8") for path in sorted(PARSERS_DIRECTORY.glob("*.lark"))]
    key = digest([__version__, *texts])
    path = folder / f"{key}.grammar"
    cached = read_cached(path, LARGEST)
    if cached is not None:
        with suppress(*MISMATCHED):
            # JSON stores integer keys as strings.
            tables = json.loads(
                cached, object_hook=lambda table: {int(k) if k.isdecimal() else k: each for k, each in table.items()}
            )
            return Lark.load(BytesIO(pickle.dumps(tables)))
    parser, buffer = _build_parser(), BytesIO()
    parser.save(buffer, exclude_options=["import_paths"])
    # Lark writes a pickle of plain values.
    write_cached(path, json.dumps(pickle.loads(buffer.getvalue())).encode())
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
