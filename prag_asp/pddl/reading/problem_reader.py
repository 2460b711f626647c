"""The reader of a PDDL problem, which checks the problem against the declarations of its domain."""

from __future__ import annotations

from fractions import Fraction

from prag_asp.pddl.definitions import ProblemFile
from prag_asp.pddl.formulas import Literal, Variable
from prag_asp.pddl.reading.domain_reader import check_requirements, object_types
from prag_asp.pddl.reading.object_functions import UNDEFINED
from prag_asp.pddl.reading.pddl_source import PddlSource
from prag_asp.pddl.reading.preferences import check_constraints, without_preferences
from prag_asp.pddl.reading.scopes import Declared, Scope
from prag_asp.pddl.syntax.expressions import Expression, Word
from prag_asp.pddl.syntax.sections import Definition


class ProblemReader:
    """A reader of a problem; it reads the objects before the domain's actions are read, which may name the objects."""

    def __init__(self, source: PddlSource, definition: Definition, *, untimed: bool) -> None:
        self._source = source
        self._definition = definition
        self._untimed = untimed
        self._lines: dict[str, int] = {}
        self._initial: list[Literal] = []
        self._values: dict[tuple[str, tuple[str, ...]], Fraction] = {}
        self._objects: dict[tuple[str, tuple[str, ...]], Variable | str | None] = {}

    def read_objects(self, domain: Word, types: dict[str, tuple[str, ...]], objects: dict[str, str]) -> None:
        """Check the name of the domain, and add the objects of the problem."""
        sections = self._definition.sections
        named = [each for each in sections[":domain"].rest if isinstance(each, Word)]
        if named and named[0] != domain:
            hint = "give the domain that it belongs to, or fix the name"
            self._source.warn(named[0].line, f"this is a problem of {named[0]}, not of {domain}; {hint}", "ignored")
        check_requirements(self._source, sections.get(":requirements"))
        check_constraints(self._source, sections.get(":constraints"))
        if ":objects" in sections:
            self._lines = object_types(self._source, sections[":objects"], types, objects)

    def problem(self, declared: Declared, derived: frozenset[str]) -> ProblemFile:
        """Return the problem."""
        sections = self._definition.sections
        scope = Scope(self._source, declared, in_domain=False)
        for part in sections[":init"].rest:
            self._read_initial(self._source.list_of([part], part.line), scope, derived)
        goal = self._source.list_of(sections[":goal"].rest, sections[":goal"].end)
        if len(sections[":goal"].rest) > 1:
            self._source.refuse(goal.end, "a goal is one condition; join several with (and ...)")
        stated: dict[tuple[str, tuple[Variable | str, ...]], bool] = {}
        for literal in self._initial:
            if stated.setdefault((literal.predicate, literal.terms), literal.positive) != literal.positive:
                text = " ".join([literal.predicate, *map(str, literal.terms)])
                self._source.refuse(literal.line, f"({text}) is both true and false at the start; state one of them")
        true = tuple(each for each in self._initial if each.positive)
        name, found = str(self._definition.name), scope.formula(without_preferences(self._source, goal))
        return ProblemFile(name, declared.objects, true, self._values, found, self._lines)

    def _read_initial(self, tree: Expression, scope: Scope, derived: frozenset[str]) -> None:
        if tree.head == "and":
            for each in tree.rest:
                self._read_initial(self._source.list_of([each], tree.line), scope, derived)
        elif tree.head == "=":
            self._read_value(tree, scope)
        elif tree.head == "at" and len(tree.rest) == 2 and isinstance(tree.rest[1], Expression):
            self._read_at_time(tree, scope, derived)
        else:
            atom = self._source.list_of(tree.rest, tree.line) if tree.head == "not" else tree
            literal = scope.literal(atom, positive=tree.head != "not")
            if literal.predicate in derived:
                hint = "remove it there, or remove its rule"
                text = f"{literal.predicate} is a derived predicate, which :init may not state; {hint}"
                self._source.refuse(literal.line, text)
            self._initial.append(literal)

    def _read_at_time(self, tree: Expression, scope: Scope, derived: frozenset[str]) -> None:
        """Read a timed initial literal, which is true in the initial state if its time is 0 and ignored otherwise."""
        time, literal = tree.rest
        if not self._untimed:
            text = "(at TIME ...): literals that become true at a time cannot be imported"
            self._source.refuse(tree.line, f"{text}; give --untimed to ignore them, or remove them")
        changed = self._source.list_of([literal], tree.line)
        if not isinstance(time, Word):
            self._source.refuse(time.line, "a time is a number; write one such as 2 or 0.5")
        if self._source.number(time) == 0:
            self._read_initial(changed, scope, derived)
            return
        if changed.head != "=":
            scope.literal(self._source.list_of(changed.rest, tree.line) if changed.head == "not" else changed)
        text = "literals that change at a time are ignored; state in :init what is always true"
        self._source.warn(tree.line, text, "ignored")

    def _read_value(self, tree: Expression, scope: Scope) -> None:
        if len(tree.rest) != 2:
            self._source.refuse(tree.line, "the value of a function is (= (FUNCTION ...) NUMBER); write it so")
        if isinstance(tree.rest[0], Expression) and scope.is_object_function(tree.rest[0]):
            self._read_object(tree.rest[0], tree.rest[1], scope)
            return
        function, value = scope.function_term(tree.rest[0]), tree.rest[1]
        if isinstance(value, Expression):
            self._source.refuse(value.line, "the value of a function is a number; compute it")
        number = self._source.number(value)
        key = function.function, tuple(map(str, function.terms))
        if self._values.setdefault(key, number) != number:
            self._source.refuse(tree.line, f"({' '.join([key[0], *key[1]])}) has two values; state one")

    def _read_object(self, part: Expression, value: Expression | Word, scope: Scope) -> None:
        """Read the value of an object function."""
        function = scope.function_value(part)
        name = None if value == UNDEFINED else scope.term(value)
        names = tuple(map(str, function.terms.terms))
        if function.terms.new or self._objects.setdefault((function.predicate, names), name) != name:
            text = f"({' '.join([part.head, *names])}) has two values, or one that depends on another function"
            self._source.refuse(part.line, f"{text}; state one object")
        if name is not None:
            scope.check_value(function, name)
            self._initial.append(function.literal(name))
