"""Check the rows of the tables of tasks against tasks sampled again with the same seed."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

from prag_asp.dataset.language import instruction_writer_of
from prag_asp.dataset.language.instruction_reader import LONGEST
from prag_asp.dataset.store.entry import entry_of
from prag_asp.dataset.store.instructions import PLAIN, captioner_with
from prag_asp.dataset.store.manifest import (
    NAME,
    LengthTally,
    Manifest,
    PartManifest,
    Shard,
    summed,
    tally_of_draw,
)
from prag_asp.dataset.verification.finding import Finding, Progress
from prag_asp.dataset.verification.untrusted_rows import Row, whole_rows
from prag_asp.errors import PragError
from prag_asp.physics.demonstration.demonstration import read_variation
from prag_asp.space.sampling.streams import log_probability
from prag_asp.space.task_space import TaskSpace

if TYPE_CHECKING:
    from prag_asp.dataset.store.entry import DatasetEntry
    from prag_asp.dataset.store.tables import TableReader
    from prag_asp.domain.load import Domain
    from prag_asp.space.distinct_sampling import RankedDraw
    from prag_asp.task import Task

READ_BACK = ("default", "exact")
"""The levels of detail at which an instruction determines the plan."""

MISSING, UNREAD = 1_000, 100_000
"""The maximum numbers of missing and of unreadable rows in a shard; if a damaged file claims more, its draws are not
sampled again.
"""

VALUES = {
    "actions": "plan", "entities": "entities", "initial": "initial", "states": "states", "subgoals": "subgoals",
    "goal": "goal", "log_probability": "log_probability",
}  # fmt: skip
"""The column of each attribute of a task."""


@dataclass
class RowChecks:
    """The checks of the rows in a dataset's tables of tasks, part by part.

    `seen` holds the location of each checked task, by length and rank; `progress` reports the number of checked tasks.
    """

    manifest: Manifest
    domain: Domain
    tables: TableReader
    progress: Progress
    done: int = 0
    seen: dict[tuple[int, str], str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        spec = self.manifest.spec
        self._writer = instruction_writer_of(self.domain, spec.language, phrasings=spec.phrasings)
        self._captioner = captioner_with(self._writer, self.domain, spec.seed)
        self._clingo = clingo_spaces(self.manifest, self.domain)
        self._colours: Mapping[int, Mapping[str, str]] = {}

    def wrong(self, note: PartManifest, drawn: Iterator[tuple[RankedDraw, Task]]) -> Iterator[Finding]:
        """Yield findings about the rows of a part, given its draws, which were sampled again."""
        tasks = 0
        for shard in note.shards:
            tables = dict[str, tuple[list[Row], list[Finding]]]()
            try:
                for name in ("tasks", "rejected", "witnesses"):
                    file = shard.files[name].path if name in shard.files else ""
                    tables[name] = whole_rows(file, self.tables.of_shard(name, shard))
            except PragError as error:
                yield Finding(_file(shard), None, f"its shard cannot be read: {error}")
                tables = {}
            count = sum(len(rows) + len(wrong) for rows, wrong in tables.values()) if tables else UNREAD
            if shard.end - shard.first > count + MISSING:
                problem = f"shard {shard.number} has too many draws for its rows, {shard.end - shard.first:,}"
                yield Finding(NAME, None, f"parts, {note.name}: {problem}; nothing after that was checked")
                return
            draws = [next(drawn, None) for _ in range(shard.end - shard.first)]
            if not tables:
                tasks += shard.rows("tasks")
                continue
            self._colours = colours_of(self.tables, shard, self.manifest)
            yield from (finding for _, wrong in tables.values() for finding in wrong)
            passed, rejected, starts = (rows for rows, _ in tables.values())
            for place, row in passed:
                if row["task"] != tasks + place:
                    problem = f"has the number {row['task']}, not {tasks + place}"
                    yield Finding(shard.files["tasks"].path, place, problem)
            tasks += shard.rows("tasks")
            yield from self._wrong_draws(shard, passed, rejected, draws)
            if shard.tally != tally_of(passed, rejected, [row for _, row in starts]):
                problem = f"the tally of shard {shard.number} of {note.name} does not match its rows"
                yield Finding(NAME, None, problem)
            self.done += shard.rows("tasks")
            self.progress("rows", self.done, self.manifest.rows("tasks"))

    def _wrong_draws(
        self, shard: Shard, passed: list[Row], rejected: list[Row], draws: list[tuple[RankedDraw, Task] | None]
    ) -> Iterator[Finding]:
        """Yield findings about the rows of a shard; each draw must have exactly one row in one of the two tables."""
        missing = set(range(shard.first, shard.end))
        for table, rows in (("tasks", passed), ("rejected", rejected)):
            before = shard.first - 1
            for place, row in rows:
                file, draw = shard.files[table].path, row["draw"]
                if draw not in missing:
                    repeated = shard.first <= draw < shard.end
                    problem = (
                        "occurs twice"
                        if repeated
                        else f"does not belong to this shard ({shard.first} to {shard.end - 1})"
                    )
                    yield Finding(file, place, f"draw {draw} {problem}")
                    continue
                if draw < before:
                    yield Finding(file, place, f"draw {draw} comes after draw {before}")
                missing.remove(draw)
                before = draw
                expected = draws[draw - shard.first]
                if expected is None:
                    yield Finding(file, place, f"there is no draw {draw}")
                    continue
                for what in self._wrong_row(table, row, expected, f"{file}, row {place}"):
                    yield Finding(file, place, what)
        for draw in sorted(missing):
            yield Finding(_file(shard), None, f"draw {draw} is missing, here and among the rejected")

    def _wrong_row(
        self, table: str, row: Mapping[str, Any], expected: tuple[RankedDraw, Task], where: str
    ) -> Iterator[str]:
        """Yield the faults of a row, given its draw and its task, which were sampled again."""
        placed, task = expected
        key = (row["length"], row["rank"])
        if key in self.seen:
            yield f"has the same task as {self.seen[key]}"
        self.seen.setdefault(key, where)
        try:
            entry = entry_of(row, "", self.manifest.domain.constants)
        except (PragError, ValueError, TypeError, KeyError) as error:
            yield f"holds no task: {error}"
            return
        plan = row["plan"]
        space = self._clingo.get(len(plan))  # independent of the sampler
        if space is None or plan not in space:
            yield f"it is not a plan of {self.domain.name}: {' '.join(plan)}"
        fixed = {
            "domain": (row["domain"], task.domain), "length": (row["length"], len(task)),
            "rank": (entry.rank, placed.rank), "skeleton": (tuple(row["skeleton"]), tuple(task.skeleton)),
            "log_probability": (row["log_probability"], log_probability(placed.probability)),
        }  # fmt: skip
        wrong = [name for name, (actual, right) in fixed.items() if actual != right]
        right_task = replace(task, log_probability=log_probability(placed.probability))
        wrong += [column for name, column in VALUES.items() if getattr(entry.task, name) != getattr(right_task, name)]
        if wrong:
            yield f"its {', '.join(dict.fromkeys(wrong))} are not those of draw {row['draw']}"
        yield from self._wrong_texts(entry, task, self._colours.get(row.get("task", -1), {}))
        yield from self._wrong_verdict(table, entry)

    def _wrong_texts(self, entry: DatasetEntry, task: Task, colours: Mapping[str, str]) -> Iterator[str]:
        """Yield the faults of the texts, which must be those for the seed; instructions must parse to the plan.

        The parser gets only the text and the colours; instructions that are too long for the parser are not parsed.
        """
        texts, writer = self._captioner(task, colours), self._writer.recoloured(colours)
        if (dict(texts.whole), texts.subgoals, texts.named) != (entry.instruction, entry.subgoals, entry.named):
            yield "its texts are not those for the seed"
        for level in READ_BACK:
            if level not in entry.instruction:
                if PLAIN not in entry.instruction:
                    yield f"has no text at the level {level}"
                continue
            if len(entry.instruction[level]) > LONGEST:
                continue
            try:
                actions = writer.read(task, entry.instruction[level]).actions
            except PragError as error:
                yield f"its text at the level {level} cannot be parsed: {error}"
                continue
            if tuple(actions) != task.actions:
                yield f"its text at the level {level} means a different plan: {' '.join(map(str, actions))}"

    def _wrong_verdict(self, table: str, entry: DatasetEntry) -> Iterator[str]:
        """Yield the faults of the verdict on a draw: a wrong search, budget or table."""
        verdict, spec = entry.verdict, self.manifest.spec
        left_out = entry.task.trivial and not spec.trivial
        if left_out != (table == "rejected" and verdict is None):
            yield "is trivial, and not left out" if left_out else "is left out, but not trivial"
        if left_out:
            return
        if verdict is None or spec.budget is None:
            if (verdict is None) != (spec.budget is None):
                yield "has no verdict" if verdict is None else "has a verdict, though there is no budget"
            return
        if verdict.feasible != (table == "tasks"):
            yield f"is {verdict.status}, which belongs in another table"
        if (verdict.seed, verdict.index) != (spec.seed, spec.deal.whole(entry.draw)):
            yield f"its verdict has the seed {verdict.seed} and the index {verdict.index}, not those of its draw"
        if verdict.budget != spec.budget:
            yield "its verdict has a different budget than requested"


def _file(shard: Shard) -> str:
    """Return the file with the tasks of a shard, or dataset.json if the shard has none."""
    return shard.files["tasks"].path if "tasks" in shard.files else NAME


def colours_of(tables: TableReader, shard: Shard, manifest: Manifest) -> Mapping[int, Mapping[str, str]]:
    """Return the colours in the recording of each task in a shard; other checks report unreadable recordings."""
    staging = manifest.spec.staging
    if staging is None or "colour" not in staging.vary:
        return {}
    colours = {}
    for row in tables.of_shard("recordings", shard, ["task", "file"]):
        with suppress(PragError):
            variation = read_variation(tables.folder / row["file"], within=tables.folder)
            colours[row["task"]] = {} if variation is None else variation.colours
    return colours


def clingo_spaces(manifest: Manifest, domain: Domain) -> dict[int, TaskSpace]:
    """Return the space for each length in a dataset, with clingo as its engine."""
    clauses = manifest.where
    return {length: TaskSpace(domain, length, engine="clingo").where(*clauses) for length in manifest.lengths}


def tally_of(passed: list[Row], rejected: list[Row], starts: list[Mapping[str, Any]]) -> list[LengthTally]:
    """Compute the tally of the draws of a shard from its rows."""
    lengths = {row["task"]: row["length"] for _, row in passed}
    tallies = [
        tally_of_draw(row["length"], row["verdict"], passed=rows is passed)
        for rows in (passed, rejected)
        for _, row in rows
    ]
    tallies += [LengthTally(lengths[start["task"]], witnesses=1) for start in starts if start["task"] in lengths]
    return summed(tallies)
