"""What is known of a draw: what physics says of the task and of further first states of it, and its words."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from hashlib import sha256
from typing import TYPE_CHECKING, NamedTuple

import msgspec

from prag_asp.dataset.store.draw_results import Looked, Recorded, Start
from prag_asp.task import Task

if TYPE_CHECKING:
    from prag_asp.dataset.store.columns import Row
    from prag_asp.dataset.store.instructions import Telling as Words
    from prag_asp.domain.load import Domain
    from prag_asp.physics import Budget, Demonstration, Staging, Validator, Verdict, Witness
    from prag_asp.scene.scene import Scene
    from prag_asp.space.distinct_sampling import RankedDraw

START = 1 << 32
"""How far the index of a search is from that of the same task's search for the next first state."""

TRIES = 4
"""How many searches are made for each first state that is wanted, at most: one that finds none is made up for."""


class Draw(NamedTuple):
    """What is to be looked at: its number in its part, the index of its first search, and the task, if it is told."""

    number: int
    search: int
    drawn: Task | RankedDraw


class Found(NamedTuple):
    """What is known of a draw: a `Looked` as JSON, files of recordings by first states, and its row.

    That is left out where the draw was a task that is told already.
    """

    looked: bytes
    recordings: tuple[bytes | None, ...] = ()
    row: Row | None = None


@dataclass(frozen=True)
class Look:
    """How the draws of a part are looked at: by physics where there is a scene.

    `scene` is there where physics looks, `telling` where draws are no tasks yet.
    """

    part: str
    seed: int
    budget: Budget | None = None
    scene: Scene | None = None
    starts: int = 1
    staging: Staging | None = None
    telling: Telling | None = None


@dataclass(frozen=True)
class Telling:
    """What tells draws of a space of some lengths and conditions as tasks, and these in words."""

    domain: Domain
    lengths: tuple[int, ...]
    where: tuple[str, ...]
    language: str
    seed: int
    phrasings: str


@contextmanager
def looker(look: Look) -> Iterator[Callable[[int, Draw], Found]]:
    """Yield what looks at a draw that is a task, by its index; search s of it has the index ``search + s * START``.

    So what it finds depends on the seed and these two alone. A search that finds no witness, or one from a first state
    that is there already, is made up for by the next one, up to `TRIES` for each first state.

    Raises:
        SceneError: the scene cannot be built, or a task speaks about something for which it has no shape.
    """
    with _validator(look) as validator:

        def found(_: int, draw: Draw) -> Found:
            assert isinstance(draw.drawn, Task)
            return _found(look, draw, draw.drawn, validator)[1]

        yield found


@contextmanager
def telling_looker(look: Look, telling: Telling) -> Iterator[Callable[[Sequence[Draw]], tuple[list[Found], bytes]]]:
    """Yield what tells draws as tasks, and looks at them as `looker` does; with what is found come their packed rows.

    Raises:
        SceneError: as `looker` does.
    """
    from prag_asp.dataset.store.columns import Rows, packed
    from prag_asp.dataset.store.shard_writer import row_of

    tasks, words = _teller(telling)
    with _validator(look) as validator:

        def found(draws: Sequence[Draw]) -> tuple[list[Found], bytes]:
            placed = [draw.drawn for draw in draws if not isinstance(draw.drawn, Task)]
            every, rows = [], Rows("refused")  # whose columns tasks have, too
            for draw, each, task in zip(draws, placed, tasks(placed), strict=True):
                looked, known = _found(look, draw, task, validator)
                every.append(known)
                rows.add(row_of(each, task, looked, words(task, looked.colours)))
            return every, packed(rows.table())

        yield found


@contextmanager
def _validator(look: Look) -> Iterator[Validator | None]:
    """Yield a validator of the scene, where there is one.

    Raises:
        SceneError: the scene cannot be built.
    """
    if look.scene is None:
        yield None
        return
    from prag_asp.physics import open_validator

    with open_validator(look.scene) as validator:
        yield validator


def _teller(telling: Telling) -> tuple[Callable[[Sequence[RankedDraw]], list[Task]], Words]:
    """Return what tells draws together as tasks, and what tells a task in words."""
    from prag_asp.dataset.store.instructions import telling_of
    from prag_asp.space.task_space import TaskSpace

    space = TaskSpace(telling.domain, telling.lengths).where(*telling.where)
    return space.tasks_of_draws, telling_of(telling.domain, telling.language, telling.seed, telling.phrasings)


def _found(look: Look, draw: Draw, task: Task, validator: Validator | None) -> tuple[Looked, Found]:
    """Return what is known of a draw, as it is and as it travels."""
    if validator is None:
        looked, recordings = Looked(look.part, draw.number, None, []), tuple[bytes | None, ...]()
    else:
        looked, recordings = _searched(look, draw, task, validator)
    return looked, Found(msgspec.json.encode(looked), recordings)


def _searched(look: Look, draw: Draw, task: Task, validator: Validator) -> tuple[Looked, tuple[bytes | None, ...]]:
    """Return what physics says of a draw, and the files of its recordings by first states."""
    verdicts = _verdicts(look, draw, task, validator)
    first = verdicts[0].to_json()
    texts = [first.pop("witness"), *(None if each.witness is None else each.witness.to_json() for each in verdicts[1:])]
    recordings = tuple(None if each.demonstration is None else each.demonstration.to_bytes() for each in verdicts)
    starts = [
        Start(each.index, msgspec.Raw(msgspec.json.encode(text)), _recorded(each.demonstration, content))
        for each, text, content in zip(verdicts, texts, recordings, strict=True)
    ]
    return Looked(look.part, draw.number, first, starts), recordings


def _verdicts(look: Look, draw: Draw, task: Task, validator: Validator) -> list[Verdict]:
    """Return the verdict on a task, and where it passes one for each of its first states, by the order of searches."""

    def verdict(search: int) -> Verdict:
        index = draw.search + search * START
        return validator.validate(task, seed=look.seed, budget=look.budget, index=index, staging=look.staging)

    different: dict[str, Verdict] = {}
    found = verdict(0)
    if found.witness is None or look.starts == 1:
        return [found]
    for search in range(1, TRIES * look.starts + 1):
        if found.witness is not None:
            different.setdefault(first_state(found.witness), found)
        if len(different) == look.starts or search == TRIES * look.starts:
            break
        found = verdict(search)
    return list(different.values())


def first_state(witness: Witness) -> str:
    """Return the first state of a witness as a text: two that are the same have the same."""
    return json.dumps([witness.moments[0].to_json(), dict(witness.sizes)], sort_keys=True)


def _recorded(demonstration: Demonstration | None, content: bytes | None) -> Recorded | None:
    """Return what is told of a recording, which has no file yet."""
    if demonstration is None or content is None:
        return None
    ends, seconds = [int(frame) for frame in demonstration.ends], float(demonstration.times[-1])
    colours = {} if demonstration.variation is None else dict(demonstration.variation.colours)
    return Recorded("", sha256(content).hexdigest(), len(demonstration.times), seconds, ends, colours)
