"""The dynamics of a PDDL problem as rules: preconditions and effects of actions, derived predicates, and the goal."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import cache

from prag_asp.pddl.conditions import BASE, END, NEVER, STEP, Bodies, Rules, Vocabulary, applied
from prag_asp.pddl.definitions import OBJECT, DomainFile, ProblemFile, Schema, SchemaEffect
from prag_asp.pddl.formulas import Formula, Junction, Literal, Quantified, Variable, conjuncts, demanded, negated
from prag_asp.pddl.line_map import FileLine, PlacedLine
from prag_asp.pddl.program_text import statement
from prag_asp.pddl.size import large_actions

TRUTH = {True: "true", False: "false"}


class Behaviour:
    """The translation of actions and the goal.

    Rules that read the state before a step or the final state are added to `rules`.
    """

    def __init__(
        self, domain: DomainFile, problem: ProblemFile, words: Vocabulary, actions: Mapping[str, str], rules: Rules
    ) -> None:
        self._domain = domain
        self._goal = problem.goal
        self._may_be_one = _overlap(domain, problem)
        self._large = large_actions(domain, problem)
        self._words = words
        self._actions = actions
        self._rules = rules
        self._bodies = Bodies(words, rules)
        self._in_steps: dict[bool, FileLine] = {}
        """The PDDL lines of the first step rule that adds an atom (key True) and of the first that deletes one (key
        False)."""

    @property
    def looks_ahead(self) -> bool:
        """Whether some action has so many instances that its rule reads ``ever``."""
        return bool(self._large)

    def action(self, action: Schema) -> Iterator[str]:
        """Yield the base rules of an action, and add its step rules to `rules`."""
        self._rules.comes_from("domain", action.line)
        term = applied(self._actions[action.name], (each.name for each in action.parameters))
        parts = list(conjuncts(action.precondition))
        fixed = [part for part in parts if not self._bodies.changes(part)]
        kinds = [*map(self._words.belongs, action.parameters)]
        # A static literal binds its variables to objects, so they need no test for the type `object`.
        facts = [part for part in fixed if isinstance(part, Literal) and part.positive]
        bound = {term for part in facts for term in part.terms if isinstance(term, Variable)}
        needless = {self._words.belongs(each) for each in bound if each.types == (OBJECT,)}
        body = [*kinds, *(each for part in fixed for each in self._bodies.body(part, BASE))]
        body = [each for each in body if each not in needless]
        if action.name in self._large:
            body += self._ever(action.precondition)
        yield statement(f"action({term})", [*kinds, NEVER] if NEVER in body else body)
        plain: dict[bool, list[str]] = {True: [], False: []}
        rest: list[str] = []
        moving = [part for part in parts if part not in fixed]
        for part in moving:
            self._rules.comes_from("domain", part.line)
            if isinstance(part, Literal) and part.predicate not in self._words.derived:
                plain[part.positive].append(self._words.atom(part))
            elif guarded := self._guarded(part):
                variables, guard, literal = guarded
                body = [f"action({term})", *map(self._words.belongs, variables), *self._bodies.body(guard, BASE)]
                head = f"precondition({term}, {self._words.atom(literal)}, {TRUTH[literal.positive]})"
                rest.append(PlacedLine(statement(head, body), self._rules.at))
            else:
                for body in self._bodies.bodies(negated(part), STEP):
                    self._rules.add(STEP, "", [f"occurs({term},t)", *body])
        self._rules.comes_from("domain", min((part.line for part in moving), default=action.line))
        yield from self._valued("precondition", term, plain)
        yield from rest
        yield from self._effects(term, action)

    def _ever(self, condition: Formula) -> Iterator[str]:
        """Yield an ``ever`` literal for each fluent that a condition requires to be true."""
        fixed = self._words.static | self._words.derived
        return (f"ever({self._words.atom(each)})" for each in demanded(condition) if each.predicate not in fixed)

    def _valued(self, predicate: str, term: str, values: Mapping[bool, list[str]]) -> Iterator[str]:
        for value, atoms in values.items():
            fluents = list(dict.fromkeys(atoms))
            if fluents:
                pool = fluents[0] if len(fluents) == 1 else f"({'; '.join(fluents)})"
                yield f"{predicate}({term}, {pool}, {TRUTH[value]}) :- action({term})."

    def _guarded(self, formula: Formula) -> tuple[tuple[Variable, ...], Formula, Literal] | None:
        """Return a formula as ``forall variables (static guard -> literal)``, or None if it does not have this form."""
        variables: tuple[Variable, ...] = ()
        while isinstance(formula, Quantified) and formula.every:
            variables, formula = (*variables, *formula.variables), formula.part
        parts = formula.parts if isinstance(formula, Junction) and not formula.every else (formula,)
        moving = [part for part in parts if self._bodies.changes(part)]
        if len(moving) != 1 or not isinstance(moving[0], Literal) or moving[0].predicate in self._words.derived:
            return None
        guards = tuple(negated(part) for part in parts if part is not moving[0])
        return variables, Junction(True, guards, moving[0].line), moving[0]

    def _effects(self, term: str, action: Schema) -> Iterator[str]:
        """Yield the unconditional effects of an action; effects that depend on the state become rules of a step.

        An atom that an action both adds and deletes becomes true.
        """
        moving = {effect for effect in action.effects if self._bodies.changes(effect.condition)}
        added = [effect for effect in action.effects if effect.literal.positive]
        plain: dict[bool, list[str]] = {True: [], False: []}
        rest: list[str] = []
        for effect in action.effects:
            literal, atom = effect.literal, self._words.atom(effect.literal)
            self._rules.comes_from("domain", literal.line)
            conflicting = [
                each
                for each in added
                if not literal.positive
                and each.literal.predicate == literal.predicate
                and all(map(self._may_be_one, literal.terms, each.literal.terms))
            ]
            if effect in moving or not moving.isdisjoint(conflicting):
                rest += self._rules.placed(self._step_effect(term, effect))
                continue
            always = [each for each in conflicting if _is_plain(each)]
            if any(each.literal.terms == literal.terms for each in always):
                continue  # the fluent is added whenever it is deleted
            if _is_plain(effect) and not conflicting:
                plain[literal.positive].append(atom)
                continue
            body = [f"action({term})", *map(self._words.belongs, effect.variables)]
            body += self._bodies.body(effect.condition, BASE)
            for other in always:
                pairs = zip(literal.terms, other.literal.terms, strict=True)
                unlike = [(self._words.term(one), self._words.term(two)) for one, two in pairs if one != two]
                left, right = (",".join(side) for side in zip(*unlike, strict=True))
                body.append(f"{left} != {right}" if len(unlike) == 1 else f"({left}) != ({right})")
            if len(always) < len(conflicting):
                body.append(f"not postcondition({term},{atom},true)")
            if NEVER not in body:
                rule = statement(f"postcondition({term}, {atom}, {TRUTH[literal.positive]})", body)
                rest.append(PlacedLine(rule, self._rules.at))
        self._rules.comes_from("domain", min((each.literal.line for each in action.effects), default=action.line))
        yield from self._valued("postcondition", term, plain)
        yield from dict.fromkeys(rest)

    def _step_effect(self, term: str, effect: SchemaEffect) -> Iterator[str]:
        """Add the rule for a state-dependent effect; yield a rule which states that the added atom may become true."""
        positive, atom = effect.literal.positive, self._words.atom(effect.literal)
        kinds = [*map(self._words.belongs, effect.variables)]
        body = [f"occurs({term},t)", *kinds, *self._bodies.body(effect.condition, STEP)]
        if NEVER not in body:
            self._in_steps.setdefault(positive, self._rules.at)
            self._rules.add(STEP, f"{'adds' if positive else 'deletes'}({atom},t)", body)
        if self.looks_ahead and positive:
            body = [f"action({term})", *kinds]
            for part in conjuncts(effect.condition):
                body += [] if self._bodies.changes(part) else self._bodies.body(part, BASE)
            if NEVER not in body:
                yield statement(f"ever({atom})", [*body, *self._ever(effect.condition)])

    def finish_effects(self) -> None:
        """Add the rules that apply conditional effects: an atom that is both added and deleted becomes true."""
        if False in self._in_steps:
            self._rules.at = self._in_steps[False]
            self._rules.add(STEP, "adds(F,t)", ["occurs(A,t)", "postcondition(A,F,true)"])
            self._rules.add(STEP, "changed(F,t)", ["deletes(F,t)", "not adds(F,t)"])
            self._rules.add(STEP, "holds(F,false,t)", ["deletes(F,t)", "not adds(F,t)"])
        if True in self._in_steps:
            self._rules.at = self._in_steps[True]
            self._rules.add(STEP, "changed(F,t)", ["adds(F,t)"])
            self._rules.add(STEP, "holds(F,true,t)", ["adds(F,t)"])

    def derive(self, part: str) -> None:
        """Add rules that evaluate the derived predicates that a program part reads, in the state that it reads."""
        done: set[str] = set()
        while new := self._bodies.read[part] - done:
            done |= new
            written: set[str] = set()
            rules = [rule for rule in self._domain.derived if rule.predicate in new]
            for rule in rules:
                self._rules.comes_from("domain", rule.line)
                terms = [*(variable.name for variable in rule.parameters), "t"]
                head = applied(self._bodies.derived(rule.predicate, part), terms)
                for body in self._bodies.bodies(rule.formula, part):
                    if self._rules.add(part, head, [*map(self._words.belongs, rule.parameters), *body]):
                        written.add(rule.predicate)
            for rule in rules:
                if rule.predicate not in written:
                    self._rules.comes_from("domain", rule.line)
                    name = self._bodies.derived(rule.predicate, part)
                    self._rules.add(part, f"#defined {name}/{len(rule.parameters) + 1}")

    def goal(self) -> list[str]:
        """Return the facts of the goal; conditions other than fluent literals become constraints on the final state."""
        parts = [(part, self._guarded(part)) for part in conjuncts(self._goal)]
        fixed = self._words.static | self._words.derived
        plain = {part for part, _ in parts if isinstance(part, Literal) and part.predicate not in fixed}
        goals = {(each.predicate, each.terms, each.positive) for each in plain}
        opposite = {each for each in plain if (each.predicate, each.terms, not each.positive) in goals}
        certain = plain - opposite
        signs = {(found[2].predicate, found[2].positive) for _, found in parts if found}
        facts = []
        for part, found in parts:
            self._rules.comes_from("problem", part.line)
            if isinstance(part, Literal) and part in certain:
                facts.append(PlacedLine(f"goal({self._words.atom(part)}, {TRUTH[part.positive]}).", self._rules.at))
            elif found and part not in opposite and (found[2].predicate, not found[2].positive) not in signs:
                variables, guard, literal = found
                body = [*map(self._words.belongs, variables), *self._bodies.body(guard, BASE)]
                fact = statement(f"goal({self._words.atom(literal)}, {TRUTH[literal.positive]})", body)
                facts.append(PlacedLine(fact, self._rules.at))
            else:
                for body in self._bodies.bodies(negated(part), END):
                    self._rules.add(END, "", body)
        return list(dict.fromkeys(facts))


def _is_plain(effect: SchemaEffect) -> bool:
    """Return whether an effect has neither a condition nor quantified variables."""
    return not effect.variables and next(conjuncts(effect.condition), None) is None


def _overlap(domain: DomainFile, problem: ProblemFile) -> Callable[[Variable | str, Variable | str], bool]:
    """Return a test of whether two terms may denote the same object, based on their types."""
    above = [domain.above(name) for name in domain.types]

    @cache
    def have_common_type(one: tuple[str, ...], other: tuple[str, ...]) -> bool:
        return any(not each.isdisjoint(one) and not each.isdisjoint(other) for each in above)

    def may_be_one(left: Variable | str, right: Variable | str) -> bool:
        if isinstance(left, str) and isinstance(right, str):
            return left == right
        one, other = (each.types if isinstance(each, Variable) else (problem.objects[each],) for each in (left, right))
        return have_common_type(one, other)

    return may_be_one
