"""The relation of each action of a task to earlier ones: whether it restores, repeats or varies what they did."""

from __future__ import annotations

from prag_asp.atom import Atom
from prag_asp.grammar.reader import Grammar
from prag_asp.grammar.template import Recurrence
from prag_asp.task import State, Task

REPETITIONS = frozenset(["repeated", "varied"])
"""The recurrences of actions that change nothing."""


def recurrences(task: Task, grammar: Grammar) -> list[Recurrence]:
    """Return, for each action, whether its facts are new, held in an earlier state, or hold already.

    An action that changes nothing repeats an equal earlier action, and varies an earlier action with the same aim and a
    verb in common: "carry the can to the bowl, then carry it to the bowl again, this time along the guide".
    """
    states, found = [task.initial, *task.states], list[Recurrence]()
    for number, (action, subgoal) in enumerate(zip(task.actions, task.subgoals, strict=True)):
        earlier = action in task.actions[:number]
        changed = {fluent: value for fluent, value in subgoal.items() if states[number].get(fluent) != value}
        made = _aim(changed or subgoal)
        if changed:
            restored = any(made.items() <= state.items() for state in states[:number])
            found.append("new" if not restored else "redone" if earlier else "restored")
        else:
            before = zip(task.actions[:number], task.subgoals, strict=False)
            alike = [other for other, aims in before if made and made.items() <= dict(aims).items()]
            verbs = {verb for other in alike for verb in _verbs(grammar, other)}
            varied = not verbs.isdisjoint(_verbs(grammar, action))
            found.append("repeated" if earlier else "varied" if varied else "new")
    return found


def _aim(facts: State) -> dict[Atom, bool]:
    """Return the facts that an action makes true or, if there are none, all of its facts."""
    return {fluent: value for fluent, value in facts.items() if value} or dict(facts)


def _verbs(grammar: Grammar, action: Atom) -> set[str]:
    """Return the first word of each sentence for an action: of the given ones or, without any, the default ones."""
    signature = (action.name, len(action.arguments))
    templates = grammar.actions.get(signature) or [each.template for each in grammar.plain.get(signature, ())]
    return {template.texts[0].partition(" ")[0] for template in templates}
