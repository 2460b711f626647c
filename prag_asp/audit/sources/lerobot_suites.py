"""Task instructions in LeRobot datasets; a text stands for the problems in other suites with the same instruction."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from prag_asp.audit.audited_problem import AuditedProblem
from prag_asp.audit.sources.problem_source import FailedRead
from prag_asp.errors import QueryError
from prag_asp.missing import require_pyarrow

LINES, TABLE = Path("meta", "tasks.jsonl"), Path("meta", "tasks.parquet")
"""The files with the texts in versions 2 and 3 of the format."""

SCENE = re.compile(r"^(?:[A-Z]+_)+SCENE\d+_")
"""The pattern of the scene at the beginning of a file name in LIBERO."""


@dataclass(frozen=True)
class TaskText:
    """An instruction from a dataset, with its suite and its location."""

    suite: str
    text: str
    place: str


def recognizes(folder: Path) -> bool:
    """Return whether a folder is a LeRobot dataset."""
    return (folder / LINES).is_file() or (folder / TABLE).is_file()


def read_texts(folders: Mapping[str, Path]) -> Iterator[TaskText]:
    """Yield the texts in datasets, in order.

    Raises:
        QueryError: a file of texts is damaged.
    """
    for suite, folder in folders.items():
        lines = folder / LINES
        texts = _of_lines(lines) if lines.is_file() else _of_table(folder / TABLE)
        for number, text in enumerate(texts, 1):
            yield TaskText(suite, text, f"{lines if lines.is_file() else folder / TABLE}:{number}")


def matched(texts: Sequence[TaskText], problems: Sequence[AuditedProblem]) -> Iterator[AuditedProblem | FailedRead]:
    """Yield the problem with the same text for each text; if several problems have this text, yield each of them."""
    by_text: dict[str, dict[object, AuditedProblem]] = {}
    for each in problems:
        name = SCENE.sub("", each.name.rpartition("/")[2]).replace("_", " ")
        for text in {_plain(each.problem.language), _plain(name)}:
            by_text.setdefault(text, {}).setdefault(each.task_form, each)
    for each_text in texts:
        found = list(by_text.get(_plain(each_text.text), {}).values())
        if not found:
            yield FailedRead(each_text.suite, each_text.place, f"{each_text.text!r} is the text of no other problem")
        for number, each in enumerate(found, 1):
            label = each_text.text if len(found) == 1 else f"{each_text.text} ({number})"
            yield AuditedProblem(each_text.suite, label, each_text.place, each.problem)


def _plain(text: str) -> str:
    return " ".join(re.findall(r"[a-z0-9]+", text.lower()))


def _of_lines(path: Path) -> list[str]:
    try:
        rows = [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines() if line.strip()]
        return [str(row["task"]) for row in rows]
    except (ValueError, KeyError, TypeError, OSError):
        raise QueryError(f'{path}: not a file of texts; each line is a table such as {{"task": "..."}}') from None


def _of_table(path: Path) -> list[str]:
    require_pyarrow()
    import pyarrow as pa  # noqa: PLC0415 - an extra, which only tables need
    from pyarrow import parquet  # noqa: PLC0415 - as above

    try:
        table = parquet.read_table(path)
        names = [name for name in ("task", "__index_level_0__") if name in table.column_names]
        return [str(text) for text in table.column(names[0]).to_pylist()]
    except (pa.ArrowException, OSError, IndexError):
        raise QueryError(f"{path}: not a table of texts; it has a column task") from None
