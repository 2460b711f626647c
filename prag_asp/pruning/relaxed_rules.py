"""User rules of a step, relaxed: rules of `reachable` that derive whatever those may ever derive.

Each rule loses its time and its negated literals. It reads actions that may occur and values that fluents may have (see
``encodings/reachable.lp``). By induction over the steps, a user rule gives no fluent a value that is not reachable,
because everything that it reads is reachable.
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
"""Characters of terms that bind no variable."""

RELAXED, STRAY = "_may_own_", "_may_stray"
"""The prefix of relaxed user predicates, and the atom that says that a rule may give a value to what is no fluent."""

ADDED_LATER: frozenset[Signature] = frozenset(
    [NAME, MENTIONS, SUCCESSOR, JOINT_UNIT, NEXT_UNIT, PRUNED, REQUEST, MEMORY, FINDING, IMPOSSIBLE]
)
"""Predicates of the base part that the library states more facts of once a domain is checked."""


class FluentSetter(NamedTuple):
    """A user rule of a step, and a head of it that gives a fluent a value or leaves its value open."""

    rule: Statement
    head: AtomNode


def fluent_setters(steps: Sequence[Statement]) -> list[FluentSetter]:
    """Return the rules of a step that set fluents, without rules for `changed` where other rules set the fluent."""
    found = (
        FluentSetter(each, atom) for each in steps for atom in _derived(each) if atom.signature in STATE_PREDICATES
    )
    return [each for each in found if each.head.signature != CHANGED or not _is_set(each, steps)]


def _derived(rule: Statement) -> Iterator[AtomNode]:
    """Yield the atoms that a rule derives; a head with ``not`` before it derives none."""
    return (atom for atom in rule.heads if not atom.negated)


def _is_set(changing: FluentSetter, steps: Iterable[Statement]) -> bool:
    """Return whether other rules set the fluent whenever a rule for `changed` fires.

    One rule makes it false and reads no more literals, except the negation of a single literal by which another rule
    makes it true.
    """
    rule, head = changing
    similar = [each for each in steps if each.parameters == rule.parameters and '"' not in each.text]
    fluent, read = _renamed(head.arguments[0], rule)
    true, false = ([_renamed(term, each) for term, each in _value_rules(similar, value)] for value in BOOLEAN)
    alone = {text for term, texts in true if term == fluent and len(texts) == 1 for text in texts}
    unless = {f"not {text}" for text in alone}
    return any(term == fluent and texts <= read | unless for term, texts in false)


def _value_rules(steps: Iterable[Statement], value: str) -> Iterator[tuple[str, Statement]]:
    """Yield the terms of fluents with the rules that give them a value whenever they fire."""
    for each in steps:
        if each.node.head.ast_type == ASTType.Literal:
            for atom in _derived(each):
                if atom.signature == HOLDS and atom.arguments[1] == value:
                    yield atom.arguments[0], each


def _renamed(term: str, rule: Statement) -> tuple[str, frozenset[str]]:
    """Return a term and the literals of a rule, with variables named by the order of their first occurrence."""
    found: dict[str, str] = {}
    new = [
        VARIABLE.sub(lambda name: found.setdefault(name[0], f"V{len(found)}"), text)
        for text in (term, *(text for _, text in rule.literals))
    ]
    return new[0], frozenset(new[1:])


class RelaxedRules:
    """Writes the user rules of a step as rules of `reachable`: the predicates that they read, and what they may set.

    Rules omit a user predicate of a step that cannot be relaxed, and a predicate of the base part that depends on
    choices. They then derive more.
    """

    def __init__(self, control: clingo.Control, statements: Sequence[Statement], steps: Sequence[Statement]) -> None:
        rules = [each for each in statements if each.is_rule]
        self._control = control
        self._certain: dict[tuple[str, int], bool] = {}
        self._base = {atom.signature for each in rules if not each.timed for atom in each.heads}
        self._timed = {atom.signature for each in rules if each.timed for atom in each.heads}
        self._later = _following(ADDED_LATER, [each for each in rules if not each.timed])
        self._void = _declared(statements) - self._later - self._base - self._timed
        heads = ((atom, each) for each in steps for atom in _derived(each))
        self._heads = [(atom, each) for atom, each in heads if atom.signature not in STATE_PREDICATES]
        read = {atom.signature for each in steps for atom in each.body}
        changing = [FluentSetter(each, atom) for each in steps for atom in _derived(each) if atom.signature == CHANGED]
        self._changing = changing if CHANGED in read else []
        self._infers = bool(changing)
        self._reads_states = not read.isdisjoint(STATE_PREDICATES)
        self._written = {atom.signature for atom, _ in self._heads}
        unlike = self._later | {each for each in self._base if each[0].startswith("-")}
        omitted = {each for atom, rule in self._heads if (each := atom.signature) in unlike or self._grows(atom, rule)}
        omitted = omitted or {("", 0)}
        while omitted:
            self._written -= omitted
            self._heads = [each for each in self._heads if each[0].signature in self._written]
            omitted = {atom.signature for atom, rule in self._heads if not self._is_bound(atom, rule)}

    def rules(self, setters: Sequence[FluentSetter]) -> Iterator[str]:
        """Yield rules for ``_may_set(N,F,V)``, the N-th setter may give F the value V, and for `STRAY`."""
        read = self._read_by(each.rule for each in (*setters, *self._changing))
        for name, arity in sorted(read & self._base):
            found = ground_atoms(self._control, name, arity)
            yield from dict.fromkeys(f"{_applied(name, [*map(str, arguments[:-1])])}." for arguments, _, _ in found)
        for atom, rule in self._heads:
            if atom.signature in read:
                yield f"{_applied(atom.name, atom.arguments[:-1])} :- {', '.join(self._body(rule)) or '#true'}."
        if self._infers:  # what is said to change may become what the invariants infer
            yield "_may_hold(G,W) :- _may_hold(F,V), _propagates(F,V,G,W)."
        for number, (rule, head) in enumerate(setters):
            yield self._set_rule(number, rule, head)
            if self._reads_states and head.signature != CHANGED:
                yield from self._stray_rules(rule, head)
        for rule, head in self._changing:
            yield from self._stray_rules(rule, head)

    def _read_by(self, rules: Iterable[Statement]) -> set[tuple[str, int]]:
        """Return the relaxed user predicates that rules depend on."""
        found: set[tuple[str, int]] = set()
        waiting = list(rules)
        while waiting:
            new = {atom.signature for atom in waiting.pop().body} & self._written - found
            found |= new
            waiting += [rule for atom, rule in self._heads if atom.signature in new]
        return found

    def _grows(self, head: AtomNode, rule: Statement) -> bool:
        """Return whether a rule may derive larger and larger terms from its own heads once it has no time."""
        read = (atom for node, text in rule.literals if (atom := _read_atom(node, text)) and not atom.negated)
        counted = not _variables(head.arguments[:-1]) <= _variables(map(str, read))
        larger = counted or any("(" in term and variables(term) for term in head.arguments[:-1])
        return larger and head.signature in self._read_by([rule])

    def _is_bound(self, head: AtomNode, rule: Statement) -> bool:
        """Return whether the relaxed body binds all variables of a head."""
        return self._is_plain(head, rule) and _variables(head.arguments[:-1]) <= _variables(self._body(rule))

    def _set_rule(self, number: int, rule: Statement, head: AtomNode) -> str:
        """Return the rule for the declared fluents that a head may set, with each value that it may give them."""
        term, value = head.arguments[0], BOTH if head.signature == CHANGED else head.arguments[1]
        body = self._body(rule)
        if COMPUTED.search(term) or not names([term]).isdisjoint(rule.parameters):
            term, value, body = "F", BOTH, []
        elif VARIABLE.fullmatch(value):
            body.append(f"_opposite({value},_)")
        elif value not in BOOLEAN:
            value = BOTH
        return f"_may_set({number},{term},{value}) :- {', '.join([f'fluent({term})', *body])}."

    def _stray_rules(self, rule: Statement, head: AtomNode) -> Iterator[str]:
        """Yield rules for `STRAY`: a head gives a value to what is no fluent, or gives what is no value."""
        term, value, body = head.arguments[0], head.arguments[1], self._body(rule)
        bound = _variables(body)
        tests = [(f"not fluent({term})", term)]
        if head.signature != CHANGED and value not in BOOLEAN:
            tests.append((f"not _opposite({value},_)", value))
        for test, about in tests:
            testable = _is_plain([about], rule) and _variables([about]) <= bound
            yield f"{STRAY} :- {', '.join([*body, *([test] if testable else [])]) or '#true'}."

    def _body(self, rule: Statement) -> list[str]:
        """Return the literals that a rule needs to fire, as far as they can be written without time."""
        read = [(plain, text) for node, text in rule.literals if (plain := _read_atom(node, text))]
        positive = [atom for atom, _ in read if not atom.negated]
        positive += (atom for atom in _own_conditions(rule.node.head) if not atom.negated)
        found = [text for atom in positive if self._is_plain(atom, rule) for text in self._relaxed(atom)]
        bound = _variables(found)
        others = [text for atom, text in read if text == f"not {atom}" and self._is_fixed(atom)]
        found += [text for text in others if _is_plain([text], rule) and _variables([text]) <= bound]
        waiting = [(node, text) for node, text in rule.literals if _compares(node)]
        waiting = [each for each in waiting if names([each[1]]).isdisjoint(rule.parameters)]
        while ready := [each for each in waiting if _open_variables(each[0], bound) <= bound]:
            waiting = [each for each in waiting if each not in ready]
            found += [text for _, text in ready]
            bound |= _variables(text for _, text in ready)
        return found

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
        """Return whether facts of the base part alone decide an atom."""
        signature = atom.signature
        if signature not in self._base - self._later or signature in self._timed or atom.name.startswith("-"):
            return False
        if signature not in self._certain:
            self._certain[signature] = all(is_fact for _, _, is_fact in ground_atoms(self._control, *signature))
        return self._certain[signature]

    def _is_plain(self, atom: AtomNode, rule: Statement) -> bool:
        """Return whether the arguments of an atom, but for its time, mention no time and compute nothing."""
        return _is_plain(atom.arguments[:-1] if atom.signature in self._timed else atom.arguments, rule)


def _following(predicates: Iterable[Signature], rules: Sequence[Statement]) -> frozenset[Signature]:
    """Return predicates with all others that rules derive from them, directly or indirectly."""
    found = set(predicates)
    while True:
        reading = (each for each in rules if not found.isdisjoint(atom.signature for atom in each.body))
        new = {atom.signature for each in reading for atom in each.heads} - found
        if not new:
            return frozenset(found)
        found |= new


def _declared(statements: Iterable[Statement]) -> set[tuple[str, int]]:
    """Return the predicates of ``#defined`` statements."""
    found = (each.node for each in statements if each.kind == ASTType.Defined)
    return {(node.name, node.arity) for node in found}


def _is_plain(texts: Collection[str], rule: Statement) -> bool:
    """Return whether texts do not mention the time of a rule and compute nothing."""
    return names(texts).isdisjoint(rule.parameters) and not any(map(COMPUTED.search, texts))


def _read_atom(literal: AST, text: str) -> AtomNode | None:
    """Return the atom of a literal; one that is not negated may have pools in its arguments."""
    plain = plain_atom(literal, text)
    if plain or literal.ast_type != ASTType.Literal or literal.sign or literal.atom.ast_type != ASTType.SymbolicAtom:
        return plain
    found = list(atoms(literal, text))
    return found[0] if len(found) == 1 else None


def _own_conditions(head: AST) -> Iterator[AtomNode]:
    """Yield the atoms of the condition of a head with a single element."""
    elements: Sequence[AST] = getattr(head, "elements", ())
    if len(elements) == 1:
        element = elements[0].condition if head.ast_type == ASTType.HeadAggregate else elements[0]
        for literal in element.condition:
            atom = _read_atom(literal, str(literal))
            if atom:
                yield atom


def _compares(literal: AST) -> bool:
    return literal.ast_type == ASTType.Literal and literal.atom.ast_type == ASTType.Comparison


def _open_variables(comparison: AST, bound: Collection[str]) -> set[str]:
    """Return the variables that a comparison does not bind: ``X = Y+1`` binds X where Y is bound."""
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
