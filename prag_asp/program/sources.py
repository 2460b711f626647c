"""The files of a logic program, joined into one text with a map from its lines to the files."""

from __future__ import annotations

import bisect
import re
import sys
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from prag_asp.errors import DomainError
from prag_asp.program.paths import data_folder
from prag_asp.program.tokens import blanked
from prag_asp.safe_reading import LARGEST_TEXT, STANDARD_INPUT, is_inside, read_bytes

KEYWORD = re.compile(r"#include\b")
CONTRACT = "contract.lp"
"""An encoding that every folder of encodings contains."""

HIERARCHY = "hierarchy.lp"
"""The encoding of composites, which is added only to domains with composites."""

ONE_VALUE = "one_value.lp"
"""The encoding that is added only to domains with rules that set fluents."""

REACHABLE = "reachable.lp"
"""The encoding of relaxed reachability, which only pruning uses."""

EVER_AT_START, EVER_BY_ACTIONS = "ever(F) :- initially(F,true).", "ever(F) :- postcondition(_,F,true)."
"""``rules/ever.lp`` without `not`, for closed worlds in which no action makes a value unknown."""

ADDED = Path("<added by the library>")
"""The path that stands for facts that the library adds to a program."""

END = re.compile(r"(?<!\.)\.(?!\.)")
"""The period that ends a statement."""

SETS = re.compile(r"\b(?:holds|_known)\b")
INCLUDE = re.compile(r'#include\s*"(?P<file>[^"\\\n]*)"\s*\.')
SCRIPT = re.compile(r"#include\s*<\s*incmode\s*>")
"""The only include file that clingo provides: a script that grounds and solves step by step."""


@dataclass(frozen=True)
class Source:
    """A file of a logic program without its includes; `includes` holds their line numbers and files."""

    path: Path
    text: str
    includes: tuple[tuple[int, Path], ...] = ()


@dataclass(frozen=True)
class Program:
    """A logic program as a sequence of files."""

    sources: tuple[Source, ...]

    @cached_property
    def text(self) -> str:
        """The joined text of all files; each file begins in the part `base`."""
        return "".join(f"#program base.\n{source.text}\n" for source in self.sources)

    @cached_property
    def _starts(self) -> list[int]:
        starts, line = [], 1
        for source in self.sources:
            starts.append(line)
            line += source.text.count("\n") + 2
        return starts

    def locate(self, line: int) -> tuple[Path, int]:
        """Return the file that contains a line of `text`, and the line number in that file, counted from 1."""
        at = max(bisect.bisect_right(self._starts, line) - 1, 0)
        return self.sources[at].path, max(line - self._starts[at], 1)


def read_sources(path: Path | Source, encodings: Path, *, own: Path | None = None) -> tuple[Source, ...]:
    """Return a file and all files that it includes, each once, included files first.

    An include is looked up in the folder of the including source, then in the folder of encodings. `own` is the folder
    that must contain the file. Without it, the file was named by the user: it may be a link, and its folder must
    contain its includes.

    Raises:
        DomainError: a file cannot be read, or an include is outside the folder `own` and the encodings.
    """
    sources: dict[Path, Source] = {}
    begin = path if isinstance(path, Source) else Source(path, read_text(path, own))
    _read(begin, encodings, own or begin.path.parent, sources, ())
    return tuple(sources.values())


def _read(source: Source, encodings: Path, own: Path, sources: dict[Path, Source], above: tuple[Path, ...]) -> None:
    path, text = source.path, source.text
    pieces, includes = [], []
    end = 0
    for keyword in KEYWORD.finditer(blanked(text)):
        line = text.count("\n", 0, keyword.start()) + 1
        include = INCLUDE.match(text, keyword.start())
        if SCRIPT.match(text, keyword.start()):
            raise DomainError(
                f"{path}:{line}: #include <incmode> is not supported because it is a script, and a script is not run; "
                "state its steps by rules, such as step(1..n)"
            )
        if include is None:
            raise DomainError(f'{path}:{line}: unreadable #include; write it as #include "file.lp".')
        for folder, limit in ((path.parent, own), (path.parent, encodings), (encodings, encodings)):
            name, target = include["file"], folder / include["file"]
            if name and "\0" not in name and target.is_file() and is_inside(target, limit):
                break
        else:
            raise DomainError(
                f"{path}:{line}: cannot include {include['file']!r}; name a file in the domain's folder or in the "
                'encodings, such as "rules/closed_world.lp"'
            )
        if target.resolve() not in (*above, path.resolve()) and target.resolve() not in sources:
            _read(Source(target, read_text(target, limit)), encodings, own, sources, (*above, path.resolve()))
        pieces += [text[end : include.start()], re.sub(r"[^\n]", " ", include[0])]
        includes.append((line, target))
        end = include.end()
    sources[path.resolve()] = Source(path, "".join([*pieces, text[end:]]), tuple(includes))


def read_text(path: Path, within: Path | None = None) -> str:
    """Return the text of a file, which must be in the folder `within` if that is given.

    Raises:
        DomainError: the file is missing, unreadable, too large, outside the folder or not UTF-8.
    """
    try:
        content = read_bytes(path, within=within)
    except OSError as error:
        problem = f"{path}:1: cannot be read: {error.strerror}"
        raise DomainError(f"{problem}; check that the path is a readable file") from None
    return decoded(content, path)


def decoded(content: bytes, path: Path) -> str:
    """Return the decoded content of a file, with all line endings replaced by line feeds.

    Raises:
        DomainError: the content is not UTF-8.
    """
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = error.object[: error.start].count(b"\n") + 1
        raise DomainError(f"{path}:{line}: not UTF-8 text; save the file as UTF-8") from None
    return text.replace("\r\n", "\n").replace("\r", "\n")


def text_source(name: str, text: str) -> Source:
    """Return a text as a source with the path ``<name>``.

    Raises:
        DomainError: the text cannot be encoded as UTF-8.
    """
    path = Path(f"<{name}>")
    try:
        text.encode()
    except UnicodeEncodeError as error:
        line = text.count("\n", 0, error.start) + 1
        raise DomainError(f"{path}:{line}: half of a surrogate pair is not a character; remove it") from None
    return Source(path, text)


def standard_input() -> Source:
    """Read standard input to its end, and return it as a source.

    Raises:
        DomainError: there is no standard input, or its content is too large or not UTF-8.
    """
    if sys.stdin is None:
        raise DomainError(f"{STANDARD_INPUT}: standard input is closed; write `cat FILE | prag-asp ...`")
    path, content = Path("<stdin>"), sys.stdin.buffer.read(LARGEST_TEXT + 1)
    if len(content) > LARGEST_TEXT:
        raise DomainError(f"{path}:1: it is larger than {LARGEST_TEXT / 10**6:,.0f} MB; shorten it")
    return Source(path, decoded(content, path))


def core_sources(encodings: Path) -> tuple[Source, ...]:
    """Return the encodings that every domain uses: those directly in the folder, except optional ones.

    Raises:
        DomainError: the folder has no encodings.
    """
    if not (encodings / CONTRACT).is_file():
        raise DomainError(f"{encodings}: this folder of encodings has no {CONTRACT}; copy the shipped encodings")
    paths = sorted(path for path in encodings.glob("*.lp") if path.name not in (HIERARCHY, ONE_VALUE, REACHABLE))
    return each_once(source for path in paths for source in read_sources(path, encodings))


def each_once(sources: Iterable[Source]) -> tuple[Source, ...]:
    """Return sources without duplicates; sources with the same path and text are duplicates."""
    unique: dict[tuple[Path, str], Source] = {}
    for source in sources:
        unique.setdefault((source.path.resolve(), source.text), source)
    return tuple(unique.values())


def asked_sources(own: Sequence[Source], encodings: Path) -> tuple[Source, ...]:
    """Return the optional encodings that a domain needs: for composites, and for rules that set fluents."""
    hierarchy = read_sources(encodings / HIERARCHY, encodings) if any("composite" in each.text for each in own) else ()
    texts = (blanked(each.text) for each in own if SETS.search(each.text))
    # an occurrence in the condition of a head also counts
    sets_fluents = any(SETS.search(rule.partition(":-")[0]) for text in texts for rule in END.split(text))
    one_value = read_sources(encodings / ONE_VALUE, encodings) if sets_fluents else ()
    return (*hierarchy, *one_value)


def owned(program: Program) -> list[tuple[Source, bool]]:
    """Return the files of a program, each with a flag that is false if it belongs to the encodings."""
    encodings = encodings_folder(program)
    if encodings is None:
        return [(source, True) for source in program.sources]
    return [
        (source, source.path.parent not in (encodings, encodings / "rules", encodings / "conditions"))
        for source in program.sources
    ]


def added_encodings(program: Program) -> frozenset[Path]:
    """Return the files in a program's encodings folder that the shipped encodings do not contain."""
    encodings, shipped = encodings_folder(program), data_folder("encodings")
    if encodings is None or encodings.resolve() == shipped.resolve():
        return frozenset()
    files = (source.path for source, own in owned(program) if not own)
    return frozenset(path for path in files if not (shipped / path.relative_to(encodings)).is_file())


def encodings_folder(program: Program) -> Path | None:
    """Return the folder of the encodings of a program, or None."""
    return next((source.path.parent for source in program.sources if source.path.name == CONTRACT), None)
