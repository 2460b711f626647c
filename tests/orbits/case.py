"""Domains over a few entities, their tasks by brute force, and the entities that are interchangeable in them.

All of it from the definition, and no code of the library. Tasks are the orbits of plans under all renamings of entities
within their classes that map what is said of plans onto itself. What is said of states counts by the complete states
that it allows, and a condition by what satisfies it, so that another way to say the same says nothing new.
"""

from __future__ import annotations

import itertools
import random
import re
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field, replace
from functools import cache, cached_property
from operator import itemgetter

from tests.brute_force import State, Toy, Values, agrees, spelled

Plan = tuple[str, ...]
Names = dict[str, str]
States = frozenset[State]
Run = tuple[State, ...]

LONGEST = 3
"""Sequences of actions up to this length tell conditions apart."""


@dataclass(frozen=True)
class Clause:
    """A condition: its words, and what they mean for a plan, or for the state after some steps, the last one by -1.

    What it `achieves`, the first state does not satisfy.
    """

    words: str
    plan: Callable[[Plan], bool] | None = None
    step: int | None = None
    state: Callable[[dict[str, bool]], bool] | None = None
    achieves: bool = False


@dataclass(frozen=True)
class Case:
    """A ground domain over named entities, with conditions.

    The fluents and actions of `toy` have the names `fluents` and `actions`. `never_after` and `ending` are rules of the
    author: pairs of actions, the second of which never follows the first, and what the last state satisfies. `order`
    is the seed of an order of its facts; without one, they stand by their predicates.
    """

    toy: Toy
    entities: dict[str, str]
    fluents: tuple[str, ...]
    actions: Plan
    clauses: tuple[Clause, ...] = ()
    ending_text: str = ""
    ending: Callable[[dict[str, bool]], bool] = field(default=lambda state: True)
    order: int | None = None

    def text(self) -> str:
        f, a, toy = self.fluents, self.actions, self.toy
        lines = [f"class({c})." for c in sorted(set(self.entities.values()))]
        lines += [f"entity({e},{c})." for e, c in self.entities.items()]
        lines += [f"fluent({each})." for each in f] + [f"action({each})." for each in a]
        for name, action in zip(a, toy.actions, strict=True):
            lines += [f"precondition({name},{f[i]},{spelled(v)})." for i, v in action.before.items()]
            lines += [f"postcondition({name},{f[i]},{spelled(v)})." for i, v in action.after.items()]
        lines += [f"initially({f[i]},{spelled(v)})." for i, v in toy.initially.items()]
        lines += [f"goal({f[i]},{spelled(v)})." for i, v in toy.goal.items()]
        for predicate in ("exclusive", "implies", "impossible"):
            lines += [f"{predicate}({f[i]},{f[j]})." for i, j in getattr(toy, predicate)]
        if self.order is not None:
            random.Random(self.order).shuffle(lines)
        lines.append("#program step(t).")
        lines += [f":- occurs({a[i]},t-1), occurs({a[j]},t)." for i, j in toy.never_after]
        lines += ["#program check(t).", self.ending_text]
        return "\n".join(lines) + "\n"

    def named(self, state: State) -> dict[str, bool]:
        return dict(zip(self.fluents, state, strict=True))

    def plans(self, length: int) -> set[Plan]:
        """Return the plans that satisfy the conditions."""
        runs = self._runs_of(self.toy, length)
        known = self._runs_of(replace(self.toy, impossible=()), length) if self._asks_what_is_told else {}
        return {
            plan
            for plan, states in runs.items()
            if all(clause.plan(plan) for clause in self.clauses if clause.plan)
            and any(
                self._told_to_hold(run) and self.ending(self.named(run[-1])) and self._lacks(run[0]) for run in states
            )
            and (not self._asks_what_is_told or self._told_apart(known[plan]))
        }

    def _runs_of(self, toy: Toy, length: int) -> dict[Plan, list[Run]]:
        """Return the states that each plan of a length may pass."""

        @cache
        def after(state: State, i: int) -> States:
            return toy.after(frozenset({state}), (), i)

        runs: dict[tuple[int, ...], list[Run]] = {(): [(state,) for state in toy.start()]}
        for _ in range(length):
            longer = {
                (*plan, i): [(*run, state) for run in found for state in after(run[-1], i)]
                for plan, found in runs.items()
                for i in range(len(self.actions))
                if (*plan[-1:], i) not in toy.never_after
            }
            runs = {plan: found for plan, found in longer.items() if found}
        return {tuple(self.actions[i] for i in plan): found for plan, found in runs.items()}

    def _told_to_hold(self, run: Run) -> bool:
        """Return whether a run satisfies what a plan learns from: the goal, and states on the way."""
        return agrees(run[-1], self.toy.goal) and self._asked(-1, run[-1]) and self._passes_what_is_asked(run)

    def _passes_what_is_asked(self, run: Run) -> bool:
        return all(
            clause.step < len(run) and clause.state(self.named(run[clause.step]))
            for clause in self.clauses
            if clause.state and clause.step not in (None, -1)
        )

    def _agrees_with_what_is_told(self, run: Run) -> bool:
        """Return whether a run satisfies what is told of its states."""
        return agrees(run[-1], self._told_of_the_last) and self._passes_what_is_asked(run)

    @cached_property
    def _told_of_the_last(self) -> Values:
        """What all last states that are asked for share."""
        last = zip(*self._said["last"], strict=True)
        return {i: values[0] for i, values in enumerate(last) if len(set(values)) == 1}

    def _lacks(self, state: State) -> bool:
        """Return whether a first state satisfies nothing that is to be achieved."""
        return not any(clause.state(self.named(state)) for clause in self.clauses if clause.state and clause.achieves)

    @property
    def _asks_what_is_told(self) -> bool:
        return any(not clause.plan and not clause.state for clause in self.clauses)

    def _told_apart(self, runs: list[Run]) -> bool:
        """Return whether the states of a plan differ as nontrivial and loop-free say, as far as they are known."""
        words = {clause.words for clause in self.clauses}
        at_each_step = zip(*filter(self._agrees_with_what_is_told, runs), strict=True)
        values = ([set(value) for value in zip(*at, strict=True)] for at in at_each_step)
        states = [tuple(value.pop() if len(value) == 1 else None for value in each) for each in values]
        distinct = len(set(states)) == len(states)
        return (states[0] != states[-1] or "nontrivial" not in words) and (distinct or "loop-free" not in words)

    @cached_property
    def renamings(self) -> list[Names]:
        """Return all renamings that map what is said onto itself, tried one by one; conditions make none of them."""
        as_it_is = self._said_under({})
        kept = [names for names in self._in_classes() if self._is_spoken(names) and self._said_under(names) == as_it_is]
        if not self.clauses:
            return kept
        bare = replace(self, clauses=())
        as_it_was = bare._said_under({})
        return [names for names in kept if bare._said_under(names) == as_it_was]

    def _is_spoken(self, names: Names) -> bool:
        """Return whether fluents and actions are fluents and actions under other names."""
        return all({rename(each, names) for each in own} == {*own} for own in (self.fluents, self.actions))

    def _in_classes(self) -> Iterator[Names]:
        """Yield all ways to rename entities within their classes."""
        classes = [[e for e, c in self.entities.items() if c == each] for each in sorted({*self.entities.values()})]
        for orders in itertools.product(*map(itertools.permutations, classes)):
            yield {
                e: name for own, order in zip(classes, orders, strict=True) for e, name in zip(own, order, strict=True)
            }

    @cached_property
    def _every(self) -> list[State]:
        return list(itertools.product((False, True), repeat=len(self.fluents)))

    @cached_property
    def _allowed(self) -> list[State]:
        """The states that the invariants allow."""
        toy = replace(self.toy, impossible=())
        return [state for state in self._every if toy.allowed(state)]

    def _having(self, values: Values) -> list[State]:
        return [state for state in self._allowed if agrees(state, {i: v for i, v in values.items() if v is not None})]

    def _asked(self, step: int, state: State) -> bool:
        """Return whether a state satisfies the conditions on the state after some steps."""
        return all(clause.state(self.named(state)) for clause in self.clauses if clause.state and clause.step == step)

    @cached_property
    def _said(self) -> dict[object, list[State]]:
        """What is said of states: those that are allowed, by what says it."""
        said: dict[object, list[State]] = {
            "invariants": self._allowed,
            "impossible": list(filter(self.toy.allowed, self._allowed)),
            "start": [state for state in self._having(self.toy.initially) if self._asked(0, state)],
            "ending": [state for state in self._allowed if self.ending(self.named(state))],
            "last": [state for state in self._having(self.toy.goal) if self._asked(-1, state)],
        }
        said["lacking"] = list(filter(self._lacks, said["start"]))
        for name, action in zip(self.actions, self.toy.actions, strict=True):
            said["before", name], said["after", name] = self._having(action.before), self._having(action.after)
        for step in {clause.step for clause in self.clauses if clause.state} - {0, -1}:
            said["state", step] = [state for state in self._allowed if self._asked(step, state)]
        return said

    @property
    def sensible(self) -> bool:
        """Whether each action can occur at some time: another one says nothing of plans."""
        occurring: set[int] = set()
        seen = new = self.toy.start()
        while new:
            found = {i: self.toy.after(new, (), i) for i in range(len(self.actions))}
            occurring |= {i for i, after in found.items() if after}
            new = frozenset().union(*found.values()) - seen
            seen |= new
        return len(occurring) == len(self.actions)

    def _said_under(self, names: Names) -> object:
        """Return all that is said, with other names for the entities."""
        place = {name: i for i, name in enumerate(self.fluents)}
        moved = [place[rename(name, names)] for name in self.fluents]
        from_place = [moved.index(i) for i in range(len(moved))]
        renamed_state = itemgetter(*from_place)
        told = {what: frozenset(map(renamed_state, states)) for what, states in self._said.items()}
        renamed_action = self._actions_under(names)
        actions = {
            renamed_action[name]: (told["before", name], frozenset(moved[i] for i in action.after), told["after", name])
            for name, action in zip(self.actions, self.toy.actions, strict=True)
        }
        never_after = {tuple(renamed_action[self.actions[i]] for i in pair) for pair in self.toy.never_after}
        conditions = {self._meaning(i, clause, renamed_action, told) for i, clause in enumerate(self.clauses)} - {None}
        whole = [told[what] for what in ("invariants", "impossible", "start", "lacking", "ending", "last")]
        return whole, actions, never_after, conditions

    def _meaning(self, place: int, clause: Clause, renamed_action: Names, told: dict[object, States]) -> object:
        """Return what a condition means, or None where all satisfy it, or it refers to the first or last state."""
        if clause.plan:
            kept = self._kept[place]
            if len(kept) == len(self._sequences):
                return None
            return frozenset(tuple(map(renamed_action.__getitem__, words)) for words in kept)
        if clause.state:
            return None if clause.step in (0, -1) else (clause.step, told["state", clause.step])
        return clause.words

    @cached_property
    def _kept(self) -> dict[int, list[Plan]]:
        """The sequences of actions that satisfy each condition on a plan, whatever the entities are called."""
        asked = ((place, clause.plan) for place, clause in enumerate(self.clauses) if clause.plan)
        return {place: list(filter(satisfies, self._sequences)) for place, satisfies in asked}

    @cached_property
    def _sequences(self) -> list[Plan]:
        return [words for n in range(LONGEST + 1) for words in itertools.product(self.actions, repeat=n)]

    def orbits(self, plans: Iterable[Plan], renamings: Iterable[Names] | None = None) -> set[frozenset[Plan]]:
        """Return plans up to all renamings that keep what is said, or up to those of a group of renamings."""
        under = self._renamed if renamings is None else list(map(self._actions_under, renamings))
        return {frozenset(tuple(map(each.__getitem__, plan)) for each in under) for plan in plans}

    @cached_property
    def _renamed(self) -> list[Names]:
        """What the actions are called under each renaming that keeps what is said."""
        return list(map(self._actions_under, self.renamings))

    def _actions_under(self, names: Names) -> Names:
        return {action: rename(action, names) for action in self.actions}


def rename(text: str, names: Names) -> str:
    return re.sub(r"\b[xy]\d\b", lambda found: names.get(found[0], found[0]), text)
