"""Domains that consist of independent parts: each part is explored separately, then their words are shuffled.

A plan of the whole domain is a shuffle of one plan of each part. Therefore the number of plans of length n is the sum,
over all compositions of n into one length per part, of the multinomial coefficient times the product of the parts'
counts (the product formula of exponential generating functions; Stanley, Enumerative Combinatorics 2, 5.1). This
requires that the state of a part does not change while another part acts, which is tested on every state.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from math import comb, prod
from typing import TYPE_CHECKING

from prag_asp.processes.progress_events import stage
from prag_asp.space.automaton.automaton import weights_by_length
from prag_asp.space.automaton.exploration import Extent
from prag_asp.space.engines.reachability import HALT, Explorer, Halt, Reach
from prag_asp.space.limits import LimitClock, limit_error
from prag_asp.stop_reason import LimitCheck, StopReason

if TYPE_CHECKING:
    from prag_asp.logic.step.transition import Transition
    from prag_asp.space.automaton.shuffle_product import ShuffledWords

FEW_STATES = 4096
"""Number of states up to which a domain with parts is counted as a whole, because that result serves more queries."""

MANY_EDGES = 5_000_000
"""Number of edges above which words are searched part by part; below it, exploring the whole domain is fast."""

LARGE_PART = 5_000_000
"""Number of edges of a part above which searching part by part gains nothing."""


@dataclass(frozen=True)
class PartCount:
    """The number of words, the number of explored states, and the limit, if any, that ended the count."""

    found: int
    states: int
    stop: StopReason | None


class IndependentParts:
    """The independent parts of one level of a domain, and the queries that they answer.

    `explorer` explores the whole domain, and `transition` returns its step function. Parts are searched only once the
    whole domain is large.
    """

    def __init__(self, explorer: Explorer, transition: Callable[[], Transition], tell: Callable[[str], None]) -> None:
        self._explorer = explorer
        self._transition = transition
        self._tell = tell
        self._parts: tuple[Transition, ...] | None = None
        self._large = False
        self._reached: tuple[int, list[Reach]] | None = None

    @property
    def counts(self) -> bool:
        """Whether words may be counted part by part, unless a later test fails."""
        if self._explorer.merge is not None:
            return False
        if self._parts is None:
            from prag_asp.logic.step.independent import independent_parts

            self._parts = independent_parts(self._transition(), by_name=self._explorer.level == "skeleton")
        return bool(self._parts)

    @property
    def finds(self) -> bool:
        """Whether words may be searched for part by part: true as long as no part is known to be large."""
        return self.counts and not self._large

    def falls_apart(self, extent: Extent) -> bool:
        """Return whether the whole domain has parts, and enough states to make counting part by part worthwhile."""
        return extent.states > FEW_STATES and self.counts

    def spreads(self, extent: Extent) -> bool:
        """Return whether the whole domain has parts, and enough edges to make searching part by part worthwhile."""
        return extent.edges > MANY_EDGES and self.finds

    def count(self, length: int, clock: LimitClock) -> PartCount | None:
        """Return the number of words of a given length, or None if a part changes while another part acts.

        If a limit was reached, the count is a lower bound. For skeletons, parts share no action name, so different
        skeletons of the parts have different shuffles.
        """
        reaches = self._explore_parts(replace(self._explorer, hopeless=None), length, clock)
        if reaches is None:
            self._parts = ()
            return None
        states = sum(reach.states for reach in reaches)
        self._tell(f"counted in {len(reaches)} independent parts with {states:,} states")
        counts = [weights_by_length(reach.completions, length + 1) for reach in reaches]
        stage("counting shuffles")
        number, late = count_shuffles(counts, clock.to_close().reached_limit)
        return PartCount(number, states, _first_stop(reaches) or late)

    def has_words(self, length: int) -> bool:
        """Return whether all parts have been explored for a length."""
        return self._reached is not None and self._reached[0] >= length

    def words(self, length: int, numbers: Mapping[str, int], clock: LimitClock) -> ShuffledWords | None:
        """Return the words of a given length as shuffles of the parts' words; `numbers` has all letters of the domain.

        The result is None if the parts turn out not to be independent, or if one of them is large as well.

        Raises:
            LimitReached: a limit ended the exploration.
        """
        from prag_asp.space.automaton.shuffle_product import ShuffledWords

        if self._reached is None or not self.has_words(length):
            plain = Explorer(self._explorer.model, self._explorer.level, self._explorer.tell, merge=False)
            reaches = self._explore_parts(plain, length, clock, lambda extent: extent.edges > LARGE_PART)
            if reaches is None:
                self._large = True
                return None
            states, stop = sum(reach.states for reach in reaches), _first_stop(reaches)
            if stop:
                raise limit_error(stop, 0, self._explorer.level, length, states)
            self._reached = (length, reaches)
            self._tell(f"found in {len(reaches)} independent parts with {states:,} states")
        reaches = self._reached[1]
        letters = [[numbers[letter] for letter in reach.letters] for reach in reaches]
        return ShuffledWords([reach.completions for reach in reaches], letters, length)

    def _explore_parts(
        self, explorer: Explorer, length: int, clock: LimitClock, halt: Halt | None = None
    ) -> list[Reach] | None:
        """Return the exploration of each part, or None if `halt` stops one or a part changes while another part acts.

        Once a limit ends one exploration, only the initial states of the other parts are explored.
        """
        reaches: list[Reach] = []
        for part in self._parts or ():
            steps = 0 if _first_stop(reaches) else length
            reaches.append(explorer.reach(part, steps, clock, halt, allow=part.rests))
            if reaches[-1].stop == HALT:
                return None
        return reaches


def _first_stop(reaches: Sequence[Reach]) -> StopReason | None:
    """Return the stop reason of the first exploration that ended early."""
    return next((reach.stop for reach in reaches if reach.stop), None)


def count_shuffles(counts: Sequence[Sequence[int]], check: LimitCheck = lambda: None) -> tuple[int, StopReason | None]:
    """Return the number of shuffles of length n of one word from each part, and the limit that was reached, or None.

    `counts` has, for each part, the numbers of words of the lengths 0, 1, ..., n. If `check` reports a limit, the
    number is a lower bound, computed from the parts shuffled so far.
    """
    first, *others = counts
    whole, length = list(first), len(first) - 1
    for place, part in enumerate(others, 1):
        totals = range(length + 1) if place < len(others) else range(length, length + 1)
        used = [k for k, count in enumerate(part) if count]
        following = []
        for n in totals:
            stop = check()
            if stop:
                return whole[length] * prod(rest[0] for rest in others[place - 1 :]), stop
            following.append(sum(comb(n, k) * part[k] * whole[n - k] for k in used if k <= n))
        whole = following
    return whole[-1], None
