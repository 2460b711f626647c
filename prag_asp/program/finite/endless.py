"""Which rules may make ever new terms, so that grounding would never end, and which certainly do.

A program whose arguments have finite ranks is ground in finite time: argument-restricted programs (Lierler and
Lifschitz, One more decidable class of finitely ground programs, ICLP 2009), with operations of arithmetic taken for
functions. Ranks are those of one recursive component, for what is below it is finite, or endless by itself. A component
that has none may be finite all the same: that is left to a count while it is ground.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import inf

import clingo
from clingo.ast import AST, ASTType, BinaryOperator, ComparisonOperator, Sign

from prag_asp.program.finite.arithmetic import OPERATIONS
from prag_asp.program.finite.components import components
from prag_asp.program.syntax import Signature, Statement, below, children_of

Argument = tuple[Signature, int]
"""An argument of a predicate, by its place."""

MADE = (*OPERATIONS, ASTType.Interval, ASTType.Function)
AGGREGATES = (ASTType.BodyAggregate, ASTType.Aggregate)
CHOICES = (ASTType.Aggregate, ASTType.Disjunction, ASTType.HeadAggregate)
UPPER = (ComparisonOperator.LessThan, ComparisonOperator.LessEqual)
LOWER = (ComparisonOperator.GreaterThan, ComparisonOperator.GreaterEqual)


@dataclass(frozen=True)
class Endless:
    """A rule that may make ever new values of `variables`; `certain` where it does as soon as it is used once.

    `element` is the number of the element of its head that does, None where that is the whole head.
    """

    rule: Statement
    variables: tuple[str, ...]
    certain: bool
    element: int | None


@dataclass(frozen=True, eq=False)
class _Derivation:
    """One way in which a rule derives an atom: the atom, and the literals that it follows from."""

    rule: Statement
    head: AST
    literals: tuple[AST, ...]
    element: int | None

    @cached_property
    def signature(self) -> Signature:
        return _signature(self.head)

    @cached_property
    def made(self) -> tuple[tuple[int, str, int], ...]:
        """The variables of each argument of the head, with how deep they stand in it."""
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
    def bound(self) -> tuple[tuple[str, Signature, int, int], ...]:
        """The variables that an argument of an atom binds, with how deep they stand in it."""
        return tuple(
            (name, _signature(atom), place, depth)
            for atom in self.atoms
            for place, argument in enumerate(_arguments(atom))
            for name, depth in _depths(argument, -1)
        )

    @cached_property
    def comparisons(self) -> tuple[tuple[AST, int, AST], ...]:
        """The comparisons of two terms, read from the left and from the right."""
        found = []
        for literal in self.literals:
            atom = literal.atom if literal.ast_type == ASTType.Literal else literal
            if atom.ast_type == ASTType.Comparison and literal.sign == Sign.NoSign:
                terms = [atom.term, *(guard.term for guard in atom.guards)]
                for left, guard, right in zip(terms, atom.guards, terms[1:], strict=False):
                    found += [(left, guard.comparison, right), (right, MIRRORED[guard.comparison], left)]
        return tuple(found)

    @cached_property
    def totals(self) -> tuple[tuple[AST, tuple[Signature, ...]], ...]:
        """What is told to be the value of an aggregate, with the predicates that it is made of."""
        found = []
        for literal in self.literals:
            atom = literal.atom if literal.ast_type == ASTType.Literal else literal
            if atom.ast_type in AGGREGATES:
                guards = (guard for guard in (atom.left_guard, atom.right_guard) if guard is not None)
                read = tuple(_signature(node.symbol) for node in below(atom) if node.ast_type == ASTType.SymbolicAtom)
                found += [(guard.term, read) for guard in guards if guard.comparison == ComparisonOperator.Equal]
        return tuple(found)


MIRRORED = {
    ComparisonOperator.LessThan: ComparisonOperator.GreaterThan,
    ComparisonOperator.GreaterThan: ComparisonOperator.LessThan,
    ComparisonOperator.LessEqual: ComparisonOperator.GreaterEqual,
    ComparisonOperator.GreaterEqual: ComparisonOperator.LessEqual,
    ComparisonOperator.Equal: ComparisonOperator.Equal,
    ComparisonOperator.NotEqual: ComparisonOperator.NotEqual,
}


def endless_rules(statements: Iterable[Statement]) -> list[Endless]:
    """Return the own rules that may make ever new terms."""
    rules = [each for each in statements if each.is_rule and each.body]
    found: list[Endless] = []
    for inside in _recursive(rules):
        derived = [
            each
            for rule in rules
            if any(head.signature in inside for head in rule.heads)
            for each in _derivations(rule)
            if each.signature in inside
        ]
        ranks = _ranks(derived, inside)
        for each in derived:
            grown = _grown(each, ranks) if each.rule.own else ()
            if grown:
                found.append(Endless(each.rule, grown, _is_certain(each), each.element))
    return found


def _recursive(rules: Iterable[Statement]) -> Iterator[set[Signature]]:
    """Yield the predicates of each component that some own rule derives from itself."""
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


def _ranks(derived: Sequence[_Derivation], inside: Collection[Signature]) -> Mapping[Argument, float]:
    """Return the least ranks of the arguments of a component; they are infinite where there are none."""
    ranks: dict[Argument, float] = {(each.signature, place): 0 for each in derived for place, _, _ in each.made}
    most = 1 + sum(_size(each) for each in derived)
    changed = True
    while changed:
        changed = False
        for each in derived:
            known = _variable_ranks(each, lambda argument: ranks.get(argument, 0))
            for place, name, depth in each.made:
                rank = known.get(name, inf) + depth
                rank = inf if rank > most else rank
                if rank > ranks[each.signature, place]:
                    ranks[each.signature, place] = rank
                    changed = True
    return ranks


def _size(each: _Derivation) -> int:
    """Return how many terms a derivation makes, at most."""
    return sum(node.ast_type in MADE for top in (each.head, *each.literals) for node in below(top)) + len(each.totals)


def _variable_ranks(each: _Derivation, rank_of: Callable[[Argument], float]) -> Mapping[str, float]:
    """Return the least ranks that literals give to variables."""
    known: dict[str, float] = {}

    def learn(name: str, rank: float) -> bool:
        better = max(rank, 0) < known.get(name, inf)
        if better:
            known[name] = max(rank, 0)
        return better

    for name, signature, place, depth in each.bound:
        learn(name, rank_of((signature, place)) - depth)
    for term, read in each.totals:
        total = 1 + max((rank_of((signature, place)) for signature in read for place in range(signature[1])), default=0)
        for name, depth in _depths(term, -1):
            learn(name, total - depth)
    changed = True
    while changed:
        changed = False
        for left, comparison, right in each.comparisons:
            if comparison == ComparisonOperator.Equal:
                rank = max((known.get(name, inf) + depth for name, depth in _depths(right, 1)), default=0)
                for name, depth in _depths(left, -1):
                    changed |= learn(name, rank - depth)
    return known


def _grown(each: _Derivation, ranks: Mapping[Argument, float]) -> tuple[str, ...]:
    """Return the variables from which a derivation makes new terms without a rank, unless a comparison bounds them."""
    known = _variable_ranks(each, lambda argument: ranks.get(argument, 0))
    plain = {name for name, _, _, depth in each.bound if depth >= 0}
    found = set()
    for place, name, depth in each.made:
        endless = ranks[each.signature, place] == known.get(name, inf) == inf
        if endless and (depth > 0 or name not in plain) and not _is_bounded(each, place, name):
            found.add(name)
    return tuple(sorted(found))


def _is_bounded(each: _Derivation, place: int, name: str) -> bool:
    """Return whether an argument of the head is a variable plus a number, and a comparison with a number ends that."""
    term = _substituted(each, _arguments(each.head)[place])
    step = _step(term)
    if step is None:
        return False
    variable, number = step
    wanted = UPPER if number > 0 else LOWER
    return any(
        left.ast_type == ASTType.Variable
        and left.name in (variable, name)
        and comparison in wanted
        and right.ast_type == ASTType.SymbolicTerm
        and right.symbol.type == clingo.SymbolType.Number
        for left, comparison, right in each.comparisons
    )


def _substituted(each: _Derivation, term: AST) -> AST:
    """Return what an equation says that a variable is, or the term itself."""
    if term.ast_type == ASTType.Variable:
        for left, comparison, right in each.comparisons:
            if comparison == ComparisonOperator.Equal and left == term and right.ast_type != ASTType.Variable:
                return right
    return term


def _step(term: AST) -> tuple[str, int] | None:
    """Return the variable and the number of a term such as X+1, None of any other."""
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
    """Return whether a derivation, used once, can be used again with what it made, without end.

    So it is where it has nothing but atoms and equations for its head, and one of the atoms is its head but for
    arguments that are made larger, which nothing else reads.
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
    read = [_substituted(each, term) for term in _arguments(each.head)]
    changed: set[str] = set()
    for before, after in zip(_arguments(own[0]), read, strict=True):
        if before != after:
            if before.ast_type != ASTType.Variable or not _is_larger(before.name, after):
                return False
            changed.add(before.name)
    read_of = [name for name, *_ in each.bound]
    return bool(changed) and all(read_of.count(name) == 1 for name in changed)


def _is_larger(name: str, term: AST) -> bool:
    """Return whether a term is a function of a variable, or the variable plus a number."""
    step = _step(term)
    if step:
        return step[0] == name
    inner = [node for node in below(term) if node.ast_type not in (ASTType.Function, ASTType.Variable)]
    inner = [node for node in inner if node.ast_type != ASTType.SymbolicTerm]
    return term.ast_type == ASTType.Function and not inner and any(found == name for found, _ in _depths(term, 1))


def _depths(term: AST, arithmetic: int) -> Iterator[tuple[str, int]]:
    """Yield the variables of a term with how many terms are around each; those of arithmetic count so much."""
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
