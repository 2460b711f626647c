"""The request for a dataset as one value: all inputs, apart from the task space, that determine the bytes."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction
from math import ceil
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import msgspec

from prag_asp.errors import QueryError
from prag_asp.grammar.phrasings import Phrasings
from prag_asp.integers import digits_of, number_of
from prag_asp.physics.filming.episode_options import Staging
from prag_asp.physics.verdict import Budget, Tier
from prag_asp.space.sampling.sharding import ALL, Deal
from prag_asp.space.strata.allocation import StratifiedBy
from prag_asp.tables.json_fields import Whole

if TYPE_CHECKING:
    from prag_asp.domain.load import Domain
    from prag_asp.exact_numbers import Number
    from prag_asp.space.task_space import TaskSpace
    from prag_asp.space.weights.temperature import Temperature
    from prag_asp.space.without_replacement import Division

SHARD = 1000
"""The default number of tasks in a full shard."""

LARGEST_SHARD, MOST_STARTS = 20_000, 1000
"""The maximum numbers of tasks in a shard and of witnesses for a task; they are in memory together (up to a few GB)."""

MOST_CANDIDATES = 100_000
"""The maximum number of candidates for tasks that are far apart; they are all in memory, at a few kB each."""

FOR_EACH_DIVERSE = 20
"""The default number of candidates per requested task."""

DRAWS_FOR_EACH = 1000
"""The default limit on draws for a part, per requested task."""

ExcludedTask = Annotated[str, msgspec.Meta(pattern="^(0|[1-9][0-9]{0,8}):(0|[1-9][0-9]*)$")]
"""The length and the rank of a task, such as ``2:181``."""

LARGEST_SEED = 2**63 - 1
"""The largest seed; seeds are stored in columns of 64-bit integers."""


class ApartSpec(msgspec.Struct, frozen=True):
    """A set of tasks, given by lengths and conditions, and the minimum distance of tasks from it, in edits."""

    distance: Annotated[int, msgspec.Meta(ge=1, le=100)]
    lengths: list[Whole]
    where: list[str]

    def space(self, near: TaskSpace) -> TaskSpace:
        """Return the set of tasks as a space, with the domain and the limits of another space."""
        from prag_asp.space.task_space import TaskSpace

        return TaskSpace(near.domain, self.lengths, limits=near.engines.limits).where(*self.where)


class DatasetSpec(msgspec.Struct, frozen=True, kw_only=True):
    """The request for a dataset, as passed to `generate` and stored in dataset.json.

    `split` holds the exact share of each part. `weights` and `temperature` are exact numbers as text. Without a
    `budget`, tasks are not validated by physics. Unless `trivial` is set, tasks whose final state equals the initial
    state are left out. `part`, such as ``3/64``, selects every 64th draw from the third on; other machines generate the
    rest. `excluded` holds the length and rank of each task to leave out. With `over`, a skeleton or a goal is sampled
    uniformly before a task. With `strata`, the parts are the strata of a sample. With `cover`, the first tasks cover
    all combinations of that many factors; all these tasks are included, even if `tasks` is smaller. With `candidates`,
    tasks that are far apart are chosen from that many sampled ones. With `apart`, all tasks are far from other sets of
    tasks.

    Raises:
        QueryError: a number is out of range.
    """

    tasks: Whole
    seed: Whole = 0
    split: dict[str, str]
    skeletons: bool = False
    hold_out: str | None = None
    starts: Whole = 1
    demonstrate: bool = False
    evenly: bool = False
    trivial: bool = False
    weights: dict[str, str] = {}
    temperature: str = "1"
    budget: Budget | None = None
    shard: Whole = SHARD
    language: str = "en"
    phrasings: str = ""
    staging: Staging | None = None
    part: Annotated[str, msgspec.Meta(pattern="^[1-9][0-9]{0,6}/[1-9][0-9]{0,6}$")] | None = None
    excluded: list[ExcludedTask] | msgspec.UnsetType = msgspec.UNSET
    strata: StratifiedBy | msgspec.UnsetType = msgspec.UNSET
    over: Literal["skeletons", "goals"] | msgspec.UnsetType = msgspec.UNSET
    cover: Annotated[int, msgspec.Meta(ge=1, le=8)] | msgspec.UnsetType = msgspec.UNSET
    candidates: Annotated[int, msgspec.Meta(ge=1, le=MOST_CANDIDATES)] | msgspec.UnsetType = msgspec.UNSET
    apart: list[ApartSpec] | msgspec.UnsetType = msgspec.UNSET

    def __post_init__(self) -> None:
        if self.tasks < 1:
            raise QueryError(f"tasks {self.tasks}: a dataset needs at least 1")
        for name, number, most in (("starts", self.starts, MOST_STARTS), ("shard", self.shard, LARGEST_SHARD)):
            if not 1 <= number <= most:
                raise QueryError(f"{name} {number}: give a number from 1 to {most}")
        if not 0 <= self.seed <= LARGEST_SEED:
            raise QueryError(f"seed {self.seed}: give one from 0 to {LARGEST_SEED}")

    @classmethod
    def of(
        cls,
        domain: Domain,
        *,
        split: Mapping[str, Number | float] | None = None,
        skeletons: bool = False,
        hold_out: str | None = None,
        weights: Mapping[str, Number] | None = None,
        temperature: Temperature = 1,
        physics: bool | None = None,
        phrasings: str = "",
        part: str | None = None,
        excluded: Iterable[tuple[int, int]] = (),
        strata: StratifiedBy | None = None,
        over: Literal["skeletons", "goals"] | None = None,
        cover: int | None = None,
        diverse: int | None = None,
        candidates: int | None = None,
        apart: Sequence[ApartSpec] = (),
        **fields: Any,
    ) -> DatasetSpec:
        """Return the request for a dataset of `tasks` distinct feasible tasks from a domain; `fields` holds the others.

        Tasks are sampled without replacement, with `weights` or the weights of the domain; lengths occur in exact
        proportion to their numbers of tasks, or in turn with `evenly`. With ``over="skeletons"`` (or ``"goals"``, which
        needs a single length), a skeleton (or a goal) is sampled uniformly first. With `split`, each part gets its
        share of the tasks, and no two parts have a task (or, with `skeletons`, a skeleton) in common; with `hold_out`,
        only ``test`` has the held-out tasks. For each task, witnesses are searched for from `starts` initial states.
        Unless `trivial` is set, tasks whose final state equals the initial state are excluded. With `demonstrate`, the
        robot executes each task; `staging` specifies the cameras that record it and the properties that vary. Without
        `physics`, which is the default if the domain has no scene, all sampled tasks are accepted. Instructions are in
        a `language` of the domain; `phrasings`, such as ``1 of 2``, restricts them to some of its phrasings. A shard
        has at most `shard` tasks. With ``part="3/64"``, only every 64th draw from the third on is validated, to find a
        64th of the tasks.

        `excluded` holds the tasks to leave out, as pairs of a length and a rank. With `strata`, `split` holds the
        share of each stratum in the sample, as `stratified_shares` returns it; strata are sampled uniformly.

        With `cover`, the first tasks cover all reachable combinations of that many factors; if physics rejects one,
        others replace it. `tasks` can then be omitted; if it is larger, further tasks are sampled uniformly. With
        `diverse` instead of `tasks`, that many tasks are far apart; they are chosen from `candidates` sampled tasks, by
        default 20 times as many. With `apart`, only tasks that are far from all tasks of other sets are sampled.

        Raises:
            QueryError: a value is out of range, or two of them contradict each other.
            SceneError: cameras are requested, and the domain has no scene.
            PhysicsMissingError: PyBullet is not installed.
        """
        from prag_asp.space.without_replacement import Division

        division = Division.parse(split, skeletons=skeletons, hold_out=hold_out, strata=strata)
        fields["tasks"] = _number_of_tasks(fields.pop("tasks", None), cover, diverse, candidates)
        if diverse is not None and candidates is None:
            candidates = min(FOR_EACH_DIVERSE * diverse, MOST_CANDIDATES)
        uniform = strata or cover is not None
        weights = ({} if uniform else domain.settings.weights) if weights is None else weights
        excluded = list(excluded)
        others = {"weights": weights, "over": over, "evenly": fields.get("evenly"), "excluded": excluded}
        _check_choice(cover, diverse, division, part, apart, [name for name, value in others.items() if value])
        spec = cls(
            split={name: str(share) for name, share in division.shares.items()},
            skeletons=skeletons,
            hold_out=hold_out,
            weights={key: str(weight) for key, weight in weights.items()},
            temperature=str(temperature),
            phrasings=str(Phrasings.parse(phrasings)),
            part=None if part is None or Deal.parse(part) == ALL else str(Deal.parse(part)),
            excluded=[f"{length}:{digits_of(rank)}" for length, rank in sorted(set(excluded))] or msgspec.UNSET,
            strata=strata or msgspec.UNSET,
            over=over or msgspec.UNSET,
            cover=msgspec.UNSET if cover is None else cover,
            candidates=msgspec.UNSET if candidates is None else candidates,
            apart=[*apart] or msgspec.UNSET,
            **fields,
        )
        budget = spec._budget_in(domain, bool(domain.settings.scene) if physics is None else physics)
        return msgspec.structs.replace(spec, budget=budget)

    def _budget_in(self, domain: Domain, physics: bool) -> Budget | None:
        """Check the physics options, and return the budget; with demonstrations, its tier includes them."""
        from prag_asp.physics import require_physics

        if physics:
            require_physics()
        elif self.demonstrate or self.starts > 1 or self.budget is not None:
            raise QueryError("demonstrations, initial states and a budget need physics; leave them out")
        folder = "" if self.demonstrate else None
        if self.staging is not None:
            require_demonstrated(self.staging, folder)
            if "colour" in self.staging.vary and self.starts > 1:
                raise QueryError(
                    f"instructions name the colours in one recording, but {self.starts} starts have {self.starts}; "
                    "request 1 start, or do not vary colour"
                )
            from prag_asp.dataset.scenes import scene_of

            self.staging.cameras_of(scene_of(domain))
        return budget_of(self.budget, folder) if physics else None

    @property
    def division(self) -> Division:
        """The division of the tasks into parts.

        Raises:
            QueryError: the shares do not add up to 1, or conflict with the other options.
        """
        from prag_asp.space.without_replacement import Division

        strata = self.strata or None
        return Division.parse(self.split, skeletons=self.skeletons, hold_out=self.hold_out, strata=strata)

    @property
    def excluded_ranks(self) -> list[tuple[int, int]]:
        """The lengths and ranks of the excluded tasks."""
        pairs = (text.split(":") for text in self.excluded or ())
        return [(int(length), number_of(rank)) for length, rank in pairs]

    @property
    def deal(self) -> Deal:
        """The draws that this machine validates."""
        return ALL if self.part is None else Deal.parse(self.part)

    def tasks_of(self, share: Fraction) -> int:
        """Return the number of tasks in a part with a share, rounded up so that it never shrinks when a request grows.

        If there are several machines, this is the number of tasks for each of them.
        """
        return ceil(Fraction(ceil(self.tasks * share), self.deal.of))

    def candidates_of(self, share: Fraction) -> int:
        """Return the number of candidates for a part with a share."""
        return ceil((self.candidates or 0) * share)

    def draws_of(self, share: Fraction, max_draws: int | None) -> int:
        """Return the number of draws after which sampling stops for a part with the given share."""
        return max_draws or DRAWS_FOR_EACH * self.tasks_of(share)

    def fixed(self) -> dict[str, Any]:
        """Return the values that must not change when a dataset is extended: all except the number of tasks."""
        return {name: value for name, value in msgspec.to_builtins(self).items() if name != "tasks"}


def _number_of_tasks(tasks: int | None, cover: int | None, diverse: int | None, candidates: int | None) -> int:
    """Return the number of tasks in a dataset, at least 1 if they cover combinations.

    Raises:
        QueryError: the number is missing or given twice, or there are fewer candidates than tasks.
    """
    if diverse is None:
        if candidates is not None:
            raise QueryError("candidates are for tasks that are far apart; add diverse, the number of tasks")
        if tasks is None and cover is None:
            raise QueryError("the number of tasks is missing; give tasks, cover or diverse")
        return 1 if tasks is None else tasks
    if tasks is not None:
        raise QueryError(f"diverse {diverse} is the number of tasks; leave tasks out")
    if candidates is not None and not diverse <= candidates <= MOST_CANDIDATES:
        raise QueryError(f"candidates {candidates}: give a number from {diverse} to {MOST_CANDIDATES}")
    return diverse


def _check_choice(
    cover: int | None, diverse: int | None, division: Division, part: str | None, apart: Sequence[ApartSpec],
    others: Sequence[str],
) -> None:  # fmt: skip
    """Check that the options for choosing tasks do not conflict with each other or with `others`, the other given ones.

    Raises:
        QueryError: two options exclude each other.
    """
    for name in others:
        if division.strata is not None:
            raise QueryError(f"strata are sampled uniformly as a whole; leave {name} out")
        if cover is not None and name != "excluded":
            raise QueryError(
                f"tasks that cover combinations are chosen, and others sampled uniformly; leave {name} out"
            )
    if apart and (cover is not None or division.strata is not None or not division.by_tasks):
        raise QueryError("tasks that are far from others are sampled; leave cover, strata, skeletons and hold_out out")
    if cover is None and diverse is None:
        return
    if cover is not None and diverse is not None:
        raise QueryError("tasks cover combinations or are far apart; leave cover or diverse out")
    name = "diverse" if cover is None else "cover"
    if part is not None:
        raise QueryError(f"{name} chooses each task after the results of others; leave part {part} out")
    if division.strata is not None or (cover is not None and len(division.shares) > 1):
        raise QueryError(
            f"{name} chooses from all tasks of the space; leave {'strata' if division.strata else 'split'} out"
        )


def budget_of(budget: Budget | None, demonstrate: str | Path | None) -> Budget:
    """Return a budget, with the tier of demonstrations if demonstrations are recorded."""
    budget = budget or Budget()
    return budget if demonstrate is None else Budget(budget.restarts, budget.samples, Tier.DEMONSTRATION)


def require_demonstrated(staging: Staging, demonstrate: str | Path | None) -> None:
    """Check that tasks are demonstrated if cameras or variations are requested.

    Raises:
        QueryError: cameras or variations are requested without demonstrations.
    """
    if demonstrate is None and (staging.cameras or staging.vary):
        what = "cameras record" if staging.cameras else f"{staging.vary[0]} varies in"
        raise QueryError(f"{what} demonstrations; request them with `demonstrate`, the folder of the recordings")
