"""Random tasks of a small made-up world, and all renamings of its entities."""

from __future__ import annotations

import itertools
import random
from collections.abc import Iterator, Mapping

from prag_asp import Atom, Task
from prag_asp.similarity import Background, Interchange
from prag_asp.task import FrozenDict

CLASSES = {"a": "apple", "b": "apple", "c": "apple", "l": "lemon", "m": "lemon", "t": "table", "x": "cup", "y": "cup",
           "u": "saucer", "v": "saucer"}  # fmt: skip
PARENTS = {"apple": ("fruit",), "lemon": ("fruit",), "fruit": ("thing",), "table": ("thing",), "cup": (), "saucer": ()}
INTERCHANGE = Interchange((("a", "b", "c"), ("l", "m")), ((("x", "u"), ("y", "v")),))
BACKGROUND = Background(CLASSES, PARENTS, INTERCHANGE)


def random_task(chance: random.Random, length: int) -> Task:
    """Return a task of a length whose actions put things on things and make a fact true or false."""
    entities = chance.sample(sorted(CLASSES), 5)
    state: dict[Atom, bool] = {Atom("on", (e, "t")): True for e in entities[:2]}
    initial, states, subgoals, actions = dict(state), [], [], []
    for _ in range(length):
        one, other = chance.sample(entities, 2)
        actions.append(Atom(chance.choice(["put", "push"]), (one, other)))
        subgoals.append({Atom("on", (one, other)): chance.random() < 0.6, Atom("seen", (one,)): True})
        state = {**state, **subgoals[-1]}
        states.append(FrozenDict(state))
    return Task(
        "made_up", tuple(actions), FrozenDict({e: CLASSES[e] for e in (*entities, "t")}), FrozenDict(initial),
        tuple(states), tuple(map(FrozenDict, subgoals)), states[-1] if states else FrozenDict(initial),
    )  # fmt: skip


def all_renamings() -> Iterator[Mapping[str, str]]:
    """Yield every renaming, by permuting the groups and the units."""
    for fruits, lemons in itertools.product(itertools.permutations("abc"), itertools.permutations("lm")):
        for unit in ("xuyv", "yvxu"):
            yield dict(zip("abclmxuyv", (*fruits, *lemons, *unit), strict=True))


def renamed(task: Task, names: Mapping[str, str]) -> Task:
    """Return a task with other entities."""

    def atom(given: Atom) -> Atom:
        return Atom(given.name, tuple(names.get(each, each) for each in given.arguments))

    def state(values: Mapping[Atom, bool]) -> FrozenDict[Atom, bool]:
        return FrozenDict({atom(fact): value for fact, value in values.items()})

    return Task(
        task.domain, tuple(map(atom, task.actions)), FrozenDict({names.get(e, e): c for e, c in task.entities.items()}),
        state(task.initial), tuple(map(state, task.states)), tuple(map(state, task.subgoals)), state(task.goal),
    )  # fmt: skip
