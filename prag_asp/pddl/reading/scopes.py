"""The names in scope in a PDDL file: variables, and declared objects, types, predicates and functions."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

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
    negated,
)
from prag_asp.pddl.reading.object_functions import UNDEFINED, AppliedPredicate, ObjectFunction, Terms
from prag_asp.pddl.reading.pddl_source import LIKE_NUMBER, NUMBER, PddlSource
from prag_asp.pddl.syntax.expressions import Expression, Word
from prag_asp.pddl.syntax.sections import UNSUPPORTED, unsupported
from prag_asp.wording import did_you_mean, nearest, plural

NEGATIONS = {"<": ">=", ">=": "<", ">": "<=", "<=": ">"}
COMPARISONS = (*NEGATIONS, "=")
OPERATORS = ("+", "-", "*", "/")


@dataclass(frozen=True)
class Declared:
    """The declarations of a domain and its problem; `types` maps each type to its direct supertypes.

    If predicates are `undeclared`, the domain has no list of them, and each is added on its first use.
    """

    types: dict[str, tuple[str, ...]]
    objects: Mapping[str, str]
    predicates: dict[str, Declaration]
    functions: Mapping[str, Declaration]
    undeclared: bool = False
    object_functions: dict[str, str] = field(default_factory=dict)
    """The predicates of the object functions, whose last argument is the value."""


class Scope:
    """The names in scope at a point in a file."""

    def __init__(self, source: PddlSource, declared: Declared, *, in_domain: bool = True) -> None:
        self._source = source
        self._declared = declared
        self._in_domain = in_domain
        self._variables: dict[str, Variable] = {}
        self._taken: set[str] = set()
        self._duration: tuple[Scope, Expression | Word] | None = None

    def within(self) -> Scope:
        """Return a nested scope; the clingo names of variables are unique in both scopes together."""
        inner = Scope(self._source, self._declared, in_domain=self._in_domain)
        inner._variables, inner._taken, inner._duration = dict(self._variables), self._taken, self._duration
        return inner

    def fix_duration(self, duration: Expression | Word | None) -> None:
        """Set the value of an action's duration, or None if it may have several values."""
        self._duration = (self, duration) if duration is not None else None

    def narrowed(self, variables: Iterable[Variable]) -> Scope:
        """Return a scope in which variables with the given names have new types."""
        inner = self.within()
        new = {variable.name: variable for variable in variables}
        inner._variables = {name: new.get(each.name, each) for name, each in self._variables.items()}
        return inner

    def declare(self, parts: Iterable[Expression | Word], *, named: bool = True) -> tuple[Variable, ...]:
        """Declare the variables of a typed list, and return them; with `named`, a repeated name is an error."""
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
        """Return the declaration of a predicate used with `arity` arguments.

        An undeclared predicate is declared by its first use in a domain, with a warning, unless it seems to be
        misspelt. If the domain declares no predicate at all, its first use in a problem also declares it.
        """
        predicates = self._declared.predicates
        if name not in predicates and (
            self._declared.undeclared or (self._in_domain and not nearest(name, predicates))
        ):
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

    def new_variable(self, types: tuple[str, ...]) -> Variable:
        """Return a new variable, which occurs in no formula."""
        variable = Variable(variable_name("value", self._taken), types)
        self._taken.add(variable.name)
        return variable

    def is_object_function(self, part: Expression | Word) -> bool:
        """Return whether a part is an object function."""
        return isinstance(part, Expression) and part.head in self._declared.object_functions

    def function_value(self, part: Expression) -> ObjectFunction:
        """Return an object function."""
        terms = self.terms(part.rest)
        predicate = self._declared.object_functions[part.head]
        *arguments, types = self._declared.predicates[predicate].types
        if len(arguments) != len(terms.terms):
            text = f"{part.head} takes {plural(len(arguments), 'argument')}, not {len(terms.terms)}; fix them"
            self._source.refuse(part.line, text)
        return ObjectFunction(predicate, terms, types, part.line)

    def check_value(self, function: ObjectFunction, value: Variable | str) -> None:
        """Refuse a value whose type cannot be among the types of a function's values."""
        for kind in value.types if isinstance(value, Variable) else (self._declared.objects[value],):
            above, waiting = {kind, OBJECT}, [kind]
            while waiting:
                new = set(self._declared.types[waiting.pop()]) - above
                above |= new
                waiting += new
            if above.isdisjoint(function.types):
                text = f"a value of {function.predicate} is a {' or '.join(function.types)}, not any {kind}"
                self._source.refuse(function.line, f"{text}; give it this type")

    def terms(self, parts: Iterable[Expression | Word]) -> Terms:
        """Return terms in which each object function is replaced by a variable that stands for its value."""
        terms: list[Variable | str] = []
        new: list[Variable] = []
        values: list[Literal] = []
        for part in parts:
            if isinstance(part, Expression) and self.is_object_function(part):
                function = self.function_value(part)
                variable = self.new_variable(function.types)
                new += (*function.terms.new, variable)
                values += (*function.terms.values, function.literal(variable))
                terms.append(variable)
            else:
                terms.append(self.term(part))
        return Terms(tuple(terms), tuple(new), tuple(values))

    def truth(self, line: int) -> Formula:
        """Return the formula that is always true."""
        return Junction(True, (), line)

    def literal(self, expression: Expression, *, positive: bool = True) -> Literal:
        """Return a literal of a predicate whose terms are variables and objects."""
        found = self.atom(expression)
        if found.terms.new:
            self._source.refuse(expression.line, "a function is not expected here; write its value")
        return Literal(found.predicate, found.terms.terms, positive, found.line)

    def atom(self, expression: Expression) -> AppliedPredicate:
        """Return a predicate applied to terms, which may be object functions."""
        name = expression.head
        if not name:
            self._source.refuse(expression.line, "a list is not expected here; remove a pair of parentheses")
        if name in UNSUPPORTED and name not in self._declared.predicates:
            self._source.refuse(name.line, unsupported(name))
        self.signature(name, len(expression.rest))
        return AppliedPredicate(str(name), self.terms(expression.rest), name.line)

    def _operands(self, expression: Expression, number: int) -> tuple[Expression, ...]:
        parts = [self._source.list_of([each], expression.line) for each in expression.rest]
        if len(parts) != number:
            text = f"{expression.head} takes {plural(number, 'condition')}, not {len(parts)}; fix them"
            self._source.refuse(expression.line, text)
        return tuple(parts)

    def formula(self, expression: Expression, *, positive: bool = True) -> Formula:  # noqa: PLR0911 - one for each word
        """Return a formula, or its negation, in negation normal form; an empty list is true."""
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
        found = self.atom(expression)
        whole = found.terms.bound(Literal(found.predicate, found.terms.terms, True, found.line))
        return whole if positive else negated(whole)

    def _object_equality(self, left: Expression, right: Expression | Word) -> Formula:
        """Return the formula: an object function and a term have the same value, or both have none."""
        one, line = self.function_value(left), left.line
        if right == UNDEFINED and UNDEFINED not in self._declared.objects:
            return one.terms.bound(self._has_no_value(one))
        if isinstance(right, Expression) and self.is_object_function(right):
            other = self.function_value(right)
            value = self.new_variable(one.types)
            both = Quantified(False, (value,), Junction(True, (one.literal(value), other.literal(value)), line), line)
            neither = Junction(True, (self._has_no_value(one), self._has_no_value(other)), line)
            return one.terms.bound(other.terms.bound(Junction(False, (both, neither), line)))
        return one.terms.bound(one.literal(self.term(right)))

    def _has_no_value(self, function: ObjectFunction) -> Formula:
        value = self.new_variable(function.types)
        return Quantified(True, (value,), negated(function.literal(value)), function.line)

    def _comparison(self, expression: Expression, positive: bool) -> Formula:
        word, (left, right) = expression.head, expression.rest
        for one, other in ((left, right), (right, left)):
            if word == "=" and isinstance(one, Expression) and self.is_object_function(one):
                found = self._object_equality(one, other)
                return found if positive else negated(found)
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
        """Return a number, a function, or an operation on numbers and functions."""
        if isinstance(part, Word) and LIKE_NUMBER.fullmatch(part):
            return self._source.number(part)
        head = part if isinstance(part, Word) else part.head
        if isinstance(part, Expression) and head in OPERATORS and part.rest:
            if head == "/" and len(part.rest) != 2:
                self._source.refuse(part.line, f"/ takes 2 operands, not {len(part.rest)}; fix them")
            return Arithmetic(str(head), tuple(map(self.quantity, part.rest)))
        if head == DURATION and self._duration:
            scope, duration = self._duration
            return scope.quantity(duration)
        if head in TIMES:
            return FunctionTerm(str(head), ())
        return self.function_term(part)

    def function_term(self, part: Expression | Word) -> FunctionTerm:
        """Return a declared function applied to terms; without terms, parentheses are optional."""
        head, terms = (part, ()) if isinstance(part, Word) else (part.head, part.rest)
        if not head:
            self._source.refuse(part.line, "a function is expected here; write one, or a number")
        if head != TOTAL or head in self._declared.functions:
            self._source.signature("function", head, len(terms), self._declared.functions)
        return FunctionTerm(str(head), tuple(map(self.term, terms)))


TOTAL = "total-cost"
DURATION = "?duration"
TIMES = (DURATION, "#t", "total-time")
"""The words for the duration of an action and for time, which have no value."""
