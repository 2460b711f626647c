"""The dynamics of a PDDL problem as rules: preconditions and effects of actions, derived predicates, and the goal."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from prag_asp.pddl.conditions import BASE, END, NEVER, STEP, Bodies, Rules, Vocabulary, applied
from prag_asp.pddl.definitions import OBJECT, DomainFile, ProblemFile, Schema, SchemaEffect
from prag_asp.pddl.formulas import Formula, Junction, Literal, Quantified, Variable, conjuncts, demanded, negated
from prag_asp.pddl.line_map import FileLine, PlacedLine
from prag_asp.pddl.program_text import statement
from prag_asp.pddl.size import large_actions

TRUTH = {True: "true", False: "false"}


class Behaviour:
    """Translates actions and the goal. Rules that read the state before a step, or the final state, go to `rules`."""

    def __init__(
        self, domain: DomainFile, problem: ProblemFile, words: Vocabulary, actions: Mapping[str, str], rules: Rules
    ) -> None:
        self._domain = domain
        self._goal = problem.goal
        self._conflicting = _ConflictingEffects(domain, problem)
        self._large = large_actions(domain, problem)
        self._words = words
        self._actions = actions
        self._rules = rules
        self._bodies = Bodies(words, rules)
        self._in_steps: dict[bool, FileLine] = {}
        """The place of the first rule of a step that adds (key true) and of the first that deletes (key false)."""

    @property
    def looks_ahead(self) -> bool:
        """Whether some action has so many instances that its rule reads ``ever``."""
        return bool(self._large)

    def action(self, action: Schema) -> Iterator[str]:
        """Yield the base rules of an action, and add its rules of a step to `rules`."""
        self._rules.comes_from("domain", action.line)
        term = applied(self._actions[action.name], (each.name for each in action.parameters))
        parts = list(conjuncts(action.precondition))
        fixed = [part for part in parts if not self._bodies.changes(part)]
        body = [*map(self._words.belongs, action.parameters)]
        for part in fixed:
            body += self._bodies.body(part, BASE)
        body = self._without_object(body, fixed)
        if action.name in self._large:
            body += self._ever(action.precondition)
        if NEVER in body:
            body = [*map(self._words.belongs, action.parameters), NEVER]
        yield statement(f"action({term})", body)
        plain: dict[bool, list[str]] = {True: [], False: []}
        rest: list[str] = []
        for part in parts:
            self._rules.comes_from("domain", part.line)
            if isinstance(part, Literal) and part not in fixed and part.predicate not in self._words.derived:
                plain[part.positive].append(self._words.atom(part))
            elif part not in fixed:
                rest += self._rules.placed(self._demand(term, part))
        self._rules.comes_from("domain", min((part.line for part in parts if part not in fixed), default=action.line))
        yield from self._valued("precondition", term, plain)
        yield from rest
        yield from self._effects(term, action)

    def _without_object(self, body: list[str], fixed: Iterable[Formula]) -> list[str]:
        """Remove type tests for `object` of variables that a static literal binds: its arguments are objects."""
        facts = [part for part in fixed if isinstance(part, Literal) and part.positive]
        bound = {term for part in facts for term in part.terms if isinstance(term, Variable)}
        needless = {self._words.belongs(each) for each in bound if each.types == (OBJECT,)}
        return [each for each in body if each not in needless]

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

    def _demand(self, term: str, formula: Formula) -> Iterator[str]:
        """Yield the rule of a precondition on guarded fluents; other preconditions become constraints of the step."""
        simple = self._guarded(formula)
        if simple is not None:
            variables, guard, literal = simple
            body = [f"action({term})", *map(self._words.belongs, variables), *self._bodies.body(guard, BASE)]
            yield statement(f"precondition({term}, {self._words.atom(literal)}, {TRUTH[literal.positive]})", body)
            return
        for body in self._bodies.bodies(negated(formula), STEP):
            self._rules.add(STEP, "", [f"occurs({term},t)", *body])

    def _guarded(self, formula: Formula) -> tuple[tuple[Variable, ...], Formula, Literal] | None:
        """Return a formula as ``forall variables (static guard -> literal)``, or None if it has another form."""
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
        """Yield the unconditional effects of an action; effects that depend on the state become rules of a step."""
        moving = {effect for effect in action.effects if self._bodies.changes(effect.condition)}
        added = [effect for effect in action.effects if effect.literal.positive]
        plain: dict[bool, list[str]] = {True: [], False: []}
        rest: list[str] = []
        for effect in action.effects:
            self._rules.comes_from("domain", effect.literal.line)
            conflicting = [] if effect.literal.positive else self._conflicting.of(effect, added)
            if effect in moving or not moving.isdisjoint(conflicting):
                self._step_effect(term, effect)
                if self.looks_ahead and effect.literal.positive:
                    rest += self._rules.placed(self._ever_made(term, effect))
                continue
            if _is_overruled(effect, conflicting):
                continue
            if _is_plain(effect) and not conflicting:
                plain[effect.literal.positive].append(self._words.atom(effect.literal))
                continue
            atom, value = self._words.atom(effect.literal), TRUTH[effect.literal.positive]
            body = [f"action({term})", *map(self._words.belongs, effect.variables)]
            body += [*self._bodies.body(effect.condition, BASE), *_differences(self._words, effect, conflicting)]
            if not all(map(_is_plain, conflicting)):
                body.append(f"not postcondition({term},{atom},true)")
            if NEVER not in body:
                rest.append(PlacedLine(statement(f"postcondition({term}, {atom}, {value})", body), self._rules.at))
        self._rules.comes_from("domain", min((each.literal.line for each in action.effects), default=action.line))
        yield from self._valued("postcondition", term, plain)
        yield from dict.fromkeys(rest)

    def _ever_made(self, term: str, effect: SchemaEffect) -> Iterator[str]:
        """Yield that an effect which depends on the state may ever come true."""
        body = [f"action({term})", *map(self._words.belongs, effect.variables)]
        for part in conjuncts(effect.condition):
            body += [] if self._bodies.changes(part) else self._bodies.body(part, BASE)
        if NEVER not in body:
            yield statement(f"ever({self._words.atom(effect.literal)})", [*body, *self._ever(effect.condition)])

    def _step_effect(self, term: str, effect: SchemaEffect) -> None:
        head = f"{'adds' if effect.literal.positive else 'deletes'}({self._words.atom(effect.literal)},t)"
        body = [f"occurs({term},t)", *map(self._words.belongs, effect.variables)]
        body += self._bodies.body(effect.condition, STEP)
        if NEVER not in body:
            self._in_steps.setdefault(effect.literal.positive, self._rules.at)
            self._rules.add(STEP, head, body)

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
        """Add the rules of the derived predicates that a part reads, evaluated in the state that it reads."""
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
        """Return the facts of the goal; other conditions than fluent literals become constraints on the final state."""
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


class _ConflictingEffects:
    """Finds effects that may set the same fluent, by the types of their terms.

    An atom that an action both adds and deletes becomes true.
    """

    def __init__(self, domain: DomainFile, problem: ProblemFile) -> None:
        self._objects = problem.objects
        self._above = [domain.above(name) for name in domain.types]
        self._overlaps: dict[tuple[tuple[str, ...], tuple[str, ...]], bool] = {}

    def of(self, effect: SchemaEffect, others: Iterable[SchemaEffect]) -> list[SchemaEffect]:
        """Return the effects among others that may set the fluent of an effect."""
        literal = effect.literal
        return [
            each
            for each in others
            if each.literal.predicate == literal.predicate
            and all(map(self._may_be_one, literal.terms, each.literal.terms))
        ]

    def _may_be_one(self, left: Variable | str, right: Variable | str) -> bool:
        if isinstance(left, str) and isinstance(right, str):
            return left == right
        types = self._types(left), self._types(right)
        if types not in self._overlaps:
            first, second = types
            self._overlaps[types] = any(
                not above.isdisjoint(first) and not above.isdisjoint(second) for above in self._above
            )
        return self._overlaps[types]

    def _types(self, term: Variable | str) -> tuple[str, ...]:
        return term.types if isinstance(term, Variable) else (self._objects[term],)


def _is_overruled(effect: SchemaEffect, conflicting: Iterable[SchemaEffect]) -> bool:
    """Return whether another effect always adds the fluent that an effect deletes."""
    return any(_is_plain(each) and each.literal.terms == effect.literal.terms for each in conflicting)


def _differences(words: Vocabulary, effect: SchemaEffect, conflicting: Iterable[SchemaEffect]) -> Iterator[str]:
    """Yield the inequalities that separate a delete effect from each plain add effect of the same action."""
    for other in filter(_is_plain, conflicting):
        pairs = zip(effect.literal.terms, other.literal.terms, strict=True)
        unlike = [(words.term(left), words.term(right)) for left, right in pairs if left != right]
        left, right = (",".join(side) for side in zip(*unlike, strict=True))
        yield f"{left} != {right}" if len(unlike) == 1 else f"({left}) != ({right})"
