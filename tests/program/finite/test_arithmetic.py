"""Arithmetic is that of clingo, operation by operation."""

from __future__ import annotations

import clingo
import pytest
from clingo.ast import AST, ASTType, parse_string

from prag_asp.program.finite.arithmetic import OPERATIONS, OutOfRange, Undefined, check_range, compute, read_expression
from prag_asp.program.syntax import below

NUMBERS = (-7, -3, -2, -1, 0, 1, 2, 3, 5, 31)


def expression_of(text: str) -> AST:
    found: list[AST] = []
    parse_string(f"p({text}).", found.append)
    return next(
        node for each in found if each.ast_type == ASTType.Rule for node in below(each) if node.ast_type in OPERATIONS
    )


def value_by_clingo(text: str) -> list[int]:
    control = clingo.Control(["--warn=none"])
    control.add("base", [], f"p({text}).")
    control.ground([("base", [])])
    return [atom.symbol.arguments[0].number for atom in control.symbolic_atoms]


@pytest.mark.parametrize("sign", ["+", "-", "*", "/", "\\", "**", "&", "?", "^"])
def test_an_operation_of_two_numbers_is_that_of_clingo(sign: str) -> None:
    for first in NUMBERS:
        for second in NUMBERS:
            text = f"(0+({first})){sign}({second})"
            try:
                found = [compute(read_expression(expression_of(text)), {})]
            except Undefined:
                found = []
            except OutOfRange:
                assert sign == "**"
                assert abs(first) > 1
                assert second == 31
                continue
            assert found == value_by_clingo(text), text


@pytest.mark.parametrize("sign", ["-{}", "~{}", "|{}|"])
def test_an_operation_of_one_number_is_that_of_clingo(sign: str) -> None:
    for number in NUMBERS:
        text = sign.format(f"(0+({number}))")
        assert [compute(read_expression(expression_of(text)), {})] == value_by_clingo(text)


@pytest.mark.parametrize(("text", "value"), [("X+1", "a"), ("X/0", "1"), ("0**(-1)", "1"), ("1+f(X)", "1")])
def test_what_has_no_value_is_within_the_range_and_no_atom_of_clingo(text: str, value: str) -> None:
    check_range(read_expression(expression_of(text)), {"X": clingo.parse_term(value)})
    assert value_by_clingo(text.replace("X", value)) == []


def test_numbers_within_an_operation_count_as_well() -> None:
    for text in ("(X*X)-(X*X)", "X+1", "0*(X+X)", "(1..X)*2", "(1;X)+1", "X**X"):
        with pytest.raises(OutOfRange):
            check_range(read_expression(expression_of(text)), {"X": clingo.Number(2**31 - 1)})
