"""Random valid tasks of a domain by a plain three-valued walk, independent of the library's engines."""

from __future__ import annotations

import random
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import Any

import clingo

from prag_asp.atom import Atom
from prag_asp.scene.scene import Scene
from prag_asp.scene.scene_loader import parse_scene
from prag_asp.task import Task
from tests.toml import tomllib

ROOT = Path(__file__).parents[2]
CLASSES = "is_a(E,C) :- entity(E,C). is_a(E,P) :- is_a(E,C), class(C,P)."
Known = dict[Atom, bool]


def _atom(symbol: clingo.Symbol) -> Atom:
    return Atom(symbol.name, tuple(str(argument) for argument in symbol.arguments))


class Rules:
    """The facts of a domain's rules, grounded."""

    def __init__(self, name: str):
        control = clingo.Control(["--warn=none"])
        text = (ROOT / "domains" / name / "domain.lp").read_text()
        control.add("base", [], text + CLASSES)
        control.ground([("base", [])])
        self.before: dict[Atom, Known] = {}
        self.after: dict[Atom, dict[Atom, bool | None]] = {}
        self.exclusive: dict[Atom, set[Atom]] = {}
        self.implies: dict[Atom, set[Atom]] = {}
        self.initially: Known = {}
        self.classes: dict[str, tuple[str, ...]] = {}
        self.entities: dict[str, str] = {}
        values = {"true": True, "false": False, "unknown": None}
        self.fluents: list[Atom] = []
        for known in control.symbolic_atoms:
            symbol = known.symbol
            arguments = symbol.arguments
            if symbol.name == "action":
                self.before.setdefault(_atom(arguments[0]), {})
                self.after.setdefault(_atom(arguments[0]), {})
            elif symbol.name == "precondition":
                self.before.setdefault(_atom(arguments[0]), {})[_atom(arguments[1])] = str(arguments[2]) == "true"
            elif symbol.name == "postcondition":
                self.after.setdefault(_atom(arguments[0]), {})[_atom(arguments[1])] = values[str(arguments[2])]
            elif symbol.name == "exclusive":
                one, two = _atom(arguments[0]), _atom(arguments[1])
                self.exclusive.setdefault(one, set()).add(two)
                self.exclusive.setdefault(two, set()).add(one)
            elif symbol.name == "implies":
                self.implies.setdefault(_atom(arguments[0]), set()).add(_atom(arguments[1]))
            elif symbol.name == "initially":
                self.initially[_atom(arguments[0])] = str(arguments[1]) == "true"
            elif symbol.name == "class":
                parents = self.classes.setdefault(str(arguments[0]), ())
                self.classes[str(arguments[0])] = parents + tuple(map(str, arguments[1:]))
            elif symbol.name == "entity":
                self.entities[str(arguments[0])] = str(arguments[1])
            elif symbol.name == "fluent":
                self.fluents.append(_atom(arguments[0]))

    def propagate(self, known: Known) -> bool:
        """Close a state under the invariants; False on a conflict."""
        queue = list(known.items())
        while queue:
            fluent, value = queue.pop()
            consequences = [(other, False) for other in self.exclusive.get(fluent, ())] if value else []
            consequences += [(other, True) for other in self.implies.get(fluent, ())] if value else []
            if not value:
                consequences += [(one, False) for one, others in self.implies.items() if fluent in others]
            for other, wanted in consequences:
                if known.get(other, wanted) != wanted:
                    return False
                if other not in known:
                    known[other] = wanted
                    queue.append((other, wanted))
        return True

    def step(self, known: Known, action: Atom) -> tuple[Known, Known] | None:
        """Return what is learned before an action and known after it; None where it cannot occur."""
        learned = dict(known)
        for fluent, value in self.before[action].items():
            if learned.get(fluent, value) != value:
                return None
            learned[fluent] = value
        if not self.propagate(learned):
            return None
        after = {f: v for f, v in learned.items() if f not in self.after[action]}
        after.update({f: v for f, v in self.after[action].items() if v is not None})
        return (learned, after) if self.propagate(after) else None

    def task(self, name: str, actions: list[Atom], learned: list[Known], states: list[Known]) -> Task:
        """Return a task with hindsight."""
        for k in range(len(actions) - 1, -1, -1):
            states[k].update(learned[k])
            changed = self.after[actions[k]]
            states[k].update({f: v for f, v in states[k + 1].items() if f not in changed})
            assert self.propagate(states[k])
        subgoals = [{f: v for f, v in self.after[a].items() if v is not None} for a in actions]
        named = {e for a in actions for e in a.arguments} | {e for s in states for f in s for e in f.arguments}
        entities = {e: c for e, c in self.entities.items() if e in named}
        return Task(name, tuple(actions), entities, states[0], tuple(states[1:]), tuple(subgoals), {})


@cache
def rules_of(name: str) -> Rules:
    """Return the rules of a shipped domain, which nothing changes."""
    return Rules(name)


def random_tasks(name: str, length: int, seed: int) -> Iterator[Task]:
    """Yield random valid tasks of a shipped domain, without end."""
    rules, rng = rules_of(name), random.Random(seed)
    options = sorted(rules.before)
    while True:
        known = dict(rules.initially)
        rules.propagate(known)
        actions: list[Atom] = []
        learned: list[Known] = []
        states = [dict(known)]
        while len(actions) < length:
            names = sorted({action.name for action in options})
            name_now = rng.choice(names)
            possible = [(a, s) for a in options if a.name == name_now and (s := rules.step(states[-1], a))]
            if not possible:
                continue
            action, (before, after) = rng.choice(possible)
            actions.append(action)
            learned.append(before)
            states.append(after)
        yield rules.task(name, actions, learned, states)


def shipped_scene(name: str) -> Scene:
    """Return the scene of a shipped domain."""
    return scene_with(name, {})


def scene_with(name: str, shapes: Mapping[str, object], *, folder: Path = Path(), **tables: object) -> Scene:
    """Return the scene of a shipped domain with other shapes of classes, and other tables."""
    table, rules = scene_table(name), rules_of(name)
    changed = {**table, **tables, "shapes": {**table["shapes"], **shapes}}
    return parse_scene(changed, rules.classes, rules.entities, folder=folder)


def scene_table(name: str) -> dict[str, Any]:
    """Return the [scene] table of a shipped domain."""
    table: dict[str, Any] = tomllib.loads((ROOT / "domains" / name / "domain.toml").read_text())["scene"]
    return table
