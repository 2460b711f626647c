"""Comments that suppress warnings: ``% lint: allow unused, empty-class`` on the line of the warning."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path

from prag_asp.program.problem import WARNINGS, Problem, allowed_by_comments, allowed_in_sources
from prag_asp.program.settings import Settings
from prag_asp.program.sources import Source
from prag_asp.wording import did_you_mean

TOML_COMMENT = re.compile(r"#(?P<words>[^#]*\blint:.*)$")

Allowed = Mapping[tuple[Path, int], tuple[str, ...]]
"""The names that are allowed on each line, including unknown names."""


def allowed_names(sources: Iterable[Source], settings: Settings) -> Allowed:
    """Return the names of warnings that comments in the sources and in domain.toml allow."""
    lines = enumerate(settings.text.split("\n"), 1)
    spoken = ((line, match["words"]) for line, text in lines if (match := TOML_COMMENT.search(text)))
    return allowed_in_sources(sources) | {(settings.path, line): names for line, names in allowed_by_comments(spoken)}


def not_allowed(problems: Iterable[Problem], allowed: Allowed) -> Iterator[Problem]:
    """Yield the problems that no comment on their line suppresses; errors cannot be suppressed."""
    for each in problems:
        if not each.is_warning or each.name not in allowed.get((each.path, each.line), ()):
            yield each


def allowance_problems(allowed: Allowed) -> Iterator[Problem]:
    """Yield comments with unknown names or without names."""
    for (path, line), names in allowed.items():
        for name in names:
            if name not in WARNINGS:
                hint = did_you_mean(name, WARNINGS, f"warnings are {', '.join(WARNINGS)}")
                yield Problem(path, line, f"unknown warning {name}; {hint}", "no-effect")
        if not names:
            text = f"this comment allows nothing; name a warning, such as {min(WARNINGS)}"
            yield Problem(path, line, text, "no-effect")
