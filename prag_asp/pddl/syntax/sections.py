"""The definition of a domain or a problem in a file, divided into sections."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from prag_asp.errors import DomainError
from prag_asp.pddl.syntax.expressions import Expression, Word, parse_expressions
from prag_asp.program.sources import read_text
from prag_asp.wording import did_you_mean

KINDS = ("domain", "problem")

SECTIONS: Mapping[str, tuple[str, ...]] = {
    "domain": (":requirements", ":types", ":constants", ":predicates", ":functions", ":constraints"),
    "problem": (":domain", ":requirements", ":objects", ":init", ":goal", ":constraints", ":metric", ":length"),
}
"""The sections that a definition may have at most once."""

REPEATED = {"domain": (":derived", ":axiom", ":action", ":durative-action"), "problem": ()}
NEEDED = {"domain": (), "problem": (":domain", ":init", ":goal")}

UNSUPPORTED = {
    **dict.fromkeys([":preferences", "preference"], "preferences"),
    **dict.fromkeys([":constraints"], "constraints on whole plans"),
    **dict.fromkeys([":process", ":event"], "processes and events"),
    **dict.fromkeys(["oneof", "unknown"], "initial states of which one is true"),
    **dict.fromkeys(["probabilistic"], "effects by chance"),
    **dict.fromkeys([":observe", ":sense", "observe"], "observations"),
}
"""Features of PDDL that a task space cannot express, by the words that introduce them."""


@dataclass(frozen=True)
class Definition:
    """A domain or a problem: its name, its sections, and its rules and actions, in the order of the file."""

    name: Word
    sections: Mapping[str, Expression]
    repeated: tuple[Expression, ...]
    end: int
    """The line of its last parenthesis."""


def parse(path: Path, kind: str) -> Definition:
    """Return the definition of a ``domain`` or ``problem`` in a file, which may contain one of each.

    Raises:
        DomainError: the file cannot be read, or has no such definition.
    """
    text = read_text(path)
    found: dict[str, Expression] = {}
    for each in parse_expressions(path, text):
        name = each.parts[1] if len(each.parts) > 1 else None
        if each.head == "define" and isinstance(name, Expression) and name.head in KINDS:
            if name.head in found:
                raise DomainError(f"{path}:{each.line}: a second {name.head}; move it to another file")
            found[name.head] = each
    if kind in found:
        return _definition(path, found[kind], kind)
    for other in found:
        hint = "give the domain first, then its problem: DOMAIN.pddl PROBLEM.pddl"
        raise DomainError(f"{path}:1: this is a {other}, but a {kind} is needed; {hint}")
    raise DomainError(f"{path}:1: not a PDDL {kind}; begin it with (define ({kind} NAME) ...")


def holds_both(path: Path) -> bool:
    """Return whether a file contains both a domain and a problem."""
    kinds = {
        each.parts[1].head
        for each in parse_expressions(path, read_text(path))
        if len(each.parts) > 1 and isinstance(each.parts[1], Expression)
    }
    return kinds.issuperset(KINDS)


def _definition(path: Path, whole: Expression, kind: str) -> Definition:
    _, title, *rest = whole.parts
    assert isinstance(title, Expression)
    names = [each for each in title.rest if isinstance(each, Word)]
    if not names:
        raise DomainError(f"{path}:{title.line}: the {kind} has no name; write (define ({kind} NAME) ...")
    sections: dict[str, Expression] = {}
    repeated: list[Expression] = []
    for each in rest:
        if isinstance(each, Word):
            raise DomainError(f"{path}:{each.line}: {unexpected(each)}")
        head = each.head
        if head in REPEATED[kind]:
            repeated.append(each)
        elif head not in SECTIONS[kind]:
            raise DomainError(f"{path}:{head.line}: {_unknown(head, kind)}")
        elif head in sections:
            raise DomainError(f"{path}:{each.line}: a second {head}; merge them into one")
        else:
            sections[str(head)] = each
    for needed in NEEDED[kind]:
        if needed not in sections:
            raise DomainError(f"{path}:{whole.end}: the {kind} has no ({needed} ...); add it")
    return Definition(names[0], sections, tuple(repeated), whole.end)


def _unknown(head: Word, kind: str) -> str:
    if head in UNSUPPORTED:
        return unsupported(head)
    other = next(each for each in KINDS if each != kind)
    if head in (*SECTIONS[other], *REPEATED[other]):
        return f"{head} is a section of a {other}, not of a {kind}; move it there"
    known = (*SECTIONS[kind], *REPEATED[kind])
    hint = did_you_mean(head, known, "look for a misspelt word or a missing parenthesis before it")
    return f"{str(head) or '('!r} is not expected here; {hint}"


def unexpected(word: str) -> str:
    """Return the message about a word that is not valid where it occurs."""
    return f"{str(word)!r} is not expected here; look for a misspelt word or a missing parenthesis before it"


def unsupported(word: str) -> str:
    """Return the message about a word in `UNSUPPORTED`."""
    return f"{word}: {UNSUPPORTED[word]} cannot be imported; remove them"
