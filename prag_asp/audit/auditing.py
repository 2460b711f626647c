"""Audit suites of problems: distinct tasks, overlaps, combinations and mistakes."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from prag_asp.audit.audited_problem import AuditedProblem, moved_pairs, pair_of, target_kind
from prag_asp.audit.canonical_facts import Form
from prag_asp.audit.goal_distance import goal_distance
from prag_asp.audit.problem_checks import AuditFinding, goal_contradictions, problem_findings, reach_findings
from prag_asp.errors import PragError, QueryError
from prag_asp.processes.progress_events import report_progress, stage

if TYPE_CHECKING:
    from prag_asp.domain.load import Domain

Progress = Callable[[str, int, int], None]

LARGEST_DOMAIN = 1_000_000
"""The maximum of m n^2, for m movable objects among n objects, with which a domain is loaded.

The number of facts in manipulation domains grows with this product; 500,000 take about a minute.
"""


@dataclass(frozen=True)
class SuiteCounts:
    """A suite: the numbers of its files, of the problems that were read, and of distinct goals and tasks."""

    suite: str
    files: int
    problems: int
    goals: int
    tasks: int


@dataclass(frozen=True)
class SuiteOverlap:
    """The number of problems in `test` whose goal, or goal and initial state, occurs in a problem in `train`."""

    test: str
    train: str
    problems: int
    goals: int
    tasks: int


@dataclass(frozen=True)
class NearestProblem:
    """The problem in another suite whose goal is nearest; `distance` is computed by `goal_distance`."""

    suite: str
    problem: str
    nearest: str
    distance: int
    same_start: bool


@dataclass(frozen=True)
class Combinations:
    """Pairs of a target and a class whose objects goals move there.

    `classes` and `targets` are those in any goal, `occurring` holds the pairs that occur in some goal, `present` holds
    the pairs for which some problem has objects, and `reachable` holds the pairs that the actions of some problem can
    make true according to the delete relaxation.
    """

    classes: tuple[str, ...]
    targets: tuple[str, ...]
    occurring: frozenset[tuple[str, str]]
    present: frozenset[tuple[str, str]]
    reachable: frozenset[tuple[str, str]] | None

    @property
    def possible(self) -> int:
        """The number of all pairs of a class and a target."""
        return len(self.classes) * len(self.targets)


@dataclass(frozen=True)
class BenchmarkAudit:
    """The result of an audit; `same` holds the groups of problems with the same goal, largest first."""

    suites: tuple[SuiteCounts, ...]
    total: SuiteCounts
    same: tuple[tuple[str, ...], ...]
    overlaps: tuple[SuiteOverlap, ...]
    nearest: tuple[NearestProblem, ...]
    combinations: Combinations
    findings: tuple[AuditFinding, ...]


def audit_problems(
    problems: Sequence[AuditedProblem],
    unreadable: Sequence[tuple[str, AuditFinding]] = (),
    *,
    train: Sequence[str] = (),
    reach: bool = True,
    progress: Progress = report_progress,
) -> BenchmarkAudit:
    """Audit the problems of suites; `unreadable` holds a suite and a finding for each file that could not be read.

    For each problem, the nearest problem is searched for in the suites `train` or, by default, in all other suites.
    With `reach`, the domain of each problem is loaded to find goals that no plan reaches; problems with the same `load`
    share a domain.
    """
    names = list(dict.fromkeys([*(each.suite for each in problems), *(suite for suite, _ in unreadable)]))
    by_suite = {name: [each for each in problems if each.suite == name] for name in names}
    failures = {name: sum(suite == name for suite, _ in unreadable) for name in names}
    counts = [_counts(name, by_suite[name], failures[name]) for name in names]
    findings = [finding for _, finding in unreadable]
    findings += [finding for each in problems for finding in problem_findings(each)]
    nearest = [*_nearest(problems, by_suite, train, findings)]
    combinations, reached = _combinations(problems, reach=reach, progress=progress)
    groups: dict[Form, list[str]] = {}
    for each in problems:
        groups.setdefault(each.goal_form, []).append(each.label)
    same = sorted((tuple(each) for each in groups.values() if len(each) > 1), key=lambda each: -len(each))
    overlaps = [
        _overlap(by_suite[test], by_suite[other], test, other) for test in names for other in names if test != other
    ]
    return BenchmarkAudit(
        tuple(counts),
        _counts("all", problems, len(unreadable)),
        tuple(same),
        tuple(overlaps),
        tuple(nearest),
        combinations,
        (*findings, *reached),
    )


def _counts(name: str, problems: Sequence[AuditedProblem], failed: int) -> SuiteCounts:
    goals, tasks = ({form(each) for each in problems} for form in (_goal_form, _task_form))
    return SuiteCounts(name, len(problems) + failed, len(problems), len(goals), len(tasks))


def _overlap(test: Sequence[AuditedProblem], train: Sequence[AuditedProblem], name: str, other: str) -> SuiteOverlap:
    goals, tasks = {each.goal_form for each in train}, {each.task_form for each in train}
    return SuiteOverlap(
        name,
        other,
        len(test),
        sum(each.goal_form in goals for each in test),
        sum(each.task_form in tasks for each in test),
    )


def _goal_form(each: AuditedProblem) -> Form:
    return each.goal_form


def _task_form(each: AuditedProblem) -> Form:
    return each.task_form


def _nearest(
    problems: Sequence[AuditedProblem],
    by_suite: dict[str, list[AuditedProblem]],
    train: Sequence[str],
    findings: list[AuditFinding],
) -> Iterator[NearestProblem]:
    """Yield the problem with the nearest goal for each problem outside `train`; ties prefer the same initial state.

    A problem whose goal cannot be compared with every other goal is skipped, and added to the findings.
    """
    distances: dict[tuple[Form, Form], int] = {}
    for each in problems:
        others = [
            other
            for suite, members in by_suite.items()
            if suite != each.suite and (suite in train or not train)
            for other in members
        ]
        if not others or each.suite in train:
            continue

        def distance(other: AuditedProblem, one: AuditedProblem = each) -> tuple[int, bool, str]:
            key = (one.goal_form, other.goal_form)
            if key not in distances:
                kinds = (one.problem.kinds, other.problem.kinds)
                same = key[0] == key[1]
                try:
                    distances[key] = 0 if same else goal_distance(one.goal_facts, other.goal_facts, kinds)
                except QueryError as error:
                    raise QueryError(f"compared with {other.label}, {error}") from None
            return distances[key], one.task_form != other.task_form, other.label

        try:
            best = min(others, key=distance)
        except QueryError as error:
            findings.append(AuditFinding("uncompared-goal", each.place, str(error)))
            continue
        yield NearestProblem(each.suite, each.label, best.label, distance(best)[0], each.task_form == best.task_form)


def _combinations(
    problems: Sequence[AuditedProblem], *, reach: bool, progress: Progress
) -> tuple[Combinations, list[AuditFinding]]:
    """Return the pairs of classes and targets, and the goals that cannot be reached."""
    occurring = frozenset(pair for each in problems for pair in moved_pairs(each.problem))
    classes, targets = sorted({one for one, _ in occurring}), sorted({other for _, other in occurring})
    wanted = {(one, other) for one in classes for other in targets}
    present: set[tuple[str, str]] = set()
    reachable: set[tuple[str, str]] = set()
    findings: list[AuditFinding] = []
    loaded: dict[Callable[[], Domain], set[tuple[str, str]]] = {}
    for number, each in enumerate(problems):
        found = _pairs_of(each, targets) & wanted
        present |= found
        if reach and each.load is not None:
            progress(f"checking {each.label}", number, len(problems))
            if each.load not in loaded:
                reasons, loaded[each.load] = _reach(each, each.load)
                findings += reasons
            reachable |= found & loaded[each.load]
    return Combinations(
        tuple(classes), tuple(targets), occurring, frozenset(present), frozenset(reachable) if reach else None
    ), findings


def _pairs_of(each: AuditedProblem, targets: Sequence[str]) -> set[tuple[str, str]]:
    """Return the pairs of a class and a target for which a problem has objects."""
    problem = each.problem
    relations: dict[str, set[str]] = {}
    for target in targets:
        relation, _, kind = target.partition(" ")
        relations.setdefault(kind, set()).add(relation)
    return {
        (problem.kinds[one], f"{relation} {kind}")
        for other in problem.kinds
        for kind in [target_kind(problem, other)]
        for relation in relations.get(kind, ())
        for one in problem.movable or problem.kinds
        if one != other
    }


def _reach(each: AuditedProblem, load: Callable[[], Domain]) -> tuple[list[AuditFinding], set[tuple[str, str]]]:
    """Return the findings about the goal of a problem, and the pairs that actions can make true."""
    problem = each.problem
    if len(problem.movable) * len(problem.kinds) ** 2 > LARGEST_DOMAIN:
        text = (
            f"whether a plan reaches the goal is not known: {len(problem.movable)} objects that can be moved and "
            f"{len(problem.kinds)} objects and regions give too many actions; use fewer objects"
        )
        return [AuditFinding("unchecked-goal", each.place, text)], set()
    stage(f"loading {each.label}")
    try:
        domain = load()
    except PragError as error:
        if conflict := next(goal_contradictions(each.problem), None):
            return [*reach_findings(each, [conflict])], set()
        text = f"whether a plan reaches the goal is not known: {error.lines[0]}"
        return [AuditFinding("unchecked-goal", each.place, text)], set()
    reasons = [warning.text for warning in domain.warnings if warning.name == "no-plan"]
    effects = domain.facts.postconditions
    made = {fluent for action in domain.facts.tried for fluent, value in effects.get(action, ()) if value != "false"}
    made |= {fluent for fluent, value in domain.facts.initially if value == "true"}
    facts = [each.own_fact(fluent) for fluent in made]
    kinds = each.problem.kinds
    return [*reach_findings(each, reasons)], {
        pair_of(each.problem, fact) for fact in facts if len(fact.arguments) == 2 and kinds.keys() >= {*fact.arguments}
    }
