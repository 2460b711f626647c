"""The stages of the linter, in the order in which one makes sense of the next."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from pathlib import Path

from clingo.ast import ASTType

from prag_asp.errors import DomainError
from prag_asp.lint.composites import composite_problems
from prag_asp.lint.directives import directive_problems, placement_problems
from prag_asp.lint.effects import effect_problems, limit_problems
from prag_asp.lint.execution import execution_problems
from prag_asp.lint.hierarchy import choice_problems, hierarchy_problems, term_problems
from prag_asp.lint.occurrence import occurrence_problems, state_problems
from prag_asp.lint.open_world import open_world_problems
from prag_asp.lint.origin import Origins
from prag_asp.lint.recursion import recursion_problems
from prag_asp.lint.table import name_problems, table_problems
from prag_asp.lint.vocabulary import vocabulary_problems
from prag_asp.program.facts import Facts, read_facts
from prag_asp.program.grounding import Grounder
from prag_asp.program.parse import parse_sources
from prag_asp.program.problem import Problem, raise_problems
from prag_asp.program.settings import Settings, read_table, settings_of
from prag_asp.program.sources import CONTRACT, HIERARCHY, Program, Source
from prag_asp.program.syntax import Statement

STEP_PART = re.compile(r"(#program\s+)(step|check)\b")


LEARNED_INVARIANT = ("impossible", 2)
"""What a file of learned invariants may state."""


def check(program: Program, path: Path) -> tuple[Facts, Settings]:
    """Return what a domain states and its settings, those of the file `path`, if nothing is wrong with them.

    Raises:
        DomainError: something is wrong; the message has one line for each problem.
    """
    owned = _owned(program)
    statements, problems = parse_sources(owned)
    table = read_table(path)
    settings = settings_of(table, path)
    raise_problems([*problems, *table_problems(table, settings)])
    raise_problems(directive_problems(statements))
    raise_problems([*vocabulary_problems(statements), *placement_problems(statements), *recursion_problems(statements)])
    plain = _one_free_step(program, owned)
    grounder = Grounder(plain)
    grounder.ground([("base", [])])
    origins = Origins([each for each in statements if each.own or each.path.name != HIERARCHY])
    facts = _facts(grounder, origins)
    _check_facts(grounder, facts, statements, origins)
    raise_problems(execution_problems(plain, grounder.control, facts, statements, origins))
    raise_problems(name_problems(settings, facts))
    return facts, settings


def check_learned(program: Program, learned: Sequence[Source]) -> Facts:
    """Return what a domain that has passed every check states together with `learned`, which `program` includes.

    Raises:
        DomainError: the learned sources state something other than invariants of declared fluents.
    """
    owned = _owned(program)
    statements, problems = parse_sources(owned)
    raise_problems(problems)
    paths = {source.path for source in learned}
    raise_problems(
        each.problem("only impossible(F,G) may be stated here; write other rules into domain.lp")
        for each in statements
        if each.path in paths and not _states_invariant(each)
    )
    raise_problems([*directive_problems(statements), *vocabulary_problems(statements)])
    grounder = Grounder(_one_free_step(program, owned))
    grounder.ground([("base", [])])
    origins = Origins([each for each in statements if each.own or each.path.name != HIERARCHY])
    facts = _facts(grounder, origins)
    raise_problems(effect_problems(grounder.control, facts, origins))
    return facts


def _states_invariant(statement: Statement) -> bool:
    """Tell whether a statement is a rule for an invariant; in a part that may not be begun, what follows passes."""
    if statement.kind == ASTType.Program:
        return statement.part == "base"
    heads = [atom.signature for atom in statement.heads]
    plain = statement.is_rule and statement.node.head.ast_type == ASTType.Literal
    return statement.part != "base" or (plain and heads == [LEARNED_INVARIANT])


def _owned(program: Program) -> list[tuple[Source, bool]]:
    """Return the files of a program, each with whether it is the domain's own."""
    encodings = _encodings_folder(program)
    return [(source, source.path.parent not in (encodings, encodings / "rules")) for source in program.sources]


def _facts(grounder: Grounder, origins: Origins) -> Facts:
    try:
        return read_facts(grounder.control)
    except DomainError:
        raise_problems(choice_problems(grounder.control, origins))
        raise


def _check_facts(grounder: Grounder, facts: Facts, statements: Sequence[Statement], origins: Origins) -> None:
    raise_problems(term_problems(facts, origins))
    raise_problems(hierarchy_problems(grounder.control, origins))
    raise_problems(effect_problems(grounder.control, facts, origins))
    raise_problems(composite_problems(facts, origins))
    raise_problems(limit_problems(grounder.control, facts, statements, origins))
    raise_problems(state_problems(facts, origins))
    if grounder.control.is_conflicting:
        raise_problems(_violations(origins))
    raise_problems(open_world_problems(grounder, facts, statements))
    raise_problems(occurrence_problems(grounder, facts, statements, origins))


def _encodings_folder(program: Program) -> Path:
    """Return the folder of the encodings: they begin every program."""
    contract = (source.path.parent for source in program.sources if source.path.name == CONTRACT)
    return next(contract, program.sources[0].path.parent)


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


def _violations(origins: Origins) -> Iterator[Problem]:
    for statement in origins.violated():
        yield statement.problem(
            "what the base part states violates this constraint, so there is no plan; mend one of them"
        )
