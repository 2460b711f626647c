"""The stages of the linter, in the order in which one makes sense of the next."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import clingo
from clingo.ast import ASTType

from prag_asp.errors import DomainError
from prag_asp.lint.composites import composite_problems
from prag_asp.lint.directives import directive_problems, placement_problems
from prag_asp.lint.effects import action_problems, effect_problems, limit_problems
from prag_asp.lint.execution import execution_problems, find_execution
from prag_asp.lint.hierarchy import choice_problems, hierarchy_problems, shared_name_problems, term_problems
from prag_asp.lint.misspellings import vocabulary_problems
from prag_asp.lint.occurrence import find_occurrence, goal_problems, occurrence_problems, state_problems
from prag_asp.lint.open_world import open_world_problems
from prag_asp.lint.reaching.ever import EVER, ever_problems, needless_problems
from prag_asp.lint.reaching.reachability import (
    LEFT_OUT,
    find_reached,
    find_unreached,
    relaxed_sources,
    steady_values,
    unreached_problems,
)
from prag_asp.lint.rule_origin import Origins
from prag_asp.lint.settings_checks import name_problems, table_problems
from prag_asp.lint.size_checks import recursion_problems, size_problems
from prag_asp.lint.unsatisfiable_atoms import demand_problems
from prag_asp.processes.progress_events import stage
from prag_asp.program.entity_names import MENTIONS, NAME, mention_facts, name_fact
from prag_asp.program.facts import Facts, read_facts, rows, without
from prag_asp.program.grounding import Grounder
from prag_asp.program.lint_comments import Allowed, allowance_problems, allowed_names, not_allowed
from prag_asp.program.parse import parse_sources
from prag_asp.program.problem import Problem, raise_problems
from prag_asp.program.settings import Settings, settings_of
from prag_asp.program.sources import ADDED, HIERARCHY, Program, Source, added_encodings, encodings_folder, owned
from prag_asp.program.syntax import Statement
from prag_asp.tables.toml_text import parse_toml

STEP_PART = re.compile(r"(#program\s+)(step|check)\b")

LEARNED_INVARIANT = ("impossible", 2)
"""What a file of learned invariants may state."""


@dataclass(frozen=True)
class Checked:
    """A domain that means something: what it states of what can occur, its settings, and what is strange about it."""

    facts: Facts
    settings: Settings
    warnings: tuple[Problem, ...]


class _Judge:
    """Raises errors as they are found, and keeps the warnings that no comment allows."""

    def __init__(self, allowed: Allowed) -> None:
        self._allowed = allowed
        self.warnings: dict[Problem, None] = {}

    def take(self, problems: Iterable[Problem]) -> None:
        """Take what a stage has found.

        Raises:
            DomainError: some of it are errors.
        """
        stage("checking the domain")
        found = list(problems)
        raise_problems(each for each in found if not each.is_warning)
        self.warnings |= dict.fromkeys(not_allowed(found, self._allowed))


def check(program: Program, given: Source, like: Mapping[clingo.Symbol, clingo.Symbol] | None = None) -> Checked:
    """Return what a domain states, its settings, those `given` as a file, and its warnings.

    `like` are entities that are not ground, each with a ground one that is like it: settings may name them.

    Raises:
        DomainError: something is wrong; the message has one line for each problem.
    """
    sources = owned(program)
    statements, problems = parse_sources(sources)
    table = parse_toml(given.path, given.text)
    settings = settings_of(table, given)
    allowed = allowed_names((source for source, own in sources if own), settings)
    judge = _Judge(allowed)
    judge.take([*problems, *table_problems(table, settings), *allowance_problems(allowed)])
    judge.take([*directive_problems(statements), *size_problems(statements)])
    judge.take([*vocabulary_problems(statements), *placement_problems(statements), *recursion_problems(statements)])
    plain = _described(_one_free_step(program, sources), statements)
    encodings = encodings_folder(program)
    relaxed = relaxed_sources(encodings) if encodings else ()
    grounder = Grounder(Program((*plain.sources, *relaxed)))
    grounder.ground([("base", [])])
    judge.take(demand_problems(grounder.control, statements))
    origins = Origins([each for each in statements if each.own or each.path.name != HIERARCHY])
    facts = _facts(grounder, statements, origins)
    _check_facts(judge, grounder, facts, statements, origins)
    added = added_encodings(program)
    told = [replace(each, own=True) if each.path in added else each for each in statements]
    left = _check_steps(judge, plain, grounder, facts, told, origins)
    judge.take(open_world_problems(grounder, left, statements))
    judge.take([*shared_name_problems(facts, origins), *name_problems(settings, with_entities(facts, like or {}))])
    if encodings and relaxed and _can_leave_out(statements):
        reached = find_reached(grounder, left, told, encodings)
        judge.take(ever_problems(grounder, left, statements, reached))
        judge.take(needless_problems(grounder, left, statements))
        if reached is not None:
            unreached = find_unreached(reached, left)
            left = replace(left, unreached=unreached.actions, steady=steady_values(reached, left))
            if not any(each.name == "no-plan" for each in judge.warnings):
                judge.take(unreached_problems(unreached, origins))
    ordered = sorted(judge.warnings, key=lambda each: (each.path != given.path, str(each.path), each.line))
    return Checked(left, settings, tuple(ordered))


def with_entities(facts: Facts, like: Mapping[clingo.Symbol, clingo.Symbol]) -> Facts:
    """Return facts with entities that are like some of them."""
    if not like:
        return facts
    above: dict[clingo.Symbol, list[clingo.Symbol]] = {}
    for entity, name in facts.memberships:
        above.setdefault(entity, []).append(name)
    more = {(entity, name) for entity, known in like.items() for name in above[known]}
    entities = {**facts.entities, **{entity: facts.entities[known] for entity, known in like.items()}}
    return replace(facts, entities=dict(sorted(entities.items())), memberships=facts.memberships | more)


def check_learned(program: Program, learned: Sequence[Source]) -> Facts:
    """Return what a domain that has passed every check states together with `learned`, which `program` includes.

    Raises:
        DomainError: the learned sources state something other than invariants of declared fluents.
    """
    sources = owned(program)
    statements, problems = parse_sources(sources)
    raise_problems(problems)
    paths = {source.path for source in learned}
    raise_problems(
        each.problem("only impossible(F,G) may be stated here; write other rules into domain.lp")
        for each in statements
        if each.path in paths and not _states_invariant(each)
    )
    raise_problems([*directive_problems(statements), *vocabulary_problems(statements)])
    grounder = Grounder(_described(_one_free_step(program, sources), statements))
    grounder.ground([("base", [])])
    origins = Origins([each for each in statements if each.own or each.path.name != HIERARCHY])
    facts = _facts(grounder, statements, origins)
    raise_problems(each for each in demand_problems(grounder.control, statements) if not each.is_warning)
    raise_problems(effect_problems(grounder.control, facts, origins))
    return facts


def _states_invariant(statement: Statement) -> bool:
    """Tell whether a statement is a rule for an invariant; in a part that may not be begun, what follows passes."""
    if statement.kind == ASTType.Program:
        return statement.part == "base"
    heads = [atom.signature for atom in statement.heads]
    plain = statement.is_rule and statement.node.head.ast_type == ASTType.Literal
    return statement.part != "base" or (plain and heads == [LEARNED_INVARIANT])


def _facts(grounder: Grounder, statements: Sequence[Statement], origins: Origins) -> Facts:
    try:
        rows(grounder.control, *EVER)
        return read_facts(grounder.control)
    except DomainError:
        raise_problems(choice_problems(grounder.control, statements, origins))
        raise


def _check_facts(
    judge: _Judge, grounder: Grounder, facts: Facts, statements: Sequence[Statement], origins: Origins
) -> None:
    """Check what the base part states."""
    judge.take(term_problems(facts, origins))
    judge.take(hierarchy_problems(grounder.control, origins))
    judge.take([*action_problems(facts, statements, origins), *effect_problems(grounder.control, facts, origins)])
    judge.take(composite_problems(facts, origins))
    judge.take(limit_problems(grounder.control, facts, statements, origins))
    judge.take(state_problems(facts, origins))
    if grounder.control.is_conflicting:
        judge.take(_violations(origins))


def _check_steps(
    judge: _Judge, plain: Program, grounder: Grounder, facts: Facts, statements: Sequence[Statement], origins: Origins
) -> Facts:
    """Check what can occur, and return what the domain states of that."""
    occurrence = find_occurrence(plain, grounder.control, facts, statements)
    judge.take(occurrence_problems(occurrence, facts, origins))
    left_out = set(occurrence.rejected)
    judge.take(goal_problems(occurrence, facts, origins))
    if facts.composites:
        execution = find_execution(plain, facts, occurrence, statements)
        judge.take(execution_problems(execution, facts, origins))
        left_out |= execution.never
    return without(facts, left_out) if _can_leave_out(statements) else facts


def _can_leave_out(statements: Sequence[Statement]) -> bool:
    """Return whether the encodings in use read what is left out: copies of older ones do not."""
    return any(atom.signature == LEFT_OUT for each in statements if not each.own for atom in each.body)


def _one_free_step(program: Program, owned: Sequence[tuple[Source, bool]]) -> Program:
    """Return the program without the hierarchy, and with the step rules of the domain in parts of their own.

    Each line stays where it was.
    """
    return Program(
        tuple(
            Source(source.path, STEP_PART.sub(r"\1own_\2", source.text) if own else source.text)
            for source, own in owned
            if source.path.name != HIERARCHY or own
        )
    )


def _described(program: Program, statements: Sequence[Statement]) -> Program:
    """Return a program with what the library states of its actions, where own rules read that before any step."""
    read = {atom.name for each in statements if each.own and not each.timed for atom in each.body}
    if not any(map(NAME.fullmatch, read)) and not any(map(MENTIONS.fullmatch, read)):
        return program
    grounder = Grounder(program)
    grounder.ground([("base", [])])
    actions = [action for (action,) in rows(grounder.control, "action", 1)]
    entities = {entity for entity, _ in rows(grounder.control, "entity", 2)}
    told = [*map(name_fact, actions), *mention_facts(actions, entities)]
    return Program((*program.sources, Source(ADDED, " ".join(told))))


def _violations(origins: Origins) -> Iterator[Problem]:
    for statement in origins.violated():
        yield statement.problem(
            "what the base part states violates this constraint, so there is no plan; mend one of them"
        )
