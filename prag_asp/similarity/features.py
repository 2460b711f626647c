"""The features of a task that metrics compare: its actions, effects, changes, states and causal links."""

from __future__ import annotations

from collections import Counter

from prag_asp.atom import Atom
from prag_asp.similarity.background import Background, FactValues, Trace
from prag_asp.similarity.symbols import Symbol

Feature = tuple[Symbol, ...]


def actions(task: Trace, background: Background) -> Feature:
    """Return the actions, in order."""
    return task.actions


def effects(task: Trace, background: Background) -> Feature:
    """Return each action with the facts that it makes true or false, in order."""
    return tuple((action, frozenset(facts.items())) for action, facts in zip(task.actions, task.subgoals, strict=True))


def changes(task: Trace, background: Background) -> Feature:
    """Return the facts whose value differs between the initial and the final state, with the final value.

    Unknown also counts as a value: None stands for a fact that is known initially and unknown at the end.
    """
    final = task.states[-1] if task.states else task.initial
    return changed(task.initial, final)


def changed(initial: FactValues, final: FactValues) -> Feature:
    """Return the facts whose values differ between two states, each with its value in the second, sorted."""
    facts = {fact: value for fact, value in final.items() if initial.get(fact) != value}
    gone = {fact: None for fact in initial if fact not in final}
    return tuple(sorted({**facts, **gone}.items(), key=str))


def states(task: Trace, background: Background) -> Feature:
    """Return the known facts of the initial state and of the state after each action."""
    return tuple(frozenset(state.items()) for state in (task.initial, *task.states))


def links(task: Trace, background: Background) -> Feature:
    """Return the causal links: producer, fact, value, consumer, and the number of equal links before it.

    A link states that an action (the consumer) needs a fact, and names the last action that established it, or None for
    the initial state (McAllester and Rosenblitt 1991). If the preconditions of an action are unknown, it is assumed to
    need the opposite of each fact that it changes.
    """
    producers: dict[tuple[Atom, bool], Atom] = {}
    found: Counter[Symbol] = Counter()
    result = []
    for consumer, facts in zip(task.actions, task.subgoals, strict=True):
        if background.preconditions is None:
            needs = {fact: not value for fact, value in facts.items()}
            needs = {fact: value for fact, value in needs.items() if (fact, value) in producers}
        else:
            needs = dict(background.preconditions.get(consumer, {}))
        for fact, value in sorted(needs.items()):
            link = (producers.get((fact, value)), fact, value, consumer)
            result.append((*link, found[link]))
            found[link] += 1
        for fact, value in facts.items():
            producers[fact, value] = consumer
            producers.pop((fact, not value), None)
    return tuple(sorted(result, key=str))
