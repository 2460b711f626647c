"""Validation jobs: the verdict on the task of a draw, further initial states, and the texts of the task."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from hashlib import sha256
from typing import TYPE_CHECKING, NamedTuple

import msgspec

from prag_asp.dataset.store.draw_results import DrawResult, RecordingInfo, StartResult
from prag_asp.task import Task

if TYPE_CHECKING:
    from prag_asp.dataset.dataset_spec import DatasetSpec
    from prag_asp.dataset.store.columns import RowReference
    from prag_asp.domain.load import Domain
    from prag_asp.physics import Validator, Verdict, Witness
    from prag_asp.scene.scene import Scene
    from prag_asp.space.distinct_sampling import RankedDraw

START = 1 << 32
"""The difference between the indices of consecutive searches for the same task."""

TRIES = 4
"""The maximum number of searches per requested initial state; after a search that finds no new state, another follows.
"""


class ValidationJob(NamedTuple):
    """A draw to validate: its number in the part, the index of its first search, and the task or the undecoded draw."""

    number: int
    search: int
    drawn: Task | RankedDraw


class JobResult(NamedTuple):
    """The result of a job: a `DrawResult` as JSON, the recording from each initial state, and the row.

    The row is None if the job came with its task.
    """

    result: bytes
    recordings: tuple[bytes | None, ...] = ()
    row: RowReference | None = None


@dataclass(frozen=True)
class ValidationSetup:
    """The options for validating the draws of a part of a dataset, with physics if there is a `scene`.

    If draws have to be decoded into tasks with texts, `space` holds the domain, lengths and conditions.
    """

    part: str
    spec: DatasetSpec
    scene: Scene | None = None
    space: tuple[Domain, tuple[int, ...], tuple[str, ...]] | None = None


@contextmanager
def open_job_validator(setup: ValidationSetup) -> Iterator[Callable[[int, ValidationJob], JobResult]]:
    """Yield a function that validates a job with a task; search s of a draw has the index ``search + s * START``.

    The results depend only on the seed and on this index. A search that finds no witness, or only one from a known
    initial state, is followed by another one; there are at most `TRIES` searches per initial state.

    Raises:
        SceneError: the scene cannot be built, or lacks the shape of an entity in a task.
    """
    with _validator(setup) as validator:

        def validate(_: int, job: ValidationJob) -> JobResult:
            assert isinstance(job.drawn, Task)
            return _result(setup, job, job.drawn, validator)[1]

        yield validate


@contextmanager
def open_draw_validator(
    setup: ValidationSetup,
) -> Iterator[Callable[[Sequence[ValidationJob]], tuple[list[JobResult], bytes]]]:
    """Yield a function that decodes draws and validates the tasks; it returns the results, and the rows as Arrow IPC.

    Raises:
        SceneError: the scene cannot be built, or lacks the shape of an entity in a task.
    """
    from prag_asp.dataset.store.columns import TableBuilder, packed
    from prag_asp.dataset.store.instructions import captioner_of
    from prag_asp.dataset.store.shard_writer import row_of
    from prag_asp.space.task_space import TaskSpace

    assert setup.space is not None
    domain, lengths, where = setup.space
    space = TaskSpace(domain, lengths).where(*where)
    captioner = captioner_of(domain, setup.spec.language, setup.spec.seed, setup.spec.phrasings)
    with _validator(setup) as validator:

        def results(jobs: Sequence[ValidationJob]) -> tuple[list[JobResult], bytes]:
            draws = [job.drawn for job in jobs if not isinstance(job.drawn, Task)]
            job_results, rows = [], TableBuilder("rejected")  # the table of tasks also has all columns of this table
            for job, draw, task in zip(jobs, draws, space.tasks_of_draws(draws), strict=True):
                result, encoded = _result(setup, job, task, validator)
                job_results.append(encoded)
                rows.add(row_of(draw, task, result, captioner(task, result.colours)))
            return job_results, packed(rows.table())

        yield results


@contextmanager
def _validator(setup: ValidationSetup) -> Iterator[Validator | None]:
    """Yield a validator for the scene, or None if there is no scene."""
    if setup.scene is None:
        yield None
        return
    from prag_asp.physics import open_validator

    with open_validator(setup.scene) as validator:
        yield validator


def _result(
    setup: ValidationSetup, job: ValidationJob, task: Task, validator: Validator | None
) -> tuple[DrawResult, JobResult]:
    """Return the result of a draw, as a value and in encoded form."""
    left_out = task.trivial and not setup.spec.trivial
    result, recordings = DrawResult(setup.part, job.number, None, [], left_out), tuple[bytes | None, ...]()
    if validator is not None and not left_out:
        verdicts = _verdicts(setup, job, task, validator)
        recordings = tuple(None if each.demonstration is None else each.demonstration.to_bytes() for each in verdicts)
        starts = []
        for each, content in zip(verdicts, recordings, strict=True):
            witness = msgspec.json.encode(None if each.witness is None else each.witness.to_json())
            shown, recording = each.demonstration, None
            if shown is not None and content is not None:
                colours = {} if shown.variation is None else dict(shown.variation.colours)
                ends, seconds = [int(frame) for frame in shown.ends], float(shown.times[-1])
                digest = sha256(content).hexdigest()
                recording = RecordingInfo("", digest, len(shown.times), seconds, ends, colours)
            starts.append(StartResult(each.index, msgspec.Raw(witness), recording))
        verdict = replace(verdicts[0], witness=None, demonstration=None)
        result = DrawResult(setup.part, job.number, verdict, starts)
    return result, JobResult(result.to_json(), recordings)


def _verdicts(setup: ValidationSetup, job: ValidationJob, task: Task, validator: Validator) -> list[Verdict]:
    """Return the verdict on a task or, if it is feasible, one verdict per initial state, in order of search."""

    def verdict(search: int) -> Verdict:
        index = job.search + search * START
        return validator.validate(task, seed=spec.seed, budget=spec.budget, index=index, staging=spec.staging)

    spec = setup.spec
    distinct: dict[str, Verdict] = {}
    result = verdict(0)
    if result.witness is None or spec.starts == 1:
        return [result]
    for search in range(1, TRIES * spec.starts + 1):
        if result.witness is not None:
            distinct.setdefault(initial_state_key(result.witness), result)
        if len(distinct) == spec.starts or search == TRIES * spec.starts:
            break
        result = verdict(search)
    return list(distinct.values())


def initial_state_key(witness: Witness) -> str:
    """Return a text that is equal for two witnesses if and only if they have the same initial state."""
    return json.dumps([witness.moments[0].to_json(), dict(witness.sizes)], sort_keys=True)
