"""An entry of a dataset: a task with its texts and verdict, decoded from a row."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from prag_asp.atom import parse_atom
from prag_asp.dataset.store.draw_results import TRIVIAL
from prag_asp.dataset.store.manifest import MOST_DIGITS
from prag_asp.errors import QueryError
from prag_asp.integers import number_of
from prag_asp.task import FrozenDict, Task

if TYPE_CHECKING:
    from prag_asp.atom import Atom
    from prag_asp.dataset.store.instructions import TaskTexts
    from prag_asp.physics.verdict import Verdict


@dataclass(frozen=True)
class DatasetEntry:
    """A task in a dataset: its part, its index in the part (None if it was rejected), and the number of its draw.

    `rank` is the rank of the task among all tasks of its length. `instruction` holds an instruction for each level of
    detail, and `subgoals` holds a sentence for each action; `named` holds the entities to which the texts refer by
    name, because nothing visible distinguishes them from others. `verdict` is None if physics was not run, as is the
    case for trivial tasks. Witnesses are in a separate table, with `starts` rows for the task.
    """

    part: str
    number: int | None
    draw: int
    rank: int
    task: Task
    verdict: Verdict | None
    instruction: Mapping[str, str]
    subgoals: tuple[str, ...]
    named: tuple[str, ...] = ()
    starts: int = 0

    @property
    def texts(self) -> TaskTexts:
        """The texts of the task."""
        from prag_asp.dataset.store.instructions import TaskTexts

        return TaskTexts(tuple(self.instruction.items()), self.subgoals, self.named)

    @property
    def reason(self) -> str:
        """The reason why the task was rejected, or "" if it was accepted."""
        if self.number is not None:
            return ""
        return TRIVIAL if self.verdict is None else self.verdict.reason


def entry_of(row: Mapping[str, Any], part: str, constants: Mapping[str, str]) -> DatasetEntry:
    """Return the entry for a row in a table of tasks.

    Raises:
        QueryError: a value is missing or invalid.
    """
    from prag_asp.physics.verdict import Verdict

    with _row_errors(row):
        rank, verdict = row["rank"], None
        if len(rank) > MOST_DIGITS or not rank.isascii() or not rank.isdecimal():
            raise ValueError("the rank is not a number")
        if row["verdict"] is not None:
            causes = {each["cause"]: each["count"] for each in row["verdict"]["causes"]}
            verdict = Verdict.from_json({**row["verdict"], "causes": causes, "witness": None})
        return DatasetEntry(
            part,
            row.get("task"),
            row["draw"],
            number_of(rank),
            task_of(row, constants),
            verdict,
            {each["level"]: each["text"] for each in row["instruction"]},
            tuple(row["subgoal_instructions"]),
            tuple(row["named"]),
            row.get("starts", 0),
        )


def task_of(row: Mapping[str, Any], constants: Mapping[str, str]) -> Task:
    """Return the task in a row.

    Raises:
        QueryError: a value is missing or invalid.
    """
    with _row_errors(row):
        return Task(
            domain=row["domain"],
            actions=tuple(map(parse_atom, row["plan"])),
            entities=FrozenDict({each["entity"]: each["class"] for each in row["entities"]}),
            initial=_state(row["initial"]),
            states=tuple(map(_state, row["states"])),
            subgoals=tuple(map(_state, row["subgoals"])),
            goal=_state(row["goal"]),
            log_probability=row["log_probability"],
            constants=FrozenDict(constants),
        )


@contextmanager
def _row_errors(row: Mapping[str, Any]) -> Iterator[None]:
    """Turn errors about a row into a `QueryError` that names its draw."""
    try:
        yield
    except (TypeError, ValueError, KeyError) as error:
        raise QueryError(f"draw {row.get('draw')}: a value of the row is invalid: {error}") from None


def _state(facts: Sequence[Mapping[str, Any]]) -> FrozenDict[Atom, bool]:
    return FrozenDict({parse_atom(fact["fluent"]): fact["value"] for fact in facts})
