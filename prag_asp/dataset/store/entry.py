"""An entry of a dataset: a task with its texts and verdict, decoded from a row."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from prag_asp.atom import parse_atom
from prag_asp.dataset.store.manifest import MOST_DIGITS
from prag_asp.errors import QueryError
from prag_asp.integers import number_of
from prag_asp.task import FrozenDict, Task

if TYPE_CHECKING:
    from prag_asp.atom import Atom
    from prag_asp.physics.verdict import Verdict


@dataclass(frozen=True)
class DatasetEntry:
    """A task of a dataset: its part, its number there from 0 (None if it was refused), and its draw.

    `rank` is its position among all tasks of its length. `instruction` has an instruction for each level of detail,
    and `subgoals` a sentence for each action; `named` are the entities that the texts call by name because nothing
    visible distinguishes them from others. `verdict` is None if physics was not run. It has no witness: witnesses
    are in a separate table, with `starts` rows for the task.
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


def entry_of(row: Mapping[str, Any], part: str, constants: Mapping[str, str]) -> DatasetEntry:
    """Return the entry of a row of a table of tasks.

    Raises:
        QueryError: a value is missing or invalid.
    """
    with _row_errors(row):
        return _entry_of(row, part, constants)


def _entry_of(row: Mapping[str, Any], part: str, constants: Mapping[str, str]) -> DatasetEntry:
    return DatasetEntry(
        part,
        row.get("task"),
        row["draw"],
        _rank(row["rank"]),
        _task_of(row, constants),
        None if row["verdict"] is None else _verdict(row["verdict"]),
        {each["level"]: each["text"] for each in row["instruction"]},
        tuple(row["subgoal_instructions"]),
        tuple(row["named"]),
        row.get("starts", 0),
    )


def _rank(text: str) -> int:
    """Return a rank, which may outgrow 64 bits.

    Raises:
        ValueError: it is no number, or has more digits than any count of tasks.
    """
    if len(text) > MOST_DIGITS or not text.isascii() or not text.isdecimal():
        raise ValueError("the rank is no number")
    return number_of(text)


def task_of(row: Mapping[str, Any], constants: Mapping[str, str]) -> Task:
    """Return the task of a row.

    Raises:
        QueryError: a value is missing or invalid.
    """
    with _row_errors(row):
        return _task_of(row, constants)


@contextmanager
def _row_errors(row: Mapping[str, Any]) -> Iterator[None]:
    """Report errors in a row together with its draw."""
    try:
        yield
    except (TypeError, ValueError, KeyError) as error:
        raise QueryError(f"draw {row.get('draw')}: a value of the row is none of a task: {error}") from None


def _task_of(row: Mapping[str, Any], constants: Mapping[str, str]) -> Task:
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


def _state(facts: Sequence[Mapping[str, Any]]) -> FrozenDict[Atom, bool]:
    return FrozenDict({parse_atom(fact["fluent"]): fact["value"] for fact in facts})


def _verdict(row: Mapping[str, Any]) -> Verdict:
    from prag_asp.physics.verdict import Verdict

    causes = {each["cause"]: each["count"] for each in row["causes"]}
    return Verdict.from_json({**row, "causes": causes, "witness": None})
