"""What may ever be true, as a domain says it with ``ever``: where it says too little, actions that ask are missing.

What may be true by relaxed reachability is stated, if it is asked for: then no step comes first at which an action
occurs that is not made, for the steps before it are those of actions that are.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence

import clingo
from clingo.ast import ASTType

from prag_asp.lint.occurrence import CHANGED
from prag_asp.lint.reaching.reachability import Reached
from prag_asp.lint.reaching.relaxed import Maker
from prag_asp.program.facts import Facts, unsorted_rows
from prag_asp.program.grounding import Grounder
from prag_asp.program.problem import Problem
from prag_asp.program.syntax import AtomNode, Statement

EVER = ("ever", 1)

MISSING = "actions that ask for it would be missing"


def ever_problems(
    grounder: Grounder, facts: Facts, statements: Sequence[Statement], reached: Reached | None
) -> Iterator[Problem]:
    """Yield the first fluent of each name that may be true at some time, is asked for by ``ever``, and is not stated.

    Where it is not known what may be `reached`, everything may be.
    """
    fluents = {fluent.name for fluent in facts.fluents}
    readers: dict[str, Statement] = {}
    for each in statements:
        for atom in each.body if each.own else ():
            if atom.signature == EVER:
                readers.setdefault(_name(atom, fluents), each)
    if not readers:
        return
    if not any(map(_states, statements)):
        told = 'ever is read, but nothing states it; add #include "rules/ever.lp".'
        yield next(iter(readers.values())).problem(told)
        return
    ever = {fluent for (fluent,) in unsorted_rows(grounder.control, *EVER)}
    told_of: set[str] = set()
    for fluent in facts.fluents:
        reader = readers.get(fluent.name) or readers.get("")
        true = reached is None or (fluent, "true") in reached.values
        if reader and true and fluent not in ever and fluent.name not in told_of:
            told_of.add(fluent.name)
            yield _problem(fluent, facts, reader, reached.setters if reached else {})


def _name(atom: AtomNode, fluents: Collection[str]) -> str:
    """Return which name of the `fluents` an atom asks for; nothing where it may be any, as of a constant."""
    name = atom.arguments[0].partition("(")[0]
    return name if name in fluents else ""


def _states(statement: Statement) -> bool:
    """Return whether a statement says what may ever be true, or that nothing may."""
    if statement.own and statement.kind == ASTType.Defined:
        return (statement.node.name, statement.node.arity) == EVER
    return any(atom.signature == EVER for atom in statement.heads)


def _problem(
    fluent: clingo.Symbol, facts: Facts, reader: Statement, setters: Mapping[tuple[clingo.Symbol, str], Maker]
) -> Problem:
    """Return what is told of a fluent that is not stated: by the own rule that makes it so, or by who asks for it."""
    made_by = setters.get((fluent, "true"))
    if made_by is not None:
        made = f"leaves open whether {fluent} is" if made_by.head.signature == CHANGED else f"may make {fluent}"
        told = f"this rule {made} true, but ever does not say so, and {MISSING}"
        return made_by.rule.problem(f"{told}; state ever({fluent})")
    reason = "it may be so at some step"
    if (fluent, "false") not in facts.initially:
        reason = "it is not false at the start"
    else:
        for action, values in facts.postconditions.items():
            if any(changed == fluent and value != "false" for changed, value in values):
                reason = f"{action} may make it so"
                break
    told = f"ever does not say that {fluent} may be true, but {reason}, and {MISSING}"
    return reader.problem(f'{told}; state it, or add #include "rules/ever.lp".')
