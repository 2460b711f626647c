"""Own rules of a step, relaxed: as rules of `reachable`, which derive what those may ever derive.

Each loses its time and what is negated. Occurrences are those of actions that may occur, and what is read of a state is
what may hold (see ``encodings/reachable.lp``). By induction over the steps, an own rule gives no fluent a value that is
not found: what it reads is found before.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Iterator, Sequence
from typing import NamedTuple

import clingo
from clingo.ast import AST, ASTType, ComparisonOperator

from prag_asp.lint.occurrence import CHANGED, STATE_PREDICATES
from prag_asp.program.atom_arrays import ground_atoms
from prag_asp.program.syntax import VARIABLE, AtomNode, Signature, Statement, atoms, names, plain_atom, variables

OCCURS, HOLDS = ("occurs", 2), ("holds", 3)
BOOLEAN = ("true", "false")
BOTH = "(true;false)"
COMPUTED = re.compile(r'[-+*/\\&?^~|."]')
"""What stands in terms that bind no variable."""

PREFIX = "_may_"
"""What the names of the linter's own predicates begin with."""

RELAXED, STRAY = f"{PREFIX}own_", f"{PREFIX}stray"
"""What the names of own predicates of a step begin with where they are relaxed; and what says that some rule may give a
value to what is no fluent."""

ADDED_LATER = frozenset(
    [("name", 2), ("mentions", 3), ("successor", 2), ("joint_unit", 2), ("next_unit", 2), ("left_out", 1),
     ("asked", 1), ("condition", 2), ("tested", 2), ("impossible", 2)]
)  # fmt: skip
"""Predicates of the base part of which the library states more once a domain is checked."""


class Maker(NamedTuple):
    """An own rule of a step, and a head of it that gives a fluent a value, or leaves its value open."""

    rule: Statement
    head: AtomNode


def makers_of(steps: Sequence[Statement]) -> list[Maker]:
    """Return the rules of a step that set fluents: not those that say of one that it changes, where others set it."""
    found = (Maker(each, atom) for each in steps for atom in _derived(each) if atom.signature in STATE_PREDICATES)
    return [each for each in found if each.head.signature != CHANGED or not _is_set(each, steps)]


def _derived(rule: Statement) -> Iterator[AtomNode]:
    """Yield the atoms that a rule derives: with ``not`` before its head, it derives none."""
    return (atom for atom in rule.heads if not atom.negated)


def _is_set(changing: Maker, steps: Iterable[Statement]) -> bool:
    """Return whether what a rule says to be changed is set by other rules whenever it fires.

    A rule makes it false that reads no more, unless what another rule makes it true by, and by nothing else, is so.
    """
    rule, head = changing
    like = [each for each in steps if each.parameters == rule.parameters and '"' not in each.text]
    fluent, read = _renamed(head.arguments[0], rule)
    true, false = ([_renamed(term, each) for term, each in _setting(like, value)] for value in BOOLEAN)
    alone = {text for term, texts in true if term == fluent and len(texts) == 1 for text in texts}
    unless = {f"not {text}" for text in alone}
    return any(term == fluent and texts <= read | unless for term, texts in false)


def _setting(steps: Iterable[Statement], value: str) -> Iterator[tuple[str, Statement]]:
    """Yield the rules that give a fluent a value whenever they fire, each after the term of the fluent."""
    for each in steps:
        if each.node.head.ast_type == ASTType.Literal:
            for atom in _derived(each):
                if atom.signature == HOLDS and atom.arguments[1] == value:
                    yield atom.arguments[0], each


def _renamed(term: str, rule: Statement) -> tuple[str, frozenset[str]]:
    """Return a term and the literals of a rule, the variables called by the order in which they come."""
    found: dict[str, str] = {}
    new = [
        VARIABLE.sub(lambda name: found.setdefault(name[0], f"V{len(found)}"), text)
        for text in (term, *(text for _, text in rule.literals))
    ]
    return new[0], frozenset(new[1:])


class Relaxed:
    """Writes the rules of a step of a domain as rules of `reachable`: what is read, and what each maker may set.

    An own predicate of a step that cannot be written is left out of what reads it, which then derives more; so is a
    predicate of the base part that depends on choices.
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
        changing = [Maker(each, atom) for each in steps for atom in _derived(each) if atom.signature == CHANGED]
        self._changing = changing if CHANGED in read else []
        self._infers = bool(changing)
        self._reads_states = not read.isdisjoint(STATE_PREDICATES)
        self._written = {atom.signature for atom, _ in self._heads}
        unlike = self._later | {each for each in self._base if each[0].startswith("-")}
        left_out = {each for atom, rule in self._heads if (each := atom.signature) in unlike or self._grows(atom, rule)}
        left_out = left_out or {("", 0)}
        while left_out:
            self._written -= left_out
            self._heads = [each for each in self._heads if each[0].signature in self._written]
            left_out = {atom.signature for atom, rule in self._heads if not self._is_bound(atom, rule)}

    def rules(self, makers: Sequence[Maker]) -> Iterator[str]:
        """Yield rules for ``_may_set(N,F,V)``: the N-th maker may give F the value V; and for `STRAY`."""
        read = self._read_by(each.rule for each in (*makers, *self._changing))
        for name, arity in sorted(read & self._base):
            found = ground_atoms(self._control, name, arity)
            yield from dict.fromkeys(f"{_applied(name, [*map(str, arguments[:-1])])}." for arguments, _, _ in found)
        for atom, rule in self._heads:
            if atom.signature in read:
                yield f"{_applied(atom.name, atom.arguments[:-1])} :- {', '.join(self._body(rule)) or '#true'}."
        if self._infers:  # what is said to change may become what the invariants infer
            yield "may_hold(G,W) :- may_hold(F,V), propagates(F,V,G,W)."
        for number, (rule, head) in enumerate(makers):
            yield self._setting(number, rule, head)
            if self._reads_states and head.signature != CHANGED:
                yield from self._straying(rule, head)
        for rule, head in self._changing:
            yield from self._straying(rule, head)

    def _read_by(self, rules: Iterable[Statement]) -> set[tuple[str, int]]:
        """Return the own predicates that rules depend on, of those that are written."""
        found: set[tuple[str, int]] = set()
        waiting = list(rules)
        while waiting:
            new = {atom.signature for atom in waiting.pop().body} & self._written - found
            found |= new
            waiting += [rule for atom, rule in self._heads if atom.signature in new]
        return found

    def _grows(self, head: AtomNode, rule: Statement) -> bool:
        """Return whether a rule may make larger terms of what it depends on, without end once time does not end it."""
        read = (atom for node, text in rule.literals if (atom := _read_atom(node, text)) and not atom.negated)
        counted = not _variables(head.arguments[:-1]) <= _variables(map(str, read))
        larger = counted or any("(" in term and variables(term) for term in head.arguments[:-1])
        return larger and head.signature in self._read_by([rule])

    def _is_bound(self, head: AtomNode, rule: Statement) -> bool:
        """Return whether a head can be written: the body, as it is written, has all its variables."""
        return self._is_plain(head, rule) and _variables(head.arguments[:-1]) <= _variables(self._body(rule))

    def _setting(self, number: int, rule: Statement, head: AtomNode) -> str:
        """Return the rule for what a head may set: fluents that are declared, each with each value that it may have."""
        term, value = head.arguments[0], BOTH if head.signature == CHANGED else head.arguments[1]
        body = self._body(rule)
        if COMPUTED.search(term) or not names([term]).isdisjoint(rule.parameters):
            term, value, body = "F", BOTH, []
        elif VARIABLE.fullmatch(value):
            body.append(f"opposite({value},_)")
        elif value not in BOOLEAN:
            value = BOTH
        return f"_may_set({number},{term},{value}) :- {', '.join([f'fluent({term})', *body])}."

    def _straying(self, rule: Statement, head: AtomNode) -> Iterator[str]:
        """Yield rules for ``_may_stray``: a head gives a value to what is no fluent, or gives one that is no value."""
        term, value, body = head.arguments[0], head.arguments[1], self._body(rule)
        bound = _variables(body)
        tests = [(f"not fluent({term})", term)]
        if head.signature != CHANGED and value not in BOOLEAN:
            tests.append((f"not opposite({value},_)", value))
        for test, about in tests:
            told = _is_plain([about], rule) and _variables([about]) <= bound
            yield f"{STRAY} :- {', '.join([*body, *([test] if told else [])]) or '#true'}."

    def _body(self, rule: Statement) -> list[str]:
        """Return what has to be so for a rule to fire, as far as it can be said without time."""
        read = [(plain, text) for node, text in rule.literals if (plain := _read_atom(node, text))]
        positive = [atom for atom, _ in read if not atom.negated]
        positive += (atom for atom in _own_conditions(rule.node.head) if not atom.negated)
        found = [text for atom in positive if self._is_plain(atom, rule) for text in self._said(atom)]
        bound = _variables(found)
        others = [text for atom, text in read if text == f"not {atom}" and self._is_fixed(atom)]
        found += [text for text in others if _is_plain([text], rule) and _variables([text]) <= bound]
        waiting = [(node, text) for node, text in rule.literals if _compares(node)]
        waiting = [each for each in waiting if names([each[1]]).isdisjoint(rule.parameters)]
        while said := [each for each in waiting if _open_variables(each[0], bound) <= bound]:
            waiting = [each for each in waiting if each not in said]
            found += [text for _, text in said]
            bound |= _variables(text for _, text in said)
        return found

    def _said(self, atom: AtomNode) -> Iterator[str]:
        if atom.signature == OCCURS:
            yield f"may_occur({atom.arguments[0]})"
        elif atom.signature == CHANGED:
            yield f"fluent({atom.arguments[0]})"
        elif atom.signature in STATE_PREDICATES:
            yield f"may_hold({atom.arguments[0]},{atom.arguments[1]})"
        elif atom.signature in self._written:
            yield _applied(atom.name, atom.arguments[:-1])
        elif atom.signature in self._void or self._is_fixed(atom):
            yield str(atom)

    def _is_fixed(self, atom: AtomNode) -> bool:
        """Return whether the base part alone says of an atom whether it holds, and says it by facts."""
        signature = atom.signature
        if signature not in self._base - self._later or signature in self._timed or atom.name.startswith("-"):
            return False
        if signature not in self._certain:
            self._certain[signature] = all(is_fact for _, _, is_fact in ground_atoms(self._control, *signature))
        return self._certain[signature]

    def _is_plain(self, atom: AtomNode, rule: Statement) -> bool:
        """Return whether all but the time of an atom is written without time, and computes nothing."""
        return _is_plain(atom.arguments[:-1] if atom.signature in self._timed else atom.arguments, rule)


def _following(predicates: Iterable[Signature], rules: Sequence[Statement]) -> frozenset[Signature]:
    """Return predicates with all that rules derive from them, or from what they derive."""
    found = set(predicates)
    while True:
        reading = (each for each in rules if not found.isdisjoint(atom.signature for atom in each.body))
        new = {atom.signature for each in reading for atom in each.heads} - found
        if not new:
            return frozenset(found)
        found |= new


def _declared(statements: Iterable[Statement]) -> set[tuple[str, int]]:
    """Return the predicates that statements say may have no rule."""
    found = (each.node for each in statements if each.kind == ASTType.Defined)
    return {(node.name, node.arity) for node in found}


def _is_plain(texts: Collection[str], rule: Statement) -> bool:
    """Return whether texts say nothing of the time of a rule, and compute nothing."""
    return names(texts).isdisjoint(rule.parameters) and not any(map(COMPUTED.search, texts))


def _read_atom(literal: AST, text: str) -> AtomNode | None:
    """Return the atom of a literal; what is not negated may have pools in its arguments, of which any may be so."""
    plain = plain_atom(literal, text)
    if plain or literal.ast_type != ASTType.Literal or literal.sign or literal.atom.ast_type != ASTType.SymbolicAtom:
        return plain
    found = list(atoms(literal, text))
    return found[0] if len(found) == 1 else None


def _own_conditions(head: AST) -> Iterator[AtomNode]:
    """Yield the atoms under which a head derives anything: those of its only element, if it has one alone."""
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
    """Return the variables of a comparison that it does not bind itself: ``X = Y+1`` binds X where Y is bound."""
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
