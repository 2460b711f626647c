"""Write the encodings into the page with the placeholder: their documentation and their rules.

A file begins with its title, ``%#``; a block ``%*! head`` to ``*%`` documents a predicate.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

ENCODINGS = Path(__file__).parent.parent.parent / "encodings"
MARK = "<!-- encodings -->"
FOLDERS = {
    ".": "The logic of a plan",
    "rules": "Rules that a domain or a command may add",
    "conditions": "Conditions",
}
BLOCK = re.compile(r"%\*! (.*?)\n(.*?)\*%\n", re.DOTALL)


def on_page_markdown(markdown: str, **_: Any) -> str:
    """Replace the placeholder of a page by the encodings."""
    return markdown.replace(MARK, "\n".join(encoding_lines())) if MARK in markdown else markdown


def encoding_lines() -> Iterator[str]:
    """Yield the lines of the page for all encodings."""
    for folder, heading in FOLDERS.items():
        yield f"## {heading}\n"
        for path in sorted((ENCODINGS / folder).glob("*.lp")):
            yield from _file(path)


def _file(path: Path) -> Iterator[str]:
    """Yield the lines for one encoding: its title, its predicates, and its rules in a collapsible block."""
    title, text = path.read_text(encoding="utf-8").split("\n", 1)
    name = path.relative_to(ENCODINGS)
    yield f"### {name} {{ data-toc-label='{path.name}' }}\n\n{title.removeprefix('%#').strip()}.\n"
    for head, meaning in BLOCK.findall(text):
        yield f"`{head.strip()}`\n:   {' '.join(meaning.split())}\n"
    rules = "\n".join(f"    {line}" for line in BLOCK.sub("", text).strip().splitlines())
    yield f'??? note "The rules of {name}"\n\n    ```prolog\n{rules}\n    ```\n'
