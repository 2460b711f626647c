"""The whole logic program of a domain: its files, and the facts that the library adds to them."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from itertools import chain, pairwise

import clingo

from prag_asp.domain.load import Domain
from prag_asp.program.entity_names import mention_facts, name_fact
from prag_asp.program.facts import Facts
from prag_asp.program.predicates import (
    JOINT_UNIT,
    MENTIONS,
    NAME,
    NEXT_UNIT,
    PRUNED,
    SUCCESSOR,
    EncodingPredicate,
    speaks_of,
)
from prag_asp.program.sources import ADDED, CONTRACT, Program, Source, owned, read_sources
from prag_asp.program.tokens import blanked

DEPENDING = re.compile(
    r"\b_(propagates|impossible_with|ruled_out|barred|goal_fluent|forces|never_without|some_impossible|never_possible"
    r"|impossible_matters)\b"
)
"""Predicates that depend on how invariants are stated, and those of `closed_invariants.lp` alone."""

DESCRIBING = (CONTRACT, "skeleton.lp")
"""The encodings that describe what the library adds, and name the actions that occur."""


def whole_program(domain: Domain) -> Program:
    """Return the program of a domain with the actions that are not tried, and with `name` and `mentions` if read."""
    return with_facts(domain.program, _added_facts(domain.facts, domain.program))


def weighing_program(domain: Domain, program: Program, weighed: Sequence[str]) -> Program:
    """Return the program of a domain with the rules that tell what weights depend on, and the facts `weighed`."""
    whole = Program((*program.sources, *_rules(domain, "weights")))
    facts = domain.facts
    told = weighed if _read(program, MENTIONS) else [*weighed, *mention_facts(facts.actions, facts.entities)]
    return with_facts(whole, told)


def closed_program(domain: Domain) -> Program | None:
    """Return the program of a domain with all that its invariants entail of two fluents, which has the same plans.

    None where the author's own rules have a predicate that depends on how they are stated.
    """
    if any(own and DEPENDING.search(blanked(source.text)) for source, own in owned(domain.program)):
        return None
    return Program((*domain.program.sources, *_rules(domain, "closed_invariants")))


def canonical_program(
    domain: Domain,
    groups: Iterable[Sequence[clingo.Symbol]],
    joint: Sequence[Sequence[Sequence[clingo.Symbol]]] = (),
) -> Program:
    """Return the program whose plans introduce the entities of each group, and the units of each joint one, in order.

    With groups of interchangeable entities, it has one plan for each task.
    """
    rules = [*_rules(domain, "canonical_names"), *(_rules(domain, "joint_names") if joint else ())]
    program = Program((*domain.program.sources, *rules))
    pairs = [SUCCESSOR.fact(d, e) for group in groups for d, e in pairwise(group)]
    told = chain.from_iterable(_unit_facts(number, units) for number, units in enumerate(joint))
    return with_facts(program, [*_added_facts(domain.facts, program), *pairs, *told])


def _unit_facts(number: int, units: Sequence[Sequence[clingo.Symbol]]) -> Iterator[str]:
    """Yield what says which entities belong to the units of a joint group, and which unit follows which."""
    for place, unit in enumerate(units):
        yield from (JOINT_UNIT.fact(entity, f"({number},{place})") for entity in unit)
        if place:
            yield NEXT_UNIT.fact(f"({number},{place - 1})", f"({number},{place})")


def _rules(domain: Domain, name: str) -> tuple[Source, ...]:
    """Return a file of rules of the encodings, if the domain does not have it."""
    known = {source.path.resolve() for source in domain.program.sources}
    rules = read_sources(domain.encodings / "rules" / f"{name}.lp", domain.encodings)
    return tuple(rule for rule in rules if rule.path.resolve() not in known)


def _added_facts(facts: Facts, program: Program) -> list[str]:
    """Return what the library adds, but for what no file of the program reads: actions can be thousands.

    The author's own files may read it of actions that never occur as well.
    """
    own = [source.text for source, own in owned(program) if own]
    named = facts.actions if _read(program, NAME) else facts.tried
    named = facts.declared_actions if any(speaks_of(text, NAME) for text in own) else named
    added = [PRUNED.fact(term) for term in (*facts.pruned, *facts.unreachable)]
    added += map(name_fact, named)
    if any(speaks_of(text, MENTIONS) for text in own):
        return [*added, *mention_facts(facts.declared_actions, facts.entities)]
    return [*added, *mention_facts(facts.actions, facts.entities)] if _read(program, MENTIONS) else added


def _read(program: Program, predicate: EncodingPredicate) -> bool:
    """Return whether a file may read a predicate: one that speaks of it, but for those that speak of it in any case."""
    files = (each.text for each, own in owned(program) if own or each.path.name not in DESCRIBING)
    return any(speaks_of(text, predicate) for text in files)


def with_facts(program: Program, facts: Sequence[str]) -> Program:
    """Return a program with more facts, each a text that ends in a period."""
    return Program((*program.sources, Source(ADDED, " ".join(facts))))
