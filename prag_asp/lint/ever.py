"""The checks of ``ever``: actions are lost if their rules read it for a fluent that may be true but is not stated.

Actions are also lost if their rules read a fluent that the action does not require.

Every fluent that is reachable and read must be stated. By induction over the steps, an action that is not ground then
never occurs, because all actions before it are ground.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence

import clingo
from clingo.ast import ASTType

from prag_asp.program.facts import Facts, unsorted_rows
from prag_asp.program.grounding import Grounder
from prag_asp.program.invariants import entailed, invariant_graph
from prag_asp.program.predicates import CHANGED, EVER
from prag_asp.program.problem import Problem
from prag_asp.program.syntax import Statement, plain_atom
from prag_asp.pruning.reachability import RelaxedReach
from prag_asp.pruning.rejected_actions import STATE_PREDICATES
from prag_asp.pruning.relaxed_rules import FluentSetter

ACTION, PRECONDITION = ("action", 1), ("precondition", 3)

ASKS = "_asks_ever"
"""The predicate of N, A and F: the N-th rule that reads `ever` derives action A only if fluent F may be true."""

MISSING = "actions that require it would be missing"


def ever_problems(
    grounder: Grounder, facts: Facts, statements: Sequence[Statement], reach: RelaxedReach | None
) -> Iterator[Problem]:
    """Yield the first fluent of each name that may be true at some time and is read by ``ever`` but not stated.

    Without a `reach`, every fluent that the initial state, an action or a user rule may make true counts.
    """
    fluents = {fluent.name for fluent in facts.fluents}
    readers: dict[str, Statement] = {}  # "" if any fluent may be read, for example by a variable
    for each in statements:
        for atom in each.body if each.own else ():
            if atom.signature == EVER:
                name = atom.arguments[0].partition("(")[0]
                readers.setdefault(name if name in fluents else "", each)
    if not readers:
        return
    defined = ((each.node.name, each.node.arity) for each in statements if each.own and each.kind == ASTType.Defined)
    derived = (atom.signature for each in statements for atom in each.heads)
    if EVER not in (*defined, *derived):
        text = 'ever is read, but no rule derives it; add #include "rules/ever.lp".'
        yield next(iter(readers.values())).problem(text)
        return
    ever = {fluent for (fluent,) in unsorted_rows(grounder.control, *EVER)}
    may_be_true = _unknown(facts, statements) if reach is None else lambda each: (each, "true") in reach.values
    named: set[str] = set()
    for fluent in facts.fluents:
        reader = readers.get(fluent.name) or readers.get("")
        if reader and may_be_true(fluent) and fluent not in ever and fluent.name not in named:
            named.add(fluent.name)
            yield _problem(fluent, facts, reader, reach.setters if reach else {})


def _unknown(facts: Facts, statements: Sequence[Statement]) -> Callable[[clingo.Symbol], bool]:
    """Return a test of whether the initial state, an action or a user rule may make a fluent true."""
    false = {fluent for fluent, value in facts.initially if value == "false"}
    set_by_actions = {
        fluent for values in facts.postconditions.values() for fluent, value in values if value != "false"
    }
    heads = [atom for each in statements if each.own for atom in each.heads if atom.signature in STATE_PREDICATES]
    set_by_rules = {atom.arguments[0].partition("(")[0] for atom in heads if atom.arguments[1] != "false"}
    any_name = not set_by_rules <= {fluent.name for fluent in facts.fluents}  # a variable, a pool or a constant
    return lambda fluent: fluent not in false or fluent in set_by_actions or any_name or fluent.name in set_by_rules


def needless_problems(grounder: Grounder, facts: Facts, statements: Sequence[Statement]) -> Iterator[Problem]:
    """Yield a warning for each rule that uses ``ever`` to require a fluent that its action does not require."""
    asking = [
        each
        for each in statements
        if each.own and each.is_rule and not each.conditions
        if [atom.signature for atom in each.heads] == [ACTION] and any(_ever_queries(each))
    ]
    stated: set[tuple[str, str]] = set()  # each action with the fluents that a rule requires for all instances of it
    for rule in statements if asking else ():
        body = [text for _, text in rule.literals]
        for head in rule.heads if rule.own else ():
            if head.signature == PRECONDITION and head.arguments[2] == "true":
                subject, text, _ = head.arguments
                pool = text[1:-1].split(";") if text[0] == "(" else [text]
                stated.update((subject, each) for each in pool if body == [f"action({subject})"])
    rules = [
        f"{ASKS}({number},{action},{fluent}) :- {', '.join(text for _, text in rule.literals)}."
        for number, rule in enumerate(asking)
        for action in rule.heads[0].arguments
        for fluent in _ever_queries(rule)
        if (action, fluent) not in stated
    ]
    if not rules:
        return
    grounder.add(ASKS, rules)
    grounder.ground([(ASKS, [])])
    graph = invariant_graph(facts)
    warned: set[int] = set()
    for number, action, fluent in unsorted_rows(grounder.control, ASKS, 3):
        needed = entailed(((each, value == "true") for each, value in facts.preconditions.get(action, ())), graph)
        if number.number not in warned and (fluent, True) not in needed:
            warned.add(number.number)
            problem = f"{action} is derived only if {fluent} may be true at some time, but does not require it"
            advice = f"state precondition({action},{fluent},true), or leave ever({fluent}) out"
            yield asking[number.number].problem(f"{problem}, so plans may be missing; {advice}", name="asks-more")


def _ever_queries(rule: Statement) -> Iterator[str]:
    """Yield the fluents that a rule reads with ``ever``."""
    for node, text in rule.literals:
        atom = plain_atom(node, text)
        if atom and not atom.negated and atom.signature == EVER:
            yield atom.arguments[0]


def _problem(
    fluent: clingo.Symbol, facts: Facts, reader: Statement, setters: Mapping[tuple[clingo.Symbol, str], FluentSetter]
) -> Problem:
    """Report a fluent that is not stated, at the user rule that sets it or at the rule that reads it."""
    made_by = setters.get((fluent, "true"))
    if made_by is not None:
        effect = f"leaves open whether {fluent} is" if made_by.head.signature == CHANGED else f"may make {fluent}"
        text = f"this rule {effect} true, but ever does not say so, and {MISSING}"
        return made_by.rule.problem(f"{text}; state ever({fluent})")
    reason = "it may be so at some step"
    if (fluent, "false") not in facts.initially:
        reason = "it is not false at the start"
    else:
        for action, values in facts.postconditions.items():
            if any(changed == fluent and value != "false" for changed, value in values):
                reason = f"{action} may make it so"
                break
    text = f"ever does not say that {fluent} may be true, but {reason}, and {MISSING}"
    return reader.problem(f'{text}; state it, or add #include "rules/ever.lp".')
