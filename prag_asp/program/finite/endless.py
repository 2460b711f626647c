"""Recursive rules that may derive new terms forever, and rules that certainly do.

A recursive rule derives new terms if a term of its head may be larger than the terms that it reads in the same
component. Without such rules, the terms of a component are bounded by those of the components below it, so grounding
terminates. This is proved for a rule if one application of it derives no larger term. For other rules, `Checks.goes_on`
limits the number and the depth of new terms at run time.

A rule that reads only its own head, with smaller terms, never terminates once it fires; such `certain` rules are
reported without grounding them up to the limit.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import inf

import clingo
from clingo.ast import AST, ASTType, BinaryOperator, ComparisonOperator, Sign

from prag_asp.program.finite.arithmetic import OPERATIONS
from prag_asp.program.finite.checks import MOST_VALUES, WIDEST
from prag_asp.program.finite.components import components
from prag_asp.program.syntax import Signature, Statement, below, children_of

MADE = (*OPERATIONS, ASTType.Interval, ASTType.Function)
SOLVED = (BinaryOperator.Plus, BinaryOperator.Minus)
CHOICES = (ASTType.Aggregate, ASTType.Disjunction, ASTType.HeadAggregate)
UPPER = (ComparisonOperator.LessThan, ComparisonOperator.LessEqual)
LOWER = (ComparisonOperator.GreaterThan, ComparisonOperator.GreaterEqual)


@dataclass(frozen=True)
class EndlessRule:
    """A rule that may build ever larger terms from `variables`; a `certain` rule does so once it fires.

    `element` is the index of the head element that derives these terms, or None if the head has no elements.
    """

    rule: Statement
    variables: tuple[str, ...]
    certain: bool
    element: int | None


@dataclass(frozen=True, eq=False)
class _Derivation:
    """An atom in the head of a rule, with the literals of its body and its condition."""

    rule: Statement
    head: AST
    literals: tuple[AST, ...]
    element: int | None

    @cached_property
    def signature(self) -> Signature:
        return _signature(self.head)

    @cached_property
    def head_variables(self) -> tuple[tuple[int, str, int], ...]:
        """The variables of the head, each with the index of its argument and its depth."""
        return tuple(
            (place, name, depth)
            for place, argument in enumerate(_arguments(self.head))
            for name, depth in _depths(argument, 1)
        )

    @cached_property
    def atoms(self) -> tuple[AST, ...]:
        """The positive atoms among the literals."""
        return tuple(
            literal.atom.symbol
            for literal in self.literals
            if literal.ast_type == ASTType.Literal
            and literal.sign == Sign.NoSign
            and literal.atom.ast_type == ASTType.SymbolicAtom
        )

    @cached_property
    def bound(self) -> tuple[tuple[str, Signature, int], ...]:
        """The variables that positive atoms bind, each with the predicate and its depth in the terms."""
        return tuple(
            (name, _signature(atom), depth)
            for atom in self.atoms
            for argument in _arguments(atom)
            for name, depth in _depths(argument, -1)
            if not _is_hidden(name, argument)
        )

    @cached_property
    def comparisons(self) -> tuple[tuple[AST, int, AST], ...]:
        """The comparisons between two terms, each of them in both directions."""
        comparisons = []
        for literal in self.literals:
            atom = literal.atom if literal.ast_type == ASTType.Literal else literal
            if atom.ast_type == ASTType.Comparison and literal.sign == Sign.NoSign:
                terms = [atom.term, *(guard.term for guard in atom.guards)]
                for left, guard, right in zip(terms, atom.guards, terms[1:], strict=False):
                    comparisons += [(left, guard.comparison, right), (right, MIRRORED[guard.comparison], left)]
        return tuple(comparisons)


MIRRORED = {
    ComparisonOperator.LessThan: ComparisonOperator.GreaterThan,
    ComparisonOperator.GreaterThan: ComparisonOperator.LessThan,
    ComparisonOperator.LessEqual: ComparisonOperator.GreaterEqual,
    ComparisonOperator.GreaterEqual: ComparisonOperator.LessEqual,
    ComparisonOperator.Equal: ComparisonOperator.Equal,
    ComparisonOperator.NotEqual: ComparisonOperator.NotEqual,
}


def endless_rules(statements: Iterable[Statement]) -> list[EndlessRule]:
    """Return the author's rules that may derive new terms forever."""
    rules = [each for each in statements if each.is_rule and (each.literals or ":" in each.text) and each.body]
    endless: list[EndlessRule] = []
    for inside in _recursive(rules):
        derived = [
            each
            for rule in rules
            if any(head.signature in inside for head in rule.heads)
            for each in _derivations(rule)
            if each.signature in inside
        ]
        for each in derived:
            grown = _grown(each, inside) if each.rule.own else ()
            if grown:
                endless.append(EndlessRule(each.rule, grown, _is_certain(each), each.element))
    return endless


def _recursive(rules: Iterable[Statement]) -> Iterator[set[Signature]]:
    """Yield the predicates of each component that contains a recursive rule of the author."""
    reads: dict[Signature, set[Signature]] = {}
    own: set[tuple[Signature, Signature]] = set()
    for rule in rules:
        read = {atom.signature for atom in rule.body if not atom.negated}
        for head in rule.heads:
            reads.setdefault(head.signature, set()).update(read)
            if rule.own:
                own.update((head.signature, signature) for signature in read)
    for component in components(reads, lambda node: (each for each in sorted(reads[node]) if each in reads)):
        inside = set(component)
        if any(head in inside and read in inside for head, read in own):
            yield inside


def _derivations(rule: Statement) -> Iterator[_Derivation]:
    head, body = rule.node.head, tuple(rule.node.body)
    if head.ast_type not in CHOICES:
        if head.ast_type == ASTType.Literal and head.atom.ast_type == ASTType.SymbolicAtom:
            yield _Derivation(rule, head.atom.symbol, body, None)
        return
    for number, element in enumerate(head.elements):
        each = element.condition if head.ast_type == ASTType.HeadAggregate else element
        if each.literal.atom.ast_type == ASTType.SymbolicAtom:
            literals = (*body, *each.condition)
            yield _Derivation(rule, each.literal.atom.symbol, literals, number if each.condition else None)


def _grown(each: _Derivation, inside: Collection[Signature]) -> tuple[str, ...]:
    """Return the variables from which a derivation builds larger terms, unless a comparison bounds them.

    The height of a variable is the depth by which its values may exceed the terms of the component `inside`. A variable
    that is bound by a predicate outside the component has finitely many values; its height is minus infinity.
    """
    heights: dict[str, float] = {}
    for name, signature, depth in each.bound:
        height = -depth if signature in inside else -inf
        heights[name] = min(height, heights.get(name, inf))
    changed = True
    while changed:
        changed = False
        for left, comparison, right in each.comparisons:
            if comparison == ComparisonOperator.Equal and left.ast_type == ASTType.Variable:
                height = max((heights.get(name, inf) + depth for name, depth in _depths(right, 1)), default=-inf)
                if left.name not in heights and height < inf:
                    heights[left.name] = height
                    changed = True
    grown = {
        name
        for place, name, depth in each.head_variables
        if heights.get(name, inf) + depth > 0 and not _is_bounded(each, place, name)
    }
    return tuple(sorted(grown))


def _is_bounded(each: _Derivation, place: int, name: str) -> bool:
    """Return whether an argument of the head is a variable plus a number, and a comparison bounds its value.

    A bound that exceeds the size limit of intervals or, in a step, the limit of `Checks.goes_on` does not count.
    """
    term = _substituted(each, _arguments(each.head)[place])
    step = _step(term)
    if step is None:
        return False
    variable, number = step
    bounding = UPPER if number > 0 else LOWER
    largest = MOST_VALUES if each.rule.timed else WIDEST
    return any(
        left.ast_type == ASTType.Variable
        and left.name in (variable, name)
        and comparison in bounding
        and right.ast_type == ASTType.SymbolicTerm
        and right.symbol.type == clingo.SymbolType.Number
        and abs(right.symbol.number) <= largest
        for left, comparison, right in each.comparisons
    )


def _substituted(each: _Derivation, term: AST) -> AST:
    """Return the term that an equation assigns to a variable, or the term itself."""
    if term.ast_type == ASTType.Variable:
        for left, comparison, right in each.comparisons:
            if comparison == ComparisonOperator.Equal and left == term and right.ast_type != ASTType.Variable:
                return right
    return term


def _step(term: AST) -> tuple[str, int] | None:
    """Return the variable and the number in a term such as ``X+1``, or None for any other term."""
    if term.ast_type != ASTType.BinaryOperation:
        return None
    left, right, sign = term.left, term.right, term.operator_type
    if sign == BinaryOperator.Plus and left.ast_type == ASTType.SymbolicTerm:
        left, right = right, left
    plain = left.ast_type == ASTType.Variable and right.ast_type == ASTType.SymbolicTerm
    if not plain or right.symbol.type != clingo.SymbolType.Number or not right.symbol.number:
        return None
    number = int(right.symbol.number)
    signed = {BinaryOperator.Plus: number, BinaryOperator.Minus: -number}.get(sign)
    return None if signed is None else (left.name, signed)


def _is_certain(each: _Derivation) -> bool:
    """Return whether a derivation that fires once fires again with its own result, forever.

    This is the case if all literals are atoms and equations, and one atom equals the head except for arguments that are
    smaller and that no other atom reads.
    """
    equal = [comparison == ComparisonOperator.Equal for _, comparison, _ in each.comparisons]
    if (
        not all(equal)
        or len(each.atoms) + len(equal) // 2 < len(each.literals)
        or each.rule.node.head.ast_type in CHOICES
    ):
        return False
    own = [atom for atom in each.atoms if _signature(atom) == each.signature]
    if len(own) != 1:
        return False
    results = [_substituted(each, term) for term in _arguments(each.head)]
    changed: set[str] = set()
    for before, after in zip(_arguments(own[0]), results, strict=True):
        if before != after:
            if before.ast_type != ASTType.Variable or not _is_larger(before.name, after):
                return False
            changed.add(before.name)
    variables = [name for atom in each.atoms for argument in _arguments(atom) for name, _ in _depths(argument, -1)]
    return bool(changed) and all(variables.count(name) == 1 for name in changed)


def _is_larger(name: str, term: AST) -> bool:
    """Return whether a term is a function term that contains a variable, or is the variable plus a number."""
    step = _step(term)
    if step:
        return step[0] == name
    inner = [node for node in below(term) if node.ast_type not in (ASTType.Function, ASTType.Variable)]
    inner = [node for node in inner if node.ast_type != ASTType.SymbolicTerm]
    return term.ast_type == ASTType.Function and not inner and any(variable == name for variable, _ in _depths(term, 1))


def _is_hidden(name: str, term: AST) -> bool:
    """Return whether a term may map several values of a variable to the same value, as ``X/7`` does."""
    if term.ast_type == ASTType.BinaryOperation and term.operator_type not in SOLVED:
        return any(variable == name for variable, _ in _depths(term, 1))
    return any(_is_hidden(name, child) for child in children_of(term))


def _depths(term: AST, arithmetic: int) -> Iterator[tuple[str, int]]:
    """Yield the variables of a term with their depths, counting 1 for a function and `arithmetic` for an operation."""
    stack = [(term, 0)]
    while stack:
        node, depth = stack.pop()
        if node.ast_type == ASTType.Variable:
            if node.name != "_":
                yield node.name, depth
            continue
        around = arithmetic if node.ast_type in (*OPERATIONS, ASTType.Interval) else int(node.ast_type in MADE)
        stack += [(child, depth + around) for child in children_of(node)]


def _signature(symbol: AST) -> Signature:
    function, sign = (symbol.argument, "-") if symbol.ast_type == ASTType.UnaryOperation else (symbol, "")
    if function.ast_type != ASTType.Function:  # a pool: p(X;Y)
        function = next(node for node in below(function) if node.ast_type == ASTType.Function)
    return sign + function.name, len(function.arguments)


def _arguments(symbol: AST) -> Sequence[AST]:
    function = symbol.argument if symbol.ast_type == ASTType.UnaryOperation else symbol
    return tuple(function.arguments) if function.ast_type == ASTType.Function else ()
