"""The pages that people read, and the examples on them: what each block is, what it does, and what it shows.

Blocks are fenced, at the margin of the page. A page's blocks are run in their order, in one folder of its own:

    console             commands after ``$``, which may continue after a ``\\``, and what they print; a line ``...``
                        stands for any lines
    pycon               a Python session, as doctest reads it; one namespace for the whole page
    prolog, toml        a piece of a domain, to be added to that of examples/dishes
    any, with a title   a piece of that file: of the repository's if it has one, else added to the page's folder
    sh                  how to set up: commands that tests cannot run, see SETUP
    text                a drawing; nothing to run

``python -m tests.docs.pages [PAGE...]`` writes into the pages what their examples print now.
"""

from __future__ import annotations

import doctest
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

ROOT = Path(__file__).parent.parent.parent
DOCS = ROOT / "docs"
PAGES = tuple(sorted([ROOT / "README.md", ROOT / "CONTRIBUTING.md", *DOCS.rglob("*.md")]))
FRESH = tuple(DOCS / "guides" / name for name in ("first_dataset.md", "formats.md", "datasets.md"))
"""Pages that a test follows word by word in an environment of their own, with what they say to install."""

PROGRAMS = Path(sys.executable).parent
"""Where the programs of this environment are, ``prag-asp`` among them."""

TIMEOUT = 300
"""Seconds that one command of a page may take."""

FENCE = re.compile(r"^```(\w+)(?: title=\"([^\"]+)\")?\n(.*?)^```$", re.MULTILINE | re.DOTALL)


@dataclass(frozen=True)
class Block:
    """A fenced block of a page: its language and title, the line of its first line of text, and the text."""

    page: Path
    language: str
    title: str
    line: int
    text: str

    def __str__(self) -> str:
        return f"{self.page.relative_to(ROOT)}:{self.line}"


@dataclass(frozen=True)
class Example:
    """Something to run: its page and last line, its source, what it is said to print, and what it prints."""

    page: Path
    line: int
    source: str
    shown: str
    printed: str = ""

    def __str__(self) -> str:
        return f"{self.page.relative_to(ROOT)}:{self.line}: {self.source}\nprinted\n{self.printed}"

    @property
    def right(self) -> bool:
        """Whether it prints what the page shows, in which a line ``...`` stands for any lines."""
        pattern = r"(?:.*\n)*".join(re.escape(part) for part in re.split(r"(?m)^\.\.\.\n", self.shown))
        return re.fullmatch(pattern, self.printed) is not None


def blocks(page: Path) -> list[Block]:
    """Return the fenced blocks of a page."""
    text = page.read_text(encoding="utf-8")
    return [
        Block(page, each[1], each[2] or "", text.count("\n", 0, each.start(3)) + 1, each[3])
        for each in FENCE.finditer(text)
    ]


def prepare(folder: Path) -> None:
    """Give a folder what the pages expect of a clone."""
    for name in ("encodings", "examples"):
        shutil.copytree(ROOT / name, folder / name, ignore=shutil.ignore_patterns("__pycache__", "*.png", "*.ipynb"))


def run_page(page: Path, folder: Path, programs: Path = PROGRAMS) -> Iterator[Example]:
    """Run the examples of a page in a prepared folder, with programs of another, and yield each with what it prints."""
    names: dict[str, Any] = {"__name__": "page"}
    for block in blocks(page):
        if block.title and not (ROOT / block.title).exists():
            (folder / block.title).parent.mkdir(parents=True, exist_ok=True)
            with (folder / block.title).open("a", encoding="utf-8") as file:
                file.write(block.text)
        elif block.language == "console":
            yield from _run_commands(block, folder, programs)
        elif block.language == "pycon":
            with _inside(folder):
                yield from _run_session(block, names)


@contextmanager
def _inside(folder: Path) -> Iterator[None]:
    """Work in a folder for a while."""
    before = Path.cwd()
    os.chdir(folder)
    try:
        yield
    finally:
        os.chdir(before)


def _run_commands(block: Block, folder: Path, programs: Path) -> Iterator[Example]:
    """Run the commands of a console block."""
    path = os.pathsep.join(map(str, (programs, PROGRAMS, os.environ["PATH"])))
    for source, line, shown in _commands(block):
        printed = subprocess.run(
            ["bash", "-c", source],
            cwd=folder,
            env={**os.environ, "PATH": path, "COLUMNS": "110", "LC_ALL": "C.UTF-8"},
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            encoding="utf-8",
            timeout=TIMEOUT,
            check=False,
        ).stdout
        yield Example(block.page, line, source, shown, printed)


def _commands(block: Block) -> list[tuple[str, int, str]]:
    """Return the commands of a console block, the line that each stands in, and what it is said to print."""
    found: list[tuple[str, int, str]] = []
    for line, text in enumerate(block.text.splitlines(keepends=True), block.line):
        if text.startswith("$ "):
            found.append((text[2:-1], line, ""))
        elif found[-1][0].endswith("\\"):
            found[-1] = f"{found[-1][0]}\n{text[:-1]}", line, ""
        else:
            source, start, shown = found[-1]
            found[-1] = source, start, shown + text
    return found


class _Recorder(doctest.DocTestRunner):
    """Runs sessions, and keeps what each example printed in place of reporting it."""

    def __init__(self) -> None:
        super().__init__(verbose=False)
        self.printed: list[str] = []

    def report_start(self, out: Any, test: Any, example: Any) -> None:
        """Say nothing."""

    def report_success(self, out: Any, test: Any, example: Any, got: str) -> None:
        self.printed.append(got)

    report_failure = report_success

    def report_unexpected_exception(self, out: Any, test: Any, example: Any, exc_info: Any) -> None:
        raise exc_info[1]


def _run_session(block: Block, names: dict[str, Any]) -> Iterator[Example]:
    """Run the Python session of a block in a namespace, which it may change."""
    session = doctest.DocTestParser().get_doctest(block.text, names, str(block), str(block.page), block.line - 1)
    recorder = _Recorder()
    recorder.run(session, clear_globs=False)
    names.update(session.globs)
    for example, printed in zip(session.examples, recorder.printed, strict=True):
        last = block.line + example.lineno + example.source.count("\n") - 1
        yield Example(block.page, last, example.source.rstrip(), example.want, printed)


def updated(page: Path) -> str:
    """Return a page with what its examples print now; what is elided stays so where it still fits."""
    lines = page.read_text(encoding="utf-8").splitlines(keepends=True)
    with TemporaryDirectory() as made:
        prepare(Path(made))
        examples = list(run_page(page, Path(made)))
    for each in reversed(examples):
        if not each.right:
            lines[each.line : each.line + each.shown.count("\n")] = each.printed.splitlines(keepends=True)
    return "".join(lines)


def main(names: Sequence[str]) -> None:
    """Update some pages, or all."""
    os.environ["PRAG_ASP_CACHE"] = ""
    for page in [Path(name).resolve() for name in names] or PAGES:
        page.write_text(updated(page), encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
