"""Entities that the author's statements treat alike: no rule names them, and their facts differ only in the name."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import clingo
from clingo.ast import AST, ASTType

from prag_asp.program.grounding import Grounder
from prag_asp.program.sources import Program, Source
from prag_asp.program.syntax import NAME, Statement, below, children_of, with_replaced
from prag_asp.reduction.applicability import is_stated

STATED = "_stated"
"""The predicate that wraps facts, together with the number of their statement, for grounding; authors cannot use the
name."""

HOLE = "_"


@dataclass(frozen=True)
class AlikeEntities:
    """The groups of two or more entities that the author's statements treat alike, each in clingo's order of terms.

    `stated` maps each fact of the author in the base part to its ground facts.
    """

    program: Program
    groups: tuple[tuple[clingo.Symbol, ...], ...]
    stated: Mapping[Statement, Sequence[clingo.Symbol]]

    def without(self, dropped: Collection[clingo.Symbol]) -> Program:
        """Return the program without the facts that name `dropped` entities; line numbers do not change."""
        texts: dict[Statement, str] = {}
        for statement, facts in self.stated.items():
            remaining = [fact for fact in facts if not any(_named(fact, dropped))]
            if len(remaining) < len(facts):
                texts[statement] = " ".join(f"{fact}." for fact in remaining)
        return Program(tuple(
            Source(source.path, with_replaced(source.text, {s: t for s, t in texts.items() if s.path == source.path}),
                   source.includes)
            for source in self.program.sources
        ))  # fmt: skip


def find_alike(program: Program, statements: Sequence[Statement]) -> AlikeEntities:
    """Return the entities that the author's statements treat alike, given that there is no `objection`.

    Raises:
        DomainError: clingo cannot ground one of the facts.
    """
    stated = _ground(statements)
    facts = [fact for instances in stated.values() for fact in instances]
    entities = {fact.arguments[0] for fact in facts if fact.name == "entity" and len(fact.arguments) == 2}
    distinguished = _distinguished(statements, entities)
    # an entity with the opposite sign is a different name
    functions = [entity for entity in entities if entity.type == clingo.SymbolType.Function]
    negated = {clingo.Function(each.name, each.arguments, not each.positive): each for each in functions}
    distinguished |= {negated[term] for fact in facts if "-" in str(fact) for term in _named(fact, negated)}
    profiles: dict[clingo.Symbol, set[object]] = {entity: set() for entity in entities}
    for fact in facts:
        named = set(_named(fact, entities))
        if len(named) == 1:
            (entity,) = named
            profiles[entity].add(_with_hole(fact, entity))
        else:
            distinguished |= named
    groups: dict[frozenset[object], list[clingo.Symbol]] = {}
    for entity in sorted(entities - distinguished):
        groups.setdefault(frozenset(profiles[entity]), []).append(entity)
    return AlikeEntities(program, tuple(tuple(group) for group in groups.values() if len(group) > 1), stated)


def _ground(statements: Iterable[Statement]) -> dict[Statement, list[clingo.Symbol]]:
    """Return the ground facts of each statement, with its pools, intervals and constants expanded."""
    facts = [each for each in statements if is_stated(each)]
    if not facts:
        return {}
    definitions = [each for each in statements if each.own and each.kind == ASTType.Definition]
    constants = {each.node.name for each in definitions}
    by_statement: dict[Statement, list[clingo.Symbol]] = {}
    expanded: list[str] = []
    for number, each in enumerate(facts):
        # clingo reads a large number of plain facts slowly
        is_plain = each.is_plain_fact and (not constants or constants.isdisjoint(NAME.findall(each.text)))
        by_statement[each] = [clingo.parse_term(each.text[:-1])] if is_plain else []
        if not is_plain and each.heads:
            expanded.append(f"{STATED}({number},{each.node.head}).")
    grounder = Grounder(Program((Source(facts[0].path, "\n".join([*expanded, *(each.text for each in definitions)])),)))
    grounder.ground([("base", [])])
    for atom in grounder.control.symbolic_atoms.by_signature(STATED, 2):
        place, fact = atom.symbol.arguments
        by_statement[facts[place.number]].append(fact)
    return by_statement


def _distinguished(statements: Iterable[Statement], entities: Collection[clingo.Symbol]) -> set[clingo.Symbol]:
    """Return the entities that a rule or constant names, that a pattern in a rule may match, or that are nested.

    Numbers and strings also count as distinguished, because rules compute with numbers.
    """
    constants: set[str] = set()
    patterns: set[tuple[str, int]] = set()
    for statement in statements:
        if statement.own and not is_stated(statement) and statement.kind != ASTType.Program:
            for term in _terms(statement.node):
                if term.ast_type == ASTType.Function and term.arguments:
                    patterns.add((term.name, len(term.arguments)))
                elif term.ast_type in (ASTType.SymbolicTerm, ASTType.Function):
                    constants.add(str(term))
    distinguished: set[clingo.Symbol] = set()
    for entity in entities:
        if inside := {inner for each in _arguments(entity) for inner in _named(each, entities)}:
            distinguished |= {entity, *inside}
        elif (
            entity.type != clingo.SymbolType.Function
            or not entity.positive
            or str(entity) in constants
            or (entity.arguments and (entity.name, len(entity.arguments)) in patterns)
        ):
            distinguished.add(entity)
    return distinguished


def _arguments(term: clingo.Symbol) -> Sequence[clingo.Symbol]:
    return term.arguments if term.type == clingo.SymbolType.Function else ()


def _terms(node: AST) -> Iterator[AST]:
    """Yield the terms in a statement, except its predicates, which are also functions in the syntax tree."""
    if node.ast_type == ASTType.SymbolicAtom:
        inner = _predicates(node.symbol)
        for each in (argument for predicate in inner for argument in predicate.arguments):
            yield from below(each)
    else:
        if node.ast_type in (ASTType.Function, ASTType.SymbolicTerm):
            yield node
        for child in children_of(node):
            yield from _terms(child)


def _predicates(symbol: AST) -> Iterator[AST]:
    if symbol.ast_type == ASTType.Pool:
        for each in symbol.arguments:
            yield from _predicates(each)
    else:
        yield symbol.argument if symbol.ast_type == ASTType.UnaryOperation else symbol


def _named(term: clingo.Symbol, entities: Collection[clingo.Symbol]) -> Iterator[clingo.Symbol]:
    waiting = [term]
    while waiting:
        term = waiting.pop()
        if term in entities:
            yield term
        waiting += _arguments(term)


def _with_hole(term: clingo.Symbol, entity: clingo.Symbol) -> object:
    """Return a form of a term, for comparison, in which `HOLE` stands for an entity."""
    if term == entity:
        return HOLE
    arguments = _arguments(term)
    if not arguments:
        return str(term)
    return (term.name, term.positive, *(_with_hole(each, entity) for each in arguments))
