"""The names in scope in a PDDL file: variables, and declared objects, types and predicates."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import NoReturn

from prag_asp.pddl.clingo_names import variable_name
from prag_asp.pddl.definitions import OBJECT, Declaration
from prag_asp.pddl.formulas import Equality, Formula, Junction, Literal, Quantified, Variable
from prag_asp.pddl.syntax.nodes import LocatedWord, Node
from prag_asp.wording import did_you_mean, plural


class Scope:
    """The names in scope at a place of a file. Errors are reported to `refuse` with their line."""

    def __init__(
        self,
        refuse: Callable[[int, str], NoReturn],
        types: Mapping[str, object],
        objects: Mapping[str, str],
        predicates: Mapping[str, Declaration],
    ) -> None:
        self._refuse = refuse
        self._types = types
        self._objects = objects
        self._predicates = predicates
        self._variables: dict[str, Variable] = {}
        self._taken: set[str] = set()

    def within(self) -> Scope:
        """Return a nested scope. The clingo names of variables are unique in both."""
        inner = Scope(self._refuse, self._types, self._objects, self._predicates)
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
        waiting: list[LocatedWord] = []
        seen: set[str] = set()

        def settle(types: tuple[str, ...]) -> None:
            for name in waiting:
                if named and str(name) in seen:
                    self._refuse(name.line, f"the variable ?{name} is declared twice; give each another name")
                seen.add(str(name))
                variable = Variable(variable_name(name, self._taken), types)
                self._taken.add(variable.name)
                self._variables[str(name)] = variable
                variables.append(variable)
            waiting.clear()

        for each in tree.children:
            if isinstance(each, Node):
                kinds = [kind for kind in each.all_words if kind != "either"]
                for kind in kinds:
                    if str(kind) not in self._types:
                        hint = did_you_mean(kind, self._types, "declare it in :types")
                        self._refuse(kind.line, f"unknown type {kind}; {hint}")
                settle(tuple(dict.fromkeys(map(str, kinds))))
            elif each != "-":
                waiting.append(each)
        settle((OBJECT,))
        return tuple(variables)

    def signature(self, name: LocatedWord, arity: int) -> Declaration:
        """Return the declaration of a predicate that is used with `arity` arguments."""
        line = name.line
        if str(name) not in self._predicates:
            hint = did_you_mean(name, self._predicates, "declare it in :predicates")
            self._refuse(line, f"unknown predicate {name}; {hint}")
        declared = self._predicates[str(name)]
        if len(declared.types) != arity:
            self._refuse(line, f"{name} takes {plural(len(declared.types), 'argument')}, not {arity}; fix them")
        return declared

    def known_object(self, name: LocatedWord) -> str:
        """Return the name of an object."""
        if str(name) not in self._objects:
            hint = did_you_mean(name, self._objects, "declare it in :objects or :constants")
            self._refuse(name.line, f"unknown object {name}; {hint}")
        return str(name)

    def term(self, term: Node | LocatedWord) -> Variable | str:
        """Return a variable, or the name of an object."""
        if isinstance(term, Node):
            return self.known_object(term.all_words[0])
        if str(term) not in self._variables:
            hint = did_you_mean(f"?{term}", [f"?{name}" for name in self._variables], "declare it")
            self._refuse(term.line, f"unknown variable ?{term}; {hint}")
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
        return self._refuse(line, f"({word} ...): numeric comparisons cannot be imported; remove it")
