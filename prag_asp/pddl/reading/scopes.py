"""The names in scope in a PDDL file: variables, and declared objects, types, predicates and functions."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from pathlib import Path
from typing import NoReturn

from prag_asp.errors import DomainError
from prag_asp.pddl.clingo_names import variable_name
from prag_asp.pddl.definitions import OBJECT, Declaration
from prag_asp.pddl.formulas import (
    Arithmetic,
    Comparison,
    Equality,
    Formula,
    FunctionTerm,
    Junction,
    Literal,
    Quantified,
    Quantity,
    Variable,
)
from prag_asp.pddl.syntax.expressions import Expression, Word
from prag_asp.pddl.syntax.sections import UNSUPPORTED, unexpected, unsupported
from prag_asp.program.problem import Problem
from prag_asp.wording import did_you_mean, nearest, plural

NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)")
LIKE_NUMBER = re.compile(r"[-+]?[\d.]+")
ATTACHED = re.compile(r"-([^\W\d][^?:]*)?")
"""The sign before a type, which some files write without the blank after it."""

NEGATIONS = {"<": ">=", ">=": "<", ">": "<=", "<=": ">"}
COMPARISONS = (*NEGATIONS, "=")
OPERATORS = ("+", "-", "*", "/")


@dataclass
class PddlSource:
    """A file whose mistakes are refused with its path and line; `warnings` are about what is read all the same."""

    path: Path
    warnings: list[Problem] = field(default_factory=list)

    def refuse(self, line: int, text: str) -> NoReturn:
        """Raise a DomainError at a line."""
        raise DomainError(f"{self.path}:{line}: {text}")

    def warn(self, line: int, text: str, name: str) -> None:
        """Add a warning."""
        self.warnings.append(Problem(self.path, line, text, name))

    def check_known(self, kind: str, name: Word, declared: Iterable[str], section: str) -> None:
        """Refuse a name that is not declared."""
        if name not in declared:
            hint = did_you_mean(name, declared, f"declare it in {section}")
            self.refuse(name.line, f"unknown {kind} {name}; {hint}")

    def check_new(self, kind: str, name: Word, declared: Iterable[str]) -> None:
        """Refuse a second declaration of a name."""
        if name in declared:
            self.refuse(name.line, f"the {kind} {name} is declared twice; remove one, or rename it")

    def signature(self, kind: str, name: Word, arity: int, declared: Mapping[str, Declaration]) -> Declaration:
        """Return the declaration of a predicate or a function that is used with `arity` arguments."""
        self.check_known(kind, name, declared, f":{kind}s")
        expected = len(declared[name].types)
        if expected != arity:
            self.refuse(name.line, f"{name} takes {plural(expected, 'argument')}, not {arity}; fix them")
        return declared[name]

    def list_of(self, parts: Iterable[Expression | Word], line: int) -> Expression:
        """Return the next part, which has to be a list."""
        part = next(iter(parts), None)
        if isinstance(part, Expression):
            return part
        self.refuse(part.line if part else line, unexpected(part) if part else "something is missing here; write it")

    def name_of(self, part: Expression | Word) -> Word:
        """Return a part that has to be a name."""
        if isinstance(part, Expression):
            self.refuse(part.line, unexpected(part.head or "("))
        if part[0] in ":?" or part == "-":
            self.refuse(part.line, unexpected(part))
        return part

    def number(self, text: Word) -> Fraction:
        """Return a number."""
        if not NUMBER.fullmatch(text):
            self.refuse(text.line, f"{text} is no number; write one such as 2 or 0.5")
        return Fraction(text)

    def typed_words(
        self, parts: Iterable[Expression | Word], types: dict[str, tuple[str, ...]] | None, *, variables: bool = False
    ) -> Iterator[tuple[Word, tuple[str, ...]]]:
        """Yield the words of a typed list, each with its alternative types; there are none without a type.

        An unknown type is added to `types` with a warning, unless it is a misspelling of one; None if all are welcome.
        """
        waiting: list[Word] = []
        each_part = iter(parts)
        for part in each_part:
            if isinstance(part, Word) and ATTACHED.fullmatch(part):
                kind = Word(part[1:], part.line) if len(part) > 1 else next(each_part, None)
                kinds = self._kinds(kind, part.line)
                for each in kinds if types is not None else ():
                    self._check_type(each, types)
                yield from ((name, tuple(dict.fromkeys(map(str, kinds)))) for name in waiting)
                waiting = []
            elif variables and isinstance(part, Word) and part[0] == "?" and len(part) > 1:
                waiting.append(Word(part[1:], part.line))
            elif variables:
                line, text = (part.line, str(part)) if isinstance(part, Word) else (part.line, "(")
                self.refuse(line, f"{text!r} is not expected here; write a variable such as ?x")
            else:
                waiting.append(self.name_of(part))
        yield from ((name, ()) for name in waiting)

    def _kinds(self, kind: Expression | Word | None, line: int) -> list[Word]:
        if kind is None:
            self.refuse(line, "a type is missing after '-'; write it")
        if isinstance(kind, Word):
            return [self.name_of(kind)]
        if kind.head != "either" or not kind.rest:
            self.refuse(kind.line, f"{str(kind.head) or '('!r} is not expected here; write a type, or (either a b)")
        return [self.name_of(each) for each in kind.rest]

    def _check_type(self, kind: Word, types: dict[str, tuple[str, ...]] | None) -> None:
        if types is not None and kind not in types:
            if nearest(kind, set(types) - {OBJECT}):
                self.check_known("type", kind, types, ":types")
            self.warn(kind.line, f"the type {kind} is not declared; declare it in :types", "undeclared")
            types[str(kind)] = ()


@dataclass(frozen=True)
class Declared:
    """The declarations of a domain and its problem. `types` are the direct supertypes of each type.

    If predicates are `undeclared`, the domain has no list of them, and each is added where it is used first.
    """

    types: dict[str, tuple[str, ...]]
    objects: Mapping[str, str]
    predicates: dict[str, Declaration]
    functions: Mapping[str, Declaration]
    undeclared: bool = False


class Scope:
    """The names in scope at a place of a file."""

    def __init__(self, source: PddlSource, declared: Declared) -> None:
        self._source = source
        self._declared = declared
        self._variables: dict[str, Variable] = {}
        self._taken: set[str] = set()

    def within(self) -> Scope:
        """Return a nested scope. The clingo names of variables are unique in both."""
        inner = Scope(self._source, self._declared)
        inner._variables, inner._taken = dict(self._variables), self._taken
        return inner

    def narrowed(self, variables: Iterable[Variable]) -> Scope:
        """Return a scope in which the variables of these names have new types."""
        inner = self.within()
        new = {variable.name: variable for variable in variables}
        inner._variables = {name: new.get(each.name, each) for name, each in self._variables.items()}
        return inner

    def declare(self, parts: Iterable[Expression | Word], *, named: bool = True) -> tuple[Variable, ...]:
        """Declare the variables of a typed list, and return them. If `named`, a repeated name is an error."""
        variables: list[Variable] = []
        seen: set[str] = set()
        for name, types in self._source.typed_words(parts, self._declared.types, variables=True):
            if named and name in seen:
                self._source.refuse(name.line, f"the variable ?{name} is declared twice; give each another name")
            seen.add(name)
            variable = Variable(variable_name(name, self._taken), types or (OBJECT,))
            self._taken.add(variable.name)
            self._variables[str(name)] = variable
            variables.append(variable)
        return tuple(variables)

    def signature(self, name: Word, arity: int) -> Declaration:
        """Return the declaration of a predicate that is used with `arity` arguments.

        In a domain that declares no predicate at all, its first use declares it, with a warning.
        """
        predicates = self._declared.predicates
        if self._declared.undeclared and name not in predicates:
            text = f"the predicate {name} is not declared; declare it in :predicates"
            self._source.warn(name.line, text, "undeclared")
            predicates[str(name)] = Declaration(((OBJECT,),) * arity, name.line)
        return self._source.signature("predicate", name, arity, self._declared.predicates)

    def term(self, term: Expression | Word) -> Variable | str:
        """Return a variable, or the name of an object."""
        if isinstance(term, Word) and term[0] == "?":
            if term[1:] not in self._variables:
                hint = did_you_mean(term, [f"?{name}" for name in self._variables], "declare it")
                self._source.refuse(term.line, f"unknown variable {term}; {hint}")
            return self._variables[term[1:]]
        name = self._source.name_of(term)
        self._source.check_known("object", name, self._declared.objects, ":objects or :constants")
        return str(name)

    def truth(self, line: int) -> Formula:
        """Return the formula that is always true."""
        return Junction(True, (), line)

    def literal(self, expression: Expression, *, positive: bool) -> Literal:
        """Return a literal of a predicate."""
        name = expression.head
        if not name:
            self._source.refuse(expression.line, "a list is not expected here; remove a pair of parentheses")
        if name in UNSUPPORTED and name not in self._declared.predicates:
            self._source.refuse(name.line, unsupported(name))
        self.signature(name, len(expression.rest))
        return Literal(str(name), tuple(map(self.term, expression.rest)), positive, name.line)

    def _operands(self, expression: Expression, number: int) -> tuple[Expression, ...]:
        parts = [self._source.list_of([each], expression.line) for each in expression.rest]
        if len(parts) != number:
            text = f"{expression.head} takes {plural(number, 'condition')}, not {len(parts)}; fix them"
            self._source.refuse(expression.line, text)
        return tuple(parts)

    def formula(self, expression: Expression, *, positive: bool = True) -> Formula:  # noqa: PLR0911 - one for each word
        """Return a formula, or its negation, in negation normal form. An empty list is true."""
        word, line = expression.head, expression.line
        if not expression.parts:
            return Junction(positive, (), line)
        if word == "not":
            return self.formula(self._operands(expression, 1)[0], positive=not positive)
        if word in ("and", "or"):
            parts = (self._source.list_of([each], line) for each in expression.rest)
            return Junction((word == "and") == positive, tuple(self.formula(p, positive=positive) for p in parts), line)
        if word == "imply":
            left, right = self._operands(expression, 2)
            either = (self.formula(left, positive=not positive), self.formula(right, positive=positive))
            return Junction(not positive, either, line)
        if word in ("forall", "exists"):
            inner = self.within()
            over, part = self._operands(expression, 2)
            variables = inner.declare(over.parts)
            return Quantified((word == "forall") == positive, variables, inner.formula(part, positive=positive), line)
        if word in COMPARISONS and len(expression.rest) == 2:
            return self._comparison(expression, positive)
        return self.literal(expression, positive=positive)

    def _comparison(self, expression: Expression, positive: bool) -> Equality | Comparison:
        word, (left, right) = expression.head, expression.rest
        if word == "=" and not self._is_quantity(left) and not self._is_quantity(right):
            return Equality(self.term(left), self.term(right), positive, expression.line)
        quantities = self.quantity(left), self.quantity(right)
        if not positive and word in NEGATIONS:
            return Comparison(NEGATIONS[word], *quantities, True, expression.line)
        return Comparison(str(word), *quantities, positive, expression.line)

    def _is_quantity(self, part: Expression | Word) -> bool:
        if isinstance(part, Expression):
            return True
        return part not in self._declared.objects and (bool(NUMBER.fullmatch(part)) or part in self._declared.functions)

    def quantity(self, part: Expression | Word) -> Quantity:
        """Return a number, a function or an operation on these."""
        if isinstance(part, Word) and LIKE_NUMBER.fullmatch(part):
            return self._source.number(part)
        head = part if isinstance(part, Word) else part.head
        if isinstance(part, Expression) and head in OPERATORS and part.rest:
            if head == "/" and len(part.rest) != 2:
                self._source.refuse(part.line, f"/ takes 2 operands, not {len(part.rest)}; fix them")
            return Arithmetic(str(head), tuple(map(self.quantity, part.rest)))
        if head in TIMES:
            return FunctionTerm(str(head), ())
        return self.function_term(part)

    def function_term(self, part: Expression | Word) -> FunctionTerm:
        """Return a declared function of terms; parentheses may be left out where it has none."""
        head, terms = (part, ()) if isinstance(part, Word) else (part.head, part.rest)
        if not head:
            self._source.refuse(part.line, "a function is expected here; write one, or a number")
        if head != TOTAL or head in self._declared.functions:
            self._source.signature("function", head, len(terms), self._declared.functions)
        return FunctionTerm(str(head), tuple(map(self.term, terms)))


TOTAL = "total-cost"
TIMES = ("?duration", "#t", "total-time")
"""The duration of an action, and time: they have no value."""
