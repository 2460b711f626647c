"""Tables of outcomes: pass rates of physics checks, and success rates of policies, with intervals."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from prag_asp.dataset.pass_rates import Rate
from prag_asp.report.report_table import ReportTable, Value
from prag_asp.report.source import PhysicsOutcome, ReportSource

if TYPE_CHECKING:
    from prag_asp.evaluation.results import Results

INTERVAL = "Intervals are Wilson's, at 95 %."


def physics_tables(outcomes: Sequence[PhysicsOutcome]) -> Iterator[ReportTable]:
    """Yield the pass rates by length and by effort, and the causes of failures, or nothing if there are no outcomes."""
    if not outcomes:
        return
    checked = [each for each in outcomes if each.status != "trivial"]
    rows: list[tuple[Value, ...]] = []
    for length in sorted({each.length for each in outcomes}):
        own = [each for each in outcomes if each.length == length]
        number = Counter(each.status for each in own)
        rate = Rate(number["feasible"], len(own) - number["trivial"])
        states = (number["trivial"], number["feasible"], number["not_found"], number["infeasible"])
        rows.append((length, len(own), *states, *_rate_cells(rate)))
    budgets = ", ".join(sorted({each.budget for each in checked}))
    yield ReportTable(
        "pass_rates", "Pass rates of physics by length",
        ("length", "sampled", "trivial", "feasible", "not found", "proved infeasible", "rate", "low", "high"),
        tuple(rows),
        f"Of the sampled tasks that are not trivial. Budget (initial states x attempts, checks): {budgets}. {INTERVAL}",
    )  # fmt: skip
    yield _effort_table(checked)
    causes: Counter[tuple[str, int]] = Counter()
    for each in checked:
        for cause, count in each.causes.items():
            causes[cause, each.length] += count
    yield ReportTable(
        "causes", "Causes of failed attempts", ("cause", "length", "failed attempts"),
        tuple((cause, length, count) for (cause, length), count in sorted(causes.items())),
        "Failed attempts at all checked tasks, including those that were found feasible in the end.",
    )  # fmt: skip
    reasons = Counter((each.status, each.reason, each.length) for each in outcomes if each.status != "feasible")
    yield ReportTable(
        "reasons", "Reasons of rejection", ("status", "reason", "length", "tasks"),
        tuple((status.replace("_", " "), reason, length, count)
              for (status, reason, length), count in sorted(reasons.items())),
    )  # fmt: skip


def _effort_table(checked: Sequence[PhysicsOutcome]) -> ReportTable:
    """Return the share of tasks that are found feasible within each number of initial states."""
    rows: list[tuple[Value, ...]] = []
    for budget in sorted({each.budget for each in checked}):
        own = [each for each in checked if each.budget == budget]
        needed = Counter(each.restarts for each in own if each.status == "feasible")
        most = max((each.restarts for each in own), default=0)
        for restarts in range(1, most + 1):
            passed = sum(count for number, count in needed.items() if number <= restarts)
            rows.append((budget, restarts, passed, len(own), *_rate_cells(Rate(passed, len(own)))))
    return ReportTable(
        "effort", "Pass rates of physics by budget",
        ("budget", "initial states", "feasible", "checked", "rate", "low", "high"), tuple(rows),
        f"Share of the checked tasks that were found feasible with at most this many initial states. {INTERVAL}",
    )  # fmt: skip


def result_tables(source: ReportSource) -> Iterator[ReportTable]:
    """Yield the success rates of each policy, and the reasons why its episodes ended."""
    if not source.evaluations:
        return
    names = policy_names(source.evaluations)
    rows: list[tuple[Value, ...]] = []
    for name, results in zip(names, source.evaluations, strict=True):
        rows.append(
            (name, "all", "all", results.whole().successes, results.whole().trials, *_rate_cells(results.whole()))
        )
        for what in ("part", "length", "action", "class"):
            rates = results.by(what)
            if what != "part" or len(rates) > 1:
                rows += [
                    (name, what, group, rate.successes, rate.trials, *_rate_cells(rate))
                    for group, rate in rates.items()
                ]
    yield ReportTable(
        "results", "Success of policies", ("policy", "by", "group", "successes", "trials", "rate", "low", "high"),
        tuple(rows),
        f"Whole episodes; by action, each subgoal that was pursued counts for the name of its action. {INTERVAL}",
    )  # fmt: skip
    yield ReportTable(
        "endings", "How episodes end", ("policy", "ending", "episodes"),
        tuple((name, cause, count) for name, each in zip(names, source.evaluations, strict=True)
              for cause, count in each.causes().items()),
    )  # fmt: skip


def episode_tables(source: ReportSource) -> Iterator[ReportTable]:
    """Yield the table of all episodes, if there are evaluations."""
    if not source.evaluations:
        return
    names = policy_names(source.evaluations)
    yield ReportTable(
        "episodes", "Episodes",
        ("policy", "scenario", "part", "length", "plan", "instruction", "success",
         "subgoals reached", "steps", "seconds", "ending"),
        tuple(
            (name, each.scenario, each.part, each.length, " ".join(each.task), each.instruction,
             "yes" if each.success else "no", each.reached, each.steps, each.seconds, each.cause)
            for name, results in zip(names, source.evaluations, strict=True) for each in results.episodes
        ),
    )  # fmt: skip


def policy_names(evaluations: Sequence[Results]) -> list[str]:
    """Return a name for each evaluation: its policy, with a number if several evaluations have the same policy."""
    policies = [each.record.policy for each in evaluations]
    seen: Counter[str] = Counter()
    names = []
    for policy in policies:
        seen[policy] += 1
        names.append(policy if policies.count(policy) == 1 else f"{policy} ({seen[policy]})")
    return names


def _rate_cells(rate: Rate) -> tuple[float, float, float]:
    """Return the share of a rate, and the bounds of its interval."""
    low, high = rate.interval()
    return float(rate.share), low, high
