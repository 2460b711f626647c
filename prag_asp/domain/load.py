"""Read a domain from disk."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import clingo

from prag_asp.errors import SceneError
from prag_asp.lint import check, check_learned
from prag_asp.program.facts import Facts, flattened
from prag_asp.program.paths import data_folder, domain_folder
from prag_asp.program.problem import Problem, first_of_each, raise_problems
from prag_asp.program.rules import rule_sources
from prag_asp.program.settings import Settings
from prag_asp.program.sources import HIERARCHY, Program, Source, core_sources, read_sources
from prag_asp.scene.model import Scene

LEARNED = "learned.lp"
"""The file of invariants that physics has proved; `prag-asp learn` writes it."""


@dataclass(frozen=True)
class Domain:
    """A domain that has passed every check.

    `program` is the whole logic program (the encodings, the domain's own files and the rules asked for), `facts` what
    its base part states. Physics runs the Python files of the domain only where it is `trusted`. `learned` are the
    impossible fluents that only the file of learned invariants states, `warnings` what is strange, but well defined.
    """

    name: str
    folder: Path
    encodings: Path
    program: Program
    facts: Facts
    settings: Settings
    trusted: bool = False
    learned: tuple[tuple[clingo.Symbol, clingo.Symbol], ...] = ()
    warnings: tuple[Problem, ...] = ()


def load_domain(
    name_or_folder: str | Path,
    *,
    rules: tuple[str, ...] = (),
    encodings: str | Path | None = None,
    flat: bool = False,
    trust: bool = False,
    learned: bool = True,
    strict: bool = False,
) -> Domain:
    """Read and check a domain, given as a shipped name or as a folder.

    `rules` are names of files in the encodings' folder ``rules``; one with arguments, such as ``at_most(grasp,2)``, is
    also stated as a fact. `encodings` is a folder to use in place of the shipped encodings. With `flat`, the composites
    of the domain are ignored: any sequence of its actions may be a plan. With `trust`, physics may run the Python files
    that its domain.toml names; nothing else does. Without `learned`, the file of learned invariants is left out; it is
    read where the folder has one. With `strict`, warnings are errors.

    Raises:
        DomainError: something is wrong with the files; the message has one line for each problem.
    """
    folder = domain_folder(name_or_folder)
    encodings = Path(encodings) if encodings is not None else data_folder("encodings")
    core = core_sources(encodings)
    own = read_sources(folder / "domain.lp", encodings, own=folder)
    hierarchy = read_sources(encodings / HIERARCHY, encodings) if any("composite" in s.text for s in own) else ()
    asked = tuple(source for rule in rules for source in rule_sources(rule, encodings))
    known = {source.path.resolve() for source in core}
    extra = tuple(source for source in (*hierarchy, *own, *asked) if source.path.resolve() not in known)
    program = Program((*core, *_unique(extra)))
    checked = check(program, folder)
    if strict:
        raise_problems(each.as_error() for each in first_of_each(checked.warnings))
    facts, settings = checked.facts, checked.settings
    if flat:
        facts = flattened(facts)
    if not facts.composites:
        program = Program(tuple(source for source in program.sources if source not in hierarchy))
    name = folder.resolve().name
    domain = Domain(name, folder, encodings, program, facts, settings, trust, warnings=checked.warnings)
    path = folder / LEARNED
    return with_learned(domain, read_sources(path, encodings)) if learned and path.is_file() else domain


def load_scene(domain: Domain) -> Scene:
    """Return the scene of a domain that `load_domain` has read; its Python predicates are trusted where it is.

    Raises:
        SceneError: the domain has none.
    """
    if not domain.settings.scene:
        raise SceneError(f"{domain.settings.path}:1: {domain.name} has no [scene]; add one, or draw with --no-physics")
    facts = domain.facts
    from prag_asp.scene.load import parse_scene

    return parse_scene(
        domain.settings.scene, facts.class_names, facts.entity_names, folder=domain.folder, trust=domain.trusted
    )


def with_learned(domain: Domain, sources: tuple[Source, ...]) -> Domain:
    """Return a domain with learned invariants, each stated as ``impossible(F,G)``.

    Raises:
        DomainError: the sources state something else, or speak of what the domain does not declare.
    """
    program = Program(_unique((*domain.program.sources, *sources)))
    impossible = check_learned(program, sources).impossible
    known = {frozenset(pair) for pair in domain.facts.impossible}
    added = {frozenset(pair): pair for pair in impossible if frozenset(pair) not in known}
    return replace(
        domain, program=program, facts=replace(domain.facts, impossible=impossible), learned=tuple(added.values())
    )


def _unique(sources: tuple[Source, ...]) -> tuple[Source, ...]:
    return tuple({(source.path.resolve(), source.text): source for source in sources}.values())
