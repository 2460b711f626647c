"""The translation of a PDDL domain and problem into a logic program: rules for actions, facts for objects."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import chain

from prag_asp.pddl.behaviour import Behaviour
from prag_asp.pddl.clingo_names import TERMS, clingo_names
from prag_asp.pddl.conditions import BASE, END, STEP, Rules, Vocabulary, applied
from prag_asp.pddl.definitions import OBJECT, DomainFile, ProblemFile
from prag_asp.pddl.formulas import Formula, Junction, Literal, Quantified, Variable, literals, subformulas
from prag_asp.pddl.line_map import FileLine, PlacedLine
from prag_asp.pddl.program_text import filled, heading, statement
from prag_asp.program.sources import EVER_AT_START, EVER_BY_ACTIONS

CLOSED = '#include "rules/closed_world.lp".'


class Translation:
    """The translation of a domain and a problem, section by section: declarations, then dynamics."""

    def __init__(self, domain: DomainFile, problem: ProblemFile) -> None:
        self._domain = domain
        self._problem = problem
        changed = {effect.literal.predicate for action in domain.actions for effect in action.effects}
        derived = frozenset(each.predicate for each in domain.derived)
        types = clingo_names(domain.types, "some")
        objects = clingo_names(problem.objects, "the", types.values())
        actions = clingo_names((each.name for each in domain.actions), "do", (*types.values(), *objects.values()))
        still = [name for name in domain.predicates if name not in changed]
        fluents = clingo_names((name for name in domain.predicates if name in changed), "is", (), TERMS)
        predicates = {**clingo_names(still, "is"), **fluents}
        self.actions: Mapping[str, str] = actions
        self.words = Vocabulary(predicates, types, objects, frozenset(still) - derived, derived, self._kinds())
        self._rules = Rules()
        self._behaviour = Behaviour(domain, problem, self.words, actions, self._rules)

    @property
    def general(self) -> list[str]:
        """The rules about all fluents, which do not correspond to any PDDL line."""
        if not self._behaviour.looks_ahead:
            return [CLOSED]
        rules = ["#defined ever/1."]
        if any(each.predicate in self.fluents() for each in self._problem.initial):
            rules.append(EVER_AT_START)
        if any(effect.literal.positive for each in self._domain.actions for effect in each.effects):
            rules.append(EVER_BY_ACTIONS)
        return [CLOSED, "", "% What may be true at some time, so that no action is grounded that never occurs", *rules]

    def lines(self, title: str) -> list[str]:
        """Return the lines of the whole program, which begins with a comment; lines from PDDL carry their PDDL line."""
        start: list[str] = []
        initial = [
            PlacedLine(f"initially({self.words.atom(literal)}, true).", FileLine("problem", literal.line))
            for literal in dict.fromkeys(self._problem.initial)
            if literal.predicate not in self.words.static
        ]
        for section in (self._classes(), self._entities(), self._static(), self._fluents(), initial):
            placed = [*self._rules.placed(section)]
            start += [*placed, ""] if placed else []
        shown: list[str] = []
        for action in self._domain.actions:
            shown += ["", *self._rules.placed(self._behaviour.action(action))]
        self._behaviour.finish_effects()
        self._behaviour.derive(STEP)
        goal = self._behaviour.goal()
        self._behaviour.derive(END)
        lines = [f"% {title}"]
        named = {"types": self.words.types, "objects": self.words.objects, "predicates": self.words.predicates}
        pairs = {kind: [*names.items()] for kind, names in named.items()}
        pairs["actions"] = [(each.given_name, self.actions[each.name]) for each in self._domain.actions]
        for kind, names in pairs.items():
            other = [f"{name} is {original}" for original, name in names if original != name]
            lines += [f"% Names of {kind} in PDDL: {', '.join(other)}."] if other else []
        lines += ["", *self.general, "", *start[:-1]]
        lines += heading("Actions") + (shown or ["", PlacedLine("#defined action/1.", FileLine("domain", 1))])
        if self._rules.parts[BASE]:
            lines += [*heading("Static conditions of actions"), "", *self._rules.parts[BASE]]
        if goal:
            lines += [*heading("The goal"), "", *goal]
        if self._rules.parts[STEP]:
            lines += heading("Conditions and effects that read the state before a step")
            lines += ["", "#program step(t).", *self._rules.parts[STEP]]
        if self._rules.parts[END]:
            lines += [*heading("Conditions on the final state"), "", "#program check(t).", *self._rules.parts[END]]
        return lines

    def _kinds(self) -> Mapping[str, tuple[tuple[str, ...], ...]]:
        """Return the types of each predicate's arguments: the declared types, and wider types that literals use."""
        kinds = {name: [list(each) for each in signature.types] for name, signature in self._domain.predicates.items()}
        for literal in chain(self._problem.initial, *map(literals, self._formulas())):
            for types, term in zip(kinds[literal.predicate], literal.terms, strict=True):
                used = term.types if isinstance(term, Variable) else (self._problem.objects[term],)
                types += [each for each in used if not any(self._is_below(each, other) for other in types)]
        return {
            name: tuple(
                tuple(
                    each for each in types if not any(each != other and self._is_below(each, other) for other in types)
                )
                for types in arguments
            )
            for name, arguments in kinds.items()
        }

    def _is_below(self, name: str, other: str) -> bool:
        return other in self._domain.above(name)

    def _classes(self) -> Iterator[str]:
        types, domain = self.words.types, self._domain.types
        used = {each for kinds in self.words.kinds.values() for each in (name for types in kinds for name in types)}
        used |= set(self._problem.objects.values())
        for formula in chain.from_iterable(map(subformulas, self._formulas())):
            if isinstance(formula, Quantified):
                used |= {name for each in formula.variables for name in each.types}
        rooted = OBJECT in used
        for name, above in domain.items():
            self._rules.comes_from("domain", self._domain.type_lines.get(name, 1))
            parents = above or ((OBJECT,) if rooted and name != OBJECT else ())
            yield from (f"class({types[name]}, {types[parent]})." for parent in parents)
            if not parents and (rooted or name != OBJECT):
                yield f"class({types[name]})."

    def _formulas(self) -> Iterator[Formula]:
        """Yield all formulas; rules, actions and effects become formulas that are quantified over their variables."""
        yield self._problem.goal
        for rule in self._domain.derived:
            yield Quantified(True, rule.parameters, rule.formula, rule.line)
        for action in self._domain.actions:
            yield Quantified(True, action.parameters, action.precondition, action.line)
            for effect in action.effects:
                whole = Junction(True, (effect.literal, effect.condition), action.line)
                yield Quantified(True, effect.variables, whole, action.line)

    def _entities(self) -> Iterator[str]:
        kinds: dict[str, list[str]] = {}
        places: dict[str, FileLine] = {}
        for name, kind in self._problem.objects.items():
            kinds.setdefault(kind, []).append(self.words.objects[name])
            line = self._problem.object_lines.get(name)
            origin = FileLine("problem", line) if line else FileLine("domain", self._domain.constant_lines[name])
            places[kind] = min(origin, places.get(kind, origin), key=lambda place: place.file == "domain")
        for kind, names in kinds.items():
            self._rules.at = places[kind]
            pool = names[0] if len(names) == 1 else f"({'; '.join(names)})"
            yield from filled(f"entity({pool}, {self.words.types[kind]}).".split(" "), indent="   ")

    def _static(self) -> Iterator[str]:
        """Yield the facts of static predicates."""
        stated: dict[str, list[Literal]] = {name: [] for name in self._domain.predicates if name in self.words.static}
        for literal in self._problem.initial:
            if literal.predicate in stated:
                stated[literal.predicate].append(literal)
        for name, initial in stated.items():
            self._rules.comes_from("domain", self._domain.predicates[name].line)
            yield f"#defined {self.words.predicates[name]}/{len(self._domain.predicates[name].types)}."
            facts = dict.fromkeys(f"{self.words.atom(literal)}." for literal in initial)
            if initial:
                self._rules.comes_from("problem", initial[0].line)
            yield from filled(facts)

    def fluents(self) -> Mapping[str, tuple[tuple[str, ...], ...]]:
        """Return the argument types of each predicate that actions change."""
        fixed = self.words.static | self.words.derived
        return {name: kinds for name, kinds in self.words.kinds.items() if name not in fixed}

    def _fluents(self) -> Iterator[str]:
        for name, kinds in self.fluents().items():
            self._rules.comes_from("domain", self._domain.predicates[name].line)
            terms = [f"X{number}" if len(kinds) > 1 else "X" for number in range(1, len(kinds) + 1)]
            head = f"fluent({applied(self.words.predicates[name], terms)})"
            yield statement(head, map(self.words.is_a, terms, kinds))
