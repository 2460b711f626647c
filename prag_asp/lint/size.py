"""Facts that are more than any machine holds, told before they are made."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from math import prod

from clingo.ast import ASTType

from prag_asp.program.problem import Problem
from prag_asp.program.syntax import STRING, Statement

MOST = 10**8
"""Atoms that one fact may stand for; each takes a hundred bytes or more."""

INTERVAL = re.compile(r"\((-?\d+|_*[a-z]\w*)\.\.(-?\d+|_*[a-z]\w*)\)")
"""An interval between two numbers or constants, as clingo writes it."""


def size_problems(statements: Sequence[Statement]) -> Iterator[Problem]:
    """Yield the own facts whose intervals stand for too many atoms; what a rule makes depends on its body."""
    constants = {each.node.name: str(each.node.value) for each in statements if each.kind == ASTType.Definition}
    for statement in statements:
        if statement.own and statement.is_rule and not statement.node.body:
            atoms = prod(_sizes(STRING.sub("", str(statement.node.head)), constants))
            if atoms > MOST:
                yield statement.problem(
                    f"this fact stands for {atoms:,} atoms, and no more than {MOST:,} can be made; choose smaller ones"
                )


def _sizes(head: str, constants: Mapping[str, str]) -> Iterator[int]:
    for ends in INTERVAL.finditer(head):
        low, high = (constants.get(end, end) for end in ends.groups())
        if re.fullmatch(r"-?\d+", low) and re.fullmatch(r"-?\d+", high):
            yield max(int(high) - int(low) + 1, 0)
