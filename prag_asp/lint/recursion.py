"""Rules of a step that make ever larger terms, so that grounding it would never end.

Those of the base part are found while it is ground.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from prag_asp.program.finite.checks import ever_larger
from prag_asp.program.finite.endless import endless_rules
from prag_asp.program.problem import Problem
from prag_asp.program.syntax import Statement


def recursion_problems(statements: Sequence[Statement]) -> Iterator[Problem]:
    """Yield the own rules of a step that certainly make ever larger terms of the same step, once they are used.

    Where nothing else derives what they start from, they are never used.
    """
    endless = [each for each in endless_rules(statements) if each.certain and each.rule.timed]
    rules = {each.rule for each in endless}
    begun = {head.signature for each in statements if each.is_rule and each not in rules for head in each.heads}
    for each in endless:
        head = each.rule.heads[0]
        if head.signature in begun:
            yield each.rule.problem(ever_larger(head.name))
