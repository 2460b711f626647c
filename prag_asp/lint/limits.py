"""What ``at_most(N, K)`` speaks of, checked against what is declared."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import clingo

from prag_asp.lint.origin import Origins
from prag_asp.program.facts import Facts, rows
from prag_asp.program.problem import Problem, suggestion
from prag_asp.program.syntax import Statement

LIMIT = ("at_most", 2)


def limit_problems(
    control: clingo.Control, facts: Facts, statements: Sequence[Statement], origins: Origins
) -> Iterator[Problem]:
    """Yield the limits of unknown actions, those that are no number, and those that no rule reads."""
    names = {action.name for action in facts.actions}
    limits = rows(control, *LIMIT)
    for name, most in limits:
        place = origins.place("at_most", name, most)
        if str(name) not in names:
            spelled = name.name if name.type == clingo.SymbolType.Function else str(name)
            hint = f"actions are {', '.join(sorted(names))}"
            hint = f"give the name alone, {spelled}" if spelled in names else suggestion(spelled, names, hint)
            yield Problem(*place, f"at_most speaks of {name}, which is not the name of an action; {hint}")
        elif most.type != clingo.SymbolType.Number or most.number < 0:
            yield Problem(*place, f"{name} cannot occur at most {most} times; write a number, as in at_most({name},2)")
    if limits and not any(atom.signature == LIMIT for each in statements for atom in each.body):
        yield Problem(
            *origins.place("at_most", *limits[0]),
            'at_most has no effect, for no rule reads it; add #include "rules/at_most.lp".',
        )
