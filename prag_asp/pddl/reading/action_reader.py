"""Read the actions of a PDDL domain: conditions and effects, nested at will, and durative actions without time."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

from prag_asp.pddl.definitions import NumericEffect, Schema, SchemaEffect
from prag_asp.pddl.formulas import Formula, Junction, Quantified, Variable
from prag_asp.pddl.reading.scopes import Declared, PddlSource, Scope
from prag_asp.pddl.reading.untimed import untimed_schema
from prag_asp.pddl.syntax.expressions import Expression, Word
from prag_asp.pddl.syntax.sections import UNSUPPORTED, unexpected, unsupported

ASSIGNMENTS = ("increase", "decrease", "assign", "scale-up", "scale-down")
PARTS: Mapping[str, tuple[str, ...]] = {
    ":action": (":parameters", ":precondition", ":effect"),
    ":durative-action": (":parameters", ":duration", ":condition", ":effect"),
}
"""The parts of an action, each at most once and in any order."""

START, END, OVER = ("at", "start"), ("at", "end"), ("over", "all")

Effect = SchemaEffect | NumericEffect


class ActionReader:
    """Reads the actions of a domain; durative actions are instantaneous if `untimed`, and refused otherwise."""

    def __init__(self, source: PddlSource, declared: Declared, derived: frozenset[str], *, untimed: bool) -> None:
        self._source = source
        self._declared = declared
        self._derived = derived
        self._untimed = untimed

    def schema(self, action: Expression) -> Schema:
        """Return an action."""
        if action.head == ":durative-action" and not self._untimed:
            hint = "give --untimed to import it as an instantaneous action"
            self._source.refuse(action.line, f"{action.head}: actions that take time cannot be imported; {hint}")
        if len(action.parts) < 2:
            self._source.refuse(action.line, f"this {action.head} has no name; write one")
        name = self._source.name_of(action.parts[1])
        parts = self._parts(action)
        scope = Scope(self._source, self._declared)
        parameters = scope.declare(parts[":parameters"].parts if ":parameters" in parts else ())
        schema = Schema(str(name), str(name), parameters, scope.truth(name.line), (), (), name.line)
        effect = parts.get(":effect", Expression((), name.line, name.line))
        if action.head == ":durative-action":
            condition = parts.get(":condition", Expression((), name.line, name.line))
            conditions = {time: self._timed_condition(condition, scope, time) for time in (START, OVER, END)}
            ends = Junction(True, (conditions[OVER], conditions[END]), condition.line)
            effects = [[*self._effects(effect, scope, (), scope.truth(effect.line), time)] for time in (START, END)]
            return untimed_schema(self._source, schema, self._derived, (conditions[START], ends), effects)
        found = [*self._effects(effect, scope, (), scope.truth(effect.line))]
        return replace(
            schema,
            precondition=scope.formula(parts[":precondition"]) if ":precondition" in parts else schema.precondition,
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
        """Return the part of a durative action's condition that belongs to a time."""
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
        """Yield the effects of a list, below the quantified variables `outer` and a `condition`.

        In a durative action, yield those of a time.
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
                yield from self._effects(self._source.list_of(rest[1:], line), scope, outer, condition)
        elif head in ASSIGNMENTS and len(rest) == 2 and head not in self._declared.predicates:
            if time != START:
                function, value = scope.function_term(rest[0]), scope.quantity(rest[1])
                yield NumericEffect(outer, condition, str(head), function, value, line)
        elif time:
            self._source.refuse(
                line, f"{str(head) or '('!r} is not expected here; write (at start ...) or (at end ...)"
            )
        else:
            atom = self._source.list_of(rest, line) if head == "not" else tree
            if atom.head == "=":
                self._source.refuse(line, "an effect cannot make two terms equal; remove it")
            yield SchemaEffect(outer, condition, scope.literal(atom, positive=head != "not"))

    def _conditional(
        self,
        guard: Expression,
        part: Expression,
        scope: Scope,
        outer: tuple[Variable, ...],
        condition: Formula,
        time: tuple[str, str] | None,
    ) -> Iterator[Effect]:
        """Yield the effects of a ``when``: its condition and those around it hold together."""
        if time is None:
            both = (condition, scope.formula(guard))
            yield from self._effects(part, scope, outer, Junction(True, both, guard.line))
            return
        both = (condition, self._timed_condition(guard, scope, time))
        effects = [*self._effects(part, scope, outer, Junction(True, both, guard.line), time)]
        others = (self._timed_condition(guard, scope, each) for each in (START, OVER, END) if each != time)
        if effects and any(has_parts(each) for each in others):
            text = "the condition and the effect of this 'when' belong to different times"
            self._source.refuse(guard.line, f"{text}; give both one time")
        yield from effects


def time_of(tree: Expression) -> tuple[str, str] | None:
    """Return the time that a part of a durative action names."""
    words = tree.parts[:2]
    if len(tree.parts) == 3 and all(isinstance(each, Word) for each in words) and isinstance(tree.parts[2], Expression):
        return next((each for each in (START, END, OVER) if each == tuple(map(str, words))), None)
    return None


def has_parts(formula: Formula) -> bool:
    """Return whether a formula is more than conjunctions and quantifiers of nothing."""
    if isinstance(formula, Junction):
        return not formula.every or any(map(has_parts, formula.parts))
    return not isinstance(formula, Quantified) or has_parts(formula.part)
