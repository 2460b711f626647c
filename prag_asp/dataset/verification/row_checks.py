"""The rows of a data set's tables of tasks, beside what is drawn now by the same seed."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import msgspec

from prag_asp.dataset.language import instruction_writer_of
from prag_asp.dataset.language.instruction_reader import LONGEST
from prag_asp.dataset.store.entry import entry_of
from prag_asp.dataset.store.instructions import PLAIN, telling_by
from prag_asp.dataset.store.manifest import NAME, Cause, LengthTally, Manifest, PartNote, Reason, Shard, summed
from prag_asp.dataset.verification.finding import Finding, Looked
from prag_asp.dataset.verification.untrusted_rows import Row, whole_rows
from prag_asp.errors import PragError
from prag_asp.physics.demonstration.demonstration import read_variation
from prag_asp.space.sampling.streams import log_probability
from prag_asp.space.task_space import TaskSpace

if TYPE_CHECKING:
    from prag_asp.dataset.store.entry import Entry
    from prag_asp.dataset.store.tables import Tables
    from prag_asp.domain.load import Domain
    from prag_asp.space.distinct_sampling import RankedDraw
    from prag_asp.task import Task

READ_BACK = ("default", "exact")
"""The levels at which words say the whole plan."""

MISSING, UNREAD = 1_000, 100_000
"""How many draws of a shard may lack their rows, and how many one may have whose rows cannot be read: what is claimed
beyond that is not drawn again."""

VALUES = {
    "actions": "plan", "entities": "entities", "initial": "initial", "states": "states", "subgoals": "subgoals",
    "goal": "goal", "log_probability": "log_probability",
}  # fmt: skip
"""The columns that have the values of a task."""


@dataclass
class Rows:
    """Looks at the rows of the tables of tasks of a data set, part by part.

    `seen` has where each task was found that was looked at, by its length and rank; `progress` is told how many of all.
    """

    manifest: Manifest
    domain: Domain
    tables: Tables
    progress: Looked
    done: int = 0
    seen: dict[tuple[int, str], str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        asked = self.manifest.asked
        self._teller = instruction_writer_of(self.domain, asked.language, phrasings=asked.phrasings)
        self._tell = telling_by(self._teller, self.domain, asked.seed)
        self._clingo = clingo_spaces(self.manifest, self.domain)
        self._colours: Mapping[int, Mapping[str, str]] = {}

    def wrong(self, note: PartNote, drawn: Iterator[tuple[RankedDraw, Task]]) -> Iterator[Finding]:
        """Yield what is wrong with the rows of a part, of which the draws come once more."""
        tasks = 0
        for shard in note.shards:
            try:
                found = {name: self._whole(name, shard) for name in ("tasks", "refused", "witnesses")}
            except PragError as error:
                yield Finding(_file(shard), None, f"its shard cannot be read: {error}")
                found = {}
            counted = sum(len(rows) + len(wrong) for rows, wrong in found.values()) if found else UNREAD
            if shard.end - shard.first > counted + MISSING:
                told = f"shard {shard.number} has too many draws for its rows, {shard.end - shard.first:,}"
                yield Finding(NAME, None, f"parts, {note.name}: {told}; nothing after that was looked at")
                return
            right = [next(drawn, None) for _ in range(shard.end - shard.first)]
            if not found:
                tasks += shard.rows("tasks")
                continue
            self._colours = colours_of(self.tables, shard, self.manifest)
            yield from (finding for _, wrong in found.values() for finding in wrong)
            passed, refused, starts = (rows for rows, _ in found.values())
            for place, row in passed:
                if row["task"] != tasks + place:
                    told = f"has the number {row['task']}, not {tasks + place}"
                    yield Finding(shard.files["tasks"].path, place, told)
            tasks += shard.rows("tasks")
            yield from self._wrong_draws(shard, passed, refused, right)
            if shard.tally != tally_of(passed, refused, [row for _, row in starts]):
                told = f"the tally of shard {shard.number} of {note.name} is not what its rows say"
                yield Finding(NAME, None, told)
            self.done += shard.rows("tasks")
            self.progress("rows", self.done, self.manifest.rows("tasks"))

    def _whole(self, table: str, shard: Shard) -> tuple[list[Row], list[Finding]]:
        file = shard.files[table].path if table in shard.files else ""
        return whole_rows(file, self.tables.of_shard(table, shard))

    def _wrong_draws(
        self, shard: Shard, passed: list[Row], refused: list[Row], right: list[tuple[RankedDraw, Task] | None]
    ) -> Iterator[Finding]:
        """Yield what is wrong with the rows of a shard: each draw stands in one of two tables, and once."""
        missing = set(range(shard.first, shard.end))
        for table, rows in (("tasks", passed), ("refused", refused)):
            before = shard.first - 1
            for place, row in rows:
                file, draw = shard.files[table].path, row["draw"]
                if draw not in missing:
                    known = shard.first <= draw < shard.end
                    told = "is there twice" if known else f"is not of this shard, {shard.first} to {shard.end - 1}"
                    yield Finding(file, place, f"draw {draw} {told}")
                    continue
                if draw < before:
                    yield Finding(file, place, f"draw {draw} stands after draw {before}")
                missing.remove(draw)
                before = draw
                expected = right[draw - shard.first]
                if expected is None:
                    yield Finding(file, place, f"there is no draw {draw}")
                    continue
                for what in self._wrong_row(table, row, expected, f"{file}, row {place}"):
                    yield Finding(file, place, what)
        for draw in sorted(missing):
            yield Finding(_file(shard), None, f"draw {draw} is missing, here and among the refused")

    def _wrong_row(
        self, table: str, row: Mapping[str, Any], expected: tuple[RankedDraw, Task], where: str
    ) -> Iterator[str]:
        """Yield what is wrong with a row, of which the draw is known."""
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
        if not self._is_plan(plan):
            yield f"its plan is none of {self.domain.name}: {' '.join(plan)}"
        fixed = {
            "domain": (row["domain"], task.domain), "length": (row["length"], len(task)),
            "rank": (entry.rank, placed.rank), "skeleton": (tuple(row["skeleton"]), tuple(task.skeleton)),
            "log_probability": (row["log_probability"], log_probability(placed.probability)),
        }  # fmt: skip
        wrong = [name for name, (found, wanted) in fixed.items() if found != wanted]
        wrong += [column for name, column in VALUES.items() if getattr(entry.task, name) != _value(task, name, placed)]
        if wrong:
            yield f"its {', '.join(dict.fromkeys(wrong))} are not those of draw {row['draw']}"
        yield from self._wrong_words(entry, task, self._colours.get(row.get("task", -1), {}))
        yield from self._wrong_verdict(table, entry)

    def _is_plan(self, plan: list[str]) -> bool:
        """Tell whether clingo, which has drawn nothing, takes a plan."""
        space = self._clingo.get(len(plan))
        return space is not None and plan in space

    def _wrong_words(self, entry: Entry, task: Task, colours: Mapping[str, str]) -> Iterator[str]:
        """Yield what words say otherwise than the task: they are read back from the text and the colours alone.

        Instructions that are longer than any that can be read are compared with those that the seed draws.
        """
        told, teller = self._tell(task, colours), self._teller.recoloured(colours)
        if (dict(told.whole), told.subgoals, told.named) != (entry.instruction, entry.subgoals, entry.named):
            yield "its words are not those that the seed draws"
        for level in READ_BACK:
            if level not in entry.instruction:
                if PLAIN not in entry.instruction:
                    yield f"has no words at the level {level}"
                continue
            if len(entry.instruction[level]) > LONGEST:
                continue
            try:
                read = teller.read(task, entry.instruction[level]).actions
            except PragError as error:
                yield f"its words at the level {level} cannot be read back: {error}"
                continue
            if tuple(read) != task.actions:
                yield f"its words at the level {level} say another plan: {' '.join(map(str, read))}"

    def _wrong_verdict(self, table: str, entry: Entry) -> Iterator[str]:
        """Yield what is wrong with the verdict on a draw: of which search it is, and whether it fits the table."""
        verdict, asked = entry.verdict, self.manifest.asked
        if verdict is None or asked.budget is None:
            if (verdict is None) != (asked.budget is None):
                yield "has no verdict" if verdict is None else "has a verdict, though physics was not asked"
            return
        if verdict.feasible != (table == "tasks"):
            yield f"is {verdict.status}, which belongs into another table"
        if (verdict.seed, verdict.index) != (asked.seed, asked.deal.whole(entry.draw)):
            yield f"its verdict is of the seed {verdict.seed} and the index {verdict.index}, not of its draw"
        if verdict.budget.to_json() != msgspec.to_builtins(asked.budget):
            yield "its verdict is of another budget than was asked for"


def _file(shard: Shard) -> str:
    """Return the file of the tasks of a shard; where it says that there is none, what says so."""
    return shard.files["tasks"].path if "tasks" in shard.files else NAME


def colours_of(tables: Tables, shard: Shard, manifest: Manifest) -> Mapping[int, Mapping[str, str]]:
    """Return the colours in the recording of each task of a shard; those that cannot be read are told of themselves."""
    staging = manifest.asked.staging
    if staging is None or "colour" not in staging.vary:
        return {}
    found = {}
    for row in tables.of_shard("recordings", shard, ["task", "file"]):
        with suppress(PragError):
            variation = read_variation(tables.folder / row["file"], within=tables.folder)
            found[row["task"]] = {} if variation is None else variation.colours
    return found


def clingo_spaces(manifest: Manifest, domain: Domain) -> dict[int, TaskSpace]:
    """Return the spaces of a data set by length, answered for by clingo."""
    clauses = manifest.asked.where
    return {length: TaskSpace(domain, length, engine="clingo").where(*clauses) for length in manifest.asked.lengths}


def tally_of(passed: list[Row], refused: list[Row], starts: list[Mapping[str, Any]]) -> list[LengthTally]:
    """Return what became of the draws of a shard, by its rows."""
    lengths = {row["task"]: row["length"] for _, row in passed}
    found = [_tally(row) for _, row in (*passed, *refused)]
    found += [LengthTally(lengths[start["task"]], witnesses=1) for start in starts if start["task"] in lengths]
    return summed(found)


def _tally(row: Mapping[str, Any]) -> LengthTally:
    verdict = row["verdict"] or {"status": "feasible", "causes": [], "reason": ""}
    status, reason = verdict["status"], verdict["reason"]
    causes = [Cause(each["cause"], each["count"]) for each in verdict["causes"]]
    return LengthTally(
        row["length"], drawn=1, feasible=status == "feasible", not_found=status == "not_found",
        infeasible=status == "infeasible", causes=causes,
        reasons=[] if status == "feasible" else [Reason(status, reason, 1)],
    )  # fmt: skip


def _value(task: Task, name: str, placed: RankedDraw) -> object:
    return log_probability(placed.probability) if name == "log_probability" else getattr(task, name)
