"""The checks of the hierarchy of classes and entities, and of names."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

import clingo

from prag_asp.lint.directives import CHOICES, STATED
from prag_asp.lint.rule_origin import Origins, RulePlace
from prag_asp.program.composition import find_cycle
from prag_asp.program.entity_names import ambiguity, shared_names
from prag_asp.program.facts import Facts, rows
from prag_asp.program.predicates import EVER
from prag_asp.program.problem import Problem
from prag_asp.program.sources import EVER_AT_START, EVER_BY_ACTIONS
from prag_asp.program.syntax import Statement
from prag_asp.wording import did_you_mean

Symbol = clingo.Symbol


def hierarchy_problems(control: clingo.Control, origins: Origins) -> Iterator[Problem]:
    """Yield the problems with the classes and entities of a grounded base part."""
    tops = {name for (name,) in rows(control, "class", 1)}
    pairs = [(child, parent) for child, parent in rows(control, "class", 2)]
    declared = tops | {child for child, _ in pairs}
    parents: dict[Symbol, list[Symbol]] = {}
    for child, parent in pairs:
        parents.setdefault(child, []).append(parent)
        if parent not in declared:
            hint = did_you_mean(str(parent), map(str, declared), f"declare class({parent})")
            yield Problem(*origins.place("class", child, parent), f"unknown class {parent} above {child}; {hint}")
    cycle = find_cycle(parents)
    if cycle:
        place = origins.place("class", cycle[0], cycle[1])
        yield Problem(*place, f"classes form a cycle, {' < '.join(map(str, cycle))}; remove one of these class/2 facts")
        return
    entities = [(entity, name) for entity, name in rows(control, "entity", 2)]
    wrong = list(_entity_problems(entities, declared, origins))
    yield from wrong
    if not wrong:  # no rule can ever use a class without entities and without subclasses
        above = {parent for each in parents.values() for parent in each}
        for name in sorted(declared - above - {name for _, name in entities}):
            place = origins.place("class", name, *parents.get(name, ())[:1])
            text = f"class {name} has no entity; add entity(..., {name}), or remove it"
            yield Problem(*place, text, "empty-class")


def _entity_problems(
    entities: Sequence[tuple[Symbol, Symbol]], declared: set[Symbol], origins: Origins
) -> Iterator[Problem]:
    first: dict[Symbol, Symbol] = {}
    homeless: dict[tuple[RulePlace, Symbol], list[Symbol]] = {}
    for entity, name in entities:
        if name not in declared:
            homeless.setdefault((origins.place("entity", entity, name), name), []).append(entity)
        elif entity in first:
            place = max(origins.place("entity", entity, each) for each in (name, first[entity]))
            yield Problem(
                *place,
                f"entity {entity} has two classes, {first[entity]} and {name}; "
                "keep one, and put the other above it with class(C, Parent)",
            )
        else:
            first[entity] = name
    for (place, name), several in homeless.items():
        hint = did_you_mean(str(name), map(str, declared), f"declare class({name})")
        yield Problem(*place, f"unknown class {name} of {', '.join(map(str, several))}; {hint}")


NAMED = re.compile(r"_*[a-z][^\"#]*")
ENTITY = re.compile(r"[^\"#]*")


def term_problems(facts: Facts, origins: Origins) -> Iterator[Problem]:
    """Yield the entities, fluents, actions and composites that are not names with optional arguments."""
    for predicate, terms in (("fluent", facts.fluents), ("action", facts.actions), ("composite", facts.composites)):
        nameless = [term for term in terms if not NAMED.fullmatch(str(term))]
        for term in nameless[:1]:
            yield Problem(
                *origins.place(predicate, term),
                f"{predicate}({term}) is not a name with arguments; write one such as on(a,b), without strings",
            )
    for entity, name in facts.entities.items():
        if not ENTITY.fullmatch(str(entity)):
            yield Problem(
                *origins.place("entity", entity, name),
                f"{entity} cannot be the name of an entity; write it in lower case, without quotes",
            )


def shared_name_problems(facts: Facts, origins: Origins) -> Iterator[Problem]:
    """Yield a problem at the last declaration of each name that a class, an entity or an action shares with another."""
    entities = {str(entity): (entity, name) for entity, name in facts.entities.items()}
    for text in shared_names(facts):
        places = [origins.place("entity", *entities[text])] if text in entities else []
        for name in (each for each in facts.classes if str(each) == text):
            places.append(origins.place("class", name, *facts.parents.get(name, ())[:1]))
        for action in [each for each in facts.declared_actions if text in (each.name, str(each))][:1]:
            places.append(origins.place("action", action))
        yield Problem(*max(places), f"{ambiguity(text, facts)}", "same-name")


def choice_problems(control: clingo.Control, statements: Sequence[Statement], origins: Origins) -> Iterator[Problem]:
    """Yield the first uncertain atom of each predicate: an atom that some answer sets of the base part lack.

    If there are no choices, and `ever` depends on its own negation through actions, only this is reported.
    """
    ever = [each.symbol for each in control.symbolic_atoms.by_signature(*EVER) if not each.is_fact]
    if ever and not any(each.node.head.ast_type in CHOICES for each in statements if each.own and each.is_rule):
        asking = [each for each in statements if each.own and any(atom.signature == EVER for atom in each.body)]
        text = f"{min(ever)} depends on actions that depend on it through `not`; state without `not` what may be true"
        yield asking[0].problem(f"{text}: {EVER_AT_START} {EVER_BY_ACTIONS}")
        return
    for name, arity in sorted(STATED):
        uncertain = [each.symbol for each in control.symbolic_atoms.by_signature(name, arity) if not each.is_fact]
        if uncertain:
            atom = min(uncertain)
            yield Problem(
                *origins.place(name, *atom.arguments),
                f"{atom} depends on a choice, but must be the same in all plans; derive it from facts",
            )
