"""The parser of the clauses of conditions, by keyword."""

from __future__ import annotations

import re
from collections.abc import Callable

from prag_asp.atom import STRING, split_terms
from prag_asp.errors import QueryError
from prag_asp.integers import TOLD, shortened, too_large
from prag_asp.space.conditions.clause_kinds import (
    LOOP_FREE,
    NONTRIVIAL,
    SHORTEST,
    Achieves,
    After,
    Begins,
    Clause,
    Ends,
    Has,
    Matches,
    Names,
    Part,
    Range,
    Uses,
)  # fmt: skip
from prag_asp.wording import unknown

NUMBER = re.compile(r"(?:(?P<bound>at\s+least|at\s+most|exactly)\s+)?(?P<number>\d+)\s+(?P<rest>\S.*)$", re.DOTALL)
AFTER = re.compile(r"(?P<steps>\d+)\s*:(?P<formula>.*)$", re.DOTALL)
PART = re.compile(r"(?P<ranges>\d+-\d+(?:,\d+-\d+)*) of (?P<modulus>\d+) by seed (?P<seed>\d+)$")


MOST_CLASSES = 10_000
"""Maximum number of classes of a `part` clause, because the condition has a state for each class."""


def parse_clause(text: str) -> Clause:
    """Return the clause that a text states, such as ``has at least 2 grasp`` or ``ends holding(panda,apple_1)``.

    Raises:
        QueryError: the text is not a clause.
    """
    words = " ".join(text.split())
    keyword, _, rest = words.partition(" ")
    if keyword == "not" and rest.partition(" ")[0] == "matches":
        keyword, rest = "not matches", rest.partition(" ")[2]
    if keyword not in KEYWORDS:
        raise QueryError(f"condition {text!r}: " + unknown(keyword, KEYWORDS, "condition"))
    if bool(rest) == (keyword in WHOLE):
        raise QueryError(f"condition {text!r}: write it like {EXAMPLES[keyword]!r}")
    for _, digits in too_large(STRING.sub(" ", words.partition(" by seed ")[0])):
        raise QueryError(f"condition {text!r}: the number {shortened(digits)} is out of range: {TOLD}")
    return KEYWORDS[keyword](rest)


def _has(rest: str) -> Clause:
    times, pattern = _quantity(rest)
    return Has(_pattern(pattern), times or Range(1))


def _uses(rest: str) -> Clause:
    number, kind = _quantity(rest)
    return Names(kind, some=True) if number is None else Uses(kind, number)


def _after(rest: str) -> Clause:
    match = AFTER.match(rest)
    if match is None:
        raise QueryError(f"condition 'after {rest}': write it like {EXAMPLES['after']!r}")
    return After(int(match["steps"]), match["formula"].strip())


def _part(rest: str) -> Clause:
    match = PART.match(rest)
    if match and int(match["modulus"]) > MOST_CLASSES:
        raise QueryError(f"condition 'part {rest}': there are at most {MOST_CLASSES:,} classes of skeletons; use fewer")
    bounds = [tuple(map(int, interval.split("-"))) for interval in match["ranges"].split(",")] if match else []
    modulus = int(match["modulus"]) if match else 0
    residues = sorted({number for low, high in bounds for number in range(low, min(high, modulus) + 1)})
    if match is None or not residues or residues[-1] >= modulus:
        raise QueryError(f"condition 'part {rest}': write it like {EXAMPLES['part']!r}")
    return Part(tuple(residues), modulus, int(match["seed"]))


def _quantity(text: str) -> tuple[Range | None, str]:
    """Return the quantity before a name, if any, and the name."""
    match = NUMBER.match(text)
    if match is None:
        return None, text
    number, bound = int(match["number"]), (match["bound"] or "exactly").split()[-1]
    bounds = {"least": Range(number), "most": Range(0, number), "exactly": Range(number, number)}
    return bounds[bound], match["rest"]


def _pattern(text: str) -> str:
    return ">".join(part.strip() for part in text.split(">"))


KEYWORDS: dict[str, Callable[[str], Clause]] = {
    "begins": lambda rest: Begins(tuple(split_terms(rest))),
    "has": _has,
    "lacks": lambda rest: Has(_pattern(rest), Range(0, 0)),
    "uses": _uses,
    "avoids": lambda rest: Names(rest, some=False),
    "matches": Matches,
    "not matches": lambda rest: Matches(rest, inverse=True),
    "starts": lambda rest: After(0, rest),
    "after": _after,
    "ends": Ends,
    "achieves": Achieves,
    "part": _part,
    "nontrivial": lambda _: NONTRIVIAL,
    "loop-free": lambda _: LOOP_FREE,
    "shortest": lambda _: SHORTEST,
}
WHOLE = {"nontrivial", "loop-free", "shortest"}
EXAMPLES = {
    "begins": "begins approach, grasp(panda,apple_1)",
    "has": "has at least 2 grasp",
    "lacks": "lacks grasp>drop",
    "uses": "uses apple",
    "avoids": "avoids can_1",
    "matches": "matches approach (grasp . drop)* withdraw?",
    "not matches": "not matches .* grasp drop .*",
    "starts": "starts open(panda), not holding(panda,can_1)",
    "after": "after 2: holding(panda,can_1)",
    "ends": "ends holding(panda,can_1) or not open(panda)",
    "achieves": "achieves holding(panda,can_1)",
    "part": "part 0-79 of 100 by seed 7",
    "nontrivial": "nontrivial",
    "loop-free": "loop-free",
    "shortest": "shortest",
}
