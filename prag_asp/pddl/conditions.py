"""The translation of formulas into rule bodies.

A conjunction is a body. A disjunction within a conjunction gets an auxiliary atom, with a rule for each case, and so
does a universal formula. The atom of a universal formula stands for its exceptions, and is negated.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from itertools import count

from prag_asp.pddl.clingo_names import unused
from prag_asp.pddl.formulas import (
    Equality,
    Formula,
    Junction,
    Literal,
    Quantified,
    Variable,
    conjuncts,
    literals,
    negated,
    variables,
)
from prag_asp.pddl.line_map import File, FileLine, PlacedLine
from prag_asp.pddl.program_text import statement

BASE, STEP, END = "base", "step(t)", "check(t)"
"""The parts of a program: the static part, a step with the state before it, and the final state."""

TIMES = {STEP: "t-1", END: "t"}
"""The time of the state that each part reads."""

NEVER = "#false"
"""The body of a rule that never fires."""


@dataclass
class Rules:
    """The rules in each program part, in order of insertion; `at` is the PDDL line of the rules added next."""

    parts: dict[str, dict[str, None]] = field(default_factory=lambda: {BASE: {}, STEP: {}, END: {}})
    at: FileLine = field(default_factory=lambda: FileLine("domain", 1))

    def add(self, part: str, head: str, body: Iterable[str] = ()) -> bool:
        """Add a rule unless its body never holds; return whether it was added."""
        conditions = list(dict.fromkeys(body))
        if NEVER in conditions:
            return False
        if not head and not conditions:
            conditions = ["#true"]
        self.parts[part].setdefault(PlacedLine(statement(head, conditions).removeprefix(" "), self.at))
        return True

    def comes_from(self, file: File, line: int) -> None:
        """Set the PDDL line of the rules added next."""
        self.at = FileLine(file, line)

    def placed(self, lines: Iterable[str]) -> Iterator[str]:
        """Yield program lines with their PDDL lines; a line without a PDDL line gets the current one."""
        for each in lines:
            yield each if isinstance(each, PlacedLine) or not each else PlacedLine(each, self.at)


@dataclass
class Vocabulary:
    """The clingo names of predicates, types and objects; which predicates are static or derived; and argument types."""

    predicates: Mapping[str, str]
    types: Mapping[str, str]
    objects: Mapping[str, str]
    static: frozenset[str]
    derived: frozenset[str]
    kinds: Mapping[str, tuple[tuple[str, ...], ...]]

    def term(self, term: Variable | str) -> str:
        """Return the clingo name of a variable or an object."""
        return term.name if isinstance(term, Variable) else self.objects[term]

    def atom(self, literal: Literal) -> str:
        """Return the atom of a literal as text."""
        return applied(self.predicates[literal.predicate], map(self.term, literal.terms))

    def belongs(self, variable: Variable) -> str:
        """Return the atom that restricts a variable to its types."""
        return self.is_a(variable.name, variable.types)

    def is_a(self, term: str, types: Iterable[str]) -> str:
        """Return the atom that restricts a term to the given types."""
        names = [self.types[each] for each in types]
        return f"is_a({term},{names[0] if len(names) == 1 else '(' + '; '.join(names) + ')'})"


def applied(name: str, terms: Iterable[str]) -> str:
    """Return a name applied to arguments, such as ``name(a,b)``, or only the name if there are no arguments."""
    arguments = ",".join(terms)
    return f"{name}({arguments})" if arguments else name


class Bodies:
    """The translation of formulas into rule bodies, which adds the rules that define auxiliary atoms."""

    def __init__(self, words: Vocabulary, rules: Rules) -> None:
        self._words = words
        self._rules = rules
        self._auxiliary: dict[tuple[str, Formula], str] = {}
        self._at_end: dict[str, str] = {}
        self.read: dict[str, set[str]] = {STEP: set(), END: set()}
        """The derived predicates that the rules of each part read."""
        self._names: set[str] = {*words.predicates.values(), *words.types.values()}

    def changes(self, formula: Formula) -> bool:
        """Return whether the truth of a formula depends on the state."""
        return any(each.predicate not in self._words.static for each in literals(formula))

    def body(self, formula: Formula, part: str) -> list[str]:
        """Return a formula as a single body in a program part; the rest of the rule must bind its free variables."""
        body: list[str] = []
        for each in conjuncts(formula):
            if isinstance(each, Literal):
                body.append(self._literal(each, part))
            elif isinstance(each, Equality):
                left, right = self._words.term(each.left), self._words.term(each.right)
                if left != right and (isinstance(each.left, Variable) or isinstance(each.right, Variable)):
                    body.append(f"{left} {'=' if each.positive else '!='} {right}")
                elif (left == right) != each.positive:
                    body.append(NEVER)
            elif isinstance(each, Quantified) and not each.every:
                body += [*map(self._words.belongs, each.variables), *self.body(each.part, part)]
            elif isinstance(each, Junction) and len(each.parts) < 2:
                body += self.body(each.parts[0], part) if each.parts else [NEVER]
            elif isinstance(each, Junction):
                body.append(self._named("either", each, part))
            else:
                body.append(f"not {self._named('exception', negated(each), part)}")
        return body

    def bodies(self, formula: Formula, part: str) -> Iterator[list[str]]:
        """Yield rule bodies whose disjunction is equivalent to a formula."""
        if isinstance(formula, Junction) and not formula.every:
            for each in formula.parts:
                yield from self.bodies(each, part)
        else:
            yield self.body(formula, part)

    def derived(self, predicate: str, part: str) -> str:
        """Return the clingo name of a derived predicate in a program part."""
        if part != END:
            return self._words.predicates[predicate]
        if predicate not in self._at_end:
            self._at_end[predicate] = unused(f"{self._words.predicates[predicate]}_at_end", self._names)
            self._names.add(self._at_end[predicate])
        return self._at_end[predicate]

    def _literal(self, literal: Literal, part: str) -> str:
        atom = self._words.atom(literal)
        if literal.predicate in self._words.derived:
            self.read[part].add(literal.predicate)
            terms = [*map(self._words.term, literal.terms), "t"]
            atom = applied(self.derived(literal.predicate, part), terms)
        elif literal.predicate not in self._words.static:
            atom = f"holds({atom},true,{TIMES[part]})"
        return atom if literal.positive else f"not {atom}"

    def _named(self, word: str, formula: Formula, part: str) -> str:
        """Return the auxiliary atom for a formula; its rules are added on first use."""
        part = part if self.changes(formula) else BASE
        free = variables(formula)
        terms = [variable.name for variable in free] + ([] if part == BASE else ["t"])
        if (part, formula) not in self._auxiliary:
            name = next(each for each in (f"{word}_{number}" for number in count(1)) if each not in self._names)
            self._names.add(name)
            self._auxiliary[part, formula] = head = applied(name, terms)
            rules = ([*map(self._words.belongs, free), *body] for body in self.bodies(formula, part))
            if not sum(self._rules.add(part, head, body) for body in rules):
                self._rules.add(part, f"#defined {name}/{len(terms)}")
        return self._auxiliary[part, formula]
