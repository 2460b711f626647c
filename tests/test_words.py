"""The glossary of CONTRIBUTING.md holds: words that it replaces do not come back, in prose or in names."""

from __future__ import annotations

import ast
import io
import re
import tokenize
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

from tests.docs.pages import ROOT

PROSE = {
    r"data sets?": "dataset",
    r"first states?": "initial state",
    r"last states?": "final state",
    r"(?<!your )own rules?": "user rules",
    r"as needed": "small-model reduction, reduced",
    r"entities as needed": "small-model reduction",
    r"steady": "static",
    r"dear(?:er|est)": "more expensive, most expensive",
    r"telling variables": "projection variables",
    r"lent": "temporary",
    r"be it ever so": "even if",
    r"from cheap to dear": "in order of cost",
    r"who wants": "to",
    r"made up for": "replaced",
    r"(?:is|are|was|were) told apart": "distinguished",
    r"tells? (?:\w+ ){0,3}apart": "distinguish",
    r"for it (?:is|has|does|would|may|can|knows|says)": "because it",
    r"for they (?:are|have|do|would|may|can)": "because they",
    r"for there (?:is|are)": "because there is",
    r"so many-th": "every n-th",
}
"""Phrases that do not come back, as regular expressions, with the words to use."""

NAMES = frozenset(
    [
        "asked",
        "told",
        "looked",
        "wanted",
        "lent",
        "struck",
        "deafen",
        "telling",
        "asking",
        "passing",
        "dealt",
        "spared",
        "steady",
        "film",
        "travel",
        "backwards",
    ]
)
"""Names that no module, class, function, argument or field may have; a class also not in capitals."""


def prose_files() -> Iterator[Path]:
    """Yield the files that people read, apart from Python."""
    yield from (ROOT / name for name in ("README.md", "CONTRIBUTING.md", "CHANGELOG.md"))
    for folder, pattern in (("docs", "*.md"), ("encodings", "*.lp"), ("domains", "*.lp"), ("examples", "*.lp")):
        yield from (ROOT / folder).rglob(pattern)


def python_prose(path: Path) -> Iterator[tuple[int, str]]:
    """Yield the comments and strings of a module, with their lines."""
    with path.open("rb") as file:
        for token in tokenize.tokenize(io.BytesIO(file.read()).readline):
            if token.type in (tokenize.COMMENT, tokenize.STRING):
                yield token.start[0], " ".join(token.string.split())


def texts(path: Path) -> list[tuple[int, str]]:
    """Return the prose of a file, with its lines, without the glossary itself."""
    if path.suffix == ".py":
        return list(python_prose(path))
    text = path.read_text(encoding="utf-8")
    if path.name == "CONTRIBUTING.md":
        text = re.sub(r"## Glossary.*?(?=^## )", "", text, flags=re.DOTALL | re.MULTILINE)
    return [(1, " ".join(text.split()))]


def modules(folder: str) -> list[Path]:
    return sorted((ROOT / folder).rglob("*.py"))


@cache
def tree(path: Path) -> ast.Module:
    """Return the syntax tree of a module."""
    return ast.parse(path.read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def prose() -> list[tuple[str, int, str]]:
    """Return all prose of the repository: file, line and text."""
    paths = (*prose_files(), *modules("prag_asp"))
    return [(str(path.relative_to(ROOT)), line, text) for path in paths for line, text in texts(path)]


@pytest.mark.parametrize("phrase", PROSE)
def test_a_word_that_the_glossary_replaces_is_not_used(phrase: str, prose: list[tuple[str, int, str]]) -> None:
    pattern = re.compile(rf"\b{phrase}\b", re.IGNORECASE)
    found = [
        f"{path}:{line}: {text[max(0, match.start() - 30) : match.end() + 30]}"
        for path, line, text in prose
        for match in pattern.finditer(text)
    ]
    assert not found, f"say {PROSE[phrase]!r}:\n" + "\n".join(found)


def names(path: Path) -> Iterator[tuple[int, str]]:
    """Yield the names that a module defines: its own, those of classes and functions, arguments and fields."""
    yield 1, path.stem
    for node in ast.walk(tree(path)):
        if isinstance(node, (ast.ClassDef, ast.FunctionDef)):
            yield node.lineno, node.name
        elif isinstance(node, ast.arg):
            yield node.lineno, node.arg
        elif isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
            yield node.lineno, node.target.id


def test_no_definition_is_named_by_a_participle_alone() -> None:
    found = [
        f"{path.relative_to(ROOT)}:{line}: {name}"
        for path in modules("prag_asp")
        for line, name in names(path)
        if name.lower().strip("_") in NAMES
    ]
    assert not found, "\n".join(found)


def test_class_names_are_used_once_and_file_names_seldom_twice() -> None:
    """Nine commands are named like the modules that they call."""
    classes: dict[str, list[Path]] = {}
    stems: dict[str, list[Path]] = {}
    for path in modules("prag_asp"):
        if path.stem != "__init__":
            stems.setdefault(path.stem, []).append(path)
        for node in tree(path).body:
            if isinstance(node, ast.ClassDef):
                classes.setdefault(node.name, []).append(path)
    twice = {name for name, where in classes.items() if len(where) > 1}
    assert not twice, sorted(twice)
    assert len({name for name, where in stems.items() if len(where) > 1}) <= 12
