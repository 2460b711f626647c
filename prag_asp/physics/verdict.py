"""Budgets and verdicts of physical validation, as values that can be converted to JSON and back."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, replace
from enum import Enum
from typing import Any, Literal

from prag_asp.errors import QueryError
from prag_asp.physics.demonstration.demonstration import Demonstration
from prag_asp.physics.demonstration.footage_strip import strip_url
from prag_asp.physics.witness import Witness
from prag_asp.tables.json_fields import Whole, read, require_complete

Status = Literal["feasible", "not_found", "infeasible"]

LONGEST = 9
"""The maximum number of digits in the text of a number of restarts or samples."""


class Tier(str, Enum):
    """A tier of checks; tiers are ordered by cost, each includes all earlier ones, and each is equal to its name."""

    KINEMATICS = "kinematics"
    SETTLING = "settling"
    TRANSIT = "transit"
    DEMONSTRATION = "demonstration"

    def __str__(self) -> str:
        return self.value


TIERS = tuple(Tier)
"""The tiers of checks, in order of cost."""


@dataclass(frozen=True)
class Budget:
    """The effort of the search for a witness, and the checks that the witness has to pass.

    `restarts` is the number of initial states to try for a task, and `samples` is the number of attempts at each
    action. If objects lack room, a few further restarts pack them tightly. `tier` is the most expensive tier of checks,
    as a `Tier` or its name; the tiers before it in `TIERS` are included.

    Raises:
        QueryError: a number is not positive, or the tier is unknown.
    """

    restarts: Whole = 10
    samples: Whole = 10
    tier: Tier = Tier.KINEMATICS

    @classmethod
    def parse(cls, text: str, tier: Tier = Tier.KINEMATICS) -> Budget:
        """Parse a budget such as ``10x10``, which gives restarts and samples.

        Raises:
            QueryError: the text has a wrong format.
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
        object.__setattr__(self, "tier", Tier(self.tier))

    def __str__(self) -> str:
        return f"{self.restarts} x {self.samples}, {self.tier}"

    def includes(self, tier: Tier) -> bool:
        """Return whether a tier of checks is the tier of this budget or a cheaper one."""
        return TIERS.index(tier) <= TIERS.index(self.tier)

    def to_json(self) -> dict[str, Any]:
        """Return the budget as JSON-compatible data."""
        return {"restarts": self.restarts, "samples": self.samples, "tier": self.tier.value}


@dataclass(frozen=True)
class Detail:
    """The common features of several attempts that failed for the same cause.

    `fact` is a spatial predicate with its arguments, which should have the truth value `value`; `text` states it in
    words. If no fact is to blame, `fact` is "" and `value` is None. `entities` are the bodies and robots involved.
    """

    cause: str
    text: str
    fact: str
    value: bool | None
    entities: tuple[str, ...]
    attempts: Whole

    def __str__(self) -> str:
        return self.text or ", ".join(self.entities)

    def to_json(self) -> dict[str, Any]:
        """Return the detail as JSON-compatible data."""
        return {**asdict(self), "entities": list(self.entities)}


@dataclass(frozen=True)
class Verdict:
    """The result of validating a task, and the effort of the search.

    `reason` is the reason why a task is proved infeasible, or the cause of most failed attempts; `causes` counts the
    failed attempts by cause (one of `CAUSES`), and `details` has the facts and bodies involved; `restarts` is the
    number of initial states tried, including those packed tightly. `seed` and `index` together reproduce the search.
    `demonstration` is present if the budget includes one; it is too large for JSON and is stored in a separate file.
    `nearest` describes in words how far the best attempts came if no witness was found; it is not part of the JSON
    either.
    """

    status: Status
    budget: Budget
    seed: Whole
    index: Whole
    reason: str = ""
    causes: Mapping[str, Whole] = field(default_factory=dict)
    restarts: Whole = 0
    witness: Witness | None = None
    demonstration: Demonstration | None = None
    details: tuple[Detail, ...] = ()
    nearest: str = field(default="", compare=False)

    @property
    def feasible(self) -> bool:
        """Whether a witness was found."""
        return self.status == "feasible"

    def _repr_html_(self) -> str:
        """Return the verdict for a notebook: its status, the effort, and why attempts failed."""
        from prag_asp.html import element, fragment, scroll_table  # noqa: PLC0415 - a verdict alone needs no page

        rows = [("status", self.status.replace("_", " ")), ("budget", str(self.budget))]
        rows += [("reason", self.reason)] if self.reason else []
        rows += [("most often", self.detail)] if self.detail else []
        rows += [("nearest", self.nearest)] if self.nearest else []
        rows += [("initial states tried", str(self.restarts)), ("seed, index", f"{self.seed}, {self.index}")]
        if self.witness is not None:
            rows.append(("witness", f"{len(self.witness.moments)} states with poses and joint angles"))
        if self.demonstration is not None:
            rows.append(("demonstration", "succeeded" if self.demonstration.success else "failed"))
        causes = [(cause, str(count)) for cause, count in sorted(self.causes.items(), key=lambda pair: -pair[1])]
        failed = scroll_table(("cause of failed attempts", "attempts"), causes, label="Failed attempts")
        table = scroll_table(("verdict", ""), rows, label="Verdict")
        footage = None if self.demonstration is None else self.demonstration.footage
        url = None if footage is None else strip_url(footage)
        strip = [] if url is None else [element("img", src=url, alt="The first image and the last one of each subgoal")]
        return fragment(
            table, *strip, *([element("details", element("summary", "Failed attempts"), failed)] if causes else [])
        )

    @property
    def detail(self) -> str:
        """A phrase for the fact or bodies that most often caused the `reason`, if no witness was found."""
        return next((str(detail) for detail in self.details if detail.cause == self.reason), "")

    def to_json(self) -> dict[str, Any]:
        """Return the verdict as JSON-compatible data, without the demonstration."""
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
    def from_json(cls, data: Mapping[str, Any]) -> Verdict:
        """Return the verdict that `to_json` wrote.

        Raises:
            QueryError: the data have a wrong format; the message gives the path of the field.
        """
        verdict = read({**data, "witness": None, "demonstration": None}, cls, "verdict")
        require_complete(data, verdict.to_json(), "verdict")
        witness = data["witness"]
        return replace(verdict, witness=None if witness is None else Witness.from_json(witness, "verdict.witness"))
