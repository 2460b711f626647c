"""The check of a domain in stages, each of which relies on the previous ones, with pruning in between."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import clingo
from clingo.ast import ASTType

from prag_asp.errors import DomainError
from prag_asp.lint.allowed_warnings import Allowed, allowance_problems, allowed_names, not_allowed
from prag_asp.lint.composites import composite_problems
from prag_asp.lint.directives import (
    directive_problems,
    last_step_problems,
    placement_problems,
    recursion_problems,
    size_problems,
)
from prag_asp.lint.effects import action_problems, effect_problems, limit_problems
from prag_asp.lint.ever import ever_problems, needless_problems
from prag_asp.lint.hierarchy import choice_problems, hierarchy_problems, shared_name_problems, term_problems
from prag_asp.lint.misspellings import vocabulary_problems
from prag_asp.lint.occurrence import (
    action_rejections,
    composite_rejections,
    goal_problems,
    state_problems,
    unreachable_problems,
)
from prag_asp.lint.open_world import open_world_problems
from prag_asp.lint.other_encodings import edited_encodings, encoding_problems
from prag_asp.lint.rule_origin import Origins
from prag_asp.lint.settings_checks import name_problems, table_problems
from prag_asp.lint.unsatisfiable_atoms import demand_problems
from prag_asp.processes.progress_events import note, stage
from prag_asp.program.entity_names import mention_facts, name_fact
from prag_asp.program.facts import Facts, read_facts, rows
from prag_asp.program.grounding import Grounder
from prag_asp.program.parse import parse_sources
from prag_asp.program.predicates import EVER, IMPOSSIBLE, MENTIONS, NAME
from prag_asp.program.problem import Problem, raise_problems
from prag_asp.program.settings import Settings, settings_of
from prag_asp.program.sources import ADDED, HIERARCHY, Program, Source, added_encodings, encodings_folder, owned
from prag_asp.program.syntax import Statement
from prag_asp.pruning import Pruning, find_pruning
from prag_asp.pruning.reachability import relaxed_sources
from prag_asp.tables.toml_text import parse_toml

STEP_PART = re.compile(r"(#program\s+)(step|check)\b")

MANY = 250_000
"""The number of fluents or actions above which a note warns the user: preparing this many actions took 48 s and 1.3 GB.
"""


@dataclass(frozen=True)
class Checked:
    """A domain without errors: its pruned facts, its settings and its warnings."""

    facts: Facts
    settings: Settings
    warnings: tuple[Problem, ...]


class _WarningCollector:
    """A collector of the warnings that no comment allows, which raises the errors of each stage."""

    def __init__(self, allowed: Allowed) -> None:
        self._allowed = allowed
        self.warnings: dict[Problem, None] = {}

    def add(self, problems: Iterable[Problem]) -> None:
        """Add the problems of a stage.

        Raises:
            DomainError: some of the problems are errors.
        """
        stage("checking the domain")
        new_problems = list(problems)
        raise_problems(each for each in new_problems if not each.is_warning)
        self.warnings |= dict.fromkeys(not_allowed(new_problems, self._allowed))


def check(
    program: Program, settings_source: Source, like: Mapping[clingo.Symbol, clingo.Symbol] | None = None
) -> Checked:
    """Return the facts of a domain without actions that can never occur, its settings and its warnings.

    `like` maps entities that are not ground to ground representatives; settings may refer to both.

    Raises:
        DomainError: the domain has errors; the message contains one line for each problem.
    """
    sources = owned(program)
    statements, problems = parse_sources(sources)
    table = parse_toml(settings_source.path, settings_source.text)
    settings = settings_of(table, settings_source)
    allowed = allowed_names((source for source, own in sources if own), settings)
    warnings = _WarningCollector(allowed)
    warnings.add([*problems, *table_problems(table, settings), *allowance_problems(allowed)])
    warnings.add([*directive_problems(statements), *size_problems(statements)])
    warnings.add([*vocabulary_problems(statements), *placement_problems(statements), *recursion_problems(statements)])
    warnings.add(last_step_problems(statements))
    step = _described(_one_free_step(sources), statements)
    encodings = encodings_folder(program)
    relaxed = relaxed_sources(encodings) if encodings else ()
    grounder = Grounder(Program((*step.sources, *relaxed)))
    grounder.ground([("base", [])])
    warnings.add(demand_problems(grounder.control, statements))
    origins = Origins([each for each in statements if each.own or each.path.name != HIERARCHY])
    facts = _facts(grounder, statements, origins)
    _note_size(facts, statements)
    _check_facts(warnings, grounder, facts, statements, origins)
    edited = edited_encodings(program, statements)
    warnings.add(encoding_problems(edited))
    added = added_encodings(program)  # additions to a copy of the encodings count as user rules
    user_statements = [replace(each, own=True) if each.path in added else each for each in statements]
    if edited:
        pruning = Pruning.none(facts)
    else:
        pruning = find_pruning(step, grounder, facts, user_statements, encodings if relaxed else None)
    warnings.add(action_rejections(pruning.actions, facts, origins))
    warnings.add(goal_problems(pruning.actions, facts, origins))
    if pruning.composites:
        warnings.add(composite_rejections(pruning.composites, facts, origins))
    warnings.add(open_world_problems(program, grounder, pruning.facts, statements))
    warnings.add([*shared_name_problems(facts, origins), *name_problems(settings, with_entities(facts, like or {}))])
    warnings.add(ever_problems(grounder, pruning.facts, statements, pruning.reach))
    warnings.add(needless_problems(grounder, pruning.facts, statements))
    if not any(each.name == "no-plan" for each in warnings.warnings):
        warnings.add(unreachable_problems(pruning.unreachable, origins))
    path = settings_source.path
    ordered = sorted(warnings.warnings, key=lambda each: (each.path != path, str(each.path), each.line))
    return Checked(pruning.facts, settings, tuple(ordered))


def _note_size(facts: Facts, statements: Sequence[Statement]) -> None:
    """Warn the user if there are so many fluents or actions that preparing them takes long."""
    for predicate, terms in (("fluent", facts.fluents), ("action", facts.actions)):
        declaring = [each for each in statements if any(atom.signature == (predicate, 1) for atom in each.heads)]
        if len(terms) > MANY and declaring:
            rule = max(declaring, key=lambda each: each.own)
            more = f"has {len(terms):,} {predicate}s; the preparation of {MANY:,} actions takes a minute and 1.3 GB"
            note(f"note: {rule.path}:{rule.line}: the domain {more}: declare fewer, or set --time and --memory")


def _check_facts(
    warnings: _WarningCollector, grounder: Grounder, facts: Facts, statements: Sequence[Statement], origins: Origins
) -> None:
    """Check the facts of the base part."""
    warnings.add(term_problems(facts, origins))
    warnings.add(hierarchy_problems(grounder.control, origins))
    warnings.add([*action_problems(facts, statements, origins), *effect_problems(grounder.control, facts, origins)])
    warnings.add(composite_problems(facts, origins))
    warnings.add(limit_problems(grounder.control, facts, statements, origins))
    warnings.add(state_problems(facts, origins))
    if grounder.control.is_conflicting:
        text = "the facts of the base part violate this constraint, so there is no plan; change one of them"
        warnings.add(statement.problem(text) for statement in origins.violated())


def with_entities(facts: Facts, like: Mapping[clingo.Symbol, clingo.Symbol]) -> Facts:
    """Return facts with the entities in `like`, each with the classes of its declared representative."""
    if not like:
        return facts
    above: dict[clingo.Symbol, list[clingo.Symbol]] = {}
    for entity, name in facts.memberships:
        above.setdefault(entity, []).append(name)
    more = {(entity, name) for entity, representative in like.items() for name in above[representative]}
    entities = {**facts.entities, **{entity: facts.entities[representative] for entity, representative in like.items()}}
    return replace(facts, entities=dict(sorted(entities.items())), memberships=facts.memberships | more)


def check_learned(program: Program, learned: Sequence[Source]) -> Facts:
    """Return the facts of a domain with learned invariants; without `learned`, `program` has passed every check.

    Raises:
        DomainError: the learned sources state something other than invariants of declared fluents.
    """
    sources = owned(program)
    statements, problems = parse_sources(sources)
    raise_problems(problems)
    paths = {source.path for source in learned}
    raise_problems(
        each.problem("only impossible(F,G) may be stated in this file; move other rules to domain.lp")
        for each in statements
        if each.path in paths and not _states_invariant(each)
    )
    raise_problems([*directive_problems(statements), *vocabulary_problems(statements)])
    grounder = Grounder(_described(_one_free_step(sources), statements))
    grounder.ground([("base", [])])
    origins = Origins([each for each in statements if each.own or each.path.name != HIERARCHY])
    facts = _facts(grounder, statements, origins)
    raise_problems(each for each in demand_problems(grounder.control, statements) if not each.is_warning)
    raise_problems(effect_problems(grounder.control, facts, origins))
    return facts


def _states_invariant(statement: Statement) -> bool:
    """Return whether a statement states an invariant or belongs to a program part that is refused anyway."""
    if statement.kind == ASTType.Program:
        return statement.part == "base"
    heads = [atom.signature for atom in statement.heads]
    plain = statement.is_rule and statement.node.head.ast_type == ASTType.Literal
    return statement.part != "base" or (plain and heads == [IMPOSSIBLE])


def _facts(grounder: Grounder, statements: Sequence[Statement], origins: Origins) -> Facts:
    try:
        rows(grounder.control, *EVER)
        return read_facts(grounder.control)
    except DomainError:
        raise_problems(choice_problems(grounder.control, statements, origins))
        raise


def _one_free_step(owned: Sequence[tuple[Source, bool]]) -> Program:
    """Return the program without the hierarchy, and with the author's step rules in parts that are not grounded.

    Line numbers do not change.
    """
    return Program(
        tuple(
            Source(source.path, STEP_PART.sub(r"\1own_\2", source.text) if own else source.text)
            for source, own in owned
            if source.path.name != HIERARCHY or own
        )
    )


def _described(program: Program, statements: Sequence[Statement]) -> Program:
    """Return a program with the names and entities of its actions as facts if the author's base part reads them."""
    names_read = {atom.name for each in statements if not each.timed for atom in each.body}
    if names_read.isdisjoint([NAME.name, MENTIONS.name]):
        return program
    grounder = Grounder(program)
    grounder.ground([("base", [])])
    actions = [action for (action,) in rows(grounder.control, "action", 1)]
    entities = {entity for entity, _ in rows(grounder.control, "entity", 2)}
    facts = [*map(name_fact, actions), *mention_facts(actions, entities)]
    return Program((*program.sources, Source(ADDED, " ".join(facts))))
