"""Write the encodings into the page that has a mark for them: what they say of themselves, and their rules.

A file begins with its title, ``%#``; a block ``%*! head`` to ``*%`` tells what a predicate means.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

ENCODINGS = Path(__file__).parent.parent.parent / "encodings"
MARK = "<!-- encodings -->"
ROOMS = {
    ".": "The logic of a plan",
    "rules": "Rules that a domain or a command may add",
    "conditions": "Conditions",
}
BLOCK = re.compile(r"%\*! (.*?)\n(.*?)\*%\n", re.DOTALL)


def on_page_markdown(markdown: str, **_: Any) -> str:
    """Put the encodings where a page has the mark."""
    return markdown.replace(MARK, "\n".join(told())) if MARK in markdown else markdown


def told() -> Iterator[str]:
    """Yield the lines of the page for all encodings."""
    for room, heading in ROOMS.items():
        yield f"## {heading}\n"
        for path in sorted((ENCODINGS / room).glob("*.lp")):
            yield from _file(path)


def _file(path: Path) -> Iterator[str]:
    """Yield the lines for one encoding: its title, its predicates, and its rules to be unfolded."""
    title, text = path.read_text(encoding="utf-8").split("\n", 1)
    name = path.relative_to(ENCODINGS)
    yield f"### {name} {{ data-toc-label='{path.name}' }}\n\n{title.removeprefix('%#').strip()}.\n"
    for head, meaning in BLOCK.findall(text):
        yield f"`{head.strip()}`\n:   {' '.join(meaning.split())}\n"
    rules = "\n".join(f"    {line}" for line in BLOCK.sub("", text).strip().splitlines())
    yield f'??? note "The rules of {name}"\n\n    ```prolog\n{rules}\n    ```\n'
