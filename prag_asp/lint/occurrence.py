"""Actions and composites that never occur, initial states that violate invariants, and unreachable goals."""

from __future__ import annotations

from collections.abc import Iterator

import clingo

from prag_asp.lint.composites import Complaint, grouped
from prag_asp.lint.rule_origin import Origins, RulePlace
from prag_asp.program.composition import composite_actions
from prag_asp.program.facts import Facts
from prag_asp.program.invariants import FluentValue, conflict, entailed, invariant_graph, spell
from prag_asp.program.problem import Problem
from prag_asp.pruning.reachability import Unreachable
from prag_asp.pruning.rejected_actions import RejectedActions, Rejection, fluent_values, value_term
from prag_asp.pruning.rejected_composites import RejectedComposites


def state_problems(facts: Facts, origins: Origins) -> Iterator[Problem]:
    """Yield the reason why no initial state or no goal state satisfies the invariants."""
    graph = invariant_graph(facts)
    for predicate, values in (("initially", facts.initially), ("goal", facts.goal)):
        pair = conflict(entailed(fluent_values(values), graph))
        if pair:
            place = max(_place(origins, predicate, value) for value in pair)
            yield Problem(*place, f"{predicate} makes {_together(pair)}, but the invariants forbid it; change one")


def action_rejections(rejected: RejectedActions, facts: Facts, origins: Origins) -> Iterator[Problem]:
    """Yield one warning for all rejected actions with the same name and reason, or only one if no action remains."""
    if rejected.rejections and len(rejected.rejections) == len(facts.actions):
        action, rejection = next(iter(rejected.rejections.items()))
        text = f"no action can ever occur: {action} cannot, because {_reason(rejection)}; change the conditions"
        yield Problem(*_blamed(origins, rejection, action), text, "no-plan")
        return
    alike: dict[tuple[str, RulePlace], list[clingo.Symbol]] = {}
    for action, rejection in rejected.rejections.items():
        alike.setdefault((action.name, _blamed(origins, rejection, action)), []).append(action)
    for (name, place), actions in alike.items():
        more = f" and {len(actions) - 1} more like it" if len(actions) > 1 else ""
        pattern = f"{name}(...)" if actions[0].arguments else name
        yield Problem(
            *place,
            f"{actions[0]}{more} can never occur: {_reason(rejected.rejections[actions[0]])}; "
            f"change the conditions, or exclude it in the body of action({pattern})",
            "never-occurs",
        )


def goal_problems(rejected: RejectedActions, facts: Facts, origins: Origins) -> Iterator[Problem]:
    """Yield the problem if the goal contradicts a static value."""
    pair = conflict(entailed(fluent_values(facts.goal), invariant_graph(facts)), rejected.static)
    if pair:
        changed = any(pair[1][0] == fluent for values in facts.postconditions.values() for fluent, _ in values)
        yield Problem(
            *_place(origins, "goal", pair[1]),
            f"the goal is never reached: it needs {spell(pair[1])}, but {_unchanging(pair[0], changed)}; "
            "change the goal, or add an action",
            "no-plan",
        )


def composite_rejections(rejected: RejectedComposites, facts: Facts, origins: Origins) -> Iterator[Problem]:
    """Yield the composites that every state rejects, and the problem if none can begin in the initial state."""
    actions, failures = composite_actions(facts), rejected.failures
    complaints: list[Complaint] = []
    for composite, failure in failures.items():  # only the innermost, each at the stage of the cause
        stages = facts.stages[composite]
        if any(part in failures for _, part in stages):
            continue
        end = 0
        for number, part in stages:
            end += len(actions.get(part, (part,)))
            if failure.place < end:
                action = actions[composite][failure.place]
                text = f"can never occur: its action {failure.place + 1}, {action}, {failure.reason}"
                place = origins.place("stage", composite, number, part)
                complaints.append(Complaint(composite, place, text, "change its stages, or remove it"))
                break
    hopeless = rejected.none_can_begin and bool(complaints) and len(rejected.composites) == len(facts.composites)
    yield from grouped(complaints, "no-plan" if hopeless else "never-occurs")
    if rejected.none_can_begin and not hopeless:
        yield Problem(
            *origins.place("composite", facts.composites[0]),
            "no composite and no free action can begin in the initial state, so there is no plan; "
            "change the initial state, or declare more with free(...)",
            "no-plan",
        )


def unreachable_problems(unreachable: Unreachable, origins: Origins) -> Iterator[Problem]:
    """Yield the reason why no plan reaches the goal, or why no plan has a step."""
    if unreachable.goal:
        fluent, value = unreachable.goal[0]
        text = f"the goal is never reached: it needs {fluent} = {value}, and no action that can occur makes it so"
        place = origins.place("goal", fluent, clingo.Function(value))
        yield Problem(*place, f"{text}; change the goal, or add an action", "no-plan")
    elif unreachable.instead_of_all is not None:
        text = f"no action can ever occur: {unreachable.instead_of_all} and all others wait for each other's effects"
        yield Problem(*origins.place("action", unreachable.instead_of_all), f"{text}; change the conditions", "no-plan")


def _reason(rejection: Rejection) -> str:
    """Return the reason for a rejection as text."""
    pair = rejection.first, rejection.second
    if rejection.needs and rejection.static:
        return f"it needs {spell(rejection.second)}, but {_unchanging(rejection.first, rejection.may_change)}"
    verb = "it needs" if rejection.needs else "it makes" if rejection.makes else "after it,"
    opposed = pair[0] != pair[1] and pair[0][0] == pair[1][0]
    return f"{verb} {_together(pair)}{'' if opposed else ', which the invariants forbid'}"


def _unchanging(value: FluentValue, may_change: bool) -> str:
    able = "that can occur " if may_change else ""
    return f"{spell(value)} from the start and no action {able}changes that"


def _blamed(origins: Origins, rejection: Rejection, action: clingo.Symbol) -> RulePlace:
    return _place(origins, rejection.predicate, rejection.stated, action)


def _place(origins: Origins, predicate: str, value: FluentValue, *before: clingo.Symbol) -> RulePlace:
    return origins.place(predicate, *before, value[0], value_term(value[1]))


def _together(pair: tuple[FluentValue, FluentValue]) -> str:
    return spell(pair[0]) if pair[0] == pair[1] else f"{spell(pair[0])} and {spell(pair[1])}"
