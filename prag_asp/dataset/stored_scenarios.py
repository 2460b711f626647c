"""The scenarios of the tasks in an earlier sample or dataset."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from prag_asp.dataset.scenario import Scenario
from prag_asp.dataset.scenarios import read_scenarios


def read_earlier(path: str | Path) -> Iterator[Scenario]:
    """Yield the scenarios of the tasks in a dataset, or in a file with one id per line.

    Raises:
        OSError: the file cannot be read.
        QueryError: a line in the file is not a scenario id, or the folder is not a dataset.
        DatasetsMissingError: the path is a folder, and pyarrow is not installed.
    """
    if Path(path).is_dir():
        from prag_asp.dataset.store.dataset import Dataset

        dataset = Dataset.open(path)
        return (dataset.task_scenario(number) for number in range(dataset.count()))
    return read_scenarios(path)
