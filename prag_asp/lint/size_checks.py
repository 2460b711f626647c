"""Find facts that are too large for any machine, and rules of a step whose grounding does not terminate.

Rules of the base part that derive ever larger terms are found while it is grounded.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from math import prod

from clingo.ast import ASTType

from prag_asp.atom import STRING
from prag_asp.program.finite.checks import ever_larger
from prag_asp.program.finite.endless import endless_rules
from prag_asp.program.problem import Problem
from prag_asp.program.syntax import Statement

MOST = 10**8
"""The maximum number of atoms of one fact. Each takes at least 100 bytes, so these take 10 GB."""

INTERVAL = re.compile(r"\((-?\d+|_*[a-z]\w*)\.\.(-?\d+|_*[a-z]\w*)\)")
"""An interval between two numbers or constants, as clingo prints it."""


def size_problems(statements: Sequence[Statement]) -> Iterator[Problem]:
    """Yield the author's facts whose intervals expand to too many atoms."""
    constants = {each.node.name: str(each.node.value) for each in statements if each.kind == ASTType.Definition}
    for statement in statements:
        if statement.own and statement.is_rule and not statement.node.body:
            atoms = prod(_sizes(STRING.sub("", str(statement.node.head)), constants))
            if atoms > MOST:
                yield statement.problem(
                    f"this fact stands for {atoms:,} atoms, more than the limit of {MOST:,}; make its intervals smaller"
                )


def _sizes(head: str, constants: Mapping[str, str]) -> Iterator[int]:
    for ends in INTERVAL.finditer(head):
        low, high = (constants.get(end, end) for end in ends.groups())
        if re.fullmatch(r"-?\d+", low) and re.fullmatch(r"-?\d+", high):
            yield max(int(high) - int(low) + 1, 0)


def recursion_problems(statements: Sequence[Statement]) -> Iterator[Problem]:
    """Yield the author's rules of a step that certainly derive ever larger terms at the same step.

    A rule that never fires, because no other rule derives its head, is not reported.
    """
    endless = [each for each in endless_rules(statements) if each.certain and each.rule.timed]
    rules = {each.rule for each in endless}
    begun = {head.signature for each in statements if each.is_rule and each not in rules for head in each.heads}
    for each in endless:
        head = each.rule.heads[0]
        if head.signature in begun:
            yield each.rule.problem(ever_larger(head.name))
