"""The reader of a PDDL domain, which checks the domain against its declarations."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from itertools import chain, count

from prag_asp.pddl.clingo_names import unused
from prag_asp.pddl.definitions import OBJECT, Declaration, Derived, DomainFile, Schema
from prag_asp.pddl.formulas import Literal, Quantified, Variable, literals, subformulas
from prag_asp.pddl.reading.action_reader import ActionReader
from prag_asp.pddl.reading.pddl_source import ATTACHED, PddlSource
from prag_asp.pddl.reading.preferences import check_constraints
from prag_asp.pddl.reading.scopes import Declared, Scope
from prag_asp.pddl.syntax.expressions import Expression, Word
from prag_asp.pddl.syntax.sections import Definition, unexpected
from prag_asp.program.finite.components import components

REQUIREMENTS = frozenset([
    ":strips", ":typing", ":equality", ":negative-preconditions", ":disjunctive-preconditions", ":adl",
    ":existential-preconditions", ":universal-preconditions", ":quantified-preconditions", ":conditional-effects",
    ":derived-predicates", ":domain-axioms", ":action-costs", ":fluents", ":numeric-fluents",
    ":object-fluents",
])  # fmt: skip
"""The supported requirements, which need not be declared."""


class DomainReader:
    """A reader of a domain; `objects` holds its constants and, once the problem's objects are read, these as well."""

    def __init__(self, source: PddlSource, definition: Definition) -> None:
        self._source = source
        self._definition = definition
        self.objects: dict[str, str] = {}
        self.declared = Declared({OBJECT: ()}, self.objects, {}, {})
        self._type_lines: dict[str, int] = {}
        self._predicates: dict[str, Declaration] = {}
        self._functions: dict[str, Declaration] = {}
        self._object_functions: dict[str, str] = {}

    def declarations(self) -> None:
        """Read all sections except rules and actions."""
        sections = self._definition.sections
        check_requirements(self._source, sections.get(":requirements"))
        check_constraints(self._source, sections.get(":constraints"))
        if ":types" in sections:
            self._read_types(sections[":types"])
        self._constant_lines = (
            object_types(self._source, sections[":constants"], self.declared.types, self.objects)
            if ":constants" in sections
            else {}
        )
        undeclared = ":predicates" not in sections
        self.declared = Declared(
            self.declared.types, self.objects, self._predicates, self._functions, undeclared, self._object_functions
        )
        self._constants = dict(self.objects)
        if ":predicates" in sections:
            self._read_signatures("predicate", sections[":predicates"].rest, self._predicates)
        if ":functions" in sections:
            self._read_functions(sections[":functions"].rest)

    def domain(self, *, untimed: bool) -> DomainFile:
        """Return the domain; if `untimed`, durative actions become instantaneous."""
        derived = [self._derived(each) for each in self._definition.repeated if each.head == ":derived"]
        derived_names = frozenset(each.predicate for each in derived)
        reader = ActionReader(self._source, self.declared, derived_names, untimed=untimed)
        trees = [each for each in self._definition.repeated if each.head != ":derived"]
        actions = [*_with_unique_names(schema for each in trees for schema in reader.schemas(each))]
        timed = [each for each in trees if each.head == ":durative-action"]
        if timed:
            text = (
                "durative actions are read as instantaneous ones, one after the other, each from its start to its end"
            )
            self._source.warn(timed[0].line, text, "ignored")
        self._check_layers(derived)
        for effect in chain.from_iterable(each.effects for each in actions):
            if effect.literal.predicate in derived_names:
                text = f"{effect.literal.predicate} is a derived predicate, which no effect may set"
                self._source.refuse(effect.literal.line, f"{text}; remove its rule, or the effect")
        return DomainFile(
            str(self._definition.name), self.declared.types, self._constants, self._predicates, self._functions,
            tuple(derived), tuple(actions), self._type_lines, self._constant_lines,
        )  # fmt: skip

    def _read_types(self, tree: Expression) -> None:
        lines, types = self._type_lines, self.declared.types
        for name, kinds in self._source.typed_words(tree.rest, None):
            lines[str(name)] = name.line
            above = tuple(kind for kind in kinds if kind != OBJECT)
            types[str(name)] = tuple(dict.fromkeys((*types.get(str(name), ()), *above)))
            for each in above:
                types.setdefault(each, ())
                lines.setdefault(each, name.line)
        groups = components(lines, types.__getitem__)
        circular = {name for group in groups for name in group if len(group) > 1 or name in types[name]}
        for first in filter(circular.__contains__, lines):
            paths, seen = [[first]], set[str]()
            while len(path := paths.pop()) == 1 or path[-1] != first:
                if path[-1] not in seen:
                    seen.add(path[-1])
                    paths += [[*path, above] for above in types[path[-1]]]
            self._source.refuse(lines[first], f"types form a cycle, {' - '.join(path)}; remove one of them")

    def _read_functions(self, parts: Iterable[Expression | Word]) -> None:
        """Read numeric functions, which may be declared with the type `number`, and object functions."""
        waiting: list[Expression | Word] = []
        each_part = iter(parts)
        for part in each_part:
            if not isinstance(part, Word) or not ATTACHED.fullmatch(part):
                waiting.append(part)
                continue
            kind = Word(part[1:], part.line) if len(part) > 1 else next(each_part, None)
            if kind == "number":
                self._read_signatures("function", waiting, self._functions)
            else:
                self._read_object_functions(waiting, self._source.kinds(kind, part.line, self.declared.types))
            waiting = []
        self._read_signatures("function", waiting, self._functions)

    def _read_object_functions(self, trees: Iterable[Expression | Word], kinds: tuple[str, ...]) -> None:
        found: dict[str, Declaration] = {}
        self._read_signatures("function", trees, found)
        for name, declaration in found.items():
            predicate = name if name not in self._predicates else unused(f"{name}-value", self._predicates)
            self._object_functions[name] = predicate
            self._predicates[predicate] = Declaration((*declaration.types, kinds), declaration.line)

    def _read_signatures(
        self, kind: str, trees: Iterable[Expression | Word], signatures: dict[str, Declaration]
    ) -> None:
        for part in trees:
            each = Expression((part,), part.line, part.line) if isinstance(part, Word) and kind == "function" else part
            tree = self._source.list_of([each], part.line)
            if not tree.head:
                self._source.refuse(tree.line, f"this {kind} has no name; write one")
            name = self._source.name_of(tree.head)
            scope = Scope(self._source, self.declared)
            types = tuple(variable.types for variable in scope.declare(tree.rest, named=False))
            if name in signatures and signatures[name].types == types:
                text = f"the {kind} {name} is declared twice in the same way; remove one"
                self._source.warn(name.line, text, "no-effect")
                continue
            self._source.check_new(kind, name, signatures)
            signatures[str(name)] = Declaration(types, name.line)

    def _derived(self, tree: Expression) -> Derived:
        if len(tree.rest) != 2:
            self._source.refuse(tree.line, "a rule is (:derived (PREDICATE ?x ...) CONDITION); write it so")
        head, condition = (self._source.list_of([each], tree.line) for each in tree.rest)
        name = head.head
        if not name:
            self._source.refuse(head.line, unexpected("("))
        scope = Scope(self._source, self.declared)
        parameters = scope.declare(head.rest)
        declared = scope.signature(name, len(parameters))
        narrowed = tuple(
            Variable(each.name, kinds if each.types == (OBJECT,) else each.types)
            for each, kinds in zip(parameters, declared.types, strict=True)
        )
        scope = scope.narrowed(narrowed)
        return Derived(str(name), narrowed, scope.formula(condition), name.line)

    def _check_layers(self, derived: Iterable[Derived]) -> None:
        """Refuse derived predicates that are not stratified, because their rules have no unique meaning."""
        rule_literals: dict[str, list[Literal]] = {}
        for rule in derived:
            rule_literals.setdefault(rule.predicate, []).extend(literals(rule.formula))
        for rule in derived:
            name = rule.predicate
            for literal in literals(rule.formula):
                if not literal.positive and name in _reached(literal.predicate, rule_literals):
                    text = f"{name} depends on the negation of {literal.predicate}, which depends on {name}"
                    self._source.refuse(literal.line, f"{text}; remove the negation")
            universal = (each for each in subformulas(rule.formula) if isinstance(each, Quantified) and each.every)
            for literal in chain.from_iterable(map(literals, universal)):
                if name in _reached(literal.predicate, rule_literals):
                    text = f"{name} depends on {literal.predicate} below a 'forall', which depends on {name}"
                    self._source.refuse(literal.line, f"{text}; remove the 'forall'")


def check_requirements(source: PddlSource, section: Expression | None) -> None:
    """Warn of unknown requirements, and of requirements for features that are refused if used."""
    for each in section.rest if section else ():
        name = source.list_of([each], each.line).head if isinstance(each, Expression) else each
        if name not in REQUIREMENTS:
            source.warn(name.line, f"the requirement {name} is ignored; remove it", "ignored")


def object_types(
    source: PddlSource, section: Expression, types: dict[str, tuple[str, ...]], objects: dict[str, str]
) -> dict[str, int]:
    """Add the objects in a list, and return the lines of new ones; redeclaring an object with the same type is allowed.

    An object of several types (``either``) gets a new type, which is a subtype of each of them.
    """
    lines: dict[str, int] = {}
    for name, kinds in source.typed_words(section.rest, types):
        if name not in objects:
            lines[str(name)] = name.line
        kind_name = "-or-".join(kinds) or OBJECT
        if len(kinds) > 1:
            types.setdefault(kind_name, kinds)
        if objects.setdefault(str(name), kind_name) != kind_name:
            source.refuse(name.line, f"the object {name} is a {objects[name]} already; give it one type")
    return lines


def _with_unique_names(schemas: Iterable[Schema]) -> Iterator[Schema]:
    """Yield schemas with unique names; of those that share a name, all but the first get a number."""
    schemas = list(schemas)
    names = {each.given_name for each in schemas}
    used: set[str] = set()
    for each in schemas:
        name = each.given_name
        if name in used:
            name = next(new for number in count(2) if (new := f"{name}-{number}") not in names | used)
        used.add(name)
        yield replace(each, name=name)


def _reached(predicate: str, rule_literals: Mapping[str, list[Literal]]) -> set[str]:
    """Return a predicate and all predicates that its rules read, directly or indirectly."""
    predicates, waiting = {predicate}, [predicate]
    while waiting:
        new = {each.predicate for each in rule_literals.get(waiting.pop(), ())} - predicates
        predicates |= new
        waiting += new
    return predicates
