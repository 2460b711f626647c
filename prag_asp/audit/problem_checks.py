"""Mistakes in the initial states, goals and instructions of problems."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Set
from dataclasses import dataclass
from itertools import islice

from prag_asp.atom import Atom
from prag_asp.audit.audited_problem import AuditedProblem
from prag_asp.bddl.ground_goals import FactValue, conjuncts, fact_values, is_true
from prag_asp.bddl.ground_problems import LOCATIONS, GroundProblem

MISTAKES = {
    "unreadable": "a file that cannot be read, or names what it does not declare",
    "remark": "a part of a file that is ignored",
    "contradictory-start": "an initial state that is impossible",
    "unreachable-goal": "a goal that no sequence of actions reaches",
    "unchecked-goal": "a goal for which it is not known whether a plan reaches it",
    "uncompared-goal": "a goal that could not be compared with every goal of other suites",
    "true-at-start": "a goal that is true in the initial state",
    "silent-language": "a sentence that names none of the goal's objects",
    "unused-object": "an object in no fact of the initial state or the goal",
}
"""The kinds of mistakes."""

SHORTEST = 3
"""The minimum length of a word from a class name to be searched for in a sentence."""


@dataclass(frozen=True)
class AuditFinding:
    """A mistake in a problem: its kind, its location, and a description."""

    kind: str
    place: str
    text: str

    def __str__(self) -> str:
        return f"{self.place}: {self.text} [{self.kind}]"


def problem_findings(each: AuditedProblem) -> Iterator[AuditFinding]:
    """Yield the mistakes in the facts of a problem; for the reachability of its goal, see `reach_findings`."""
    problem = each.problem
    for remark in each.remarks:
        place, _, text = remark.partition(": ")
        yield AuditFinding("remark", place, text)
    for text in contradictions(problem):
        yield AuditFinding("contradictory-start", each.place, text)
    if is_true(problem.goal, problem.true_facts):
        yield AuditFinding("true-at-start", each.place, "the goal is true in the initial state; no action is needed")
    named = {name for fact in fact_values(problem.goal) for name in fact.fact.arguments}
    named |= {problem.parts[name][0] for name in named & problem.parts.keys()}
    if (
        problem.language
        and named
        and not any(_mentions(problem.language, problem.kinds.get(name, name)) for name in named)
    ):
        kinds = ", ".join(sorted({problem.kinds.get(name, name) for name in named - problem.parts.keys()}))
        text = f"{problem.language!r} names none of the goal's objects: {kinds}"
        yield AuditFinding("silent-language", each.place, text)
    facts = (fact.fact for fact in (*problem.initial, *fact_values(problem.goal)))
    used = {name for fact in facts for name in fact.arguments}
    used |= {target for name, (target, _) in problem.parts.items()}
    for name in problem.kinds:
        if name not in used and name not in problem.parts:
            yield AuditFinding("unused-object", each.place, f"{name} is in no fact of the initial state or the goal")


def contradictions(problem: GroundProblem) -> Iterator[str]:
    """Yield the reasons why the initial state of a problem is impossible."""
    false = {each.fact for each in problem.initial if not each.value}
    return _conflicts(problem.true_facts, false, problem, "the initial state")


def goal_contradictions(problem: GroundProblem) -> Iterator[str]:
    """Yield the reasons why no state can have all facts of a goal; disjunctions are not considered."""
    facts = [each for each in conjuncts(problem.goal) if isinstance(each, FactValue)]
    true, false = ({each.fact for each in facts if each.value is value} for value in (True, False))
    return _conflicts(true, false, problem, "the goal")


def _conflicts(true: Set[Atom], false: Set[Atom], problem: GroundProblem, where: str) -> Iterator[str]:
    for fact in sorted(true & false):
        yield f"{where} has both {fact} and its negation"
    places: dict[str, list[Atom]] = {}
    for fact in sorted(true):
        if fact.name in LOCATIONS and len(fact.arguments) == 2 and fact.arguments[0] in problem.movable:
            places.setdefault(fact.arguments[0], []).append(fact)
    for name, facts in places.items():
        if len(facts) > 1:
            yield f"{name} is at {len(facts)} places in {where}: {', '.join(map(str, facts))}"
    below = {name: facts[0].arguments[1] for name, facts in places.items()}
    for name in below:
        passed = [name]
        while passed[-1] in below and len(passed) <= len(below):
            passed.append(below[passed[-1]])
            if passed[-1] == name:
                if name == min(passed):
                    yield f"in {where}, {passed[0]} is on {', which is on '.join(passed[1:])}"
                break


def reach_findings(each: AuditedProblem, warnings: Iterator[str] | list[str]) -> Iterator[AuditFinding]:
    """Yield a finding about a goal that no plan reaches, given the reasons why its domain has no plan."""
    for text in islice(warnings, 1):
        yield AuditFinding("unreachable-goal", each.place, text)


def repeated_names(problems: list[AuditedProblem]) -> Iterator[AuditFinding]:
    """Yield the names that several problems of a suite share."""
    counts = Counter(each.label for each in problems)
    for each in problems:
        if counts[each.label] > 1:
            yield AuditFinding("remark", each.place, f"{counts[each.label]} problems of {each.suite} have this name")


def _mentions(sentence: str, kind: str) -> bool:
    """Return whether a sentence contains a word from the name of a class; plurals and compounds count."""
    words = re.findall(r"[a-z]+", sentence.lower())
    parts = [
        part for part in re.findall(r"[a-z]+", kind.lower()) if len(part) >= SHORTEST and part not in ("region", "of")
    ]
    return any(part in word or (len(word) >= SHORTEST and word in part) for part in parts for word in words)
