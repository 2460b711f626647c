"""The evaluation of clingo's arithmetic terms with exact integers, which detects intermediate results out of range."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from itertools import islice, product

import clingo
from clingo.ast import AST, ASTType, BinaryOperator, UnaryOperator

from prag_asp.integers import fits

OPERATIONS = (ASTType.BinaryOperation, ASTType.UnaryOperation)

WIDTH, COMBINATIONS = 64, 10_000
"""The width up to which an interval in an operation is evaluated at all values, not only at its ends, and the maximum
number of combinations of values that are evaluated. Both limit the time of a check."""


class OutOfRange(Exception):
    """A number is out of clingo's range."""


class Undefined(Exception):
    """An operation has no value; clingo itself reports this."""


@dataclass(frozen=True)
class Leaf:
    """An operand that is not an operation: the text of a term, whose value is known only during grounding."""

    text: str


@dataclass(frozen=True)
class NumberRange:
    """An interval of numbers."""

    low: Expression
    high: Expression


@dataclass(frozen=True)
class Operation:
    """An operation: its sign, or its name if it is unary, and its arguments."""

    sign: str
    arguments: tuple[Expression, ...]


Expression = int | Leaf | NumberRange | Operation | tuple["Expression", ...]
"""An expression; a tuple is a pool of expressions."""

UNARY = {UnaryOperator.Minus: "negative", UnaryOperator.Negation: "complement", UnaryOperator.Absolute: "absolute"}
BINARY = {
    BinaryOperator.Plus: "+",
    BinaryOperator.Minus: "-",
    BinaryOperator.Multiplication: "*",
    BinaryOperator.Division: "/",
    BinaryOperator.Modulo: "\\",
    BinaryOperator.Power: "**",
    BinaryOperator.And: "&",
    BinaryOperator.Or: "?",
    BinaryOperator.XOr: "^",
}


def read_expression(term: AST) -> Expression:
    """Return a term as an expression."""
    kind = term.ast_type
    if kind == ASTType.SymbolicTerm and term.symbol.type == clingo.SymbolType.Number:
        return int(term.symbol.number)
    if kind == ASTType.UnaryOperation:
        return Operation(UNARY[term.operator_type], (read_expression(term.argument),))
    if kind == ASTType.BinaryOperation:
        return Operation(BINARY[term.operator_type], (read_expression(term.left), read_expression(term.right)))
    if kind == ASTType.Interval:
        return NumberRange(read_expression(term.left), read_expression(term.right))
    if kind == ASTType.Pool:
        return tuple(map(read_expression, term.arguments))
    return Leaf(str(term))


def leaves(expression: Expression) -> Iterator[str]:
    """Yield the texts of the operands of an expression, in order."""
    if isinstance(expression, Leaf):
        yield expression.text
    for part in _parts(expression):
        yield from leaves(part)


def divides(expression: Expression) -> bool:
    """Return whether an expression contains a division, which crashes clingo if it is out of range."""
    own = isinstance(expression, Operation) and expression.sign in ("/", "\\")
    return own or any(map(divides, _parts(expression)))


def check_range(expression: Expression, values: Mapping[str, clingo.Symbol]) -> None:
    """Evaluate an expression for the given values of its leaves.

    Raises:
        OutOfRange: the value or an intermediate result is out of range.
    """
    with suppress(Undefined):
        for _ in islice(_values(expression, values), COMBINATIONS):
            pass


def compute(expression: Expression, values: Mapping[str, clingo.Symbol]) -> int:
    """Return the first value of an expression.

    Raises:
        OutOfRange: the value or an intermediate result is out of range.
        Undefined: the expression has no value.
    """
    return next(_values(expression, values))


def _parts(expression: Expression) -> Sequence[Expression]:
    if isinstance(expression, Operation):
        return expression.arguments
    if isinstance(expression, NumberRange):
        return (expression.low, expression.high)
    return expression if isinstance(expression, tuple) else ()


def _values(expression: Expression, values: Mapping[str, clingo.Symbol]) -> Iterator[int]:
    """Yield the values of an expression; if it contains intervals or pools, it has several."""
    if isinstance(expression, int):
        yield expression
    elif isinstance(expression, Leaf):
        symbol = values.get(expression.text)
        if symbol is None or symbol.type != clingo.SymbolType.Number:
            raise Undefined
        yield _in_range(symbol.number)
    elif isinstance(expression, Operation):
        for arguments in product(
            *(tuple(islice(_values(each, values), COMBINATIONS)) for each in expression.arguments)
        ):
            yield _in_range(COMPUTED[expression.sign](*arguments))
    elif isinstance(expression, NumberRange):
        for low, high in product(tuple(_values(expression.low, values)), tuple(_values(expression.high, values))):
            yield from range(low, high + 1) if high - low < WIDTH else (low, high)
    else:
        for each in expression:
            yield from _values(each, values)


def _in_range(number: int) -> int:
    if not fits(number):
        raise OutOfRange
    return number


def _quotient(dividend: int, divisor: int) -> int:
    if divisor == 0:
        raise Undefined
    quotient = abs(dividend) // abs(divisor)
    return quotient if (dividend < 0) == (divisor < 0) else -quotient


def _power(base: int, exponent: int) -> int:
    if exponent < 0:
        if base == 0:
            raise Undefined
        return 0
    if abs(base) > 1 and exponent > 31:
        raise OutOfRange
    return int(base**exponent) if abs(base) > 1 or exponent == 0 else base ** (2 - exponent % 2)


COMPUTED: Mapping[str, Callable[..., int]] = {
    "negative": lambda a: -a,
    "complement": lambda a: ~a,
    "absolute": abs,
    "+": lambda a, b: a + b,
    "-": lambda a, b: a - b,
    "*": lambda a, b: a * b,
    "/": _quotient,
    "\\": lambda a, b: a - b * _quotient(a, b),
    "**": _power,
    "&": lambda a, b: a & b,
    "?": lambda a, b: a | b,
    "^": lambda a, b: a ^ b,
}
"""clingo's operations: division rounds towards zero, and a power with a negative exponent is 0."""
