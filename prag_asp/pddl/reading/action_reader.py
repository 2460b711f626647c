"""The reader of the actions of a PDDL domain: nested conditions and effects, and durative actions without time."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from itertools import combinations

from prag_asp.pddl.definitions import NumericEffect, Schema, SchemaEffect
from prag_asp.pddl.formulas import Formula, Junction, Literal, Quantified, Variable, certainly_unlike
from prag_asp.pddl.reading.object_functions import UNDEFINED, ObjectFunction
from prag_asp.pddl.reading.outcomes import ONE_OF, outcomes, words_of
from prag_asp.pddl.reading.pddl_source import PddlSource
from prag_asp.pddl.reading.preferences import without_preferences
from prag_asp.pddl.reading.scopes import DURATION, Declared, Scope
from prag_asp.pddl.reading.untimed import EarlyCondition, untimed_schema
from prag_asp.pddl.syntax.expressions import Expression, Word
from prag_asp.pddl.syntax.sections import UNSUPPORTED, unexpected, unsupported

ASSIGNMENTS = ("increase", "decrease", "assign", "scale-up", "scale-down")
PARTS: Mapping[str, tuple[str, ...]] = {
    ":action": (":parameters", ":vars", ":precondition", ":effect"),
    ":durative-action": (":parameters", ":vars", ":duration", ":condition", ":effect"),
}
"""The parts of an action, each of which may occur at most once, in any order."""

START, END, OVER = ("at", "start"), ("at", "end"), ("over", "all")

Effect = SchemaEffect | NumericEffect


class ActionReader:
    """A reader of the actions of a domain; with `untimed`, durative actions become instantaneous instead of refused."""

    def __init__(self, source: PddlSource, declared: Declared, derived: frozenset[str], *, untimed: bool) -> None:
        self._source = source
        self._declared = declared
        self._derived = derived
        self._untimed = untimed
        self._assigned: list[tuple[ObjectFunction, int]] = []

    def schemas(self, action: Expression) -> Iterator[Schema]:
        """Yield an action, or an action for each of its outcomes; the variables of ``:vars`` are further parameters."""
        if action.head == ":durative-action" and not self._untimed:
            hint = "give --untimed to import it as an instantaneous action"
            self._source.refuse(action.line, f"{action.head}: actions that take time cannot be imported; {hint}")
        if len(action.parts) < 2:
            self._source.refuse(action.line, f"this {action.head} has no name; write one")
        name = self._source.name_of(action.parts[1])
        parts = self._parts(action)
        effect = parts.get(":effect", Expression((), name.line, name.line))
        for part in (":precondition", ":condition"):
            if part in parts:
                parts[part] = without_preferences(self._source, parts[part])
        found = [effect] if ONE_OF in self._declared.predicates else outcomes(self._source, effect)
        if len(found) > 1:
            text = f"each outcome of {ONE_OF} is read as an action of its own, so that plans choose the outcomes"
            self._source.warn(name.line, text, "ignored")
        for each in found:
            yield self._schema(name, parts, each, timed=action.head == ":durative-action")

    def _schema(self, name: Word, parts: Mapping[str, Expression], effect: Expression, *, timed: bool) -> Schema:
        scope = Scope(self._source, self._declared)
        names = (each for part in (":parameters", ":vars") if part in parts for each in parts[part].parts)
        schema = Schema(str(name), str(name), scope.declare(names), scope.truth(name.line), (), (), name.line)
        if timed:
            if ":duration" in parts:
                scope.fix_duration(fixed_duration(parts[":duration"]))
            condition = parts.get(":condition", Expression((), name.line, name.line))
            conditions = {time: self._timed_condition(condition, scope, time) for time in (START, OVER, END)}
            ends = Junction(True, (conditions[OVER], conditions[END]), condition.line)
            effects: list[list[Effect]] = []
            for time in (START, END):
                effects.append([*self._effects(effect, scope, (), scope.truth(effect.line), time)])
                self._check_assigned(conditions[START])
            return untimed_schema(self._source, schema, self._derived, (conditions[START], ends), effects)
        precondition = scope.formula(parts[":precondition"]) if ":precondition" in parts else schema.precondition
        found = [*self._effects(effect, scope, (), scope.truth(effect.line))]
        self._check_assigned(precondition)
        return replace(
            schema,
            precondition=precondition,
            effects=tuple(each for each in found if isinstance(each, SchemaEffect)),
            numeric=tuple(each for each in found if isinstance(each, NumericEffect)),
        )

    def _parts(self, action: Expression) -> dict[str, Expression]:
        found: dict[str, Expression] = {}
        words = iter(action.parts[2:])
        for word in words:
            if not isinstance(word, Word) or word not in PARTS[action.head]:
                head = word if isinstance(word, Word) else word.head
                self._source.refuse(word.line, unsupported(head) if head in UNSUPPORTED else unexpected(head or "("))
            if word in found:
                self._source.refuse(word.line, f"a second {word} of this action; merge them into one")
            value = next(words, None)
            if not isinstance(value, Expression):
                line = value.line if value else action.end
                self._source.refuse(line, f"{word} has no value; write (...) after it, or remove it")
            found[str(word)] = value
        return found

    def _timed_condition(self, tree: Expression, scope: Scope, time: tuple[str, str]) -> Formula:
        """Return the part of a durative action's condition that has a given time specifier."""
        if tree.head == "and" or not tree.parts:
            parts = (self._source.list_of([each], tree.line) for each in tree.rest)
            return Junction(True, tuple(self._timed_condition(each, scope, time) for each in parts), tree.line)
        if tree.head == "forall" and len(tree.rest) == 2:
            inner = scope.within()
            variables = inner.declare(self._source.list_of(tree.rest, tree.line).parts)
            part = self._timed_condition(self._source.list_of(tree.rest[1:], tree.line), inner, time)
            return Quantified(True, variables, part, tree.line)
        if time_of(tree) is None:
            text = (
                f"{str(tree.head) or '('!r} is not expected here; write (at start ...), (over all ...) or (at end ...)"
            )
            self._source.refuse(tree.line, text)
        if time_of(tree) != time:
            return scope.truth(tree.line)
        return scope.formula(self._source.list_of(tree.rest[1:], tree.line))

    def _effects(
        self,
        tree: Expression,
        scope: Scope,
        outer: tuple[Variable, ...],
        condition: Formula,
        time: tuple[str, str] | None = None,
    ) -> Iterator[Effect]:
        """Yield the effects in a list, under the quantified variables `outer` and a `condition`.

        In a durative action, yield only the effects at the given time.
        """
        head, rest, line = tree.head, tree.rest, tree.line
        if not tree.parts:
            return
        if head == "and":
            for each in rest:
                yield from self._effects(self._source.list_of([each], line), scope, outer, condition, time)
        elif head == "forall":
            inner = scope.within()
            more = inner.declare(self._source.list_of(rest, line).parts)
            part = self._source.list_of(rest[1:], line)
            yield from self._effects(part, inner, (*outer, *more), condition, time)
        elif head == "when":
            guard, part = self._source.list_of(rest, line), self._source.list_of(rest[1:], line)
            yield from self._conditional(guard, part, scope, outer, condition, time)
        elif time and time_of(tree):
            if time_of(tree) == time:
                self._refuse_times_in(tree)
                yield from self._effects(self._source.list_of(rest[1:], line), scope, outer, condition)
        elif head in ASSIGNMENTS and len(rest) == 2 and head not in self._declared.predicates:
            yield from self._change(tree, scope, outer, condition, time)
        elif time:
            self._source.refuse(
                line, f"{str(head) or '('!r} is not expected here; write (at start ...) or (at end ...)"
            )
        else:
            atom = self._source.list_of(rest, line) if head == "not" else tree
            if atom.head == "=":
                self._source.refuse(line, "an effect cannot make two terms equal; remove it")
            found = scope.atom(atom)
            condition = Junction(True, (condition, *found.terms.values), line) if found.terms.new else condition
            literal = Literal(found.predicate, found.terms.terms, head != "not", found.line)
            yield SchemaEffect((*outer, *found.terms.new), condition, literal)

    def _change(
        self,
        tree: Expression,
        scope: Scope,
        outer: tuple[Variable, ...],
        condition: Formula,
        time: tuple[str, str] | None,
    ) -> Iterator[Effect]:
        """Yield the effects that change a function; a numeric change without a time specifier applies at the end."""
        target, value = tree.rest
        if scope.is_object_function(target):
            if time or tree.head != "assign":
                text = f"{tree.head} changes no function of objects here"
                self._source.refuse(tree.line, f"{text}; write (at start (assign ...)) or (assign ...)")
            yield from self._assignment(tree, scope, outer, condition)
        elif time != START:
            function, number = scope.function_term(target), scope.quantity(value)
            yield NumericEffect(outer, condition, str(tree.head), function, number, tree.line)

    def _assignment(
        self, tree: Expression, scope: Scope, outer: tuple[Variable, ...], condition: Formula
    ) -> Iterator[SchemaEffect]:
        """Yield the effects that give an object function a different value, or no value."""
        target, value = self._source.list_of(tree.rest, tree.line), tree.rest[1]
        function = scope.function_value(target)
        if any(variable not in function.terms.terms for variable in outer):
            text = f"a 'forall' changes {target.head} several times"
            self._source.refuse(tree.line, f"{text}; name its variables in the function")
        self._assigned.append((function, tree.line))
        guard = Junction(True, (condition, *function.terms.values), tree.line)
        old = scope.new_variable(function.types)
        yield SchemaEffect((*outer, *function.terms.new, old), guard, function.literal(old, positive=False))
        if value != UNDEFINED or UNDEFINED in self._declared.objects:
            new = scope.terms([value])
            scope.check_value(function, new.terms[0])
            guard = Junction(True, (guard, *new.values), tree.line)
            yield SchemaEffect((*outer, *function.terms.new, *new.new), guard, function.literal(new.terms[0]))

    def _check_assigned(self, precondition: Formula) -> None:
        """Check that no object function gets two values at once, and reset the recorded changes."""
        for (one, _), (other, line) in combinations(self._assigned, 2):
            if one.predicate == other.predicate and not certainly_unlike(
                one.terms.terms, other.terms.terms, precondition
            ):
                text = f"{one.predicate} may get two values at once"
                self._source.refuse(line, f"{text}; join both changes, or require their objects to differ")
        self._assigned.clear()

    def _conditional(
        self,
        guard: Expression,
        part: Expression,
        scope: Scope,
        outer: tuple[Variable, ...],
        condition: Formula,
        time: tuple[str, str] | None,
    ) -> Iterator[Effect]:
        """Yield the effects of a ``when``, under the conjunction of its condition and the enclosing conditions."""
        if time is None:
            both = (condition, scope.formula(guard))
            yield from self._effects(part, scope, outer, Junction(True, both, guard.line))
            return
        read = {each: self._timed_condition(guard, scope, each) for each in (START, OVER, END)}
        if time == START:
            own = Junction(True, (condition, read[START]), guard.line)
        else:
            early = EarlyCondition(True, (read[START],), guard.line)
            own = Junction(True, (condition, early, read[OVER], read[END]), guard.line)
        effects = [*self._effects(part, scope, outer, own, time)]
        if time == START and effects and (has_parts(read[OVER]) or has_parts(read[END])):
            text = "an effect at the start has a condition over all or at the end, which is only known later"
            self._source.refuse(
                guard.line, f"{text}; write (at start ...) in the condition, or (at end ...) in the effect"
            )
        yield from effects

    def _refuse_times_in(self, tree: Expression) -> None:
        """Refuse an effect with a time specifier that has another one inside."""
        waiting = [*tree.parts[2:]]
        while waiting:
            each = waiting.pop()
            if not isinstance(each, Expression):
                continue
            if time_of(each):
                inner, outer = (" ".join(map(str, one.parts[:2])) for one in (each, tree))
                text = f"({inner} ...) is not expected inside ({outer} ...)"
                self._source.refuse(
                    each.line, f"{text}; give the effect one time, as in (when (at start ...) ({outer} ...))"
                )
            waiting += each.parts


def fixed_duration(tree: Expression) -> Expression | Word | None:
    """Return the value that a duration must equal, or None if it may have several values."""
    part = tree.parts[0] if len(tree.parts) == 1 else tree
    if isinstance(part, Expression) and part.head == "and" and len(part.rest) == 1:
        part = part.rest[0]
    if isinstance(part, Expression) and time_of(part):
        part = part.rest[1]
    equal = isinstance(part, Expression) and part.head == "=" and len(part.rest) == 2
    if not equal or part.rest[0] != DURATION or DURATION in [*words_of(part.rest[1])]:  # type: ignore[union-attr]
        return None
    return part.rest[1]  # type: ignore[union-attr]


def time_of(tree: Expression) -> tuple[str, str] | None:
    """Return the time specifier of a part of a durative action, if it has one."""
    words = tree.parts[:2]
    if len(tree.parts) == 3 and all(isinstance(each, Word) for each in words) and isinstance(tree.parts[2], Expression):
        return next((each for each in (START, END, OVER) if each == tuple(map(str, words))), None)
    return None


def has_parts(formula: Formula) -> bool:
    """Return whether a formula contains anything but conjunctions and quantifiers."""
    if isinstance(formula, Junction):
        return not formula.every or any(map(has_parts, formula.parts))
    return not isinstance(formula, Quantified) or has_parts(formula.part)
