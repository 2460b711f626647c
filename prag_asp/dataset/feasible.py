"""Physics on a stream of tasks: which pass, and what the robot performs."""

from __future__ import annotations

from collections.abc import Generator, Iterator
from contextlib import closing
from itertools import islice, tee
from typing import TYPE_CHECKING

from prag_asp.cli.options import Checking
from prag_asp.dataset.jsonl import Record
from prag_asp.dataset.tally import Tally
from prag_asp.errors import OutputError
from prag_asp.output import make_folder
from prag_asp.physics import Demonstration, validate_tasks
from prag_asp.wording import plural

if TYPE_CHECKING:
    from prag_asp.cli.terminal import Tell
    from prag_asp.scene.model import Scene
    from prag_asp.task import Task


class Recordings:
    """The folder of the demonstrations of some tasks; no folder, no files."""

    def __init__(self, folder: str | None):
        """Make the folder, where there is to be one.

        Raises:
            OutputError: it cannot be made.
        """
        self._folder = None if folder is None else make_folder(folder)

    def write(self, number: int, demonstration: Demonstration | None) -> str | None:
        """Write the demonstration of the task on a line, counted from 1, and return the name of its file.

        Raises:
            OutputError: it cannot be written.
        """
        if self._folder is None or demonstration is None:
            return None
        name = f"{number:06d}.npz"
        demonstration.save(self._folder / name)
        return name


def feasible(tasks: Iterator[Task], scene: Scene, seed: int, checking: Checking, tally: Tally) -> Iterator[Record]:
    """Yield the feasible tasks with verdict and witness, write their demonstrations, and count all of them."""
    asked, kept = tee(tasks)
    recordings, workers, budget = Recordings(checking.demonstrate), checking.workers, checking.limits()
    with closing(validate_tasks(asked, scene, seed=seed, workers=workers, budget=budget)) as verdicts:
        for task, verdict in zip(kept, verdicts, strict=False):
            tally.add(verdict)
            if verdict.feasible:
                told = verdict.to_json()
                witness = told.pop("witness")
                name = recordings.write(tally.passed, verdict.demonstration)
                if name is not None:
                    told["demonstration"] = name
                yield Record(task, told, witness)


def first_feasible(
    tasks: Iterator[Task],
    wanted: int,
    scene: Scene,
    seed: int,
    checking: Checking,
    limit: int,
    tell: Tell,
) -> Generator[Record, None, None]:
    """Yield the first `wanted` feasible ones of at most `limit` tasks, and say on stderr how many it took.

    Raises:
        OutputError: they are fewer.
    """
    tally = Tally(("drawn", "drawn"), f"budget {checking.limits()}")
    try:
        for record in islice(feasible(islice(tasks, limit), scene, seed, checking, tally), wanted):
            yield record
            tell(str(tally), tally.passed, wanted)
    finally:
        if tally.seen:
            tally.show()
    if tally.passed < wanted:
        found = f"only {tally.passed} of {plural(wanted, 'task')} found in {plural(tally.seen, 'draw')}"
        raise OutputError(f"{found}; raise --max-draws" if tally.seen == limit else found)
