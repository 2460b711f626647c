"""The checks of a domain, and what is pruned of it between them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

import clingo

from prag_asp.lint import Checked, check_pruned, check_stated
from prag_asp.lint.allowed_warnings import allowed_names, not_allowed
from prag_asp.program.problem import Problem
from prag_asp.program.settings import Settings
from prag_asp.program.sources import Program, Source
from prag_asp.pruning import find_pruning


def check(program: Program, settings: Source, like: Mapping[clingo.Symbol, clingo.Symbol] | None = None) -> Checked:
    """Return what a domain states without what can never occur, its settings and its warnings.

    `like` maps entities that are not ground to ground ones that are like them: settings may name both.

    Raises:
        DomainError: something is wrong; the message has one line for each problem.
    """
    stated = check_stated(program, settings)
    pruning = find_pruning(stated.step, stated.grounder, stated.facts, stated.user_statements, stated.encodings)
    return check_pruned(stated, pruning, like)


def shown_warnings(warnings: Iterable[Problem], settings: Settings) -> Iterator[Problem]:
    """Yield the warnings that no comment of a domain.toml allows."""
    return not_allowed(warnings, allowed_names((), settings))
