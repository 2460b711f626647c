"""Ground programs in aspif, the intermediate format of gringo and clasp; each line is checked before clingo reads it.

The format is that of Kaminski, Schaub and Wanko, "A Tutorial on Hybrid Answer Set Solving with clingo" (2017),
appendix A.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence

import clingo

from prag_asp.program.parse import DEEPEST, require_memory
from prag_asp.program.problem import Problem
from prag_asp.program.sources import Source

HEADER = re.compile(r"asp \d")
"""The beginning of every aspif file."""

LARGEST = 2**31 - 1
"""The largest number that clingo can read."""

RULE, MINIMIZE, OUTPUT, ASSUME, THEORY, COMMENT = 1, 2, 4, 6, 9, 10
"""The type numbers of rules, minimize statements, show statements, assumptions, theory statements, and comments."""


def is_aspif(source: Source) -> bool:
    """Return whether a source is a ground program."""
    return HEADER.match(source.text) is not None


def aspif_text(source: Source) -> str:
    """Return the text of a checked program for clingo, without its comments and anything after its end.

    Assumptions become constraints, because clingo forgets them after its first search.
    """
    lines = source.text.split("\n")
    statements: list[str] = []
    for line in lines[: lines.index("0") + 1]:
        kind, *fields = line.split(" ")
        if kind == str(ASSUME):
            statements += (f"1 0 0 0 1 {-int(literal)}" for literal in fields[1:])
        elif kind != str(COMMENT):
            statements.append(line)
    return "".join(f"{line}\n" for line in statements)


def aspif_problems(source: Source, *, optimal: bool) -> Iterator[Problem]:
    """Yield the lines that clingo cannot read, one problem per line, and unsupported statements.

    Minimize statements are supported if `optimal` is true.
    """
    lines = source.text.rstrip("\n").split("\n")
    header = lines[0].split(" ")
    if header[:2] != ["asp", "1"] or len(header) < 4 or header[4:] not in ([], ["incremental"]):
        yield Problem(source.path, 1, "this header is not that of aspif; begin the file with `asp 1 0 0`")
        return
    for number, line in enumerate(lines[1:], 2):
        if line == "0":
            rest = next((place for place, text in enumerate(lines[number:], number + 1) if text.strip()), None)
            if rest is not None:
                problem = "a second step follows the 0 that ends the first; ground one step only"
                yield Problem(source.path, rest, problem)
            return
        try:
            _AspifLine(line).check(optimal=optimal)
        except _Malformed as error:
            yield Problem(source.path, number, str(error))
    yield Problem(source.path, len(lines), "the program has no end; add a last line 0")


class _Malformed(Exception):
    """A line is not a supported statement; the message gives the reason and the remedy."""


class _AspifLine:
    """The fields of one line, which are read from left to right."""

    def __init__(self, text: str) -> None:
        self._left = text.encode()
        self._begun = False

    def check(self, *, optimal: bool) -> None:
        """Check that the line is a supported statement.

        Raises:
            _Malformed: the line is not a statement, or the statement is not supported.
        """
        kind = self.number("the kind of a statement")
        if kind == COMMENT:
            return
        if kind == THEORY:
            raise _Malformed("a theory is not supported because clingo alone does not interpret it; leave it out")
        if kind == MINIMIZE and not optimal:
            raise _Malformed(
                "a statement that minimizes is not supported because it optimises; "
                "add --optimal to keep only optimal answer sets, or remove the line"
            )
        if kind not in FIELDS:
            raise _Malformed(f"aspif has no statement of kind {kind}; the kinds are 1 to 10")
        for read in FIELDS[kind]:
            read(self)
        if self._left:
            raise _Malformed(f"{self._left.decode(errors='replace')!r} follows the statement; remove it")

    def number(self, what: str, least: int = 0, most: int = LARGEST) -> int:
        """Read the next number, which is separated from the previous one by a single blank."""
        text, blank, rest = self._left[self._begun :].partition(b" ")
        self._begun, self._left = True, blank + rest
        digits = text.removeprefix(b"-")
        if not digits.isdigit() or len(digits) > len(str(LARGEST)) or not least <= int(text) <= most:
            found = repr(text.decode(errors="replace")) if text else "nothing"
            raise _Malformed(f"expected {what}, and found {found}; correct the line")
        return int(text)

    def atom(self) -> None:
        """Read an atom."""
        self.number("an atom", 1)

    def atoms(self) -> None:
        """Read a counted list of atoms."""
        for _ in range(self.number("the number of atoms")):
            self.atom()

    def literals(self) -> None:
        """Read a counted list of literals."""
        for _ in range(self.number("the number of literals")):
            self._literal()

    def weighted(self, least: int = -LARGEST) -> None:
        """Read a counted list of literals, each with a weight."""
        for _ in range(self.number("the number of literals")):
            self._literal()
            self.number("a weight" if least else "a weight that is not negative", least)

    def body(self) -> None:
        """Read the body of a rule: literals, or a sum with its lower bound."""
        if self.number("the kind of a body, 0 or 1", 0, 1):
            self.number("a lower bound", -LARGEST)
            self.weighted(0)
        else:
            self.literals()

    def term(self) -> None:
        """Read a ground term, preceded by its length in bytes."""
        length = self.number("the length of a term")
        term, self._left = self._left[1 : length + 1], self._left[length + 1 :]
        text = term.decode(errors="replace")
        if len(term) < length or self._left[:1] != b" ":
            raise _Malformed(f"no blank follows the {length} bytes of the term {text!r}; correct its length")
        if text.count("(") > DEEPEST:
            raise _Malformed(f"the term has more than {DEEPEST} parentheses; flatten it")
        try:
            clingo.parse_term(text, logger=lambda *_: None)
        except RuntimeError as error:
            require_memory(error)
            raise _Malformed(f"{text!r} is not a ground term; correct it, or its length") from None

    def _literal(self) -> None:
        if not self.number("a literal", -LARGEST):
            raise _Malformed("0 is not a literal; write an atom, negative if it is negated")


def _field(what: str, least: int = 0, most: int = LARGEST) -> Callable[[_AspifLine], object]:
    return lambda line: line.number(what, least, most)


_PRIORITY, _NODE = _field("a priority", -LARGEST), _field("a node", -LARGEST)

FIELDS: Mapping[int, Sequence[Callable[[_AspifLine], object]]] = {
    RULE: (_field("the kind of a head, 0 or 1", 0, 1), _AspifLine.atoms, _AspifLine.body),
    MINIMIZE: (_PRIORITY, _AspifLine.weighted),
    3: (_AspifLine.atoms,),  # #project
    OUTPUT: (_AspifLine.term, _AspifLine.literals),
    5: (_AspifLine.atom, _field("the value of an external, 0 to 3", 0, 3)),
    ASSUME: (_AspifLine.literals,),
    7: (
        _field("the kind of a heuristic, 0 to 5", 0, 5), _AspifLine.atom, _field("the bias of a heuristic", -LARGEST),
        _field("a priority that is not negative"), _AspifLine.literals,
    ),
    8: (_NODE, _NODE, _AspifLine.literals),  # #edge
}  # fmt: skip
"""The fields of each supported statement, by its type number."""
