"""Ground atoms as plain values that can be converted to text and back."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import TYPE_CHECKING, NamedTuple

from prag_asp.errors import QueryError
from prag_asp.integers import TOLD, shortened, too_large

if TYPE_CHECKING:
    import clingo

STRING = re.compile(r'"(?:\\["\\n]|[^"\\\n])*"')
"""A quoted string, as clingo reads it."""


class Atom(NamedTuple):
    """A ground action or fluent: ``Atom("grasp", ("panda", "apple_1"))`` prints ``grasp(panda,apple_1)``."""

    name: str
    arguments: tuple[str, ...] = ()

    def __str__(self) -> str:
        return f"{self.name}({','.join(self.arguments)})" if self.arguments else self.name


def atom_of(term: clingo.Symbol) -> Atom:
    """Return a clingo term as an atom, the form in which users see terms."""
    return Atom(term.name, tuple(map(str, term.arguments)))


def symbol_of(atom: Atom | str) -> clingo.Symbol:
    """Return an atom given by a user, or its text, as a clingo term.

    Raises:
        QueryError: the text is not a ground term, or has a number out of range.
    """
    for _, digits in too_large(STRING.sub(" ", str(atom))):
        raise QueryError(f"{str(atom)!r}: the number {shortened(digits)} is out of range: {TOLD}")
    import clingo  # noqa: PLC0415 - atoms are plain values, which need no solver

    try:
        return clingo.parse_term(str(atom), logger=lambda *_: None)
    except RuntimeError:
        raise QueryError(f"{str(atom)!r} is not a ground atom; write it like grasp(panda,apple_1)") from None


def parse_atom(text: str) -> Atom:
    """Return the atom written in `text`; its arguments may themselves be terms.

    Raises:
        QueryError: `text` is not a ground term.
    """
    name, parenthesis, rest = text.strip().partition("(")
    if not parenthesis:
        if not name or any(c in ",) \t" for c in name):
            raise QueryError(f"{text!r} is not a ground atom; write it like grasp(panda,apple_1)")
        return Atom(name)
    if not name or not rest.endswith(")"):
        raise QueryError(f"{text!r} is not a ground atom; write it like grasp(panda,apple_1)")
    return Atom(name.strip(), tuple(split_terms(rest[:-1])))


def split_terms(text: str) -> list[str]:
    """Return the terms of a comma-separated list; commas within parentheses do not separate terms.

    Raises:
        QueryError: a term is empty or its parentheses do not match.
    """
    terms, depth, start = [], 0, 0
    for position, character in enumerate(text):
        depth += (character == "(") - (character == ")")
        if depth < 0:
            break
        if character == "," and depth == 0:
            terms.append(text[start:position].strip())
            start = position + 1
    terms.append(text[start:].strip())
    if depth != 0 or not all(terms):
        raise QueryError(f"{text!r} is not a list of terms; write it like approach,grasp(panda,apple_1)")
    return terms


def split_actions(*texts: str) -> list[str]:
    """Return the actions listed in texts, in order; within a text, they are separated by spaces or commas.

    Raises:
        QueryError: an action is empty, or its parentheses do not match.
    """
    return [action for text in texts if text.strip() for term in split_terms(text) for action in _words(term)]


def _words(text: str) -> Iterator[str]:
    """Yield the words of a text; spaces inside parentheses or before an opening parenthesis do not separate words."""
    depth, start = 0, 0
    for position, character in enumerate(text):
        depth += (character == "(") - (character == ")")
        if character.isspace() and depth == 0:
            if text[position:].lstrip().startswith("("):
                continue
            if start < position:
                yield text[start:position]
            start = position + 1
    yield text[start:]
