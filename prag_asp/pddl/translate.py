"""A domain and a problem of PDDL as a logic program that states the same: rules for actions, facts for objects."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from prag_asp.pddl.conditions import BASE, END, NEVER, STEP, Bodies, Rules, Vocabulary, applied
from prag_asp.pddl.formula import (
    Formula,
    Junction,
    Literal,
    Quantified,
    Variable,
    conjuncts,
    literals,
    negated,
)
from prag_asp.pddl.layout import filled, heading, statement, wrapped
from prag_asp.pddl.model import OBJECT, DomainFile, Effect, ProblemFile, Schema
from prag_asp.pddl.names import TERMS, clingo_names
from prag_asp.pddl.places import File, Line, Place
from prag_asp.pddl.rivals import is_conditional, may_be_same, told_apart

CLOSED = '#include "rules/closed_world.lp".'
TRUTH = {True: "true", False: "false"}


class Translation:
    """Writes a domain and a problem as a logic program, section by section."""

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
        self._bodies = Bodies(self.words, self._rules)

    def lines(self, title: str) -> list[str]:
        """Return the whole program, which begins with a comment; what PDDL says knows its place."""
        start: list[str] = []
        for section in (self._classes(), self._entities(), self._static(), self._fluents(), self._initially()):
            found = [*self._placed(section)]
            start += [*found, ""] if found else []
        shown: list[str] = []
        for action in self._domain.actions:
            shown += ["", *self._placed(self._action(action))]
        self._finish_effects()
        self._derive(STEP)
        goal = self._goal()
        self._derive(END)
        lines = [f"% {title}", *self._changed_names(), "", CLOSED, "", *start[:-1]]
        lines += heading("Actions") + (shown or ["", Line("#defined action/1.", Place("domain", 1))])
        if self._rules.parts[BASE]:
            lines += [*heading("What actions ask of what never changes"), "", *self._rules.parts[BASE]]
        if goal:
            lines += [*heading("The goal"), "", *goal]
        if self._rules.parts[STEP]:
            lines += heading("What depends on the state before a step")
            lines += ["", "#program step(t).", *self._rules.parts[STEP]]
        if self._rules.parts[END]:
            lines += [*heading("What the last state satisfies"), "", "#program check(t).", *self._rules.parts[END]]
        return lines

    def _placed(self, lines: Iterable[str]) -> Iterator[str]:
        """Yield lines with their places: those that know none come from where the translation is as they are made."""
        for each in lines:
            yield each if isinstance(each, Line) or not each else Line(each, self._rules.at)

    def _at(self, file: File, line: int) -> None:
        """Say where what follows comes from."""
        self._rules.at = Place(file, line)

    def _kinds(self) -> Mapping[str, tuple[tuple[str, ...], ...]]:
        """Return the types of each predicate's arguments: those declared, and those beyond that it is used with."""
        kinds = {name: [list(each) for each in signature.types] for name, signature in self._domain.predicates.items()}
        for literal in self._all_literals():
            for types, term in zip(kinds[literal.predicate], literal.terms, strict=True):
                used = term.types if isinstance(term, Variable) else (self._problem.objects[term],)
                types += [each for each in used if not any(self._is_below(each, other) for other in types)]
        return {name: tuple(map(self._widest, each)) for name, each in kinds.items()}

    def _widest(self, types: list[str]) -> tuple[str, ...]:
        """Return those of some types that are below no other of them."""
        return tuple(
            each for each in types if not any(each != other and self._is_below(each, other) for other in types)
        )

    def _is_below(self, name: str, other: str) -> bool:
        return other in self._domain.above(name)

    def _all_literals(self) -> Iterator[Literal]:
        yield from self._problem.initial
        yield from literals(self._problem.goal)
        for rule in self._domain.derived:
            yield from literals(rule.formula)
        for action in self._domain.actions:
            yield from literals(action.precondition)
            for effect in action.effects:
                yield effect.literal
                yield from literals(effect.condition)

    def _changed_names(self) -> Iterator[str]:
        """Yield comments that say which names PDDL spells in another way."""
        words = self.words
        all_names = {"types": words.types, "objects": words.objects, "predicates": words.predicates}
        for kind, names in {**all_names, "actions": self.actions}.items():
            other = [f"{name} is {given}" for given, name in names.items() if given != name]
            if other:
                yield f"% Names of {kind} in PDDL: {', '.join(other)}."

    def _classes(self) -> Iterator[str]:
        types, domain = self.words.types, self._domain.types
        read = {each for kinds in self.words.kinds.values() for each in (name for types in kinds for name in types)}
        read |= {name for action in self._domain.actions for each in action.parameters for name in each.types}
        read |= set(self._problem.objects.values())
        quantified = [each for formula in self._formulas() for each in _quantified(formula)]
        read |= {name for each in quantified for name in each.types}
        rooted = OBJECT in read
        for name, above in domain.items():
            self._at("domain", self._domain.type_lines.get(name, 1))
            if name == OBJECT:
                if rooted:
                    yield f"class({types[OBJECT]})."
                continue
            parents = above or ((OBJECT,) if rooted else ())
            yield from (f"class({types[name]}, {types[parent]})." for parent in parents)
            if not parents:
                yield f"class({types[name]})."

    def _formulas(self) -> Iterator[Formula]:
        yield self._problem.goal
        yield from (each.formula for each in self._domain.derived)
        for each in self._domain.derived:
            yield Quantified(True, each.parameters, Junction(True, (), each.line), each.line)
        for action in self._domain.actions:
            yield action.precondition
            for effect in action.effects:
                yield effect.condition
                yield Quantified(True, effect.variables, effect.literal, effect.literal.line)

    def _entities(self) -> Iterator[str]:
        kinds: dict[str, list[str]] = {}
        places: dict[str, Place] = {}
        for name, kind in self._problem.objects.items():
            kinds.setdefault(kind, []).append(self.words.objects[name])
            line = self._problem.object_lines.get(name)
            found = Place("problem", line) if line else Place("domain", self._domain.constant_lines[name])
            places[kind] = min(found, places.get(kind, found), key=lambda place: place.file == "domain")
        for kind, names in kinds.items():
            self._rules.at = places[kind]
            told = names[0] if len(names) == 1 else f"({'; '.join(names)})"
            yield from wrapped(f"entity({told}, {self.words.types[kind]}).")

    def _static(self) -> Iterator[str]:
        """Yield the facts of predicates that never change."""
        stated: dict[str, list[Literal]] = {name: [] for name in self._domain.predicates if name in self.words.static}
        for literal in self._problem.initial:
            if literal.predicate in stated:
                stated[literal.predicate].append(literal)
        for name, found in stated.items():
            self._at("domain", self._domain.predicates[name].line)
            yield f"#defined {self.words.predicates[name]}/{len(self._domain.predicates[name].types)}."
            facts = dict.fromkeys(f"{self.words.atom(literal)}." for literal in found)
            if found:
                self._at("problem", found[0].line)
            yield from filled(facts)

    def fluents(self) -> Mapping[str, tuple[tuple[str, ...], ...]]:
        """Return the types of the arguments of each predicate that actions change."""
        fixed = self.words.static | self.words.derived
        return {name: kinds for name, kinds in self.words.kinds.items() if name not in fixed}

    def _fluents(self) -> Iterator[str]:
        for name, kinds in self.fluents().items():
            self._at("domain", self._domain.predicates[name].line)
            terms = [f"X{number}" if len(kinds) > 1 else "X" for number in range(1, len(kinds) + 1)]
            head = f"fluent({applied(self.words.predicates[name], terms)})"
            yield statement(head, map(self.words.is_a, terms, kinds))

    def _initially(self) -> Iterator[str]:
        for literal in dict.fromkeys(self._problem.initial):
            if literal.predicate not in self.words.static:
                self._at("problem", literal.line)
                yield f"initially({self.words.atom(literal)}, true)."

    def _action(self, action: Schema) -> Iterator[str]:
        """Yield the rules of an action; those of steps are kept for their section."""
        self._at("domain", action.line)
        term = applied(self.actions[action.name], (each.name for each in action.parameters))
        parts = list(conjuncts(action.precondition))
        fixed = [part for part in parts if not self._bodies.changes(part)]
        body = [*map(self.words.belongs, action.parameters)]
        for part in fixed:
            body += self._bodies.body(part, BASE)
        body = self._without_object(body, fixed)
        if NEVER in body:
            body = [*map(self.words.belongs, action.parameters), NEVER]
        yield statement(f"action({term})", body)
        plain: dict[bool, list[str]] = {True: [], False: []}
        rest: list[str] = []
        for part in parts:
            self._at("domain", part.line)
            if isinstance(part, Literal) and part not in fixed and part.predicate not in self.words.derived:
                plain[part.positive].append(self.words.atom(part))
            elif part not in fixed:
                rest += self._placed(self._demand(term, part))
        self._at("domain", min((part.line for part in parts if part not in fixed), default=action.line))
        yield from self._valued("precondition", term, plain)
        yield from rest
        yield from self._effects(term, action)

    def _without_object(self, body: list[str], fixed: Iterable[Formula]) -> list[str]:
        """Leave out that variables are objects where a fact binds them, for all that is stated of is an object."""
        facts = [part for part in fixed if isinstance(part, Literal) and part.positive]
        bound = {term for part in facts for term in part.terms if isinstance(term, Variable)}
        needless = {self.words.belongs(each) for each in bound if each.types == (OBJECT,)}
        return [each for each in body if each not in needless]

    def _valued(self, predicate: str, term: str, values: Mapping[bool, list[str]]) -> Iterator[str]:
        for value, atoms in values.items():
            found = list(dict.fromkeys(atoms))
            if found:
                told = found[0] if len(found) == 1 else f"({'; '.join(found)})"
                yield f"{predicate}({term}, {told}, {TRUTH[value]}) :- action({term})."

    def _demand(self, term: str, formula: Formula) -> Iterator[str]:
        """Yield what a precondition asks of each fluent of a kind; forbid the opposite of what it asks otherwise."""
        simple = self._guarded(formula)
        if simple is not None:
            variables, guard, literal = simple
            body = [f"action({term})", *map(self.words.belongs, variables), *self._bodies.body(guard, BASE)]
            yield statement(f"precondition({term}, {self.words.atom(literal)}, {TRUTH[literal.positive]})", body)
            return
        for body in self._bodies.bodies(negated(formula), STEP):
            self._rules.add(STEP, "", [f"occurs({term},t)", *body])

    def _guarded(self, formula: Formula) -> tuple[tuple[Variable, ...], Formula, Literal] | None:
        """Return a formula as a literal that holds for all variables that satisfy a guard, which never changes."""
        variables: tuple[Variable, ...] = ()
        while isinstance(formula, Quantified) and formula.every:
            variables, formula = (*variables, *formula.variables), formula.part
        parts = formula.parts if isinstance(formula, Junction) and not formula.every else (formula,)
        moving = [part for part in parts if self._bodies.changes(part)]
        if len(moving) != 1 or not isinstance(moving[0], Literal) or moving[0].predicate in self.words.derived:
            return None
        guards = tuple(negated(part) for part in parts if part is not moving[0])
        return variables, Junction(True, guards, moving[0].line), moving[0]

    def _effects(self, term: str, action: Schema) -> Iterator[str]:
        """Yield what an action changes; what depends on the state becomes rules of a step."""
        moving = {effect for effect in action.effects if self._bodies.changes(effect.condition)}
        added = [effect for effect in action.effects if effect.literal.positive]
        plain: dict[bool, list[str]] = {True: [], False: []}
        rest: list[str] = []
        for effect in action.effects:
            self._at("domain", effect.literal.line)
            rivals = [] if effect.literal.positive else [each for each in added if may_be_same(each, effect)]
            if effect in moving or not moving.isdisjoint(rivals):
                self._step_effect(term, effect)
                continue
            unlike = told_apart(self.words, effect, rivals)
            if unlike is None:
                continue
            if not (effect.variables or is_conditional(effect) or unlike):
                plain[effect.literal.positive].append(self.words.atom(effect.literal))
                continue
            atom, value = self.words.atom(effect.literal), TRUTH[effect.literal.positive]
            body = [f"action({term})", *map(self.words.belongs, effect.variables)]
            body += self._bodies.body(effect.condition, BASE)
            body += [each if each != "" else f"not postcondition({term},{atom},true)" for each in unlike]
            if NEVER not in body:
                rest.append(Line(statement(f"postcondition({term}, {atom}, {value})", body), self._rules.at))
        self._at("domain", min((each.literal.line for each in action.effects), default=action.line))
        yield from self._valued("postcondition", term, plain)
        yield from dict.fromkeys(rest)

    def _step_effect(self, term: str, effect: Effect) -> None:
        head = f"{'adds' if effect.literal.positive else 'deletes'}({self.words.atom(effect.literal)},t)"
        body = [f"occurs({term},t)", *map(self.words.belongs, effect.variables)]
        self._rules.add(STEP, head, [*body, *self._bodies.body(effect.condition, STEP)])

    def _finish_effects(self) -> None:
        """Add what conditional effects come to: what is added and deleted at once is added."""
        rules = self._rules.parts[STEP]
        self._rules.at = next((each.place for each in rules if isinstance(each, Line)), self._rules.at)
        adds, deletes = (any(rule.startswith(word) for rule in rules) for word in ("adds(", "deletes("))
        if deletes:
            self._rules.add(STEP, "adds(F,t)", ["occurs(A,t)", "postcondition(A,F,true)"])
            self._rules.add(STEP, "changed(F,t)", ["deletes(F,t)"])
            self._rules.add(STEP, "holds(F,false,t)", ["deletes(F,t)", "not adds(F,t)"])
        if adds:
            self._rules.add(STEP, "changed(F,t)", ["adds(F,t)"])
            self._rules.add(STEP, "holds(F,true,t)", ["adds(F,t)"])

    def _derive(self, part: str) -> None:
        """Add the rules of derived predicates that a part reads, for the state that it reads."""
        read: set[str] = set()
        while True:
            text = "\n".join(self._rules.parts[part])
            names = {each: f"{self._bodies.derived(each, part)}(" for each in self.words.derived}
            new = {each for each, name in names.items() if name in text} - read
            if not new:
                return
            read |= new
            for rule in self._domain.derived:
                if rule.predicate in new:
                    self._at("domain", rule.line)
                    head = applied(
                        self._bodies.derived(rule.predicate, part), [*(v.name for v in rule.parameters), "t"]
                    )
                    for body in self._bodies.bodies(rule.formula, part):
                        self._rules.add(part, head, [*map(self.words.belongs, rule.parameters), *body])

    def _goal(self) -> list[str]:
        """Return the facts of the goal; what is no value of a fluent becomes rules of the last state."""
        parts = list(conjuncts(self._problem.goal))
        fluents = set(self.words.predicates) - self.words.static - self.words.derived
        plain = [part for part in parts if isinstance(part, Literal) and part.predicate in fluents]
        opposite = [part for part in plain if any(_is_opposite(part, other) for other in plain)]
        signs = {
            (found[2].predicate, found[2].positive) for part in parts if (found := self._guarded(part)) is not None
        }
        facts = []
        for part in parts:
            self._at("problem", part.line)
            if isinstance(part, Literal) and part in plain and part not in opposite:
                facts.append(Line(f"goal({self.words.atom(part)}, {TRUTH[part.positive]}).", self._rules.at))
                continue
            simple = self._guarded(part)
            if (
                part not in opposite
                and simple is not None
                and (simple[2].predicate, not simple[2].positive) not in signs
            ):
                variables, guard, literal = simple
                body = [*map(self.words.belongs, variables), *self._bodies.body(guard, BASE)]
                fact = statement(f"goal({self.words.atom(literal)}, {TRUTH[literal.positive]})", body)
                facts.append(Line(fact, self._rules.at))
                continue
            for body in self._bodies.bodies(negated(part), END):
                self._rules.add(END, "", body)
        return list(dict.fromkeys(facts))


def _quantified(formula: Formula) -> Iterator[Variable]:
    if isinstance(formula, Junction):
        for part in formula.parts:
            yield from _quantified(part)
    elif isinstance(formula, Quantified):
        yield from formula.variables
        yield from _quantified(formula.part)


def _is_opposite(literal: Literal, other: Literal) -> bool:
    same = (literal.predicate, literal.terms) == (other.predicate, other.terms)
    return same and literal.positive != other.positive
