"""Domains as plain Python values, their text, and the plans that the definition allows: no code of the library.

A plan is valid if some complete initial state that agrees with `initially` and satisfies the invariants executes it.
So the set of all complete states that are still possible is carried along, and a plan is valid while it is not empty.
"""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property

State = tuple[bool, ...]
Values = dict[int, bool | None]


@dataclass(frozen=True)
class Action:
    name: str
    before: Values
    after: Values


@dataclass(frozen=True)
class Toy:
    """A ground domain over the fluents f0, f1, ...; an unknown effect is None.

    A part of a composite is the number of an action or, above these, the number of actions plus that of a composite
    before it. Without composites, `free` means nothing.
    """

    fluents: int
    actions: tuple[Action, ...]
    initially: Values = field(default_factory=dict)
    exclusive: tuple[tuple[int, int], ...] = ()
    implies: tuple[tuple[int, int], ...] = ()
    goal: Values = field(default_factory=dict)
    never_after: tuple[tuple[int, int], ...] = ()
    at_most: dict[str, int] = field(default_factory=dict)
    blocked: tuple[tuple[int, int, int], ...] = ()
    composites: tuple[tuple[int, ...], ...] = ()
    free: tuple[int, ...] = ()
    impossible: tuple[tuple[int, int], ...] = ()

    def text(self) -> str:
        lines = [f"fluent(f{f})." for f in range(self.fluents)]
        lines += [f"action({term(self, i)})." for i in range(len(self.actions))]
        for i, action in enumerate(self.actions):
            lines += [f"precondition({term(self, i)},f{f},{spelled(v)})." for f, v in action.before.items()]
            lines += [f"postcondition({term(self, i)},f{f},{spelled(v)})." for f, v in action.after.items()]
        lines += [f"initially(f{f},{spelled(v)})." for f, v in self.initially.items()]
        lines += [f"exclusive(f{f},f{g})." for f, g in self.exclusive]
        lines += [f"implies(f{f},f{g})." for f, g in self.implies]
        lines += [f"impossible(f{f},f{g})." for f, g in self.impossible]
        lines += [f"goal(f{f},{spelled(v)})." for f, v in self.goal.items()]
        lines += [f"at_most({name},{k})." for name, k in self.at_most.items()]
        lines += [f"composite(c{i})." for i in range(len(self.composites))]
        lines += [
            f"stage(c{i},{k},{part(self, p)})." for i, c in enumerate(self.composites) for k, p in enumerate(c, 1)
        ]
        lines += [f"free({term(self, i)})." for i in self.free]
        lines.append("#program step(t).")
        lines += [f":- occurs({term(self, i)},t-1), occurs({term(self, j)},t)." for i, j in self.never_after]
        lines += [
            f":- occurs({term(self, i)},t), holds(f{f},true,t-1), not holds(f{g},true,t-1)." for i, f, g in self.blocked
        ]
        return "\n".join(lines) + "\n"

    def allowed(self, state: State) -> bool:
        return state in self._allowed

    @cached_property
    def _allowed(self) -> frozenset[State]:
        """The states that satisfy the invariants."""
        return frozenset(
            state
            for state in itertools.product((False, True), repeat=self.fluents)
            if not any(state[f] and state[g] for f, g in (*self.exclusive, *self.impossible))
            and all(state[g] for f, g in self.implies if state[f])
        )

    def start(self) -> frozenset[State]:
        return frozenset(state for state in self._allowed if agrees(state, self.initially))

    def after(self, states: frozenset[State], plan: tuple[int, ...], i: int) -> frozenset[State]:
        if plan and (plan[-1], i) in self.never_after:
            return frozenset()
        if self.at_most:
            names = Counter(self.actions[j].name for j in (*plan, i))
            if any(names[name] > k for name, k in self.at_most.items()):
                return frozenset()
        return frozenset().union(*(self._after(state, i) for state in states))

    def _after(self, state: State, i: int) -> frozenset[State]:
        """Return the states after an action, whatever came before: each is asked for by many plans."""
        if (state, i) not in self._known:
            self._known[state, i] = frozenset(self._found_after(state, i))
        return self._known[state, i]

    @cached_property
    def _known(self) -> dict[tuple[State, int], frozenset[State]]:
        return {}

    def _found_after(self, state: State, i: int) -> Iterator[State]:
        action = self.actions[i]
        if not agrees(state, action.before):
            return
        if any(i == j and state[f] and not state[g] for j, f, g in self.blocked):
            return
        free = [f for f, v in action.after.items() if v is None]
        for values in itertools.product((False, True), repeat=len(free)):
            changed = {**action.after, **dict(zip(free, values, strict=True))}
            after = tuple(bool(changed.get(f, state[f])) for f in range(self.fluents))
            if self.allowed(after):
                yield after

    def plans(self, length: int) -> Iterator[tuple[int, ...]]:
        def extend(plan: tuple[int, ...], states: frozenset[State]) -> Iterator[tuple[int, ...]]:
            if not states:
                return
            if len(plan) == length:
                if any(agrees(state, self.goal) for state in states) and (
                    not self.composites or next(self.readings(plan), None) is not None
                ):
                    yield plan
                return
            for i in range(len(self.actions)):
                yield from extend((*plan, i), self.after(states, plan, i))

        return extend((), self.start())

    def word(self, number: int) -> tuple[int, ...]:
        """Return the actions of a part."""
        if number < len(self.actions):
            return (number,)
        return tuple(i for p in self.composites[number - len(self.actions)] for i in self.word(p))

    def readings(self, plan: tuple[int, ...]) -> Iterator[tuple[int, ...]]:
        """Yield the ways to read a plan as whole composites and free actions, each as their numbers."""
        if not plan:
            yield ()
        composites = (len(self.actions) + i for i in range(len(self.composites)))
        for number in (*self.free, *composites):
            word = self.word(number)
            if plan and plan[: len(word)] == word:
                yield from ((number, *rest) for rest in self.readings(plan[len(word) :]))


def agrees(state: State, values: Values) -> bool:
    return all(state[f] == v for f, v in values.items())


def term(toy: Toy, i: int) -> str:
    return f"{toy.actions[i].name}({i})"


def part(toy: Toy, number: int) -> str:
    return term(toy, number) if number < len(toy.actions) else f"c{number - len(toy.actions)}"


def spelled(value: bool | None) -> str:
    return "unknown" if value is None else str(value).lower()
