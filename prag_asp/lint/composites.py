"""The checks of composites and their stages."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import NamedTuple

import clingo

from prag_asp.lint.effects import Findings
from prag_asp.lint.rule_origin import Origins, RulePlace
from prag_asp.program.composition import composite_sizes, find_cycle, inner_composites
from prag_asp.program.facts import Facts
from prag_asp.program.problem import Problem

MOST_ACTIONS = 100
"""The maximum number of actions in a composite, because the encodings nest them in a term of this depth."""

Symbol = clingo.Symbol


class Complaint(NamedTuple):
    """A problem with a composite: the file and line, the text that follows the composite's name, and the remedy."""

    composite: Symbol
    place: RulePlace
    words: str
    advice: str


def composite_problems(facts: Facts, origins: Origins) -> Iterator[Problem]:
    """Yield the problems with composites, stages and free actions; each check runs only if the previous ones pass."""
    undeclared = list(_undeclared(facts, origins))
    yield from undeclared
    if facts.free and not facts.composites:
        text = "without composites, every action is free; declare a composite, or remove free(...)"
        yield Problem(*origins.place("free", facts.free[0]), text, "no-effect")
    words = "is a composite, which is free anyway"
    both = (each for each in facts.composites if each in facts.free)
    complaints = (Complaint(each, origins.place("free", each), words, f"remove free({each})") for each in both)
    yield from grouped(complaints, "no-effect")
    misplaced = [] if undeclared else list(grouped(_misplaced(facts, origins)))
    yield from misplaced
    if undeclared or misplaced:
        return
    cycle = find_cycle(inner_composites(facts))
    if cycle:
        number = next(number for number, part in facts.stages[cycle[0]] if part == cycle[1])
        place = origins.place("stage", cycle[0], number, cycle[1])
        yield Problem(*place, f"composites form a cycle, {' > '.join(map(str, cycle))}; remove one of these stages")
        return
    yield from grouped(
        Complaint(each, origins.place("composite", each), f"has {size} actions, more than {MOST_ACTIONS}", "split it")
        for each, size in composite_sizes(facts).items()
        if size > MOST_ACTIONS
    )


def grouped(complaints: Iterable[Complaint], name: str = "") -> Iterator[Problem]:
    """Yield one problem for all composites with the same name and line: an error or, with `name`, a warning."""
    alike: dict[tuple[str, RulePlace], list[Complaint]] = {}
    for complaint in complaints:
        alike.setdefault((complaint.composite.name, complaint.place), []).append(complaint)
    for (_, place), group in alike.items():
        composite, _, words, advice = group[0]
        more = f" (and {len(group) - 1} more like it)" if len(group) > 1 else ""
        yield Problem(*place, f"{composite} {words}{more}; {advice}", name)


def _undeclared(facts: Facts, origins: Origins) -> Iterator[Problem]:
    findings = Findings(origins, facts)
    composites, actions = set(facts.composites), set(facts.actions)
    for composite, stages in facts.stages.items():
        for number, part in stages:
            row = (composite, number, part)
            if composite not in composites:
                findings.undeclared("composite", composite, facts.composites, "stage", row)
            if part not in actions and part not in composites:
                findings.undeclared("action", part, (*facts.actions, *facts.composites), "stage", row)
    for action in facts.free:
        if action not in actions and action not in composites:
            findings.undeclared("action", action, facts.actions, "free", (action,))
    yield from findings.problems()


def _misplaced(facts: Facts, origins: Origins) -> Iterator[Complaint]:
    """Yield the composites that have no stages, gaps between stages, or two parts at one stage."""
    actions = set(facts.actions)
    for composite in facts.composites:
        stages = facts.stages.get(composite, ())
        if composite in actions:
            place = origins.place("composite", composite)
            yield Complaint(composite, place, "is an action and a composite", "rename one")
        if not stages:
            advice = f"state stage({composite},1,...), or remove it"
            yield Complaint(composite, origins.place("composite", composite), "has no stage", advice)
        for expected, (number, part) in enumerate(stages, 1):
            if number == clingo.Number(expected):
                continue
            place = origins.place("stage", composite, number, part)
            if expected > 1 and stages[expected - 2][0] == number:
                other = stages[expected - 2][1]
                place = max(place, origins.place("stage", composite, number, other))
                words = f"has two parts at stage {number}, {other} and {part}"
                yield Complaint(composite, place, words, "keep one")
            else:
                words = f"has a stage {number} where its stage {expected} should be"
                yield Complaint(composite, place, words, "number its stages 1, 2, 3, ...")
            break
