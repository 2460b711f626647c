"""Sort the sections of a file, and the parts of its actions, into the order that the grammar requires."""

from __future__ import annotations

import re
from bisect import bisect
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from itertools import islice
from operator import itemgetter
from typing import NoReturn

TOKEN = re.compile(r"[()]|[^\s()]+")

ORDER = {
    "domain": (":requirements", ":types", ":constants", ":predicates", ":functions"),
    "problem": (":domain", ":requirements", ":objects", ":init", ":goal", ":metric"),
}
"""The sections that a file has at most once, in the order of the grammar; rules and actions come after them."""

NEEDED = {"domain": (), "problem": (":domain", ":init", ":goal")}
ACTION = (":parameters", ":precondition", ":effect")

DROPPED = frozenset([":length"])
"""The sections that do not affect the set of plans."""

NOT_EMPTY = frozenset([":requirements", ":predicates", ":functions"])
"""The sections that the grammar does not accept empty."""

Span = tuple[int, int]
Refuse = Callable[[int, str], NoReturn]


@dataclass
class Arranged:
    """A text composed of pieces of a source text, with the position of each piece in the source."""

    _source: str
    _pieces: list[tuple[int, int, str]] = field(default_factory=list)
    """The pieces: position in this text, position in the source, text."""

    @property
    def text(self) -> str:
        """The text."""
        return "".join(text for _, _, text in self._pieces)

    def take(self, start: int, end: int) -> None:
        """Append a piece of the source."""
        self.insert(self._source[start:end], start)

    def insert(self, text: str, at: int) -> None:
        """Append text whose position in the source is `at`, also if the source lacks it."""
        start = self._pieces[-1][0] + len(self._pieces[-1][2]) if self._pieces else 0
        self._pieces.append((start, at, f"{text} "))

    def origin(self, position: int) -> int:
        """Return the position in the source of a character of this text."""
        start, at, text = self._pieces[max(bisect(self._pieces, position, key=itemgetter(0)) - 1, 0)]
        return at + min(position - start, len(text))


def arranged(text: str, kind: str, refuse: Refuse) -> Arranged:
    """Return a text without comments and with matching parentheses, in the order that the grammar requires.

    Unknown sections and parts of actions stay, after the others. `refuse` gets the position and the message of an error
    if a section is repeated or missing.
    """
    (start, end), *after = _items(text, 0, len(text))
    _, name, *sections = _items(text, start + 1, end - 1)
    spans: dict[str, Span] = {}
    others: list[tuple[str, Span]] = []
    for span in sections:
        word = TOKEN.search(text, span[0] + 1, span[1]) if text[span[0]] == "(" else None
        head = word[0] if word else ""
        if head not in ORDER[kind]:
            others.append((head, span))
        elif spans.setdefault(head, span) != span:
            refuse(span[0], f"a second {head}; merge them into one")
    for head in NEEDED[kind]:
        if head not in spans:
            refuse(end - 1, f"the {kind} has no ({head} ...); add it")
    result = Arranged(text)
    result.take(start, name[1])
    for head, span in [*((head, spans[head]) for head in ORDER[kind] if head in spans), *others]:
        parts = list(_items(text, span[0] + 1, span[1] - 1))
        if head == ":action":
            _arrange_action(result, text, span, parts, refuse)
        elif head == ":goal" and len(parts) == 2 and not list(_items(text, parts[1][0] + 1, parts[1][1] - 1)):
            result.insert("(:goal (and))", span[0])
        elif head not in DROPPED and (len(parts) > 1 or head not in NOT_EMPTY):
            result.take(*span)
    for span in ((end - 1, end), *after):
        result.take(*span)
    return result


def _arrange_action(result: Arranged, text: str, span: Span, parts: list[Span], refuse: Refuse) -> None:
    """Append an action; it is copied unchanged if it is not a list of known keywords with one value each."""
    words = [text[begin:end] for begin, end in islice(parts, 2, None, 2)]
    if len(parts) % 2 or not set(words) <= set(ACTION):
        result.take(*span)
        return
    spans = dict(zip(words, zip(parts[2::2], parts[3::2], strict=True), strict=True))
    if len(spans) < len(words):
        again = next(number for number, word in enumerate(words) if word in words[:number])
        refuse(parts[2 + 2 * again][0], f"a second {words[again]} of this action; merge them into one")
    result.take(span[0], parts[1][1])
    for word in ACTION:
        if word in spans:
            (begin, _), (_, end) = spans[word]
            for piece in _flat(text, begin, end) if word == ":effect" else [(begin, end)]:
                result.take(*piece)
        elif word == ":parameters":
            result.insert(":parameters ()", parts[1][1])
    result.take(span[1] - 1, span[1])


def _flat(text: str, start: int, end: int) -> Iterator[Span]:
    """Yield a text in pieces with nested ``(and (and ...))`` flattened: the grammar does not accept it in effects."""
    heads: list[tuple[str, bool]] = []
    begin = start
    for token in TOKEN.finditer(text, start, end):
        if token[0] == "(":
            word = TOKEN.search(text, token.end(), end)
            head = word[0] if word else ""
            within = head == "and" and bool(heads) and heads[-1][0] == "and"
            heads.append((head, within))
            if word and within:
                yield begin, token.start()
                begin = word.end()
        elif token[0] == ")" and heads.pop()[1]:
            yield begin, token.start()
            begin = token.end()
    yield begin, end


def _items(text: str, start: int, end: int) -> Iterator[Span]:
    """Yield the spans of the words and parenthesized expressions at the top level of a text."""
    depth = begin = 0
    for token in TOKEN.finditer(text, start, end):
        if token[0] == "(":
            begin = begin if depth else token.start()
            depth += 1
        elif token[0] == ")":
            depth -= 1
            if not depth:
                yield begin, token.end()
        elif not depth:
            yield token.span()
