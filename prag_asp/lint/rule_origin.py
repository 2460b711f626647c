"""The rules from which ground atoms of the base part come, which clingo does not record."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from pathlib import Path
from typing import NamedTuple

import clingo
from clingo.ast import ASTType

from prag_asp.program.syntax import Statement

TRACE = "_stated"
VIOLATED = "_violated"


class RulePlace(NamedTuple):
    """A file and a line in it."""

    path: Path
    line: int


class Origins:
    """The places of the rules that derive the atoms of the base part, which is grounded once more on first use."""

    def __init__(self, statements: Sequence[Statement]) -> None:
        self._statements = statements

    @cached_property
    def _traces(self) -> dict[tuple[str, tuple[clingo.Symbol, ...]], list[Statement]]:
        """The rules that derive each atom: the base part without constraints is ground with a mark of each rule."""
        base = [each for each in self._statements if each.part == "base" and each.kind != ASTType.Program]
        lines = [each.text for each in base if not each.is_rule or each.heads]
        for number, statement in enumerate(base):
            if statement.is_rule and statement.node.head.ast_type == ASTType.Literal:
                body = "; ".join(text for _, text in statement.literals) or "#true"
                stated = [str(atom).lstrip("-") for atom in statement.heads] or [VIOLATED]
                lines += [f"{TRACE}({number},{each}) :- {body}." for each in stated]
        control = clingo.Control(["--warn=none"], logger=lambda *_: None)
        try:
            control.add("base", [], "\n".join(lines))
            control.ground([("base", [])])
        except RuntimeError:
            return {}
        traces: dict[tuple[str, tuple[clingo.Symbol, ...]], list[Statement]] = {}
        marks = (atom.symbol.arguments for atom in control.symbolic_atoms.by_signature(TRACE, 2))
        for number, term in sorted(((mark[0].number, mark[1]) for mark in marks), key=lambda mark: mark[0]):
            traces.setdefault((term.name, tuple(term.arguments)), []).append(base[number])
        return traces

    def place(self, predicate: str, *arguments: clingo.Symbol) -> RulePlace:
        """Return the place of the first rule that derives an atom, or else that derives its predicate."""
        traced = self._traces.get((predicate, arguments))
        if traced:
            return RulePlace(traced[0].path, traced[0].line)
        own = [each for each in self._statements if each.own] or list(self._statements)
        stating = [each for each in own if any(atom.name == predicate for atom in each.heads)]
        return RulePlace(stating[0].path, stating[0].line) if stating else RulePlace(own[0].path, 1)

    def violated(self) -> list[Statement]:
        """Return the author's constraints of the base part that its facts violate."""
        return [each for each in self._traces.get((VIOLATED, ()), ()) if each.own]
