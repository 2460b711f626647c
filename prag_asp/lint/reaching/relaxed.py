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
from clingo.ast import AST, ASTType

from prag_asp.lint.occurrence import CHANGED, STATE_PREDICATES
from prag_asp.program.atoms import ground_atoms
from prag_asp.program.syntax import VARIABLE, AtomNode, Statement, names, plain_atom, variables

OCCURS, HOLDS = ("occurs", 2), ("holds", 3)
BOOLEAN = ("true", "false")
BOTH = "(true;false)"
COMPUTED = re.compile(r'[-+*/\\&?^~|."]')
"""What stands in terms that bind no variable."""

PREFIX = "_may_"
"""What the names of own predicates of a step begin with where they are relaxed."""


class Maker(NamedTuple):
    """An own rule of a step, and a head of it that gives a fluent a value, or leaves its value open."""

    rule: Statement
    head: AtomNode


def makers_of(steps: Sequence[Statement]) -> list[Maker]:
    """Return the rules of a step that set fluents: not those that say of one that it changes, where others set it."""
    found = (Maker(each, atom) for each in steps for atom in each.heads if atom.signature in STATE_PREDICATES)
    return [each for each in found if each.head.signature != CHANGED or not _is_set(each, steps)]


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
            for atom in each.heads:
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
        self._void = _declared(statements, own=True) - _declared(statements, own=False) - self._base - self._timed
        self._heads = [(atom, each) for each in steps for atom in each.heads if atom.signature not in STATE_PREDICATES]
        self._written = {atom.signature for atom, _ in self._heads}
        left_out = {atom.signature for atom, rule in self._heads if self._grows(atom, rule)} or {("", 0)}
        while left_out:
            self._written -= left_out
            self._heads = [each for each in self._heads if each[0].signature in self._written]
            left_out = {atom.signature for atom, rule in self._heads if not self._is_bound(atom, rule)}

    def rules(self, makers: Sequence[Maker]) -> Iterator[str]:
        """Yield rules for what makers read, and for ``_may_set(N,F,V)``: the N-th of them may give F the value V."""
        read = self._read_by([each.rule for each in makers])
        for name, arity in sorted(read & self._base):
            terms = [f"X{number}" for number in range(1, arity)]
            yield f"{_applied(name, terms)} :- {name}({','.join([*terms, '_'])})."
        for atom, rule in self._heads:
            if atom.signature in read:
                yield f"{_applied(atom.name, atom.arguments[:-1])} :- {', '.join(self._body(rule)) or '#true'}."
        for number, (rule, head) in enumerate(makers):
            yield self._setting(number, rule, head)

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
        larger = any("(" in term and variables(term) for term in head.arguments[:-1])
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

    def _body(self, rule: Statement) -> list[str]:
        """Return what has to be so for a rule to fire, as far as it can be said without time."""
        read = [(plain, text) for node, text in rule.literals if (plain := plain_atom(node, text))]
        positive = [atom for atom, _ in read if not atom.negated]
        if len(rule.heads) == 1:
            positive += rule.conditions
        found = [text for atom in positive if self._is_plain(atom, rule) for text in self._said(atom)]
        bound = _variables(found)
        others = [text for atom, text in read if text == f"not {atom}" and self._is_fixed(atom)]
        others += [text for node, text in rule.literals if _compares(node)]
        return [*found, *(text for text in others if _is_plain([text], rule) and _variables([text]) <= bound)]

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
        if signature not in self._base or signature in self._timed or atom.name.startswith("-"):
            return False
        if signature not in self._certain:
            self._certain[signature] = all(is_fact for _, _, is_fact in ground_atoms(self._control, *signature))
        return self._certain[signature]

    def _is_plain(self, atom: AtomNode, rule: Statement) -> bool:
        """Return whether all but the time of an atom is written without time, and computes nothing."""
        return _is_plain(atom.arguments[:-1] if atom.signature in self._timed else atom.arguments, rule)


def _declared(statements: Iterable[Statement], *, own: bool) -> set[tuple[str, int]]:
    """Return the predicates that statements say may have no rule."""
    found = (each.node for each in statements if each.own == own and each.kind == ASTType.Defined)
    return {(node.name, node.arity) for node in found}


def _is_plain(texts: Collection[str], rule: Statement) -> bool:
    """Return whether texts say nothing of the time of a rule, and compute nothing."""
    return names(texts).isdisjoint(rule.parameters) and not any(map(COMPUTED.search, texts))


def _compares(literal: AST) -> bool:
    return literal.ast_type == ASTType.Literal and literal.atom.ast_type == ASTType.Comparison


def _applied(name: str, terms: Collection[str]) -> str:
    name = f"{PREFIX}{name.replace('-', 'not_')}"
    return f"{name}({','.join(terms)})" if terms else name


def _variables(texts: Iterable[str]) -> set[str]:
    return {name for text in texts for name in variables(text)}
