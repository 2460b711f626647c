"""Jobs of validation: what physics says of the task of a draw and of further initial states of it, and its texts."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from hashlib import sha256
from typing import TYPE_CHECKING, Any, NamedTuple

import msgspec

from prag_asp.dataset.store.draw_results import DrawResult, RecordingInfo, StartResult
from prag_asp.task import Task

if TYPE_CHECKING:
    from prag_asp.dataset.store.columns import RowReference
    from prag_asp.dataset.store.instructions import Captioner
    from prag_asp.domain.load import Domain
    from prag_asp.physics import Budget, Demonstration, Staging, Validator, Verdict, Witness
    from prag_asp.scene.scene import Scene
    from prag_asp.space.without_replacement import Placed

START = 1 << 32
"""The difference between the indices of two searches in a row for the same task."""

TRIES = 4
"""Searches for each requested initial state, at most: one that finds none is replaced by the next."""


class ValidationJob(NamedTuple):
    """A draw to validate: its number in its part, the index of its first search, and its task or where that is."""

    number: int
    search: int
    drawn: Task | Placed


class JobResult(NamedTuple):
    """The result of a job: a `DrawResult` as JSON, files of recordings by initial states, and its row.

    The row is None where the job came with its task.
    """

    result: bytes
    recordings: tuple[bytes | None, ...] = ()
    row: RowReference | None = None


@dataclass(frozen=True)
class ValidationSetup:
    """How the draws of a part are validated: by physics with a `scene`; `captions` make tasks and texts of draws."""

    part: str
    seed: int
    budget: Budget | None = None
    scene: Scene | None = None
    starts: int = 1
    staging: Staging | None = None
    captions: CaptionSetup | None = None


@dataclass(frozen=True)
class CaptionSetup:
    """What makes tasks of the draws of a space of some lengths and conditions, and texts of the tasks."""

    domain: Domain
    lengths: tuple[int, ...]
    where: tuple[str, ...]
    language: str
    seed: int
    phrasings: str


def answers(messages: Iterator[Any]) -> Iterator[list[JobResult]]:
    """Yield the results of numbered jobs, many together; the first message is their `ValidationSetup`.

    Raises:
        SceneError: the scene cannot be built, or a task names something for which it has no shape.
    """
    with open_job_validator(next(messages)) as validate:
        for numbered in messages:
            yield validate([job for _, job in numbered])


@contextmanager
def open_job_validator(setup: ValidationSetup) -> Iterator[Callable[[Sequence[ValidationJob]], list[JobResult]]]:
    """Yield a function that validates jobs with tasks; search s of a draw has the index ``search + s * START``.

    So its results depend on the seed and these two alone. A search that finds no witness, or one from an initial state
    that is there already, is replaced by the next one, up to `TRIES` for each initial state.

    Raises:
        SceneError: as `answers` does.
    """
    with _validator(setup) as validator:

        def results(jobs: Sequence[ValidationJob]) -> list[JobResult]:
            return [_result(setup, job, job.drawn, validator)[1] for job in jobs if isinstance(job.drawn, Task)]

        yield results


@contextmanager
def open_draw_validator(
    setup: ValidationSetup, captions: CaptionSetup
) -> Iterator[Callable[[Sequence[ValidationJob]], tuple[list[JobResult], bytes]]]:
    """Yield a function that makes tasks of draws and validates them; it returns results, and their rows as Arrow.

    Raises:
        SceneError: as `answers` does.
    """
    from prag_asp.dataset.store.columns import TableBuilder, packed
    from prag_asp.dataset.store.shard_writer import row_of

    tasks, captioner = _tasks_and_texts(captions)
    with _validator(setup) as validator:

        def results(jobs: Sequence[ValidationJob]) -> tuple[list[JobResult], bytes]:
            placed = [job.drawn for job in jobs if not isinstance(job.drawn, Task)]
            every, rows = [], TableBuilder("refused")  # all of its columns are columns of tasks, too
            for job, each, task in zip(jobs, placed, tasks(placed), strict=True):
                result, encoded = _result(setup, job, task, validator)
                every.append(encoded)
                rows.add(row_of(each, task, result, captioner(task, result.colours)))
            return every, packed(rows.table())

        yield results


@contextmanager
def _validator(setup: ValidationSetup) -> Iterator[Validator | None]:
    """Yield a validator of the scene, where there is one.

    Raises:
        SceneError: the scene cannot be built.
    """
    with ExitStack() as resources:
        if setup.scene is None:
            yield None
            return
        from prag_asp.physics.worker import opened_validator

        yield opened_validator(setup.scene, resources)


def _tasks_and_texts(setup: CaptionSetup) -> tuple[Callable[[Sequence[Placed]], list[Task]], Captioner]:
    """Return a function that makes tasks of draws, many together, and one that makes the texts of a task."""
    from prag_asp.dataset.store.instructions import captioner_of
    from prag_asp.space.task_space import TaskSpace
    from prag_asp.space.task_spaces import TaskSpaces
    from prag_asp.space.without_replacement import tell

    one = len(setup.lengths) == 1
    domain = setup.domain
    whole = TaskSpace(domain, setup.lengths[0]) if one else TaskSpaces(domain, setup.lengths)
    space = whole.where(*setup.where)

    def tasks(draws: Sequence[Placed]) -> list[Task]:
        return [task for _, task in tell(space, iter(draws), together=len(draws))]

    return tasks, captioner_of(domain, setup.language, setup.seed, setup.phrasings)


def _result(
    setup: ValidationSetup, job: ValidationJob, task: Task, validator: Validator | None
) -> tuple[DrawResult, JobResult]:
    """Return the result of a draw, as a value and encoded."""
    result, recordings = DrawResult(setup.part, job.number, None, []), tuple[bytes | None, ...]()
    if validator is not None:
        verdicts = _verdicts(setup, job, task, validator)
        recordings = tuple(None if each.demonstration is None else each.demonstration.packed() for each in verdicts)
        starts = [
            StartResult(each.index, _witness_json(each), _recording_info(each.demonstration, content))
            for each, content in zip(verdicts, recordings, strict=True)
        ]
        result = DrawResult(setup.part, job.number, _without_witness(verdicts[0]), starts)
    return result, JobResult(msgspec.json.encode(result), recordings)


def _verdicts(setup: ValidationSetup, job: ValidationJob, task: Task, validator: Validator) -> list[Verdict]:
    """Return the verdict on a task, or if it is feasible one for each of its initial states, in order of searches."""

    def verdict(search: int) -> Verdict:
        index = job.search + search * START
        return validator.validate(task, seed=setup.seed, budget=setup.budget, index=index, staging=setup.staging)

    different: dict[str, Verdict] = {}
    found = verdict(0)
    if found.witness is None or setup.starts == 1:
        return [found]
    for search in range(1, TRIES * setup.starts + 1):
        if found.witness is not None:
            different.setdefault(initial_state_key(found.witness), found)
        if len(different) == setup.starts or search == TRIES * setup.starts:
            break
        found = verdict(search)
    return list(different.values())


def _witness_json(verdict: Verdict) -> msgspec.Raw:
    return msgspec.Raw(msgspec.json.encode(None if verdict.witness is None else verdict.witness.to_json()))


def _without_witness(verdict: Verdict) -> dict[str, Any]:
    """Return a verdict as a value of JSON; its witness has a table of its own."""
    return {name: value for name, value in verdict.to_json().items() if name != "witness"}


def initial_state_key(witness: Witness) -> str:
    """Return a text that two witnesses have in common if and only if they have the same initial state."""
    return json.dumps([witness.moments[0].to_json(), dict(witness.sizes)], sort_keys=True)


def _recording_info(demonstration: Demonstration | None, content: bytes | None) -> RecordingInfo | None:
    """Return the description of a recording, which has no file yet."""
    if demonstration is None or content is None:
        return None
    ends, seconds = [int(frame) for frame in demonstration.ends], float(demonstration.times[-1])
    colours = {} if demonstration.variation is None else dict(demonstration.variation.colours)
    return RecordingInfo("", sha256(content).hexdigest(), len(demonstration.times), seconds, ends, colours)
