"""Atoms in rules that can never hold, because no derivable atom has one of their names at its position.

    precondition(dorp(R,O), empty(R), true) :- action(dorp(R,O)).

never fires if no action is called dorp, and clingo does not report it. Each name in a body is searched for in the
ground atoms of its predicate, at the same position. A name that no ground atom has is not a mistake if it is in the
head of a rule that might fire with more entities. If the rules that derive it demand another missing name, only that
other name is reported: as an error if a known name is similar, and otherwise as a warning.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Iterator, Sequence
from typing import NamedTuple

import clingo
from clingo.ast import ASTType

from prag_asp.program.predicates import CHANGED, HOLDS, KNOWN, OCCURS
from prag_asp.program.problem import Problem
from prag_asp.program.syntax import AtomNode, Signature, Statement, atoms, names, plain_atom, split_arguments
from prag_asp.wording import did_you_mean, is_misspelt

FUNCTION = re.compile(r"(?P<name>_*[a-z][\w']*)?(?:\((?P<arguments>.*)\))?", re.S)
ACTION, FLUENT = ("action", 1), ("fluent", 1)
DECLARING: dict[Signature, Signature] = {OCCURS: ACTION, **dict.fromkeys([HOLDS, KNOWN, CHANGED], FLUENT)}
"""The predicate in the base part that declares the first argument, for some predicates of steps."""

CLASS, CLASS_BELOW, BELONGING = ("class", 1), ("class", 2), ("entity", 2)
"""The predicates that declare a class, and the members of a class."""

NO_NAME: Signature = ("", -1)
"""The signature of a number, a string, or a missing argument."""

Step = tuple[str, int, int]
"""A step into a term: the name and the arity of the function, and the index of the argument."""


class ArgumentPlace(NamedTuple):
    """The position of a name in the atoms of a predicate: the index of the argument, and the path within it."""

    predicate: Signature
    argument: int
    below: tuple[Step, ...] = ()


class TermPattern(NamedTuple):
    """A function or constant in a rule; an argument that is a variable, a number or a computed term is None."""

    name: str
    arguments: tuple[TermPattern | None, ...]

    @property
    def signature(self) -> Signature:
        """The name and the number of arguments."""
        return self.name, len(self.arguments)


class NameDemand(NamedTuple):
    """A name in an atom of a rule; without a `place`, the name may occur anywhere.

    If the atom is `necessary`, the rule never fires without the name.
    """

    rule: Statement
    atom: AtomNode
    place: ArgumentPlace | None
    name: Signature
    necessary: bool


def demand_problems(control: clingo.Control, statements: Sequence[Statement]) -> Iterator[Problem]:
    """Yield the names in the bodies of user rules that no derivable atom has at the same position."""
    rules = [each for each in statements if each.is_rule]
    stated = {head.signature for each in rules if not each.timed for head in each.heads}
    timed = {head.signature for each in rules if each.timed for head in each.heads}
    defined = stated | timed
    defined |= {
        (each.node.name, each.node.arity) for each in statements if each.kind == ASTType.Defined and not each.own
    }
    demands = list(_demands(rules, stated - timed, defined))
    anywhere = {each.name[0] for each in demands if each.place is None}
    missing = _missing(control, demands)
    if not missing and not anywhere:
        return
    makers = _NameMakers(statements)
    unmade = anywhere - makers.names(set())
    unmet = [
        each
        for each in demands
        if (each.name[0] in unmade if each.place is None else (each.place, each.name) in missing)
    ]
    names_made = makers.names({each.rule for each in unmet if each.necessary}) if unmet else set()
    first = {each.name[0]: each for each in reversed(list(makers.roots(unmet)))}
    for each in reversed(first.values()):
        yield _problem(each, control, names_made)


def _problem(demand: NameDemand, control: clingo.Control, derivable: set[str]) -> Problem:
    """Return the problem that no atom has a name at a position; `derivable` holds the names of all derivable atoms."""
    name, arity = demand.name
    rule, line = demand.rule, demand.atom.line
    there: set[Signature] = set()
    if demand.place:
        ground = control.symbolic_atoms.by_signature(*demand.place.predicate)
        there = {_name_at(atom.symbol, demand.place) for atom in ground} - {NO_NAME}
    taken = sorted(number for other, number in there if other == name)
    if taken:
        counts = " or ".join(map(str, taken))
        text = f"{demand.atom} never holds: {name} takes {counts} arguments there, not {arity}"
        return rule.problem(f"{text}; fix its arguments, or remove the rule", line)
    if name in derivable:
        return rule.problem(f"{demand.atom} never holds; state it, or remove the rule", line, "never-holds")
    around = {other for other, _ in there}
    candidates = next((names for names in (around, derivable) if is_misspelt(name, names)), around | derivable)
    hint = did_you_mean(name, candidates, "declare it, or remove the rule")
    text = f"no entity, fluent or action has the name {name}; {hint}"
    return rule.problem(text, line, "" if is_misspelt(name, candidates) else "never-holds")


def _demands(
    rules: Iterable[Statement], stated: Collection[Signature], defined: Collection[Signature]
) -> Iterator[NameDemand]:
    """Yield the names in the bodies of user rules; only those in predicates `stated` in the base have a place.

    Undefined predicates are skipped: they are reported elsewhere, or declared with ``#defined``.
    """
    for rule in rules:
        reads: list[tuple[AtomNode, bool]] = []  # each atom, and whether the rule fires only if it holds
        for node, text in rule.literals if rule.own else ():
            plain = plain_atom(node, text)
            reads += [(plain, not plain.negated)] if plain else [(atom, False) for atom in atoms(node, text)]
        reads += [(atom, False) for atom in rule.conditions if rule.own]
        for atom, necessary in reads:
            if atom.signature not in defined:
                continue
            declaring = DECLARING.get(atom.signature)
            predicate = declaring or atom.signature
            found: list[tuple[ArgumentPlace | None, Signature]] = []
            for number, text in enumerate(atom.arguments):
                term = read_term(text)
                if term is not None and predicate in stated and (declaring is None or number == 0):
                    found += _below(ArgumentPlace(predicate, number), term)
                else:
                    found += [(None, (name, 0)) for name in sorted(names([text]))]
            for place, name in found:
                if name[1] or name[0] not in rule.parameters:
                    yield NameDemand(rule, atom, place, name, necessary)


def _below(place: ArgumentPlace, term: TermPattern) -> Iterator[tuple[ArgumentPlace, Signature]]:
    yield place, term.signature
    for number, argument in enumerate(term.arguments):
        if argument is not None:
            yield from _below(place._replace(below=(*place.below, (*term.signature, number))), argument)


def read_term(text: str) -> TermPattern | None:
    """Parse a function or a constant; return None for a variable, a number, or a computed term."""
    match = FUNCTION.fullmatch(text)
    if not match or not text or '"' in text or ";" in text:
        return None
    name, inside = match["name"] or "", match["arguments"]
    arguments = split_arguments(inside) if inside else []
    if arguments is None or (not name and len(arguments) == 1):
        return None
    return TermPattern(name, tuple(map(read_term, arguments if name or arguments[-1:] != [""] else arguments[:-1])))


def _missing(control: clingo.Control, demands: Iterable[NameDemand]) -> set[tuple[ArgumentPlace, Signature]]:
    """Return pairs of a position and a name that no ground atom has there, except those within a missing term."""
    required: dict[Signature, dict[ArgumentPlace, set[Signature]]] = {}
    for each in demands:
        if each.place is not None:
            required.setdefault(each.place.predicate, {}).setdefault(each.place, set()).add(each.name)
    for predicate, places in required.items():
        for atom in control.symbolic_atoms.by_signature(*predicate):
            for place, open_ in list(places.items()):
                open_.discard(_name_at(atom.symbol, place))
                if not open_:
                    del places[place]
            if not places:
                break
    missing = {(place, name) for places in required.values() for place, open_ in places.items() for name in open_}
    return {
        (place, name)
        for place, name in missing
        if not any(
            (place._replace(below=place.below[:depth]), step[:2]) in missing for depth, step in enumerate(place.below)
        )
    }


def _name_at(atom: clingo.Symbol, place: ArgumentPlace) -> Signature:
    term = atom.arguments[place.argument]
    for name, arity, number in place.below:
        if _signature(term) != (name, arity):
            return NO_NAME
        term = term.arguments[number]
    return _signature(term)


def _signature(term: clingo.Symbol) -> Signature:
    return (term.name, len(term.arguments)) if term.type == clingo.SymbolType.Function else NO_NAME


class _NameMakers:
    """The rules that can derive atoms containing a name, indexed by the position of the name."""

    def __init__(self, statements: Iterable[Statement]) -> None:
        statements = list(statements)
        definitions = [each.node for each in statements if each.kind == ASTType.Definition]
        self._constants = names(text for node in definitions for text in (node.name, str(node.value)))
        self._heads: dict[Signature, list[tuple[Statement, AtomNode]]] = {}
        self._of_name: dict[str, set[Statement]] = {}
        self._at_place: dict[ArgumentPlace, dict[Signature | None, set[Statement]]] = {}
        for rule in statements:
            computed = (text for node, text in rule.literals if rule.own and plain_atom(node, text) is None)
            for head in rule.heads:
                self._heads.setdefault(head.signature, []).append((rule, head))
            for name in names([*(text for head in rule.heads for text in head.arguments), *computed]):
                self._of_name.setdefault(name, set()).add(rule)

    def roots(self, unmet: Sequence[NameDemand]) -> Iterator[NameDemand]:
        """Yield the demands that no rule can meet, except those that are unmet only because others are.

        Only a rule whose own demands are met can meet a demand. If only dead rules would meet a demand, it is unmet
        because of their demands, unless they demand the same name.
        """
        dead = {each.rule for each in unmet if each.necessary}
        while True:
            hopeless = [each for each in unmet if not self._can_make(each, dead)]
            still = {each.rule for each in hopeless if each.necessary}
            if still == dead:
                break
            dead = still
        alike: dict[Signature, set[Statement]] = {}
        for each in hopeless:
            alike.setdefault(each.name, set()).add(each.rule)
        first = [each for each in hopeless if not self._can_make(each, alike[each.name])]
        yield from first or hopeless[:1]

    def names(self, dead: set[Statement]) -> set[str]:
        """Return all names, in heads or computed in bodies, that rules other than the `dead` ones can put in atoms."""
        return {name for name, rules in self._of_name.items() if not rules.issubset(dead)} | self._constants

    def _can_make(self, demand: NameDemand, dead: set[Statement]) -> bool:
        """Return whether a rule that is not `dead` may derive an atom with a name at the demanded position."""
        name = demand.name[0]
        anywhere = name in self._constants or not self._of_name.get(name, set()) <= dead
        if demand.place is None or name in self._constants:
            return anywhere
        there = self._rules_at(demand.place)
        return not there.get(demand.name, set()) <= dead or (anywhere and not there.get(None, set()) <= dead)

    def _rules_at(self, place: ArgumentPlace) -> dict[Signature | None, set[Statement]]:
        """Map each name to the rules that derive it at a position, and None to the rules that may derive any name."""
        rules_of_name = self._at_place.get(place)
        if rules_of_name is None:
            rules_of_name = self._at_place[place] = {}
            places = [place]
            if place.predicate == BELONGING and place.argument == 1:  # a class may later have entities
                places += [ArgumentPlace(CLASS, 0), ArgumentPlace(CLASS_BELOW, 0)]
            for each in places:
                for rule, head in self._heads.get(each.predicate, ()):
                    rules_of_name.setdefault(_written_at(head, each), set()).add(rule)
        return rules_of_name


def _written_at(head: AtomNode, place: ArgumentPlace) -> Signature | None:
    """Return the name that a head has at a position, or None if it may have any name there."""
    term = read_term(head.arguments[place.argument])
    for name, arity, number in place.below:
        if term is None:
            return None
        if term.signature != (name, arity):
            return NO_NAME
        term = term.arguments[number]
    return None if term is None else term.signature
