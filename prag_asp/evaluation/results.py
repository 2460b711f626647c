"""The results of an evaluation: a folder with a table of episodes, and success rates with intervals."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from io import BytesIO
from pathlib import Path
from typing import Any

import msgspec

from prag_asp.atom import parse_atom
from prag_asp.dataset.pass_rates import Rate
from prag_asp.dataset.store.manifest_file import ManifestFile
from prag_asp.dataset.strata.stratum_figures import StratumFigures
from prag_asp.errors import QueryError
from prag_asp.evaluation.episode import EvaluatedEpisode
from prag_asp.evaluation.stratified_rates import StratifiedRate, stratified_rate
from prag_asp.missing import require_pyarrow
from prag_asp.output import file_in, replace_file
from prag_asp.safe_reading import read_bytes
from prag_asp.tables.json_fields import Whole
from prag_asp.tables.report import shown

EPISODES = "episodes.parquet"
"""The file of episodes, with one row per episode."""


class EvaluationRecord(msgspec.Struct, frozen=True):
    """The contents of evaluation.json: the policy, the scenarios and the options in an evaluation.

    `options` are the options of the environment as text; `rejected` counts sampled tasks that physics found infeasible.
    `strata` are those of a stratified sample; the part of each episode is then the name of its stratum. `wrapper` is
    the name of the wrapper of the environment, or "".
    """

    identity: str
    policy: str
    source: str
    domain: str
    digest: str
    options: dict[str, str]
    seed: Whole
    episodes: Whole
    rejected: Whole
    versions: str
    strata: list[StratumFigures] = []
    wrapper: str = ""

    def difference(self, other: EvaluationRecord) -> str:
        """Return how the domain or the options for episodes differ from those of another evaluation, or ""."""
        if self.domain != other.domain:
            return f"the domains are {self.domain} and {other.domain}"
        if self.digest != other.digest:
            return f"their versions of the domain {self.domain} differ ({self.digest} and {other.digest})"
        for name in sorted({*self.options, *other.options} & {"control", "rate", "action_scale", "steps"}):
            mine, its = self.options.get(name, "the default"), other.options.get(name, "the default")
            if mine != its:
                return f"the option {name} is {shown(mine)} and {shown(its)}"
        return ""


EVALUATION = ManifestFile("evaluation.json", EvaluationRecord, "prag_asp evaluation", 1, "evaluation")
"""The file evaluation.json; the version is that of the file and of the table."""


@dataclass(frozen=True)
class Results:
    """The results of an evaluation, in the order of the scenarios.

    Wilson's intervals assume independent episodes; episodes of the same task from different initial states are not
    fully independent.
    """

    record: EvaluationRecord
    episodes: tuple[EvaluatedEpisode, ...] = field(repr=False)

    @classmethod
    def open(cls, folder: str | Path) -> Results:
        """Read the results in a folder.

        Raises:
            QueryError: the folder has no results, or they are damaged.
            DatasetsMissingError: pyarrow is not installed.
        """
        require_pyarrow()
        import pyarrow as pa
        from pyarrow import parquet

        path = Path(folder)
        record = EVALUATION.read(path)
        if record is None:
            hint = "run the evaluation again to end it" if path.is_dir() else "give the folder of prag-asp evaluate -o"
            raise QueryError(f"{path}: has no complete evaluation; {hint}")
        try:
            content = pa.BufferReader(read_bytes(path / EPISODES, within=path))
            # Threads of pyarrow that are still alive when Python exits can abort the process.
            with parquet.ParquetFile(content) as file:
                rows = file.read(use_threads=False).to_pylist()
            episodes = msgspec.convert(rows, tuple[EvaluatedEpisode, ...])
        except (OSError, pa.ArrowException, msgspec.ValidationError) as error:
            reason = " ".join(str(error).split())
            raise QueryError(f"{path / EPISODES}: is damaged: {reason:.200}; evaluate again") from None
        if len(episodes) != record.episodes:
            raise QueryError(f"{path / EPISODES}: has {len(episodes)} of {record.episodes} episodes; evaluate again")
        return cls(record, episodes)

    def write(self, folder: Path) -> None:
        """Write the results to a folder: first the table, then evaluation.json.

        Raises:
            OutputError: a file cannot be written.
            DatasetsMissingError: pyarrow is not installed.
        """
        require_pyarrow()
        import pyarrow as pa
        from pyarrow import parquet

        rows = [msgspec.to_builtins(episode) for episode in self.episodes]
        content = BytesIO()
        parquet.write_table(pa.Table.from_pylist(rows, schema=_schema()), content)
        replace_file(file_in(folder, EPISODES), content.getvalue(), follow=False)
        EVALUATION.write(folder, self.record)

    def whole(self) -> Rate:
        """Return the success rate over all episodes."""
        return rate(self.episodes)

    def whole_space(self) -> StratifiedRate | None:
        """Return the success rate over all tasks of the space, estimated from strata, or None if there are none."""
        return stratified_rate(self.episodes, self.record.strata) if self.record.strata else None

    def by(self, what: str) -> Mapping[str, Rate]:
        """Return the rates, grouped by ``part``, ``length``, ``class`` or ``action``.

        An episode counts once for each class of its entities; each pursued subgoal counts for the name of its action.

        Raises:
            QueryError: there is no such grouping.
        """
        if what not in GROUPINGS:
            raise QueryError(f"results are grouped by {', '.join(GROUPINGS)}, not by {what}")
        successes: Counter[Any] = Counter()
        trials: Counter[Any] = Counter()
        for episode in self.episodes:
            for key, success in _outcomes(episode, what):
                trials[key] += 1
                successes[key] += success
        return {str(key): Rate(successes[key], trials[key]) for key in sorted(trials)}

    def causes(self) -> Mapping[str, int]:
        """Return the number of episodes that ended for each cause."""
        return dict(Counter(episode.cause for episode in self.episodes).most_common())

    def table(self) -> str:
        """Return the rates as text, with Wilson's 95 % intervals; if there are strata, the whole space comes first."""
        estimate = self.whole_space()
        rows: list[tuple[str, Rate | StratifiedRate]] = [] if estimate is None else [("whole space", estimate)]
        rows.append(("all", self.whole()))
        for what in GROUPINGS:
            rates = self.by(what)
            if len(rates) > 1 or what in ("length", "action"):
                rows += [(f"{what} {name}", rate) for name, rate in rates.items()]
        wide = max(len(name) for name, _ in rows)
        return "\n".join(f"{name:<{wide}}  {rate}" for name, rate in rows)


GROUPINGS = ("part", "length", "action", "class")
"""The groupings of results, in the order of the table."""


def rate(episodes: Sequence[EvaluatedEpisode]) -> Rate:
    """Return the success rate in the given episodes."""
    return Rate(sum(episode.success for episode in episodes), len(episodes))


def _outcomes(episode: EvaluatedEpisode, what: str) -> Iterable[tuple[Any, bool]]:
    """Yield the groups to which an episode belongs, each with the success that counts in the group."""
    if what == "action":
        return ((parse_atom(subgoal.action).name, subgoal.success) for subgoal in episode.subgoals)
    groups: Mapping[str, Sequence[Any]] = {
        "part": [episode.part], "length": [episode.length], "class": episode.classes,
    }  # fmt: skip
    return ((group, episode.success) for group in groups[what])


def _schema() -> Any:
    """Return the schema of the table of episodes."""
    import pyarrow as pa

    subgoal = pa.struct([("action", pa.string()), ("success", pa.bool_()), ("steps", pa.int64())])
    return pa.schema(
        [
            ("scenario", pa.string()), ("part", pa.string()), ("initial", pa.string()), ("length", pa.int32()),
            ("task", pa.list_(pa.string())), ("classes", pa.list_(pa.string())), ("instruction", pa.string()),
            ("success", pa.bool_()), ("reached", pa.int32()), ("subgoals", pa.list_(subgoal)), ("steps", pa.int64()),
            ("cause", pa.string()), ("seconds", pa.float64()), ("weight", pa.string()),
            ("weight_value", pa.float64()),
        ]
    )  # fmt: skip
