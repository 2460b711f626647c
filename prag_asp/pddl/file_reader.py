"""Read a PDDL domain and problem from their syntax trees, and check them against their declarations."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from itertools import chain
from pathlib import Path

from prag_asp.pddl.definitions import OBJECT, Cost, Declaration, Derived, DomainFile, ProblemFile, Schema, SchemaEffect
from prag_asp.pddl.formulas import Formula, Literal, Quantified, Variable, literals, subformulas
from prag_asp.pddl.scopes import PddlSource, Scope, typed_words
from prag_asp.pddl.syntax.nodes import LocatedWord, Node
from prag_asp.pddl.syntax.parsing import parse
from prag_asp.program.finite.components import components

TOTAL = "total-cost"


def read_files(domain: Path, problem: Path) -> tuple[DomainFile, ProblemFile]:
    """Read a domain and its problem.

    Raises:
        DomainError: a file is not PDDL, or uses something undeclared or unsupported.
    """
    first, second = parse(domain, "domain"), parse(problem, "problem")
    reader = _DomainReader(domain)
    definition = reader.domain(first)
    return definition, _ProblemReader(problem, definition).problem(second)


class _FileReader(PddlSource):
    """The parts that both readers share: numbers, and typed lists of objects."""

    def number(self, text: LocatedWord) -> str:
        """Return a number as text; the grammar also accepts numbers with several points."""
        if text.count(".") > 1:
            self.refuse(text.line, f"{text} is no number; write one such as 2 or 0.5")
        return str(text)

    def object_types(self, tree: Node, types: Mapping[str, object], objects: dict[str, str]) -> dict[str, int]:
        """Add the objects of a list, and return the lines of new ones; one may be declared again with the same type."""
        lines: dict[str, int] = {}
        for name, kinds in typed_words(tree):
            for kind in kinds:
                self.check_known("type", kind, types, ":types")
            if name not in objects:
                lines[str(name)] = name.line
            kind_name = str(kinds[0]) if kinds else OBJECT
            if objects.setdefault(str(name), kind_name) != kind_name:
                self.refuse(name.line, f"the object {name} is a {objects[name]} already; give it one type")
        return lines


class _DomainReader(_FileReader):
    """Reads a domain."""

    def __init__(self, path: Path) -> None:
        super().__init__(path)
        self._types: dict[str, tuple[str, ...]] = {OBJECT: ()}
        self._type_lines: dict[str, int] = {}
        self._constants: dict[str, str] = {}
        self._constant_lines: dict[str, int] = {}
        self._predicates: dict[str, Declaration] = {}
        self._functions: dict[str, Declaration] = {}

    def domain(self, tree: Node) -> DomainFile:
        """Return the domain of a syntax tree."""
        derived: list[Derived] = []
        actions: dict[str, Schema] = {}
        name = next(part for part in tree.nodes if part.kind == "domain_def").words[-1]
        for part in tree.nodes:
            if part.kind == "types":
                self._read_types(part.nodes[0])
            elif part.kind == "constants":
                self._constant_lines = self.object_types(part.nodes[0], self._types, self._constants)
            elif part.kind == "predicates":
                self._read_signatures("predicate", part, self._predicates)
            elif part.kind == "functions":
                self._read_signatures("function", part.nodes[0], self._functions)
            elif part.kind == "derived_predicates":
                derived.append(self._derived(part))
            elif part.kind == "action_def":
                action = self._action(part)
                self.check_new("action", part.words[1], actions)
                actions[action.name] = action
        self._check_layers(derived)
        derived_names = {each.predicate for each in derived}
        for effect in chain.from_iterable(each.effects for each in actions.values()):
            if effect.literal.predicate in derived_names:
                text = f"{effect.literal.predicate} is a derived predicate, which no effect may set"
                self.refuse(effect.literal.line, f"{text}; remove its rule, or the effect")
        return DomainFile(
            str(name), self._types, self._constants, self._predicates, self._functions, tuple(derived),
            tuple(actions.values()), self._type_lines, self._constant_lines,
        )  # fmt: skip

    def _read_types(self, tree: Node) -> None:
        lines = self._type_lines
        for name, kinds in typed_words(tree):
            lines[str(name)] = name.line
            above = tuple(str(kind) for kind in kinds if kind != OBJECT)
            self._types[str(name)] = tuple(dict.fromkeys((*self._types.get(str(name), ()), *above)))
            for each in above:
                self._types.setdefault(each, ())
                lines.setdefault(each, name.line)
        groups = components(lines, self._types.__getitem__)
        circular = {name for group in groups for name in group if len(group) > 1 or name in self._types[name]}
        for first in filter(circular.__contains__, lines):
            paths, seen = [[first]], set[str]()
            while len(path := paths.pop()) == 1 or path[-1] != first:
                if path[-1] not in seen:
                    seen.add(path[-1])
                    paths += [[*path, above] for above in self._types[path[-1]]]
            self.refuse(lines[first], f"types form a cycle, {' - '.join(path)}; remove one of them")

    def _scope(self) -> Scope:
        return Scope(self, self._types, self._constants, self._predicates)

    def _read_signatures(self, kind: str, tree: Node, signatures: dict[str, Declaration]) -> None:
        for each in tree.nodes:
            name = each.words[0]
            self.check_new(kind, name, signatures)
            types = tuple(variable.types for variable in self._scope().declare(each.nodes[0], named=False))
            signatures[str(name)] = Declaration(types, name.line)

    def _derived(self, tree: Node) -> Derived:
        head, condition = tree.nodes
        name = head.words[0]
        scope = self._scope()
        parameters = scope.declare(head.nodes[0])
        declared = scope.signature(name, len(parameters))
        if len(set(parameters)) != len(parameters):
            self.refuse(name.line, f"the rule for {name} names a variable twice; give each another name")
        narrowed = tuple(
            Variable(each.name, kinds if each.types == (OBJECT,) else each.types)
            for each, kinds in zip(parameters, declared.types, strict=True)
        )
        scope = scope.narrowed(narrowed)
        return Derived(str(name), narrowed, scope.formula(condition), name.line)

    def _action(self, action: Node) -> Schema:
        name, scope = action.words[1], self._scope()
        parameters = scope.declare(action.nodes[0].nodes[0])
        body = {each.kind: each for each in action.nodes[1].nodes}
        true = scope.truth(name.line)
        conditions = body["emptyor_pregd"].nodes if "emptyor_pregd" in body else ()
        trees = body["emptyor_effect"].nodes if "emptyor_effect" in body else ()
        found = [each for tree in trees for each in self._effects(tree, scope, (), true)]
        effects = tuple(each for each in found if isinstance(each, SchemaEffect))
        costs = tuple(each for each in found if isinstance(each, Cost))
        precondition = scope.formula(conditions[0]) if conditions else true
        return Schema(str(name), parameters, precondition, effects, costs, name.line)

    def _effects(
        self, tree: Node, scope: Scope, outer: tuple[Variable, ...], condition: Formula
    ) -> Iterator[SchemaEffect | Cost]:
        """Yield the effects and costs of a syntax tree, below the quantified variables `outer` and a `condition`."""
        first, parts = next(iter(tree.words), None), tree.nodes
        if tree.kind == "num_effect":
            yield self._cost(tree, scope, bool(outer) or condition != scope.truth(condition.line))
        elif tree.kind == "atomic_formula_term":
            yield SchemaEffect(outer, condition, self._change(tree, scope, positive=True))
        elif first == "not":
            yield SchemaEffect(outer, condition, self._change(parts[0], scope, positive=False))
        elif first is not None and first == "oneof":
            self.refuse(first.line, "oneof: probabilistic effects cannot be imported; remove them")
        elif first == "forall":
            inner = scope.within()
            more = inner.declare(parts[0])
            yield from self._effects(parts[1], inner, (*outer, *more), condition)
        elif first == "when":
            yield from self._effects(parts[1], scope, outer, scope.formula(parts[0]))
        else:
            for part in parts:
                yield from self._effects(part, scope, outer, condition)

    def _change(self, tree: Node, scope: Scope, *, positive: bool) -> Literal:
        literal = scope.atom(tree, positive=positive)
        if not isinstance(literal, Literal):
            self.refuse(literal.line, "an effect cannot make two terms equal; remove it")
        return literal

    def _cost(self, tree: Node, scope: Scope, conditional: bool) -> Cost:
        operation, (head, value) = tree.words[0], tree.nodes
        line, name = operation.line, head.words[0]
        if operation != "increase" or name != TOTAL:
            self.refuse(
                line, f"({operation} ({name} ...)): numeric fluents other than costs cannot be imported; remove them"
            )
        if conditional:
            self.refuse(line, "a conditional cost cannot be imported; move it out of the 'when'")
        inner = value.nodes[0]
        if len(value.nodes) > 1 or inner.kind == "f_exp":
            self.refuse(line, "a computed cost cannot be imported; write a number or one function")
        if inner.kind == "num_literal":
            return Cost(self.number(inner.words[0]))
        function, terms = inner.words[0], tuple(map(scope.term, inner.children[1:]))
        self.signature("function", function, len(terms), self._functions)
        return Cost((str(function), terms))

    def _check_layers(self, derived: Iterable[Derived]) -> None:
        """Refuse derived predicates that are not stratified: their rules have no unique meaning."""
        rule_literals: dict[str, list[Literal]] = {}
        for rule in derived:
            rule_literals.setdefault(rule.predicate, []).extend(literals(rule.formula))
        for rule in derived:
            name = rule.predicate
            for literal in literals(rule.formula):
                if not literal.positive and name in _reached(literal.predicate, rule_literals):
                    text = f"{name} depends on the negation of {literal.predicate}, which depends on {name}"
                    self.refuse(literal.line, f"{text}; remove the negation")
            universal = (each for each in subformulas(rule.formula) if isinstance(each, Quantified) and each.every)
            for literal in chain.from_iterable(map(literals, universal)):
                if name in _reached(literal.predicate, rule_literals):
                    text = f"{name} depends on {literal.predicate} below a 'forall', which depends on {name}"
                    self.refuse(literal.line, f"{text}; remove the 'forall'")


def _reached(predicate: str, rule_literals: Mapping[str, list[Literal]]) -> set[str]:
    """Return a predicate, and all predicates that its rules read directly or indirectly."""
    predicates, waiting = {predicate}, [predicate]
    while waiting:
        new = {each.predicate for each in rule_literals.get(waiting.pop(), ())} - predicates
        predicates |= new
        waiting += new
    return predicates


class _ProblemReader(_FileReader):
    """Reads a problem of a domain."""

    def __init__(self, path: Path, domain: DomainFile) -> None:
        super().__init__(path)
        self._domain = domain
        self._objects = dict(domain.constants)
        self._derived = {each.predicate for each in domain.derived}

    def problem(self, tree: Node) -> ProblemFile:
        """Return the problem of a syntax tree."""
        parts = {part.kind: part for part in tree.nodes}
        named = parts["problem_domain"].words[-1]
        if named != self._domain.name:
            hint = "give the domain that it belongs to, or fix the name"
            self.refuse(named.line, f"this is a problem of {named}, not of {self._domain.name}; {hint}")
        lines: dict[str, int] = {}
        if "objects" in parts:
            lines = self.object_types(parts["objects"].nodes[0], self._domain.types, self._objects)
        scope = Scope(self, self._domain.types, self._objects, self._domain.predicates)
        initial: list[Literal] = []
        costs: dict[tuple[str, tuple[str, ...]], str] = {}
        for each in parts["init"].nodes:
            self._initial(each, scope, initial, costs)
        name, goal = str(parts["problem_def"].words[-1]), scope.formula(parts["goal"].nodes[0])
        stated: dict[tuple[str, tuple[Variable | str, ...]], bool] = {}
        for literal in initial:
            if stated.setdefault((literal.predicate, literal.terms), literal.positive) != literal.positive:
                text = " ".join([literal.predicate, *map(str, literal.terms)])
                self.refuse(literal.line, f"({text}) is both true and false at the start; state one of them")
        true = tuple(each for each in initial if each.positive)
        return ProblemFile(name, self._objects, true, costs, goal, lines)

    def _initial(
        self, tree: Node, scope: Scope, initial: list[Literal], costs: dict[tuple[str, tuple[str, ...]], str]
    ) -> None:
        first = tree.nodes[0]
        if first.kind == "basic_function_term":
            function, *terms = first.words
            if function != TOTAL:
                self.check_known("function", function, self._domain.functions, ":functions")
            for term in terms:
                scope.known_object(term)
            value = self.number(tree.nodes[1].words[0])
            if costs.setdefault((str(function), tuple(map(str, terms))), value) != value:
                self.refuse(function.line, f"({' '.join([function, *terms])}) has two values; state one")
            return
        name, *terms = first.nodes[0].words
        scope.signature(name, len(terms))
        if str(name) in self._derived:
            self.refuse(
                name.line,
                f"{name} is a derived predicate, which :init may not state; remove it there, or remove its rule",
            )
        for term in terms:
            scope.known_object(term)
        initial.append(Literal(str(name), tuple(map(str, terms)), "not" not in first.words, name.line))
