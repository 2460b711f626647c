"""The whole logic program of a domain: its files and the facts that the library adds."""

from __future__ import annotations

import re
from collections.abc import Sequence
from functools import cache
from itertools import pairwise

import clingo

from prag_asp.domain.load import Domain
from prag_asp.program.entity_names import mention_facts, name_fact
from prag_asp.program.facts import Facts
from prag_asp.program.paths import data_folder
from prag_asp.program.predicates import (
    INTRODUCED,
    JOINT_UNIT,
    MENTIONS,
    NAME,
    NEXT_UNIT,
    PRUNED,
    SUCCESSOR,
    UNIT_INTRODUCED,
    EncodingPredicate,
    refers_to,
)
from prag_asp.program.sources import (
    ADDED,
    CONTRACT,
    Program,
    Source,
    added_encodings,
    owned,
    read_sources,
    read_text,
)
from prag_asp.program.tokens import blanked

DEPENDING = re.compile(
    r"\b_(propagates|impossible_with|ruled_out|barred|goal_fluent|forces|never_without|some_impossible|never_possible"
    r"|impossible_matters)\b"
)
"""A pattern for predicates that depend on how invariants are stated, or that only `closed_invariants.lp` defines."""

CANONICAL = (SUCCESSOR, JOINT_UNIT, NEXT_UNIT, INTRODUCED, UNIT_INTRODUCED)
"""The predicates that the programs of tasks add."""

Groups = Sequence[Sequence[clingo.Symbol]]
Joint = Sequence[Sequence[Sequence[clingo.Symbol]]]
"""Groups of interchangeable entities, and of units whose entities are interchangeable together."""

DESCRIBING = (CONTRACT, "skeleton.lp")
"""The encodings that always mention the added predicates."""


def whole_program(domain: Domain) -> Program:
    """Return the program of a domain with facts about its pruned actions, and with `name` and `mentions` if read."""
    return with_facts(domain.program, _added_facts(domain.facts, domain.program))


def weighing_program(domain: Domain, program: Program, weighed: Sequence[str]) -> Program:
    """Return a program of a domain with the rules of `weights.lp` and the facts `weighed`."""
    whole = Program((*program.sources, *_rules(domain, "weights")))
    facts = domain.facts
    stated = weighed if _read(program, MENTIONS) else [*weighed, *mention_facts(facts.actions, facts.entities)]
    return with_facts(whole, stated)


def closed_program(domain: Domain) -> Program | None:
    """Return the program of a domain with all binary invariants that its invariants entail; the plans are the same.

    The result is None if a user rule contains a predicate that depends on how invariants are stated.
    """
    if any(own and DEPENDING.search(blanked(source.text)) for source, own in owned(domain.program)):
        return None
    return Program((*domain.program.sources, *_rules(domain, "closed_invariants")))


def canonical_program(domain: Domain, groups: Groups, joint: Joint = ()) -> Program:
    """Return the program of tasks: plans that introduce entities of each group and units of each joint group in order.

    If the entities of each group are interchangeable, it has one plan for each task.
    """
    program = Program((*domain.program.sources, *_canonical_rules(domain, joint)))
    return with_facts(program, [*_added_facts(domain.facts, program), *_order_facts(groups, joint)])


def canonical_extension(
    domain: Domain, groups: Groups, joint: Joint = ()
) -> tuple[Program, list[clingo.Symbol]] | None:
    """Return the rules that `canonical_program` adds to `whole_program`, and the atoms carried from step to step.

    The result is None if a file of the domain reads an added predicate, because the rules of that file have to be
    ground with the added facts.
    """
    if any(_read(domain.program, predicate) for predicate in CANONICAL):
        return None
    rules = _canonical_rules(domain, joint)
    stated = set(_added_facts(domain.facts, domain.program))
    facts = _added_facts(domain.facts, Program((*domain.program.sources, *rules)))
    added = [*(each for each in facts if each not in stated), *_order_facts(groups, joint)]
    carried = [INTRODUCED.timeless(entity) for group in groups for entity in group[:-1]]
    carried += [
        UNIT_INTRODUCED.timeless(clingo.Function("", [clingo.Number(number), clingo.Number(place)]))
        for number, units in enumerate(joint)
        for place in range(len(units) - 1)
    ]
    return with_facts(Program(rules), added), carried


def _canonical_rules(domain: Domain, joint: Joint) -> tuple[Source, ...]:
    return (*_rules(domain, "canonical_names"), *(_rules(domain, "joint_names") if joint else ()))


def _order_facts(groups: Groups, joint: Joint) -> list[str]:
    """Return the facts that order the entities of groups, and that state and order the units of joint groups."""
    facts = [SUCCESSOR.fact(d, e) for group in groups for d, e in pairwise(group)]
    for number, units in enumerate(joint):
        for place, unit in enumerate(units):
            facts += [JOINT_UNIT.fact(entity, f"({number},{place})") for entity in unit]
            if place:
                facts.append(NEXT_UNIT.fact(f"({number},{place - 1})", f"({number},{place})"))
    return facts


def _rules(domain: Domain, name: str) -> tuple[Source, ...]:
    """Return a file of ``encodings/rules`` and the files that it includes, except files that the domain already has."""
    paths = {source.path.resolve() for source in domain.program.sources}
    rules = read_sources(domain.encodings / "rules" / f"{name}.lp", domain.encodings)
    return tuple(rule for rule in rules if rule.path.resolve() not in paths)


def _added_facts(facts: Facts, program: Program) -> list[str]:
    """Return the facts that the library adds.

    Facts that no file reads are omitted, because there can be thousands. User rules may also read facts about actions
    that never occur.
    """
    others = added_encodings(program)
    own = [source.text for source, own in owned(program) if own or source.path in others]
    named = facts.actions if _read(program, NAME) else facts.tried
    named = facts.declared_actions if any(refers_to(text, NAME) for text in own) else named
    added = [PRUNED.fact(term) for term in (*facts.pruned, *facts.unreachable)]
    added += map(name_fact, named)
    if any(refers_to(text, MENTIONS) for text in own):
        return [*added, *mention_facts(facts.declared_actions, facts.entities)]
    return [*added, *mention_facts(facts.actions, facts.entities)] if _read(program, MENTIONS) else added


def _read(program: Program, predicate: EncodingPredicate) -> bool:
    """Return whether a file other than the shipped files `DESCRIBING` mentions a predicate."""
    describing = _describing()
    return any(refers_to(each.text, predicate) for each in program.sources if each.text not in describing)


@cache
def _describing() -> frozenset[str]:
    return frozenset(read_text(data_folder("encodings") / name) for name in DESCRIBING)


def with_facts(program: Program, facts: Sequence[str]) -> Program:
    """Return a program with additional facts, each a text that ends in a period."""
    return Program((*program.sources, Source(ADDED, " ".join(facts))))
