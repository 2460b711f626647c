"""What is known of a draw: what physics says of the task and of further first states of it, and its words."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from hashlib import sha256
from typing import TYPE_CHECKING, Any, NamedTuple

import msgspec

from prag_asp.dataset.store.looked import Looked, Recorded, Start
from prag_asp.task import Task

if TYPE_CHECKING:
    from prag_asp.dataset.store.told import Telling as Words
    from prag_asp.dataset.store.told import Told
    from prag_asp.domain.load import Domain
    from prag_asp.physics import Budget, Demonstration, Staging, Validator, Verdict, Witness
    from prag_asp.scene.model import Scene
    from prag_asp.space.ordered import Placed

START = 1 << 32
"""How far the index of a search is from that of the same task's search for the next first state."""

TRIES = 4
"""How many searches are made for each first state that is wanted, at most: one that finds none is made up for."""


class Draw(NamedTuple):
    """What is to be looked at: its number in its part, the index of its first search, and the task, if it is told."""

    number: int
    search: int
    drawn: Task | Placed


class Found(NamedTuple):
    """What is known of a draw: a `Looked` as JSON, files of recordings by first states, and its task with its words.

    These are left out where the draw was a task that is told already.
    """

    looked: bytes
    recordings: tuple[bytes | None, ...] = ()
    told: tuple[Task, Told] | None = None


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


def answers(messages: Iterator[Any]) -> Iterator[list[Found]]:
    """Yield what is known of numbered draws, many together; first of all comes how they are looked at.

    Raises:
        SceneError: the scene cannot be built, or a task speaks about something for which it has no shape.
    """
    with looker(next(messages)) as looked_at:
        for numbered in messages:
            yield looked_at([draw for _, draw in numbered])


@contextmanager
def looker(look: Look) -> Iterator[Callable[[Sequence[Draw]], list[Found]]]:
    """Yield what looks at draws; search s of a draw has the index ``search + s * START``.

    So what it finds depends on the seed and these two alone. A search that finds no witness, or one from a first state
    that is there already, is made up for by the next one, up to `TRIES` for each first state.

    Raises:
        SceneError: as `answers` does.
    """
    with ExitStack() as resources:
        validator = None
        if look.scene is not None:
            from prag_asp.physics.worker import opened_validator

            validator = opened_validator(look.scene, resources)
        told = None if look.telling is None else _teller(look.telling)

        def found(draws: Sequence[Draw]) -> list[Found]:
            if told is None:
                return [_found(look, draw, draw.drawn, validator) for draw in draws if isinstance(draw.drawn, Task)]
            tasks, words = told
            drawn = tasks([draw.drawn for draw in draws if not isinstance(draw.drawn, Task)])
            return [_found(look, draw, task, validator, words) for draw, task in zip(draws, drawn, strict=True)]

        yield found


def _teller(telling: Telling) -> tuple[Callable[[Sequence[Placed]], list[Task]], Words]:
    """Return what tells draws together as tasks, and what tells a task in words."""
    from prag_asp.dataset.store.told import telling_of
    from prag_asp.space.ordered import tell
    from prag_asp.space.task_space import TaskSpace
    from prag_asp.space.task_spaces import TaskSpaces

    one = len(telling.lengths) == 1
    domain = telling.domain
    whole = TaskSpace(domain, telling.lengths[0]) if one else TaskSpaces(domain, telling.lengths)
    space = whole.where(*telling.where)

    def tasks(draws: Sequence[Placed]) -> list[Task]:
        return [task for _, task in tell(space, iter(draws), together=len(draws))]

    return tasks, telling_of(domain, telling.language, telling.seed, telling.phrasings)


def _found(look: Look, draw: Draw, task: Task, validator: Validator | None, words: Words | None = None) -> Found:
    """Return what is known of a draw, with its task and its words where something tells these."""
    if validator is None:
        looked, recordings = Looked(look.part, draw.number, None, []), tuple[bytes | None, ...]()
    else:
        looked, recordings = _searched(look, draw, task, validator)
    told = None if words is None else (task, words(task, looked.colours))
    return Found(msgspec.json.encode(looked), recordings, told)


def _searched(look: Look, draw: Draw, task: Task, validator: Validator) -> tuple[Looked, tuple[bytes | None, ...]]:
    """Return what physics says of a draw, and the files of its recordings by first states."""
    verdicts = _verdicts(look, draw, task, validator)
    first = verdicts[0].to_json()
    texts = [first.pop("witness"), *(None if each.witness is None else each.witness.to_json() for each in verdicts[1:])]
    recordings = tuple(None if each.demonstration is None else each.demonstration.packed() for each in verdicts)
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
