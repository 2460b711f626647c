"""The problems that the linter reports: errors, and warnings with a name."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import NamedTuple

from prag_asp.errors import DomainError, one_line
from prag_asp.program.sources import Source
from prag_asp.program.tokens import comments
from prag_asp.wording import plural

WARNINGS: Mapping[str, str] = {
    "asks-more": "an action whose rule requires `ever` for a fluent it does not need: plans may be missing",
    "empty-class": "a class without entities",
    "ignored": "a part of a PDDL file that does not affect plans, or whose meaning differs here",
    "never-holds": "an atom that a rule reads, but that no fact or rule can derive",
    "never-occurs": "an action or a composite that can never occur: it is pruned",
    "no-cavity": "a body from a file without a cavity, although objects are put into it",
    "no-effect": "a statement, a key or a comment that changes nothing",
    "no-grasp": "a body with a model for which no grasp was found",
    "no-plan": "an unreachable goal, or an initial state in which no action is applicable: every count is 0",
    "no-words": "a word that is missing in a language used for instructions",
    "other-encoding": "a shipped encoding that is missing from a copy, or has different rules there",
    "out-of-reach": "a place that actions use, but that no gripper can reach",
    "same-name": "a name that two or more of these share: a class, an entity and an action",
    "sounds-alike": "two actions that their sentences do not distinguish",
    "tips-over": "a body from a file that tips far before it comes to rest",
    "too-heavy": "a body that no gripper can lift, because of its weight or its friction",
    "too-wide": "a body that no gripper can close around",
    "undefined": "a predicate that is read but never defined",
    "undeclared": "a name that a PDDL file uses but does not declare",
    "unused": "a predicate that no rule reads",
}
"""The names of warnings: the domain is suspicious, but well-defined."""

SHOWN = 5
"""The maximum number of warnings with the same name that are shown, because more are rarely informative."""

ALLOW = re.compile(r"\blint:\s*allow\b(?P<names>[^*#%\n]*)")
"""A comment that allows warnings, in a logic program (after %, or in %* *%) or in domain.toml (after #)."""


class Problem(NamedTuple):
    """One line of the report; `text` reads ``what is wrong; what to do``.

    If it has no name, it is an error: the domain has no meaning, or a count could be wrong. With the `name` of one of
    the `WARNINGS`, it is a warning, which the comment ``% lint: allow NAME`` on its line suppresses.
    """

    path: Path
    line: int
    text: str
    name: str = ""

    @property
    def is_warning(self) -> bool:
        """Whether the problem is a warning, that is, the domain is well-defined."""
        return bool(self.name)

    def as_error(self) -> Problem:
        """Return the problem as an error."""
        return Problem(self.path, self.line, f"{self.text} [{self.name}]") if self.name else self

    def __str__(self) -> str:
        place = f"{self.path}:{self.line}"
        return one_line(f"{place}: warning: {self.text} [{self.name}]" if self.name else f"{place}: {self.text}")


def raise_problems(problems: Iterable[Problem]) -> None:
    """Raise all distinct problems as one error, in order.

    Raises:
        DomainError: there is a problem.
    """
    lines = dict.fromkeys(map(str, problems))
    if lines:
        raise DomainError(*lines)


def first_of_each(warnings: Iterable[Problem]) -> Iterator[Problem]:
    """Yield the first `SHOWN` warnings with each name; the last of these states how many others are omitted."""
    warnings = list(warnings)
    total = Counter(each.name for each in warnings)
    texts: Counter[str] = Counter()
    for each in warnings:
        texts[each.name] += 1
        if texts[each.name] < SHOWN or (texts[each.name] == SHOWN and total[each.name] == SHOWN):
            yield each
        elif texts[each.name] == SHOWN:
            more = plural(total[each.name] - SHOWN, "more warning")
            yield each._replace(text=f"{each.text} (and {more} like it)")


def allowed_in_sources(sources: Iterable[Source]) -> dict[tuple[Path, int], tuple[str, ...]]:
    """Return the names of warnings that comments in sources allow, by file and line, including unknown names."""
    allowed: dict[tuple[Path, int], tuple[str, ...]] = {}
    for source in sources:
        if "lint:" in source.text:
            allowed |= {(source.path, line): names for line, names in allowed_by_comments(comments(source.text))}
    return allowed


def allowed_by_comments(spoken: Iterable[tuple[int, str]]) -> Iterator[tuple[int, tuple[str, ...]]]:
    """Yield the line number of each comment that allows warnings, together with the names that it allows."""
    for line, words in spoken:
        match = ALLOW.search(words)
        if match:
            yield line, tuple(re.findall(r"[^\s,]+", match["names"]))
