"""Compare two evaluations on the scenarios that they share."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

from prag_asp.dataset.strata.stratum_figures import StratumFigures
from prag_asp.errors import QueryError
from prag_asp.evaluation.episode import EvaluatedEpisode
from prag_asp.evaluation.paired import Pairs
from prag_asp.evaluation.results import GROUPINGS, Results
from prag_asp.evaluation.stratified_rates import StratifiedDifference, stratified_difference
from prag_asp.wording import plural


@dataclass(frozen=True)
class PolicyComparison:
    """Pairs of episodes from two evaluations: one pair for each shared scenario.

    `only_first` and `only_second` count episodes without a counterpart; `other_states` counts scenarios whose initial
    states differ, because different versions searched for them. None of these are compared. `strata` holds the strata
    if both evaluations have the same ones and all their episodes are paired.
    """

    pairs: tuple[tuple[EvaluatedEpisode, EvaluatedEpisode], ...]
    only_first: int = 0
    only_second: int = 0
    other_states: int = 0
    strata: tuple[StratumFigures, ...] = ()

    def whole_space(self) -> StratifiedDifference | None:
        """Return the difference over all tasks of the space, or None unless all episodes of equal strata are paired."""
        return stratified_difference(self.pairs, self.strata) if self.strata else None

    def whole(self) -> Pairs:
        """Return the counts over all pairs."""
        return _counted(self.pairs)

    def by(self, what: str) -> Mapping[str, Pairs]:
        """Return the counts of pairs, grouped by ``part``, ``length`` or ``class``.

        Raises:
            QueryError: there is no such grouping.
        """
        if what not in PAIRED:
            raise QueryError(f"pairs are grouped by {', '.join(PAIRED)}, not by {what}")
        groups: dict[int | str, list[tuple[EvaluatedEpisode, EvaluatedEpisode]]] = {}
        for pair in self.pairs:
            first = pair[0]
            keys: Sequence[int | str] = (
                first.classes if what == "class" else [first.length if what == "length" else first.part]
            )
            for key in keys:
                groups.setdefault(key, []).append(pair)
        return {str(key): _counted(groups[key]) for key in sorted(groups, key=lambda key: (str(type(key)), key))}

    def table(self) -> str:
        """Return both rates, their difference with its 95 % interval, and the p-value, for all pairs and by group."""
        rows: list[tuple[str, ...]] = [("", "pairs", "first", "second", "difference", "p")]
        estimate = self.whole_space()
        if estimate is not None:
            shares = (f"{100 * float(each):.0f} %" for each in (estimate.first, estimate.second))
            difference = _percent(estimate.difference, (estimate.low, estimate.high))
            rows.append(("whole space", str(len(self.pairs)), *shares, difference, ""))
        groups = [("all", self.whole())]
        for what in PAIRED:
            found = self.by(what)
            groups += [(f"{what} {name}", pairs) for name, pairs in found.items()] if len(found) > 1 else []
        for name, pairs in groups:
            one, two = pairs.rates
            difference = _percent(pairs.difference, pairs.interval())
            shares = (f"{100 * float(each.share):.0f} %" for each in (one, two))
            rows.append((name, str(pairs.total), *shares, difference, f"{float(pairs.p_value()):.2g}"))
        widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
        return "\n".join(
            "  ".join(
                [f"{row[0]:<{widths[0]}}", *(f"{cell:>{wide}}" for cell, wide in zip(row[1:], widths[1:], strict=True))]
            )
            for row in rows
        )

    def unpaired(self) -> str:
        """Return a line about the episodes that are not compared, or "" if there are none."""
        notes = [
            f"{plural(number, 'episode')} only in the {which}"
            for number, which in ((self.only_first, "first"), (self.only_second, "second"))
            if number
        ]
        if self.other_states:
            notes.append(f"{plural(self.other_states, 'scenario')} with different initial states")
        return f"not compared: {', '.join(notes)}" if notes else ""


PAIRED = tuple(what for what in GROUPINGS if what != "action")
"""The groupings of pairs; they exclude actions, because the subgoals that two policies pursue are not paired."""


def compare(first: Results, second: Results, *, across: bool = False) -> PolicyComparison:
    """Pair the episodes of two evaluations by their scenarios.

    With `across`, evaluations with different domains, controls or step limits are compared as well.

    Raises:
        QueryError: the domain, the control or the step limit differs, a scenario occurs twice, or no episodes can be
            paired.
    """
    difference = first.record.difference(second.record)
    if difference and not across:
        raise QueryError(
            f"the evaluations differ in more than the policy: {difference}; use --across to compare them anyway"
        )
    ours, theirs = _by_scenario(first), _by_scenario(second)
    shared = [(episode, theirs[scenario]) for scenario, episode in ours.items() if scenario in theirs]
    pairs = tuple((one, two) for one, two in shared if one.initial == two.initial)
    if not pairs:
        raise QueryError("the evaluations have no scenario in common; evaluate both on the same scenarios")
    complete = len(pairs) == len(ours) == len(theirs) and first.record.strata == second.record.strata
    strata = tuple(first.record.strata) if complete else ()
    unpaired = len(ours) - len(shared), len(theirs) - len(shared), len(shared) - len(pairs)
    return PolicyComparison(pairs, *unpaired, strata)


def _by_scenario(results: Results) -> dict[str, EvaluatedEpisode]:
    """Return the episodes of an evaluation by their scenarios.

    Raises:
        QueryError: a scenario occurs twice.
    """
    found: dict[str, EvaluatedEpisode] = {}
    for episode in results.episodes:
        if found.setdefault(episode.scenario, episode) is not episode:
            raise QueryError(f"scenario {episode.scenario} occurs twice in the evaluation of {results.record.policy}")
    return found


def _percent(difference: Fraction, interval: tuple[float, float]) -> str:
    """Return a difference with its interval as text, in percentage points."""
    low, high = interval
    return f"{100 * float(difference):+.0f} ({100 * low:+.0f} to {100 * high:+.0f})"


def _counted(pairs: Sequence[tuple[EvaluatedEpisode, EvaluatedEpisode]]) -> Pairs:
    """Return the numbers of pairs in which both policies succeed, only one does, or neither does."""
    outcomes = [(one.success, two.success) for one, two in pairs]
    return Pairs(*map(outcomes.count, ((True, True), (True, False), (False, True), (False, False))))
