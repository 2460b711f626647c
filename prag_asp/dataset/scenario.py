"""Scenario ids: short texts that identify a task and its initial state in every process.

An id is ``DOMAIN:DIGEST:LENGTH:RANK[:START][~CONDITION...]``, such as ``tabletop:8f6c01b2d4:2:181:7.3~uses+can_1``:

- the name of the domain, with set constants as ``,NAME=VALUE``, and a digest of everything on which its tasks and
  initial states depend (`prag_asp.dataset.scenarios`);
- the length of the task, and its rank among the tasks of this length that satisfy the conditions;
- the search that found the initial state, as ``SEED.INDEX``, followed by ``.RESTARTSxSAMPLES-TIER-KIND...`` if the
  budget is not the default or properties vary in the demonstration; without physics, the search is missing;
- the conditions, each after a ``~``.

Texts are percent-encoded as in a URL; a space becomes ``+``. Each scenario has exactly one id.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING
from urllib.parse import quote, quote_plus, unquote, unquote_plus

from prag_asp.errors import QueryError
from prag_asp.integers import digits_of, number_of
from prag_asp.task import FrozenDict

if TYPE_CHECKING:
    from prag_asp.physics import Budget, Staging

DIGITS = 10
"""The number of hexadecimal digits in the digest of a domain; two versions have the same digest with probability
10^-12.
"""

LONGEST = 100_000
"""The maximum number of characters in an id; ranks of tasks with thousands of actions have thousands of digits."""

NUMBER = r"0|[1-9]\d*"
FORM = re.compile(
    rf"(?P<name>[^:,~=]+)(?P<constants>(?:,[^:,~=]+=[^:,~=]+)*):(?P<digest>[\da-f]{{{DIGITS}}})"
    rf":(?P<length>0|[1-9]\d{{0,8}}):(?P<rank>{NUMBER})(?::(?P<start>[^:~]+))?(?P<where>(?:~[^:~]+)*)"
)
START = re.compile(
    r"(?P<seed>0|[1-9]\d{0,18})\.(?P<index>0|[1-9]\d{0,18})"
    r"(?:\.(?P<budget>[1-9]\d{0,8}x[1-9]\d{0,8})-(?P<tier>[a-z]+)(?P<vary>(?:-[a-z]+)*))?"
)


@dataclass(frozen=True)
class SearchStart:
    """The search that finds an initial state for a task, with a witness; without a `budget`, the default applies."""

    seed: int
    index: int = 0
    budget: Budget | None = None
    vary: tuple[str, ...] = ()

    @classmethod
    def of(cls, seed: int, index: int, budget: Budget | None, staging: Staging | None = None) -> SearchStart:
        """Return a search in its shortest form, without a default budget and without properties that do not vary."""
        from prag_asp.physics import Budget, Tier

        budget = budget or Budget()
        vary = staging.vary if staging is not None and budget.includes(Tier.DEMONSTRATION) else ()
        return cls(seed, index, None if budget == Budget() else budget, vary)

    @classmethod
    def parse(cls, text: str) -> SearchStart:
        """Return the search described by a text that `str` has written.

        Raises:
            QueryError: the text is malformed.
        """
        match = START.fullmatch(text)
        if match is None:
            raise QueryError(f"the start {text!r:.40} is not SEED.INDEX")
        seed, index = int(match["seed"]), int(match["index"])
        if match["budget"] is None:
            return cls(seed, index)
        from prag_asp.physics import TIERS, Budget, Staging

        if match["tier"] not in TIERS:
            raise QueryError(f"there is no tier {match['tier']}")
        budget = Budget.parse(match["budget"], TIERS[TIERS.index(match["tier"])])
        return cls.of(seed, index, budget, Staging(vary=tuple(match["vary"].split("-")[1:])))

    def __str__(self) -> str:
        text = f"{self.seed}.{self.index}"
        if self.budget is None:
            return text
        budget = self.budget
        return f"{text}.{'-'.join([f'{budget.restarts}x{budget.samples}', budget.tier.value, *self.vary])}"


@dataclass(frozen=True)
class Scenario:
    """A task, given by its rank among the tasks of its length that satisfy the conditions, and its initial state.

    `digest` is the digest of the domain. Without physics, there is no `start`.
    """

    domain: str
    digest: str
    length: int
    rank: int
    start: SearchStart | None = None
    where: tuple[str, ...] = ()
    constants: Mapping[str, str] = field(default_factory=FrozenDict)

    @classmethod
    def parse(cls, text: str) -> Scenario:
        """Return the scenario with a given id.

        Raises:
            QueryError: the text is not an id.
        """
        match = FORM.fullmatch(text) if isinstance(text, str) and len(text) <= LONGEST and text.isascii() else None
        try:
            if match is None:
                raise QueryError("it is not DOMAIN:DIGEST:LENGTH:RANK[:SEED.INDEX][~CONDITION]")
            constants = (each.split("=") for each in match["constants"].split(",")[1:])
            scenario = cls(
                unquote(match["name"]),
                match["digest"],
                int(match["length"]),
                number_of(match["rank"]),
                None if match["start"] is None else SearchStart.parse(match["start"]),
                tuple(map(unquote_plus, match["where"].split("~")[1:])),
                FrozenDict({unquote(name): unquote(value) for name, value in constants}),
            )
            if str(scenario) != text:
                raise QueryError(f"write {str(scenario)!r:.200}")
        except QueryError as error:
            remedy = "copy an id as prag-asp sample --format scenario prints it"
            raise QueryError(f"{text!r:.200} is not a scenario id: {error}; {remedy}") from None
        return scenario

    def __str__(self) -> str:
        constants = "".join(f",{_quoted(name)}={_quoted(value)}" for name, value in self.constants.items())
        parts = [f"{_quoted(self.domain)}{constants}", self.digest, str(self.length), digits_of(self.rank)]
        parts += [] if self.start is None else [str(self.start)]
        return ":".join(parts) + "".join(f"~{_quoted(each, quote_plus)}" for each in self.where)

    @property
    def task(self) -> Scenario:
        """The scenario without its initial state, which is equal for all scenarios of a task."""
        return Scenario(self.domain, self.digest, self.length, self.rank, None, self.where, self.constants)


def _quoted(text: str, quoting: Callable[..., str] = quote) -> str:
    """Return a text in which all characters except letters, digits, ``-``, ``_`` and ``.`` are percent-encoded."""
    return quoting(text, safe="").replace("~", "%7E")
