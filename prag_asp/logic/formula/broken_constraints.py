"""A program whose constraints derive atoms that report violations by line, instead of forbidding them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import clingo
from clingo.ast import AST, ASTType, parse_string

from prag_asp.program.sources import Program, Source

BROKEN = "__broken"
TIMES = {"base": "0", "step": "{}", "check": "{}+1"}
"""The time of a violation by program part: the start, a step, or the time after the last step."""


@dataclass(frozen=True)
class ReportingProgram:
    """A program without constraints; ``__broken(L,T)`` says that the constraint of line L is broken at time T.

    `rules` has the file, the line and the text of each L.
    """

    program: Program
    rules: Mapping[int, tuple[Path, int, str]]


def report_violations(program: Program) -> ReportingProgram:
    """Return a program with its constraints turned into rules that derive an atom; no line moves."""
    lines = program.text.splitlines()
    statements: dict[int, list[str]] = {}
    rules: dict[int, tuple[Path, int, str]] = {}
    part, time = "base", "0"

    def collect(statement: AST) -> None:
        nonlocal part, time
        begin, end = statement.location.begin.line, statement.location.end.line
        if statement.ast_type == ASTType.Program:
            part = statement.name
            time = statement.parameters[0].name if statement.parameters else "0"
        text = str(statement)
        if _is_constraint(statement) and part in TIMES:
            rules[begin] = (*program.locate(begin), " ".join(line.strip() for line in lines[begin - 1 : end]))
            body = "; ".join(map(str, statement.body))
            text = f"{BROKEN}({begin},{TIMES[part].format(time)}) :- {body or '#true'}."
        statements.setdefault(begin, []).append(text)

    parse_string(program.text, collect)
    return ReportingProgram(Program(tuple(_rewritten(program, statements))), rules)


def _rewritten(program: Program, statements: Mapping[int, Sequence[str]]) -> Iterator[Source]:
    """Yield the sources of a program with the statements of some lines replaced; each begins after an added line."""
    line = 1
    for source in program.sources:
        height = source.text.count("\n") + 1
        texts = (" ".join(statements.get(number, ())) for number in range(line + 1, line + 1 + height))
        yield Source(source.path, "\n".join(texts))
        line += height + 1


def broken_atoms(symbols: Mapping[clingo.Symbol, int]) -> dict[int, dict[int, int]]:
    """Return the literals of the atoms of violations, by time and then by line."""
    by_time: dict[int, dict[int, int]] = {}
    for symbol, literal in symbols.items():
        if symbol.match(BROKEN, 2):
            line, time = (argument.number for argument in symbol.arguments)
            by_time.setdefault(time, {})[line] = literal
    return by_time


def _is_constraint(statement: AST) -> bool:
    if statement.ast_type != ASTType.Rule or statement.head.ast_type != ASTType.Literal:
        return False
    atom = statement.head.atom
    return bool(atom.ast_type == ASTType.BooleanConstant and not atom.value and not statement.head.sign)
