"""Parse PDDL into a syntax tree, by the grammar of the package `pddl`.

Of the first two tasks of all families of the public planning competition collection (294 tasks), the parser of `pddl`
0.5.1 accepts 194, because it refuses files that declare fewer requirements than they use. The reader of
`unified-planning` 1.3.0 accepts 262; it supports neither derived predicates nor a name with two meanings. The grammar
of `pddl` alone accepts all 294, in 10 s, and gives the line of every word. So only that grammar is used, on the text
in lower case, and `file_reader` interprets the tree.
"""

from __future__ import annotations

import re
from bisect import bisect_left
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

from prag_asp.errors import DomainError
from prag_asp.pddl.syntax.lark_grammar import KINDS, grammar
from prag_asp.pddl.syntax.nodes import LocatedWord, Node
from prag_asp.pddl.syntax.sections import ORDER, arranged
from prag_asp.program.sources import read_text
from prag_asp.wording import plural

if TYPE_CHECKING:
    from lark import Token, Tree

DEEPEST = 100
"""The maximum nesting depth of parentheses."""

COMMENT = re.compile(r";[^\n]*")
BEGIN = re.compile(r"\s*\(\s*define\s*\(\s*(\w+)")
WORDS = re.compile(r"([:?]?[\w-]+|\S|)\s*([:?]?[\w-]*)")

NESTED = re.compile(r"\(\s*(when|forall)\s*\(?\Z")

SECTIONS = frozenset([*ORDER["domain"], *ORDER["problem"], ":derived", ":action"])

UNSUPPORTED = {
    **dict.fromkeys([":durative-action", ":durative-actions", ":duration-inequalities"], "actions that take time"),
    **dict.fromkeys([":preferences", "preference"], "preferences"),
    **dict.fromkeys([":constraints"], "constraints on whole plans"),
    **dict.fromkeys([":timed-initial-literals"], "literals that are timed"),
    **dict.fromkeys([":process", ":event", ":time", ":continuous-effects"], "processes and events"),
    **dict.fromkeys([":object-fluents"], "functions whose values are objects"),
    **dict.fromkeys([":probabilistic-effects", "probabilistic"], "effects by chance"),
}
"""Features of PDDL that a task space cannot express, by the keywords that introduce them."""


def parse(path: Path, kind: str) -> Node:
    """Return the syntax tree of a ``domain`` or ``problem`` file.

    Raises:
        DomainError: the file cannot be read, or is not of this kind.
        PddlMissingError: the package pddl is not installed.
    """
    text = COMMENT.sub(lambda found: " " * len(found[0]), read_text(path).lower())
    begin = BEGIN.match(text)
    if begin is None:
        raise DomainError(f"{path}:1: not a PDDL {kind}; begin it with (define ({kind} NAME) ...")
    if begin[1] != kind and begin[1] in KINDS:
        hint = "give the domain first, then its problem: DOMAIN.pddl PROBLEM.pddl"
        raise DomainError(f"{path}:1: this is a {begin[1]}, but a {kind} is needed; {hint}")
    _check_parentheses(path, text)
    ends = [found.start() for found in re.finditer("\n", text)]

    def refuse(at: int, message: str) -> NoReturn:
        raise DomainError(f"{path}:{bisect_left(ends, at) + 1}: {message}") from None

    parser, arrangement = grammar(), arranged(text, kind, refuse)
    from lark import UnexpectedInput

    try:
        return _node(
            parser.parse(arrangement.text, start=kind), lambda at: bisect_left(ends, arrangement.origin(at)) + 1
        )
    except UnexpectedInput as error:
        at = min(error.pos_in_stream or 0, len(arrangement.text))
        refuse(arrangement.origin(at), _message(arrangement.text, at, kind))


def _node(tree: Tree[Token], line: Callable[[int], int]) -> Node:
    """Return a lark tree without its parentheses; `line` maps a position to its line number."""
    from lark import Tree

    children: list[Node | LocatedWord] = []
    for each in tree.children:
        if isinstance(each, Tree):
            children.append(_node(each, line))
        elif each is not None and each not in ("(", ")"):
            children.append(LocatedWord(str(each), line(each.start_pos or 0)))
    return Node(str(tree.data), tuple(children))


def _message(text: str, at: int, kind: str) -> str:  # noqa: PLR0911 - one for each mistake
    """Return the message of a syntax error at a position: the problem and the remedy."""
    begin, around = WORDS.match(text, at), WORDS.match(text, max(text.rfind("(", 0, at), 0))
    words = begin.groups() if begin else ("", "")
    for word in (*words, *(around.groups() if around else ())):
        if word in UNSUPPORTED:
            return f"{word}: {UNSUPPORTED[word]} cannot be imported; remove them"
    nested = NESTED.search(text, 0, at + len(words[0]))
    if nested:
        return (
            f"({nested[1]} ...) cannot stand here; write (forall (...) (when ...)), with all conditions in one 'when'"
        )
    if words[0] == ")" and text[:at].rstrip().endswith("("):
        return "() cannot stand here; write (and) for what always holds, or changes nothing"
    if words[0] == ")":
        return f"')' comes too early: the {kind} is incomplete; complete it, or remove a ')'"
    if not words[0]:
        return f"the {kind} is incomplete; write its missing parts"
    if words[0] in SECTIONS:
        return f"{words[0]} is not expected here; close the section before it"
    if text.rfind("(:requirements", 0, at) > text.rfind(")", 0, at):
        return f"{words[0]}: unknown requirement; correct it, or remove it"
    if re.match(r"-\d", words[0]):
        return f"{words[0]}: negative numbers cannot be imported; make costs 0 or more"
    if words[0] == "(" and text[:at].rstrip().endswith("-"):
        return "either is not supported here; declare c - a c - b for (either a b)"
    if re.match(r"[\d_]|[^\W\d_a-z]", words[0]):
        return f"{words[0]!r} is not a name; write a letter from a to z first, then letters, digits, '-' and '_'"
    return f"{words[0]!r} is not expected here; look for a misspelt word or a missing parenthesis before it"


def _check_parentheses(path: Path, text: str) -> None:
    """Check that parentheses match, and are nested at most `DEEPEST` deep.

    Raises:
        DomainError: they do not match, or are nested deeper.
    """
    depth, line = 0, 1
    for sign in re.findall(r"[()\n]", text):
        line += sign == "\n"
        depth += {"(": 1, ")": -1}.get(sign, 0)
        if depth < 0:
            raise DomainError(f"{path}:{line}: this ')' closes nothing; remove it, or look for a '(' that is missing")
        if depth > DEEPEST:
            raise DomainError(f"{path}:{line}: parentheses are nested more than {DEEPEST} deep; flatten the expression")
    if depth:
        line, open_ones = text.rstrip().count("\n") + 1, plural(depth, "'('", "'('")
        raise DomainError(f"{path}:{line}: the file ends while {open_ones} is open; close each with a ')'")
