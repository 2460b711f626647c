"""The names in scope in a PDDL file: variables, and declared objects, types and predicates."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import NoReturn

from prag_asp.errors import DomainError
from prag_asp.pddl.clingo_names import variable_name
from prag_asp.pddl.definitions import OBJECT, Declaration
from prag_asp.pddl.formulas import Equality, Formula, Junction, Literal, Quantified, Variable
from prag_asp.pddl.syntax.nodes import LocatedWord, Node
from prag_asp.wording import did_you_mean, plural


@dataclass
class PddlSource:
    """A file whose mistakes are refused with its path and their line."""

    path: Path

    def refuse(self, line: int, text: str) -> NoReturn:
        """Raise a DomainError at a line."""
        raise DomainError(f"{self.path}:{line}: {text}")

    def check_known(self, kind: str, name: LocatedWord, declared: Iterable[str], section: str) -> None:
        """Refuse a name that is not declared."""
        if name not in declared:
            hint = did_you_mean(name, declared, f"declare it in {section}")
            self.refuse(name.line, f"unknown {kind} {name}; {hint}")

    def check_new(self, kind: str, name: LocatedWord, declared: Iterable[str]) -> None:
        """Refuse a second declaration of a name."""
        if name in declared:
            self.refuse(name.line, f"the {kind} {name} is declared twice; remove one, or rename it")

    def signature(self, kind: str, name: LocatedWord, arity: int, declared: Mapping[str, Declaration]) -> Declaration:
        """Return the declaration of a predicate or a function that is used with `arity` arguments."""
        self.check_known(kind, name, declared, f":{kind}s")
        expected = len(declared[name].types)
        if expected != arity:
            self.refuse(name.line, f"{name} takes {plural(expected, 'argument')}, not {arity}; fix them")
        return declared[name]


def typed_words(tree: Node) -> Iterator[tuple[LocatedWord, list[LocatedWord]]]:
    """Yield the words of a typed list, each with its alternative types; the list is empty without a type."""
    waiting: list[LocatedWord] = []
    children = iter(tree.children)
    for each in children:
        if each == "-":
            kind = next(children)
            words = kind.all_words if isinstance(kind, Node) else [kind]
            yield from ((name, [word for word in words if word != "either"]) for name in waiting)
            waiting = []
        elif isinstance(each, LocatedWord):
            waiting.append(each)
    yield from ((name, []) for name in waiting)


class Scope:
    """The names in scope at a place of a file."""

    def __init__(
        self,
        source: PddlSource,
        types: Mapping[str, object],
        objects: Mapping[str, str],
        predicates: Mapping[str, Declaration],
    ) -> None:
        self._source = source
        self._types = types
        self._objects = objects
        self._predicates = predicates
        self._variables: dict[str, Variable] = {}
        self._taken: set[str] = set()

    def within(self) -> Scope:
        """Return a nested scope. The clingo names of variables are unique in both."""
        inner = Scope(self._source, self._types, self._objects, self._predicates)
        inner._variables, inner._taken = dict(self._variables), self._taken
        return inner

    def narrowed(self, variables: Iterable[Variable]) -> Scope:
        """Return a scope in which the variables of these names have new types."""
        inner = self.within()
        new = {variable.name: variable for variable in variables}
        inner._variables = {name: new.get(each.name, each) for name, each in self._variables.items()}
        return inner

    def declare(self, tree: Node, *, named: bool = True) -> tuple[Variable, ...]:
        """Declare the variables of a typed list, and return them. If `named`, a repeated name is an error."""
        variables: list[Variable] = []
        seen: set[str] = set()
        for name, kinds in typed_words(tree):
            for kind in kinds:
                self._source.check_known("type", kind, self._types, ":types")
            if named and name in seen:
                self._source.refuse(name.line, f"the variable ?{name} is declared twice; give each another name")
            seen.add(name)
            types = tuple(dict.fromkeys(map(str, kinds)))
            variable = Variable(variable_name(name, self._taken), types or (OBJECT,))
            self._taken.add(variable.name)
            self._variables[str(name)] = variable
            variables.append(variable)
        return tuple(variables)

    def signature(self, name: LocatedWord, arity: int) -> Declaration:
        """Return the declaration of a predicate that is used with `arity` arguments."""
        return self._source.signature("predicate", name, arity, self._predicates)

    def known_object(self, name: LocatedWord) -> str:
        """Return the name of an object."""
        self._source.check_known("object", name, self._objects, ":objects or :constants")
        return str(name)

    def term(self, term: Node | LocatedWord) -> Variable | str:
        """Return a variable, or the name of an object."""
        if isinstance(term, Node):
            return self.known_object(term.all_words[0])
        if str(term) not in self._variables:
            hint = did_you_mean(f"?{term}", [f"?{name}" for name in self._variables], "declare it")
            self._source.refuse(term.line, f"unknown variable ?{term}; {hint}")
        return self._variables[str(term)]

    def truth(self, line: int) -> Formula:
        """Return the formula that is always true."""
        return Junction(True, (), line)

    def atom(self, tree: Node, *, positive: bool) -> Literal | Equality:
        """Return a literal of a predicate, or an equality or inequality."""
        (name, *_), arguments = tree.words, tree.children[1:]
        line = name.line
        if name == "=":
            return Equality(self.term(arguments[0]), self.term(arguments[1]), positive, line)
        self.signature(name, len(arguments))
        return Literal(str(name), tuple(map(self.term, arguments)), positive, line)

    def formula(self, tree: Node, *, positive: bool = True) -> Formula:  # noqa: PLR0911 - one for each word
        """Return a formula, or its negation, in negation normal form."""
        if tree.kind == "atomic_formula_term":
            return self.atom(tree, positive=positive)
        parts = tree.nodes
        if not tree.words:
            return self.formula(parts[0], positive=positive)
        word, line = tree.words[0], tree.words[0].line
        if word == "not":
            return self.formula(parts[0], positive=not positive)
        if word in ("and", "or"):
            return Junction((word == "and") == positive, tuple(self.formula(p, positive=positive) for p in parts), line)
        if word == "imply":
            either = (self.formula(parts[0], positive=not positive), self.formula(parts[1], positive=positive))
            return Junction(not positive, either, line)
        if word in ("forall", "exists"):
            inner = self.within()
            variables = inner.declare(parts[0])
            return Quantified(
                (word == "forall") == positive, variables, inner.formula(parts[1], positive=positive), line
            )
        return self._source.refuse(line, f"({word} ...): numeric comparisons cannot be imported; remove it")
