"""The fluents that a user rule of a step may change without giving them a value.

They are unknown after such a step, like a fluent with the postcondition `unknown`. A step is grounded once, for any
state that satisfies the invariants, and a solver searches for a step that leaves a known fluent without a value. The
hypotheses are that a fluent is known in every state, and that a user predicate carried from step to step is true of
given terms in every state. Hypotheses that a step may break are dropped until the rest is inductive (Flanagan and Leino
2001).
"""

from __future__ import annotations

from collections.abc import Collection, Sequence

import clingo

from prag_asp.errors import DomainError
from prag_asp.program.atom_arrays import ground_atoms
from prag_asp.program.entity_names import mention_facts, name_fact
from prag_asp.program.facts import Facts
from prag_asp.program.grounding import Grounder
from prag_asp.program.predicates import CHANGED, HOLDS, OCCURS, PRUNED
from prag_asp.program.sources import ADDED, HIERARCHY, Program, Source, owned
from prag_asp.program.syntax import AtomNode, Signature, Statement
from prag_asp.pruning.rejected_actions import STEP
from prag_asp.pruning.relaxed_rules import BOOLEAN, renamed_literals

MOST_STEPS = 512
"""The number of steps above which a carried predicate counts as unbounded, in which case no hypothesis is tested."""

BEFORE = STEP - 1
STATES = f"""
{{ holds(F,true,{BEFORE}); holds(F,false,{BEFORE}) }} 1 :- fluent(F).
{{ occurs(A,{BEFORE}) : action(A), not _pruned(A) }} 1.
:- exclusive(F,G), holds(F,true,{BEFORE}), holds(G,true,{BEFORE}).
:- impossible(F,G), holds(F,true,{BEFORE}), holds(G,true,{BEFORE}).
:- implies(F,G), holds(F,true,{BEFORE}), holds(G,false,{BEFORE}).
#external _supposed(F) : fluent(F).
:- _supposed(F), fluent(F), not holds(F,true,{BEFORE}), not holds(F,false,{BEFORE}).
"""
"""The rules for the states before a step, in which some fluents are known and satisfy the invariants."""

BROKEN = f"_broken(F) :- fluent(F), changed(F,{STEP}), not holds(F,true,{STEP}), not holds(F,false,{STEP})."
"""The rule for a step that leaves a fluent without a value."""


def unset_fluents(
    program: Program, facts: Facts, statements: Sequence[Statement], unsure: Collection[clingo.Symbol]
) -> dict[clingo.Symbol, Statement]:
    """Return the fluents that may become unknown, each with the rule responsible, except those in `unsure`."""
    steps = [each for each in statements if each.own and each.is_rule and each.part == "step"]
    heads = ((each, atom) for each in steps for atom in each.heads if atom.signature == CHANGED and not atom.negated)
    changing = [(each, atom) for each, atom in heads if not _is_set(each, atom, steps)]
    if not changing:
        return {}
    try:
        fluents = _found_unset(_step_program(program, facts), facts, _carried(statements, steps), unsure)
    except DomainError:  # engines that unroll the steps handle such a step
        fluents = [fluent for fluent in facts.fluents if fluent not in unsure]
    blamed: dict[clingo.Symbol, Statement] = {}
    for fluent in fluents:
        rules = (rule for rule, atom in changing if _may_name(atom.arguments[0], fluent))
        rule = next(rules, None)
        if rule is not None:
            blamed[fluent] = rule
    return blamed


def _is_set(rule: Statement, head: AtomNode, steps: Sequence[Statement]) -> bool:
    """Return whether, whenever a rule changes a fluent, another rule gives the fluent a value."""
    fluent, literals = renamed_literals(head.arguments[0], rule)
    setting = (
        renamed_literals(atom.arguments[0], each)
        for each in steps
        if each.parameters == rule.parameters and len(each.heads) == 1 and not each.conditions
        for atom in each.heads
        if atom.signature == HOLDS and atom.arguments[1] in BOOLEAN
    )
    return any(term == fluent and texts <= literals for term, texts in setting)


def _may_name(term: str, fluent: clingo.Symbol) -> bool:
    """Return whether the text of a term may denote a fluent."""
    name = term.partition("(")[0]
    return not name[:1].islower() or name == fluent.name or ";" in term


def _carried(statements: Sequence[Statement], steps: Sequence[Statement]) -> list[Signature]:
    """Return the predicates, other than states and actions, that user rules read at the previous step."""
    timed = {atom.signature for each in statements if each.timed for atom in each.heads}
    read = {
        atom.signature
        for each in steps
        for atom in each.body
        if atom.arguments and atom.arguments[-1] == f"({each.parameters[0]}-1)"
    }
    return sorted(read & timed - {HOLDS, OCCURS})


def _step_program(program: Program, facts: Facts) -> Program:
    """Return a program without its hierarchy, with the facts that the library adds."""
    sources = [source for source, own in owned(program) if own or source.path.name != HIERARCHY]
    added = [PRUNED.fact(term) for term in (*facts.pruned, *facts.unreachable)]
    added += [*map(name_fact, facts.declared_actions), *mention_facts(facts.declared_actions, facts.entities)]
    return Program((*sources, Source(ADDED, " ".join(added))))


def _found_unset(
    program: Program, facts: Facts, carried: Sequence[Signature], unsure: Collection[clingo.Symbol]
) -> list[clingo.Symbol]:
    """Return the fluents that are not known in every state, found by dropping hypotheses that a step breaks."""
    atoms = _carried_atoms(program, carried) if carried else set[clingo.Symbol]()
    if atoms is None:
        return [fluent for fluent in facts.fluents if fluent not in unsure]
    grounder = Grounder(program, strict=False)
    control = grounder.control
    grounder.ground([("base", [])])
    begun = {each for each in carried if any(time == clingo.Number(0) for *_, time in _rows(grounder, each))}
    rules = [
        STATES,
        *(f"{{ {clingo.Function(each.name, [*each.arguments, clingo.Number(BEFORE)])} }}." for each in atoms),
    ]
    tests = [BROKEN]
    for number, (name, arity) in enumerate(carried):
        terms = ",".join(f"X{place}" for place in range(arity - 1))
        some = f"{name}({terms + ',' if terms else ''}{{}})"
        rules.append(f"#external _supposed({number}).")
        rules.append(f":- _supposed({number}), {{ {some.format(BEFORE)} }} 0.")
        tests.append(f"_broken({number}) :- {{ {some.format(STEP)} }} 0.")
    grounder.add("_states", rules)
    grounder.add("_tests", tests)
    grounder.ground([("_states", []), ("step", [clingo.Number(STEP)]), ("_tests", [])])
    supposed = {fluent for fluent in facts.fluents if fluent not in unsure}
    supposed |= {clingo.Number(number) for number, each in enumerate(carried) if each in begun}
    for term in supposed:
        control.assign_external(clingo.Function("_supposed", [term]), True)
    broken = {term: literal for (term,), literal, _ in ground_atoms(control, "_broken", 1) if term in supposed}
    dropped: list[clingo.Symbol] = []
    while broken:
        with control.backend() as backend:
            backend.add_rule([], [-literal for literal in broken.values() if literal])
        with control.solve(yield_=True) as handle:
            model = handle.model()
            new = [term for term, literal in broken.items() if model is not None and model.is_true(literal)]
        if not new:
            break
        for term in new:
            control.assign_external(clingo.Function("_supposed", [term]), False)
            del broken[term]
        dropped += new
    return sorted(term for term in dropped if term.type == clingo.SymbolType.Function)


def _carried_atoms(program: Program, carried: Sequence[Signature]) -> set[clingo.Symbol] | None:
    """Return the atoms of given predicates, without their time, that steps may derive, however many there are.

    The result is None if there seem to be infinitely many.
    """
    grounder = Grounder(program, strict=False)
    grounder.add("_states", [STATES])
    grounder.ground([("base", [])])
    stated = {clingo.Function(each[0], row[:-1]) for each in carried for row in _rows(grounder, each)}
    grounder.add(
        "_carried",
        [f"{{ {clingo.Function(each.name, [*each.arguments, clingo.Number(BEFORE)])} }}." for each in stated],
    )
    grounder.ground([("_states", []), ("_carried", [])])
    steps, more = 0, 1
    while True:
        grounder.ground([("step", [clingo.Number(STEP + step)]) for step in range(steps, steps + more)])
        steps += more
        last = clingo.Number(STEP + steps - 1)
        rows = [(each[0], row) for each in carried for row in _rows(grounder, each)]
        sooner = {clingo.Function(name, row[:-1]) for name, row in rows if row[-1] != last}
        now = {clingo.Function(name, row[:-1]) for name, row in rows if row[-1] == last}
        if now <= sooner:
            return sooner | stated
        if steps >= MOST_STEPS:
            return None
        more = steps


def _rows(grounder: Grounder, signature: Signature) -> list[list[clingo.Symbol]]:
    """Return the arguments of the ground atoms of a predicate."""
    return [arguments for arguments, _, _ in ground_atoms(grounder.control, *signature)]
