"""The user rules of a step, relaxed to rules of the part `reachable` that derive all that the user rules may derive.

Each rule loses its time and its negated literals. It reads reachable actions and reachable values of fluents (see
``encodings/reachable.lp``). By induction over the steps, a user rule sets no fluent to an unreachable value, because
everything that it reads is reachable.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Iterator, Sequence
from typing import NamedTuple

import clingo
from clingo.ast import AST, ASTType, ComparisonOperator

from prag_asp.program.atom_arrays import ground_atoms
from prag_asp.program.predicates import (
    CHANGED,
    FINDING,
    HOLDS,
    IMPOSSIBLE,
    JOINT_UNIT,
    MEMORY,
    MENTIONS,
    NAME,
    NEXT_UNIT,
    OCCURS,
    PRUNED,
    REQUEST,
    SUCCESSOR,
)
from prag_asp.program.syntax import VARIABLE, AtomNode, Signature, Statement, atoms, names, plain_atom, variables
from prag_asp.pruning.rejected_actions import STATE_PREDICATES

BOOLEAN = ("true", "false")
BOTH = "(true;false)"
COMPUTED = re.compile(r'[-+*/\\&?^~|."]')
"""The characters that mark terms which bind no variable."""

RELAXED, STRAY = "_may_own_", "_may_stray"
"""The prefix of relaxed user predicates, and the atom that holds if a rule may assign a value to a non-fluent."""

ADDED_LATER: frozenset[Signature] = frozenset(
    [NAME, MENTIONS, SUCCESSOR, JOINT_UNIT, NEXT_UNIT, PRUNED, REQUEST, MEMORY, FINDING, IMPOSSIBLE]
)
"""Predicates of the base part to which the library adds facts after a domain is checked."""


class FluentSetter(NamedTuple):
    """A user rule of a step, and one of its heads, which sets the value of a fluent or leaves it open."""

    rule: Statement
    head: AtomNode


def fluent_setters(steps: Sequence[Statement]) -> list[FluentSetter]:
    """Return the step rules that set fluents, except rules for `changed` whose fluent is always set by other rules.

    The fluent of a rule for `changed` is always set if some rule makes it false whose body contains only literals of
    the rule for `changed` and negations `not L`, where L is the whole body of a rule that makes the fluent true.
    """
    setting: dict[str, list[tuple[Statement, str, frozenset[str]]]] = {value: [] for value in BOOLEAN}
    for each in steps:
        for atom in _derived(each) if each.node.head.ast_type == ASTType.Literal and '"' not in each.text else ():
            if atom.signature == HOLDS and atom.arguments[1] in BOOLEAN:
                setting[atom.arguments[1]].append((each, *renamed_literals(atom.arguments[0], each)))

    def is_set(rule: Statement, head: AtomNode) -> bool:
        fluent, literals = renamed_literals(head.arguments[0], rule)
        true, false = (
            [texts for each, term, texts in setting[value] if term == fluent and each.parameters == rule.parameters]
            for value in BOOLEAN
        )
        unless = {f"not {text}" for texts in true if len(texts) == 1 for text in texts}
        return any(texts <= literals | unless for texts in false)

    return [
        FluentSetter(each, atom)
        for each in steps
        for atom in _derived(each)
        if atom.signature in STATE_PREDICATES and not (atom.signature == CHANGED and is_set(each, atom))
    ]


def _derived(rule: Statement) -> Iterator[AtomNode]:
    """Yield the atoms that a rule derives; a head with ``not`` derives no atom."""
    return (atom for atom in rule.heads if not atom.negated)


def renamed_literals(term: str, rule: Statement) -> tuple[str, frozenset[str]]:
    """Return a term and the literals of a rule, with variables renamed in order of first occurrence."""
    renaming: dict[str, str] = {}
    renamed = [
        VARIABLE.sub(lambda name: renaming.setdefault(name[0], f"V{len(renaming)}"), text)
        for text in (term, *(text for _, text in rule.literals))
    ]
    return renamed[0], frozenset(renamed[1:])


class RelaxedRules:
    """The translation of the user rules of a step into rules of the part `reachable`.

    The rules also derive the user predicates that they read. Bodies omit user predicates of a step that cannot be
    relaxed, and predicates of the base part that depend on choices, so that the rules derive more.
    """

    def __init__(self, control: clingo.Control, statements: Sequence[Statement], steps: Sequence[Statement]) -> None:
        rules = [each for each in statements if each.is_rule]
        self._control = control
        self._certain: dict[tuple[str, int], bool] = {}
        self._base = {atom.signature for each in rules if not each.timed for atom in each.heads}
        self._timed = {atom.signature for each in rules if each.timed for atom in each.heads}
        self._later = _following(ADDED_LATER, [each for each in rules if not each.timed])
        declared = {(each.node.name, each.node.arity) for each in statements if each.kind == ASTType.Defined}
        self._void = declared - self._later - self._base - self._timed
        heads = ((atom, each) for each in steps for atom in _derived(each))
        self._heads = [(atom, each) for atom, each in heads if atom.signature not in STATE_PREDICATES]
        signatures_read = {atom.signature for each in steps for atom in each.body}
        changing = [FluentSetter(each, atom) for each in steps for atom in _derived(each) if atom.signature == CHANGED]
        self._changing = changing if CHANGED in signatures_read else []
        self._infers = bool(changing)
        self._reads_states = not signatures_read.isdisjoint(STATE_PREDICATES)
        self._written = {atom.signature for atom, _ in self._heads}
        unlike = self._later | {each for each in self._base if each[0].startswith("-")}
        omitted = {each for atom, rule in self._heads if (each := atom.signature) in unlike or self._grows(atom, rule)}
        omitted = omitted or {("", 0)}
        while omitted:
            self._written -= omitted
            self._heads = [each for each in self._heads if each[0].signature in self._written]
            omitted = {  # the relaxed body must bind all variables of the head
                atom.signature
                for atom, rule in self._heads
                if not (self._is_plain(atom, rule) and _variables(atom.arguments[:-1]) <= _variables(self._body(rule)))
            }

    def rules(self, setters: Sequence[FluentSetter]) -> Iterator[str]:
        """Yield rules for `STRAY`, and for ``_may_set(N,F,V)``: the N-th setter may set F to V."""
        predicates = self._read_by(each.rule for each in (*setters, *self._changing))
        for name, arity in sorted(predicates & self._base):
            rows = ground_atoms(self._control, name, arity)
            yield from dict.fromkeys(f"{_applied(name, [*map(str, arguments[:-1])])}." for arguments, _, _ in rows)
        for atom, rule in self._heads:
            if atom.signature in predicates:
                yield f"{_applied(atom.name, atom.arguments[:-1])} :- {', '.join(self._body(rule)) or '#true'}."
        if self._infers:  # a fluent declared to change may take a value that the invariants infer
            yield "_may_hold(G,W) :- _may_hold(F,V), _propagates(F,V,G,W)."
        for number, (rule, head) in enumerate(setters):
            # the declared fluents that the head may set, with their possible values
            term, value = head.arguments[0], BOTH if head.signature == CHANGED else head.arguments[1]
            body = self._body(rule)
            if COMPUTED.search(term) or not names([term]).isdisjoint(rule.parameters):
                term, value, body = "F", BOTH, []
            elif VARIABLE.fullmatch(value):
                body.append(f"_opposite({value},_)")
            elif value not in BOOLEAN:
                value = BOTH
            yield f"_may_set({number},{term},{value}) :- {', '.join([f'fluent({term})', *body])}."
            if self._reads_states and head.signature != CHANGED:
                yield from self._stray_rules(rule, head)
        for rule, head in self._changing:
            yield from self._stray_rules(rule, head)

    def _read_by(self, rules: Iterable[Statement]) -> set[tuple[str, int]]:
        """Return the relaxed user predicates on which rules depend."""
        predicates: set[tuple[str, int]] = set()
        waiting = list(rules)
        while waiting:
            new = {atom.signature for atom in waiting.pop().body} & self._written - predicates
            predicates |= new
            waiting += [rule for atom, rule in self._heads if atom.signature in new]
        return predicates

    def _grows(self, head: AtomNode, rule: Statement) -> bool:
        """Return whether a rule, regardless of time, may derive ever larger terms from its own heads."""
        atoms_read = (atom for node, text in rule.literals if (atom := _read_atom(node, text)) and not atom.negated)
        counted = not _variables(head.arguments[:-1]) <= _variables(map(str, atoms_read))
        larger = counted or any("(" in term and variables(term) for term in head.arguments[:-1])
        return larger and head.signature in self._read_by([rule])

    def _stray_rules(self, rule: Statement, head: AtomNode) -> Iterator[str]:
        """Yield rules that derive `STRAY` if a head sets a non-fluent, or sets a value other than true or false."""
        term, value, body = head.arguments[0], head.arguments[1], self._body(rule)
        bound = _variables(body)
        tests = [(f"not fluent({term})", term)]
        if head.signature != CHANGED and value not in BOOLEAN:
            tests.append((f"not _opposite({value},_)", value))
        for test, about in tests:
            testable = _is_plain([about], rule) and _variables([about]) <= bound
            yield f"{STRAY} :- {', '.join([*body, *([test] if testable else [])]) or '#true'}."

    def _body(self, rule: Statement) -> list[str]:
        """Return the literals of a rule that can be written without time."""
        literals = [(plain, text) for node, text in rule.literals if (plain := _read_atom(node, text))]
        positive = [atom for atom, _ in literals if not atom.negated]
        elements: Sequence[AST] = getattr(rule.node.head, "elements", ())
        if len(elements) == 1:  # its condition must hold
            inner = elements[0].condition if rule.node.head.ast_type == ASTType.HeadAggregate else elements[0]
            conditions = (_read_atom(literal, str(literal)) for literal in inner.condition)
            positive += (atom for atom in conditions if atom and not atom.negated)
        body = [text for atom in positive if self._is_plain(atom, rule) for text in self._relaxed(atom)]
        bound = _variables(body)
        others = [text for atom, text in literals if text == f"not {atom}" and self._is_fixed(atom)]
        body += [text for text in others if _is_plain([text], rule) and _variables([text]) <= bound]
        waiting = [
            (node, text)
            for node, text in rule.literals
            if node.ast_type == ASTType.Literal and node.atom.ast_type == ASTType.Comparison
            if names([text]).isdisjoint(rule.parameters)
        ]
        while ready := [each for each in waiting if _open_variables(each[0], bound) <= bound]:
            waiting = [each for each in waiting if each not in ready]
            body += [text for _, text in ready]
            bound |= _variables(text for _, text in ready)
        return body

    def _relaxed(self, atom: AtomNode) -> Iterator[str]:
        if atom.signature == OCCURS:
            yield f"_may_occur({atom.arguments[0]})"
        elif atom.signature == CHANGED:
            yield f"fluent({atom.arguments[0]})"
        elif atom.signature in STATE_PREDICATES:
            yield f"_may_hold({atom.arguments[0]},{atom.arguments[1]})"
        elif atom.signature in self._written:
            yield _applied(atom.name, atom.arguments[:-1])
        elif atom.signature in self._void or self._is_fixed(atom):
            yield str(atom)

    def _is_fixed(self, atom: AtomNode) -> bool:
        """Return whether the predicate of an atom is defined by facts of the base part only."""
        signature = atom.signature
        if signature not in self._base - self._later or signature in self._timed or atom.name.startswith("-"):
            return False
        if signature not in self._certain:
            self._certain[signature] = all(is_fact for _, _, is_fact in ground_atoms(self._control, *signature))
        return self._certain[signature]

    def _is_plain(self, atom: AtomNode, rule: Statement) -> bool:
        """Return whether the arguments of an atom, except its time, neither mention time nor compute anything."""
        return _is_plain(atom.arguments[:-1] if atom.signature in self._timed else atom.arguments, rule)


def _following(predicates: Iterable[Signature], rules: Sequence[Statement]) -> frozenset[Signature]:
    """Return predicates and all other predicates that rules derive from them, directly or indirectly."""
    closure = set(predicates)
    while True:
        reading = (each for each in rules if not closure.isdisjoint(atom.signature for atom in each.body))
        new = {atom.signature for each in reading for atom in each.heads} - closure
        if not new:
            return frozenset(closure)
        closure |= new


def _is_plain(texts: Collection[str], rule: Statement) -> bool:
    """Return whether texts neither mention the time of a rule nor compute anything."""
    return names(texts).isdisjoint(rule.parameters) and not any(map(COMPUTED.search, texts))


def _read_atom(literal: AST, text: str) -> AtomNode | None:
    """Return the atom of a literal; a positive literal may have pools in its arguments."""
    plain = plain_atom(literal, text)
    if plain or literal.ast_type != ASTType.Literal or literal.sign or literal.atom.ast_type != ASTType.SymbolicAtom:
        return plain
    candidates = list(atoms(literal, text))
    return candidates[0] if len(candidates) == 1 else None


def _open_variables(comparison: AST, bound: Collection[str]) -> set[str]:
    """Return the variables that must be bound before a comparison; ``X = Y+1`` binds X if Y is bound."""
    first, guards = comparison.atom.term, comparison.atom.guards
    sides = [str(each) for each in (first, *(guard.term for guard in guards))]
    if not comparison.sign and len(guards) == 1 and guards[0].comparison == ComparisonOperator.Equal:
        for variable, other in (sides, sides[::-1]):
            if VARIABLE.fullmatch(variable) and _variables([other]) <= set(bound):
                return set()
    return _variables(sides)


def _applied(name: str, terms: Collection[str]) -> str:
    name = f"{RELAXED}{name.replace('-', 'not_')}"
    return f"{name}({','.join(terms)})" if terms else name


def _variables(texts: Iterable[str]) -> set[str]:
    return {name for text in texts for name in variables(text)}
