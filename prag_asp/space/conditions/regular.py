"""Regular expressions over names, and the deterministic automata that recognise them.

The states of an automaton are expressions for the remaining words (derivatives, Brzozowski 1964).
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache

from prag_asp.errors import QueryError
from prag_asp.wording import unknown

TOKEN = re.compile(r"\s*(?:(?P<name>[\w]+)|\{(?P<low>\d+)(?P<range>,(?P<high>\d*))?\}|(?P<sign>[.|*+?()]))")
MOST_COPIES = 1000

MOST_STATES = 20_000
"""Maximum number of states of an automaton; for some expressions, each additional name doubles the number."""


@dataclass(frozen=True)
class Nothing:
    """The language without words."""


@dataclass(frozen=True)
class Empty:
    """The language of the empty word."""


@dataclass(frozen=True)
class OneOf:
    """The words that consist of one name; `names` is None for any name."""

    names: frozenset[str] | None


@dataclass(frozen=True)
class Chain:
    """The words that consist of a word of `first` followed by a word of `rest`.

    Its hash is cached because the hash of a long chain would otherwise be recomputed link by link.
    """

    first: Expression
    rest: Expression
    _hash: int = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "_hash", hash((Chain, self.first, self.rest)))

    def __hash__(self) -> int:
        return self._hash


@dataclass(frozen=True)
class Choice:
    """The words of any of `parts`."""

    parts: frozenset[Expression]


@dataclass(frozen=True)
class Star:
    """The words that consist of any number of words of `part`, one after the other."""

    part: Expression


Expression = Nothing | Empty | OneOf | Chain | Choice | Star


@dataclass(frozen=True)
class Recogniser:
    """A deterministic automaton that starts in state 0 and rejects a word if there is no move for one of its names."""

    moves: Sequence[Mapping[str, int]]
    accepting: frozenset[int]


def recogniser(expression: Expression, names: Iterable[str], *, inverse: bool = False) -> Recogniser:
    """Return the minimal automaton for the words of `expression` over `names` or, with `inverse`, for all other words.

    The minimal automaton without dead states is unique (Myhill 1957, Nerode 1958).

    Raises:
        QueryError: the construction takes more than `MOST_STATES` states.
    """
    alphabet = sorted(names)
    numbers: dict[Expression, int] = {expression: 0}
    states = [expression]
    moves: list[dict[str, int]] = []
    for state in states:
        if len(states) > MOST_STATES:
            raise QueryError(
                f"an expression needs an automaton of more than {MOST_STATES:,} states; "
                "ask for less, such as fewer names after a part that may have any length"
            )
        row = {}
        for name in alphabet:
            after = derivative(state, name)
            if after not in numbers:
                numbers[after] = len(states)
                states.append(after)
            row[name] = numbers[after]
        moves.append(row)
    accepting = {number for number, state in enumerate(states) if nullable(state) != inverse}
    return _smallest(moves, accepting)


def _smallest(moves: Sequence[Mapping[str, int]], accepting: set[int]) -> Recogniser:
    blocks = [int(state in accepting) for state in range(len(moves))]
    while True:
        kinds: dict[tuple[int, ...], int] = {}
        refined = [
            kinds.setdefault((blocks[state], *(blocks[target] for target in row.values())), len(kinds))
            for state, row in enumerate(moves)
        ]
        if len(kinds) == len(set(blocks)):
            break
        blocks = refined
    live = set(accepting)
    while True:
        sources = {state for state, row in enumerate(moves) if live & set(row.values())} - live
        if not sources:
            break
        live |= sources
    order = [0]
    numbers = {refined[0]: 0}
    rows: list[dict[str, int]] = []
    for state in order:
        row = {name: target for name, target in moves[state].items() if target in live}
        for target in row.values():
            if refined[target] not in numbers:
                numbers[refined[target]] = len(order)
                order.append(target)
        rows.append({name: numbers[refined[target]] for name, target in row.items()})
    return Recogniser(rows, frozenset(numbers[refined[s]] for s in accepting if refined[s] in numbers))


@cache
def nullable(expression: Expression) -> bool:
    """Return whether the empty word is a word of an expression."""
    if isinstance(expression, Chain):
        return nullable(expression.first) and nullable(expression.rest)
    if isinstance(expression, Choice):
        return any(map(nullable, expression.parts))
    return isinstance(expression, Empty | Star)


@cache
def derivative(expression: Expression, name: str) -> Expression:
    """Return the expression for the words that, after `name`, complete a word of an expression."""
    if isinstance(expression, OneOf):
        return Empty() if expression.names is None or name in expression.names else Nothing()
    if isinstance(expression, Chain):
        after = chain(derivative(expression.first, name), expression.rest)
        return choice([after, derivative(expression.rest, name)]) if nullable(expression.first) else after
    if isinstance(expression, Choice):
        return choice(derivative(part, name) for part in expression.parts)
    if isinstance(expression, Star):
        return chain(derivative(expression.part, name), expression)
    return Nothing()


def chain(first: Expression, rest: Expression) -> Expression:
    """Return the expression for a word of `first` followed by a word of `rest`, in a normal form."""
    if isinstance(first, Nothing) or isinstance(rest, Nothing):
        return Nothing()
    if isinstance(first, Empty):
        return rest
    if isinstance(rest, Empty):
        return first
    if isinstance(first, Chain):
        return Chain(first.first, chain(first.rest, rest))
    return Chain(first, rest)


def choice(parts: Iterable[Expression]) -> Expression:
    """Return the expression for a word of any of `parts`, in a normal form."""
    choices: set[Expression] = set()
    for part in parts:
        choices |= part.parts if isinstance(part, Choice) else {part}
    choices.discard(Nothing())
    if len(choices) > 1:
        return Choice(frozenset(choices))
    return choices.pop() if choices else Nothing()


def parse_expression(text: str, names: Iterable[str]) -> Expression:
    """Parse an expression of names, ``.``, ``|``, ``*``, ``+``, ``?``, ``{m,n}`` and parentheses.

    Raises:
        QueryError: the text is not an expression, or has an unknown name.
    """
    return _ExpressionParser(text, frozenset(names)).whole()


class _ExpressionParser:
    """A recursive-descent parser of an expression."""

    def __init__(self, text: str, names: frozenset[str]) -> None:
        self._text, self._names = text, names
        self._tokens: list[re.Match[str]] = []
        position = 0
        while text[position:].strip():
            token = TOKEN.match(text, position)
            if token is None:
                raise self._wrong(f"{text[position:].strip()[0]!r} cannot occur in one")
            self._tokens.append(token)
            position = token.end()

    def whole(self) -> Expression:
        expression = self._choice()
        if self._tokens:
            raise self._wrong(f"unexpected {self._tokens[0][0].strip()!r}")
        return expression

    def _sign(self) -> str | None:
        return self._tokens[0]["sign"] if self._tokens else None

    def _choice(self) -> Expression:
        parts = [self._chain()]
        while self._sign() == "|":
            self._tokens.pop(0)
            parts.append(self._chain())
        return choice(parts)

    def _chain(self) -> Expression:
        parts: list[Expression] = []
        while self._tokens and self._sign() not in ("|", ")"):
            parts.append(self._repeated())
        whole: Expression = Empty()
        for part in reversed(parts):
            whole = chain(part, whole)
        return whole

    def _repeated(self) -> Expression:
        part = self._single()
        while self._tokens and (self._tokens[0]["low"] or self._sign() in ("*", "+", "?")):
            token = self._tokens.pop(0)
            if token["low"]:
                high = int(token["high"]) if token["high"] else None
                part = self._copies(part, int(token["low"]), high if token["range"] else int(token["low"]))
            else:
                part = self._copies(part, int(token["sign"] == "+"), 1 if token["sign"] == "?" else None)
        return part

    def _copies(self, part: Expression, low: int, high: int | None) -> Expression:
        if max(low, high or 0) > MOST_COPIES or (high is not None and high < low):
            raise self._wrong(f"{{m,n}} needs m <= n <= {MOST_COPIES}")
        optional: Expression = Empty() if high is not None else part if isinstance(part, Star) else Star(part)
        for _ in range((high or low) - low):
            optional = choice([Empty(), chain(part, optional)])
        for _ in range(low):
            optional = chain(part, optional)
        return optional

    def _single(self) -> Expression:
        token = self._tokens.pop(0)
        if token["name"]:
            if token["name"] not in self._names:
                raise QueryError(unknown(token["name"], self._names, "action"))
            return OneOf(frozenset({token["name"]}))
        if token["sign"] == ".":
            return OneOf(None)
        if token["sign"] == "(":
            inside = self._choice()
            if self._sign() != ")":
                raise self._wrong("a parenthesis is not closed")
            self._tokens.pop(0)
            return inside
        raise self._wrong(f"nothing precedes {token[0].strip()!r}")

    def _wrong(self, what: str) -> QueryError:
        return QueryError(
            f"{self._text!r} is not an expression: {what}; write it like 'approach (grasp . drop)* withdraw?'"
        )
