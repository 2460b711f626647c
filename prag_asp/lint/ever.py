"""What may ever be true, as a domain says it with ``ever``: where it says too little, actions that ask are missing.

What is true at the start, or made so by a postcondition, is compared with what the base part states. What the domain's
own rules of a step make true is found by the same rules in the base part, relaxed: each without its time and without
what is negated, occurrences being all actions, and truth before a step being what may ever be true. By induction over
the steps, nothing comes true that is neither so stated nor found here.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from typing import NamedTuple

import clingo
from clingo.ast import ASTType

from prag_asp.lint.occurrence import CHANGED, STATE_PREDICATES
from prag_asp.program.facts import Facts, rows, unsorted_rows
from prag_asp.program.grounding import Grounder
from prag_asp.program.problem import Problem
from prag_asp.program.syntax import VARIABLE, AtomNode, Statement, names, plain_atom, variables

EVER = ("ever", 1)
CLOSED_EVER = ("ever(F) :- initially(F,true).", "ever(F) :- postcondition(_,F,true).")
"""What may ever be true of a closed world, where no action leaves anything unknown."""

OCCURS, HOLDS = ("occurs", 2), ("holds", 3)
RELAXED = "_ever"
"""What the predicates begin with that relaxed rules derive."""

COMPUTED = re.compile(r'[-+*/\\&?^~|."]')
"""What stands in terms that bind no variable."""

MEND = "actions that ask for it would be missing"


def ever_problems(grounder: Grounder, facts: Facts, statements: Sequence[Statement]) -> Iterator[Problem]:
    """Yield what may be true at some time, is asked for by ``ever``, and is not stated by it."""
    readers: dict[str, Statement] = {}
    for each in statements:
        for atom in each.body if each.own else ():
            if atom.signature == EVER:
                readers.setdefault(_name(atom), each)
    if not readers:
        return
    if not any(atom.signature == EVER for each in statements for atom in each.heads):
        told = 'ever is read, but nothing states it; add #include "rules/ever.lp".'
        yield next(iter(readers.values())).problem(told)
        return
    ever = {fluent for (fluent,) in unsorted_rows(grounder.control, *EVER)}
    asked = {each: reader for each in facts.fluents if each not in ever and (reader := _reader(each, readers))}
    if asked:
        yield from [*_unstated(facts, asked)] or _made_by_rules(grounder, statements, asked, readers)


def _name(atom: AtomNode) -> str:
    """Return the name of the fluent that an atom speaks of, nothing where it may be any."""
    found = names(atom.arguments[0].partition("(")[:1])
    return next(iter(found), "")


def _reader(fluent: clingo.Symbol, readers: Mapping[str, Statement]) -> Statement | None:
    """Return a statement that may ask for a fluent."""
    return readers.get(fluent.name) or readers.get("")


def _unstated(facts: Facts, asked: Mapping[clingo.Symbol, Statement]) -> Iterator[Problem]:
    """Yield for each reader the first fluent that is not false at the start or set by an action, and not stated."""
    false = {fluent for fluent, value in facts.initially if value == "false"}
    found = {each: "it is not false at the start" for each in asked if each not in false}
    for action, values in facts.postconditions.items():
        for fluent, value in values:
            if fluent in asked and value != "false":
                found.setdefault(fluent, f"{action} may make it so")
    told: set[Statement] = set()
    for fluent, reason in found.items():
        if asked[fluent] not in told:
            told.add(asked[fluent])
            text = f"ever does not say that {fluent} may be true, but {reason}, and {MEND}"
            yield asked[fluent].problem(f'{text}; state it, or add #include "rules/ever.lp".')


class _Maker(NamedTuple):
    """A rule of a step, and a head of it that sets a fluent."""

    rule: Statement
    head: AtomNode


def _made_by_rules(
    grounder: Grounder, statements: Sequence[Statement], asked: Collection[clingo.Symbol], read: Collection[str]
) -> Iterator[Problem]:
    """Yield the first fluent of each name that an own rule of a step may make true, and that is not stated."""
    steps = [each for each in statements if each.is_rule and each.part == "step" and _is_added(each)]
    makers = [_Maker(each, atom) for each in steps for atom in each.heads if _may_make(atom, each, steps)]
    if not makers:
        return
    grounder.derive(_Relaxed(statements, steps, read).rules(makers))
    found: dict[str, tuple[int, clingo.Symbol]] = {}
    for maker, fluent in rows(grounder.control, f"{RELAXED}_made", 2):
        if fluent in asked:
            found.setdefault(fluent.name, (maker.number, fluent))
    for number, fluent in found.values():
        told = f"this rule may make {fluent} true, but ever does not say so, and {MEND}"
        yield makers[number].rule.problem(f"{told}; state ever({fluent})")


def _is_added(statement: Statement) -> bool:
    """Return whether a statement is the domain's own, or one of those that it asked for."""
    return statement.own or statement.path.parent.name == "rules"


def _may_make(head: AtomNode, statement: Statement, steps: Sequence[Statement]) -> bool:
    """Return whether a head may make a fluent true, or leave open whether it is."""
    if head.signature not in STATE_PREDICATES:
        return False
    return not _is_set(head, statement, steps) if head.signature == CHANGED else head.arguments[1] != "false"


def _is_set(head: AtomNode, statement: Statement, steps: Sequence[Statement]) -> bool:
    """Return whether what a rule says to be changed is set by other rules whenever it fires.

    A rule makes it false that reads the same, unless what another rule makes it true by, and by nothing else, is so.
    """
    fluent, positive = _renamed(head.arguments[0], statement)
    true, false = ([_renamed(term, each) for term, each in _setting(steps, value)] for value in ("true", "false"))
    alone = {text for term, texts in true if term == fluent and len(texts) == 1 for text in texts}
    unless = {f"not {text}" for text in alone}
    return any(term == fluent and positive <= texts <= positive | unless for term, texts in false)


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


class _Relaxed:
    """Writes rules of a step for the base part, without time, so that each derives what it may derive at some step.

    What is `asked` for are names of fluents, the empty one for all: nothing is known of when others are true. A
    predicate of a step that cannot be written is left out of what it is read by, which then derives more.
    """

    def __init__(self, statements: Sequence[Statement], steps: Sequence[Statement], asked: Collection[str]) -> None:
        rules = [each for each in statements if each.is_rule]
        self._asked = asked
        self._base = {atom.signature for each in rules if not each.timed for atom in each.heads}
        self._timed = {atom.signature for each in rules if each.timed for atom in each.heads}
        self._heads = [(atom, each) for each in steps for atom in each.heads if atom.signature not in STATE_PREDICATES]
        self._written = {atom.signature for atom, _ in self._heads} - {OCCURS}
        while (
            unbound := {atom.signature for atom, rule in self._heads if not self._is_bound(atom, rule)} & self._written
        ):
            self._written -= unbound

    def rules(self, makers: Iterable[_Maker]) -> Iterator[str]:
        """Yield the rules of what is read, and of what each maker may make."""
        for name, arity in sorted(self._written & self._base):
            terms = [f"X{number}" for number in range(1, arity)]
            yield f"{_applied(name, terms)} :- {name}({','.join([*terms, '_'])})."
        for atom, rule in self._heads:
            if atom.signature in self._written:
                yield f"{_applied(atom.name, atom.arguments[:-1])} :- {', '.join(self._body(rule)) or '#true'}."
        for number, maker in enumerate(makers):
            yield _made(number, maker, self._body(maker.rule))

    def _is_bound(self, head: AtomNode, rule: Statement) -> bool:
        """Return whether a head can be written: the body, as it is written, has all its variables."""
        return self._is_plain(head, rule) and _variables(head.arguments[:-1]) <= _variables(self._body(rule))

    def _body(self, rule: Statement) -> list[str]:
        """Return what has to be true for a rule to fire, as far as it can be said without time."""
        read: list[AtomNode] = [plain for node, text in rule.literals if (plain := plain_atom(node, text))]
        if len(rule.heads) == 1:
            read += rule.conditions
        return [text for atom in read if not atom.negated for text in self._said(atom, rule)]

    def _said(self, atom: AtomNode, rule: Statement) -> Iterator[str]:
        first, *others = atom.arguments or ("",)
        if not self._is_plain(atom, rule):
            return
        if atom.signature == OCCURS:
            yield f"action({first})"
        elif atom.signature in STATE_PREDICATES:
            known = others[0] == "true" and not {_name(atom), ""}.isdisjoint(self._asked)
            yield f"{'ever' if known else 'fluent'}({first})"
        elif atom.signature in self._written:
            yield _applied(atom.name, atom.arguments[:-1])
        elif atom.signature in self._base - self._timed:
            yield str(atom)

    def _is_plain(self, atom: AtomNode, rule: Statement) -> bool:
        """Return whether all but the time of an atom is written without time, and computes nothing."""
        timed = atom.signature in self._timed
        terms = atom.arguments[:-1] if timed or atom.signature == OCCURS else atom.arguments
        return names(terms).isdisjoint(rule.parameters) and not any(map(COMPUTED.search, terms))


def _made(number: int, maker: _Maker, body: Iterable[str]) -> str:
    """Return the rule for the fluents that a head makes true: those declared that its term may be."""
    term, *others = maker.head.arguments
    if COMPUTED.search(term) or not names([term]).isdisjoint(maker.rule.parameters):
        term, body = "F", ()
    value = [f"{others[0]} = true"] if VARIABLE.fullmatch(others[0]) else []
    return f"{RELAXED}_made({number},{term}) :- {', '.join([f'fluent({term})', *value, *body])}."


def _applied(name: str, terms: Collection[str]) -> str:
    name = f"{RELAXED}{'_opposite' if name.startswith('-') else ''}_{name.removeprefix('-')}"
    return f"{name}({','.join(terms)})" if terms else name


def _variables(texts: Iterable[str]) -> set[str]:
    return {name for text in texts for name in variables(text)}
