"""The insertion of checks into the rules of a domain: of the range of numbers, and of the number of new terms.

clingo computes with 32 bits and overflows silently. Therefore rules call functions of `Checks` during grounding; line
numbers do not change. An operation is checked in place: ``X+1`` becomes ``(X+1)+@in_range(7,X)``, which adds 0 or has
no value. If clingo solves an operation for a variable, as in a body atom, the check follows the literal.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import chain
from math import prod

from clingo.ast import AST, AggregateFunction, ASTType, ComparisonOperator, Sign, UnaryOperator

from prag_asp.errors import DomainError
from prag_asp.program.finite.arithmetic import OPERATIONS, divides, leaves, read_expression
from prag_asp.program.finite.checks import WIDEST, BoundReached, Site, too_wide
from prag_asp.program.finite.constants_in_range import require_constants_in_range
from prag_asp.program.finite.endless import EndlessRule, endless_rules
from prag_asp.program.parse import number_problem, parse_sources
from prag_asp.program.sources import ADDED, Program, Source, owned
from prag_asp.program.syntax import Statement, below, children_of, runs_no_code, variables

OPERATION = re.compile(r"[-+*/\\&?^~|]|\.\.")
"""A pattern that matches all rules with arithmetic, as clingo prints them, and some rules without arithmetic."""

SUMS = (AggregateFunction.Sum, AggregateFunction.SumPlus)
COLLECTIONS = (ASTType.Pool, ASTType.Aggregate, ASTType.BodyAggregate, ASTType.HeadAggregate)
"""Nodes in which intervals are alternatives, which do not multiply the instances of a rule."""

MOST_COMBINATIONS = 100_000_000
"""The maximum number of combinations of a rule's constant intervals; clingo needs half a minute for that many."""

SMALL = 1_000
"""The largest constant weight for which sums are not checked; an overflow would take two million elements."""


@dataclass(frozen=True)
class Guarded:
    """The text of a program with its checks, and the sites of these checks.

    `endless_steps` is true if rules of steps may derive new terms forever.
    """

    text: str
    sites: tuple[Site, ...]
    endless_steps: bool


@lru_cache(maxsize=16)
def guard_program(program: Program) -> Guarded:
    """Insert the checks into a program.

    Raises:
        BoundReached: a number is out of range, or an interval is too wide.
        DomainError: a statement calls an external function.
    """
    for source in program.sources:
        problem = number_problem(source)
        if problem:
            raise BoundReached(problem)
    statements = {source: parse_sources([(source, own)])[0] for source, own in owned(program) if source.path != ADDED}
    for statement in chain.from_iterable(statements.values()):
        for name in statement.scripts if statement.own else ():  # the functions of the checks are internal
            raise DomainError(str(statement.problem(runs_no_code(name))))
    require_constants_in_range(chain.from_iterable(statements.values()))
    endless: dict[Statement, list[EndlessRule]] = {}
    for each in endless_rules(chain.from_iterable(statements.values())):
        endless.setdefault(each.rule, []).append(each)
    sites: list[Site] = []
    sources = []
    for source in program.sources:
        writer = _CheckWriter(sites)
        for statement in statements.get(source, ()):
            if statement.own and statement.is_rule:
                writer.guard(statement, endless.get(statement, ()))
            elif statement.own and statement.kind == ASTType.Minimize:
                writer.guard_cost(statement)
        sources.append(Source(source.path, writer.written(source.text)))
    endless_steps = any(statement.timed for statement in endless)
    return Guarded(Program(tuple(sources)).text, tuple(sites), endless_steps)


class _CheckWriter:
    """The checks to insert into the text of one source; checks at the same position keep their order of insertion."""

    def __init__(self, sites: list[Site]) -> None:
        self._sites = sites
        self._added: list[tuple[int, int, int, str]] = []
        self._rule: Statement

    def written(self, text: str) -> str:
        """Return the source text with the checks inserted; clingo counts columns in bytes."""
        if not self._added:
            return text
        lines = text.encode().split(b"\n")
        for line, column, _, added in sorted(self._added, reverse=True):
            old = lines[line - 1]
            lines[line - 1] = old[: column - 1] + added.encode() + old[column - 1 :]
        return b"\n".join(lines).decode()

    def guard(self, rule: Statement, endless: Sequence[EndlessRule]) -> None:
        """Add checks to a rule."""
        self._rule = rule
        text = rule.text
        self._require_few_combinations(rule)
        if OPERATION.search(text.replace(":-", "").replace(self._before, "")) or "#sum" in text:
            bound = self._scope(rule.node.body, frozenset())
            head = rule.node.head
            if head.ast_type == ASTType.Literal:
                self._literal(head, bound, binding=False)
            elif head.ast_type == ASTType.Disjunction:
                for element in head.elements:
                    self._literal(element.literal, self._scope(element.condition, bound), binding=False)
            elif head.ast_type in (ASTType.Aggregate, ASTType.HeadAggregate):
                self._aggregate(head, bound)
        for each in endless:
            self._count(each)

    def _require_few_combinations(self, rule: Statement) -> None:
        """Check that the constant intervals of a rule, if they multiply its instances, have few combinations.

        Raises:
            BoundReached: the intervals have too many combinations.
        """
        if rule.text.count("..") < 2:
            return
        parts = (rule.node.head, *rule.node.body)
        if any(part.ast_type != ASTType.Literal for part in parts):
            return
        nodes = [node for part in parts for node in below(part)]
        if any(node.ast_type in COLLECTIONS for node in nodes):
            return
        ends = [[read_expression(n.left), read_expression(n.right)] for n in nodes if n.ast_type == ASTType.Interval]
        widths = (high - low + 1 for low, high in ends if isinstance(low, int) and isinstance(high, int))
        combinations = prod(width for width in widths if width > 0)
        if combinations > MOST_COMBINATIONS:
            what = f"the intervals of this rule have {combinations:,} combinations, more than {MOST_COMBINATIONS:,}"
            raise Site(rule.path, rule.line, "").error(f"{what}; make them smaller")

    def guard_cost(self, statement: Statement) -> None:
        """Add checks to a weak constraint, or to an element of ``#minimize`` or ``#maximize``."""
        self._rule = statement
        node = statement.node
        self._scope(node.body, frozenset())
        self._terms([node.weight, node.priority, *node.terms], None)

    @property
    def _before(self) -> str:
        """The text of the previous step in the rule, such as ``(t-1)``, which is always in range."""
        return f"({self._rule.parameters[0]}-1)" if self._rule.timed and self._rule.parameters else ":-"

    def _count(self, endless: EndlessRule) -> None:
        """Add the check that counts the terms derived by an endless rule."""
        rule = endless.rule
        time = rule.parameters[0] if rule.timed and rule.parameters else "0"
        names = "/".join(dict.fromkeys(head.name for head in rule.heads))
        check = self._call(
            "goes_on", Site(rule.path, rule.line, names, certain=endless.certain), time, *endless.variables
        )
        if endless.element is None:
            end = rule.node.location.end
            self._add((end.line, end.column - 1), f";0={check}")
        else:
            element = rule.node.head.elements[endless.element]
            if rule.node.head.ast_type == ASTType.HeadAggregate:
                element = element.condition
            self._add(_end(element.condition[-1]), f",0={check}")

    def _scope(self, literals: Iterable[AST], bound: frozenset[str]) -> frozenset[str]:
        """Add checks to a conjunction of literals, and return the variables that the literals bind."""
        literals = tuple(literals)
        bound = _bound(literals, bound)
        for literal in literals:
            if literal.ast_type == ASTType.ConditionalLiteral:
                inner = self._scope(literal.condition, bound)
                self._literal(literal.literal, inner, binding=False)
            else:
                self._literal(literal, bound, binding=literal.sign == Sign.NoSign)
        return bound

    def _literal(self, literal: AST, bound: frozenset[str], *, binding: bool) -> None:
        """Add checks to a literal; they follow the literal if it binds a variable through an operation."""
        atom = literal.atom
        if atom.ast_type == ASTType.SymbolicAtom:
            self._terms([atom.symbol], literal if binding else None)
        elif atom.ast_type == ASTType.Comparison:
            terms = [atom.term, *(guard.term for guard in atom.guards)]
            free = any(not variables(str(term)) <= bound for term in terms)
            self._terms(terms, literal if binding and free else None)
        elif atom.ast_type in (ASTType.BodyAggregate, ASTType.Aggregate):
            self._aggregate(atom, bound)

    def _aggregate(self, aggregate: AST, bound: frozenset[str]) -> None:
        guards = [each.term for each in (aggregate.left_guard, aggregate.right_guard) if each is not None]
        self._terms([term for term in guards if variables(str(term)) <= bound], None)
        for element in aggregate.elements:
            if aggregate.ast_type == ASTType.Aggregate:
                self._literal(element.literal, self._scope(element.condition, bound), binding=False)
                continue
            condition = element.condition
            literals = condition.condition if aggregate.ast_type == ASTType.HeadAggregate else condition
            inner = self._scope(literals, bound)
            if aggregate.ast_type == ASTType.HeadAggregate:
                self._literal(condition.literal, inner, binding=False)
            self._tuple(aggregate, element, bound)

    def _tuple(self, aggregate: AST, element: AST, bound: frozenset[str]) -> None:
        """Add checks to the tuple of an element, and to the sum of which its weight is a part."""
        terms = list(element.terms)
        weight = read_expression(terms[0]) if terms else 0
        if aggregate.function not in SUMS or (isinstance(weight, int) and abs(weight) <= SMALL):
            self._terms(terms, None)
            return
        groups = sorted(variables(str(element)) & bound)
        site = Site(self._rule.path, terms[0].location.begin.line, f"the sum of {terms[0]}")
        time = self._rule.parameters if self._rule.timed else ()
        whole, group = ",".join([*map(str, terms), ""]), ",".join([*groups, *time, "0", ""])
        self._add(_begin(terms[0]), "(")
        self._terms(terms[:1], None)
        self._add(_end(terms[0]), f")+{self._call('summed', site, f'({group})', f'({whole})')}")
        self._terms(terms[1:], None)

    def _terms(self, terms: Iterable[AST], after: AST | None) -> None:
        """Add checks to the operations and intervals in terms, in place or after a literal."""
        for term in terms:
            kind = term.ast_type
            if kind in OPERATIONS and not _is_signed(term):
                self._operation(term, after)
            elif kind == ASTType.Interval:
                self._interval(term)
            elif kind not in (ASTType.SymbolicTerm, ASTType.Variable):
                self._terms(children_of(term), after)

    def _operation(self, term: AST, after: AST | None) -> None:
        expression, text = read_expression(term), str(term)
        inputs = tuple(dict.fromkeys(leaves(expression)))
        if text == self._before or "_" in inputs:
            return
        site = Site(self._rule.path, term.location.begin.line, _bare(text), expression, inputs)
        if after is not None and not divides(expression):
            self._intervals(term)
            self._add(_end(after), f",0={self._call('must_fit', site, *inputs)}")
            return
        self._add(_begin(term), "(")
        self._intervals(term)
        self._add(_end(term), f")+{self._call('in_range', site, *inputs)}")

    def _intervals(self, term: AST) -> None:
        """Add checks to the intervals within an operation."""
        for child in children_of(term):
            if child.ast_type == ASTType.Interval:
                self._interval(child)
            else:
                self._intervals(child)

    def _interval(self, term: AST) -> None:
        low, high = term.left, term.right
        site = Site(self._rule.path, term.location.begin.line, _bare(str(term)))
        ends = [read_expression(low), read_expression(high)]
        if isinstance(ends[0], int) and isinstance(ends[1], int):
            if ends[1] - ends[0] >= WIDEST:
                raise site.error(too_wide(site.text, ends[0], ends[1]))
            return
        self._terms([low], None)
        name = self._call("up_to", site, str(low))
        self._add(_begin(high), f"{name[:-1]},")
        self._terms([high], None)
        self._add(_end(high), ")")

    def _call(self, function: str, site: Site, *inputs: str) -> str:
        self._sites.append(site)
        return f"@{function}({','.join([str(len(self._sites) - 1), *inputs])})"

    def _add(self, place: tuple[int, int], text: str) -> None:
        self._added.append((*place, len(self._added), text))


def _begin(node: AST) -> tuple[int, int]:
    return node.location.begin.line, node.location.begin.column


def _end(node: AST) -> tuple[int, int]:
    return node.location.end.line, node.location.end.column


def _bound(literals: Sequence[AST], outer: frozenset[str]) -> frozenset[str]:
    """Return the variables that literals bind without solving an operation."""
    bound = set(outer)
    equations: list[tuple[str, set[str]]] = []
    for literal in literals:
        if literal.ast_type != ASTType.Literal or literal.sign != Sign.NoSign:
            continue
        atom = literal.atom
        if atom.ast_type == ASTType.SymbolicAtom:
            bound |= _plain_variables(atom.symbol)
        elif atom.ast_type == ASTType.Comparison and atom.guards[0].comparison == ComparisonOperator.Equal:
            for term, other in ((atom.term, atom.guards[0].term), (atom.guards[0].term, atom.term)):
                equations += [(name, variables(str(other))) for name in _plain_variables(term)]
        elif atom.ast_type in (ASTType.BodyAggregate, ASTType.Aggregate):
            for guard in (atom.left_guard, atom.right_guard):
                if guard is not None and guard.comparison == ComparisonOperator.Equal:
                    bound |= _plain_variables(guard.term)
    while True:
        new = {name for name, needed in equations if name not in bound and needed <= bound}
        if not new:
            return frozenset(bound)
        bound |= new


def _plain_variables(term: AST) -> set[str]:
    """Return the variables of a term that occur outside of operations."""
    if term.ast_type == ASTType.Variable:
        return {term.name}
    if (term.ast_type in OPERATIONS and not _is_signed(term)) or term.ast_type == ASTType.Interval:
        return set()
    return {name for child in children_of(term) for name in _plain_variables(child)}


def _is_signed(term: AST) -> bool:
    """Return whether a term is the negation or the absolute value of another, and so in range if the other is."""
    return term.ast_type == ASTType.UnaryOperation and term.operator_type != UnaryOperator.Negation


def _bare(text: str) -> str:
    """Return the text of an operation without the parentheses around it."""
    return text[1:-1] if text.startswith("(") else text
