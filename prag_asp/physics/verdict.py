"""The outcome of a physical check, as values that round-trip to JSON."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, get_args

import msgspec

from prag_asp.errors import QueryError
from prag_asp.physics.witness import Witness, witness_of
from prag_asp.tables.json_fields import Whole, one_of, read

if TYPE_CHECKING:
    from prag_asp.physics.demonstration.demonstration import Demonstration

Status = Literal["feasible", "not_found", "infeasible"]
Tier = Literal["kinematics", "settling", "transit", "demonstration"]
STATUSES: tuple[Status, ...] = get_args(Status)
TIERS: tuple[Tier, ...] = get_args(Tier)
"""The tiers of checks, the cheapest first."""

LONGEST = 9
"""Digits of a number of a budget that a text spells."""


@dataclass(frozen=True)
class Budget:
    """How hard to look for a witness, and what it has to pass.

    `restarts` are the first states tried for a task, `samples` the attempts at each action. `tier` is the
    dearest tier of checks; those before it in `TIERS` are included.

    Raises:
        QueryError: a number is not positive, or the tier is unknown.
    """

    restarts: int = 10
    samples: int = 10
    tier: Tier = "kinematics"

    @classmethod
    def parse(cls, text: str, tier: Tier = "kinematics") -> Budget:
        """Return the budget that a text such as ``10x10`` spells: restarts, and samples.

        Raises:
            QueryError: it spells none.
        """
        restarts, _, samples = text.partition("x")
        if not all(each.isdecimal() and len(each) <= LONGEST and int(each) for each in (restarts, samples)):
            most = f"two numbers from 1 to {10**LONGEST - 1:,}"
            raise QueryError(f"budget {text!r}: write RESTARTSxSAMPLES, {most}, such as 10x10")
        return cls(int(restarts), int(samples), tier)

    def __post_init__(self) -> None:
        if self.restarts < 1 or self.samples < 1:
            raise QueryError(f"a budget needs at least 1 restart and 1 sample; got {self.restarts} x {self.samples}")
        if self.tier not in TIERS:
            raise QueryError(f"unknown tier of checks {self.tier!r}; known are {', '.join(TIERS)}")

    def __str__(self) -> str:
        return f"{self.restarts} x {self.samples}, {self.tier}"

    def includes(self, tier: Tier) -> bool:
        """Tell whether a tier of checks is asked for."""
        return TIERS.index(tier) <= TIERS.index(self.tier)

    def to_json(self) -> dict[str, Any]:
        """Return the budget as JSON-able data."""
        return {"restarts": self.restarts, "samples": self.samples, "tier": self.tier}


class Detail(NamedTuple):
    """Of what attempts failed for a cause, and how many of them.

    `fact` is a spatial predicate with its arguments that should have the `value`, told in words by `text`; where no
    fact is to blame it is "", and the value None. `entities` are the bodies and robots concerned.
    """

    cause: str
    text: str
    fact: str
    value: bool | None
    entities: tuple[str, ...]
    attempts: int

    def __str__(self) -> str:
        return self.text or ", ".join(self.entities)

    def to_json(self) -> dict[str, Any]:
        """Return the detail as JSON-able data."""
        return {**self._asdict(), "entities": list(self.entities)}


class _BudgetForm(msgspec.Struct):
    """A budget as it stands in a file."""

    restarts: Whole
    samples: Whole
    tier: str


class _DetailForm(msgspec.Struct):
    """A detail as it stands in a file."""

    cause: str
    text: str
    fact: str
    value: bool | None
    entities: tuple[str, ...]
    attempts: Whole


class _VerdictForm(msgspec.Struct):
    """A verdict as it stands in a file."""

    status: str
    budget: _BudgetForm
    seed: Whole
    index: Whole
    reason: str
    causes: dict[str, Whole]
    restarts: Whole
    witness: Any
    details: tuple[_DetailForm, ...] = ()


@dataclass(frozen=True)
class Verdict:
    """What physics says of a task, and how hard it looked.

    `reason` says why a task is proved infeasible or could not be looked at; `causes` counts why attempts failed, by the
    kinds in `CAUSES`, and `details` name of what; `restarts` is how many first states were tried. `seed` and `index`
    together repeat the search. `demonstration` is there where the budget asks for one; it is too large for JSON, and
    has a file of its own.
    """

    status: Status
    budget: Budget
    seed: int
    index: int
    reason: str = ""
    causes: Mapping[str, int] = field(default_factory=dict)
    restarts: int = 0
    witness: Witness | None = None
    demonstration: Demonstration | None = None
    details: tuple[Detail, ...] = ()

    @property
    def feasible(self) -> bool:
        """Whether a witness was found."""
        return self.status == "feasible"

    @property
    def detail(self) -> str:
        """In words the fact, or the bodies, to blame most often for the reason of a task that was not found."""
        return next((str(detail) for detail in self.details if detail.cause == self.reason), "")

    def to_json(self) -> dict[str, Any]:
        """Return the verdict as JSON-able data."""
        return {
            "status": self.status,
            "budget": self.budget.to_json(),
            "seed": self.seed,
            "index": self.index,
            "reason": self.reason,
            "causes": dict(self.causes),
            "restarts": self.restarts,
            "witness": None if self.witness is None else self.witness.to_json(),
            **({"details": [detail.to_json() for detail in self.details]} if self.details else {}),
        }

    @classmethod
    def from_json(cls, data: Mapping[str, Any], robot: str = "panda") -> Verdict:
        """Return the verdict that `to_json` wrote; `robot` is the single one of a witness of the form before.

        Raises:
            QueryError: the data are of another form; the message names the field by its path.
        """
        form = read(data, _VerdictForm, "verdict")
        budget = form.budget
        return cls(
            status=one_of(STATUSES, form.status, "verdict.status"),
            budget=Budget(budget.restarts, budget.samples, one_of(TIERS, budget.tier, "verdict.budget.tier")),
            seed=form.seed,
            index=form.index,
            reason=form.reason,
            causes=form.causes,
            restarts=form.restarts,
            witness=None if form.witness is None else witness_of(form.witness, "verdict.witness", robot),
            details=tuple(Detail(*msgspec.structs.astuple(detail)) for detail in form.details),
        )
