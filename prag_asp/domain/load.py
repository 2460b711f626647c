"""Load a domain: find its files, read them, and check them."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING

import clingo

from prag_asp.checking import check
from prag_asp.domain.domain_source import find_domain
from prag_asp.domain.rules import rule_sources
from prag_asp.errors import DomainError, SceneError
from prag_asp.lint import check_learned
from prag_asp.processes.progress_events import stage
from prag_asp.program.constants import Constant, parse_constants, set_constants
from prag_asp.program.facts import Facts, flattened
from prag_asp.program.paths import data_folder
from prag_asp.program.problem import Problem, first_of_each, raise_problems
from prag_asp.program.settings import Settings
from prag_asp.program.sources import (
    HIERARCHY,
    Program,
    Source,
    asked_sources,
    core_sources,
    each_once,
    read_sources,
    read_text,
)
from prag_asp.reduction.reduction import Reduction, find_reduction

if TYPE_CHECKING:
    from prag_asp.scene.scene import Scene

LEARNED = "learned.lp"
"""The file of invariants that physics has proved; `prag-asp learn` writes it."""

NO_SETTINGS = Path("<no domain.toml>")
"""Where the settings of a domain that has no folder would be; there is no such file."""


@dataclass(frozen=True)
class Domain:
    """A domain that has passed every check.

    `program` is the whole logic program (the encodings, the domain's own files and the rules asked for), `facts` what
    its base part states. `folder` is None unless the domain was given as a name or a folder. Physics runs the Python
    files of the domain only where it is `trusted`. `learned` are the impossible fluents that only the file of learned
    invariants states, `constants` the values given to ``#const``s by name, `warnings` the problems that are no errors.
    `reduction` is the small-model reduction of `program`, if there is one: counts use it, and everything that reads
    `facts` grounds all entities. `irreducible` is the reason why a domain with many alike entities has none.
    """

    name: str
    folder: Path | None
    encodings: Path
    program: Program
    facts: Facts
    settings: Settings
    trusted: bool = False
    learned: tuple[tuple[clingo.Symbol, clingo.Symbol], ...] = ()
    constants: Mapping[str, str] = field(default_factory=dict)
    warnings: tuple[Problem, ...] = ()
    reduction: Reduction | None = None
    irreducible: str = ""

    @property
    def label(self) -> str:
        """The name, and the constants that were set: ``hanoi (discs=4)``."""
        given = ", ".join(f"{name}={value}" for name, value in self.constants.items())
        return f"{self.name} ({given})" if given else self.name


def load_domain(
    *given: str | Path | Source,
    text: str | None = None,
    constants: Mapping[str, Constant] | None = None,
    settings: str | Path | None = None,
    rules: tuple[str, ...] = (),
    encodings: str | Path | None = None,
    flat: bool = False,
    trust: bool = False,
    learned: bool = True,
    strict: bool = False,
) -> Domain:
    """Read and check a domain, given as a shipped name, as a folder, as files that end in .lp, or as a text.

    Files (``-`` is standard input) and a text together are one domain, named after the first. A file includes from its
    own folder, a text from the working directory; they come without settings. Two files that end in .pddl, a domain
    and its problem, are read as such. `constants` are values for ``#const``s of the domain. `settings` is a file to
    read in place of the folder's domain.toml; paths in it begin at its folder.

    `rules` are names of files in the encodings' folder ``rules``; one with arguments, such as ``at_most(grasp,2)``, is
    also stated as a fact. `encodings` is a folder to use in place of the shipped encodings. With `flat`, the composites
    of the domain are ignored: any sequence of its actions may be a plan. With `trust`, physics may run the Python files
    that its domain.toml names; nothing else does. Without `learned`, the file of learned invariants is left out; it is
    read where a folder has one, unless `settings` give another scene than it was learned from. With `strict`, warnings
    are errors.

    Raises:
        DomainError: something is wrong with the files; the message has one line for each problem.
    """
    stage("reading the domain")
    name, folder, entries = find_domain(given, text)
    values = parse_constants(constants or {})
    encodings = Path(encodings) if encodings is not None else data_folder("encodings")
    core = core_sources(encodings)
    own = each_once(each for entry in entries for each in read_sources(entry, encodings, own=folder))
    own = set_constants(own, values, name) if values else own
    selected = tuple(each for rule in rules for each in rule_sources(rule, encodings))
    known = {each.path.resolve() for each in core}
    added = (*asked_sources(own, encodings), *own, *selected)
    extra = tuple(each for each in added if each.path.resolve() not in known)
    program = Program((*core, *each_once(extra)))
    path = folder / LEARNED if learned and folder and settings is None else None
    path = path if path is not None and os.path.lexists(path) else None
    table_file = _settings(settings, folder)
    found = None if path else find_reduction(program, table_file)
    reduction, irreducible = (found, "") if isinstance(found, Reduction) else (None, found or "")
    checked = reduction.checked if reduction else check(program, table_file)
    if strict:
        raise_problems(each.as_error() for each in first_of_each(checked.warnings))
    facts = flattened(checked.facts) if flat else checked.facts
    if reduction:
        facts = reduction.whole_facts()
    elif not facts.composites:
        program = Program(tuple(each for each in program.sources if each.path != encodings / HIERARCHY))
    domain = Domain(
        name, folder, encodings, program, facts, checked.settings, trust,
        constants=values, warnings=checked.warnings, reduction=reduction, irreducible=irreducible,
    )  # fmt: skip
    return with_learned(domain, read_sources(path, encodings, own=folder)) if path else domain


def _settings(given: str | Path | None, folder: Path | None) -> Source:
    """Return the file of settings; it need not be there, unless it is given.

    Raises:
        DomainError: it is given, and is not there; or it cannot be read.
    """
    if given is not None:
        if not os.path.lexists(given):
            raise DomainError(f"{given}: no such file of settings; give one written like a domain.toml")
        return Source(Path(given), read_text(Path(given)))
    if folder is None:
        return Source(NO_SETTINGS, "")
    path = folder / "domain.toml"
    return Source(path, read_text(path, folder) if os.path.lexists(path) else "")


def load_scene(domain: Domain) -> Scene:
    """Return the scene of a domain that `load_domain` has read; its Python predicates are trusted where it is.

    Raises:
        SceneError: the domain has none.
    """
    if not domain.settings.scene:
        if domain.settings.path == NO_SETTINGS:
            problem = f"{domain.name}: files have no [scene] of their own; give settings"
            raise SceneError(f"{problem} (--settings FILE), or draw with --no-physics")
        raise SceneError(f"{domain.settings.path}:1: {domain.name} has no [scene]; add one, or draw with --no-physics")
    facts = domain.facts
    from prag_asp.scene.scene_loader import parse_scene

    stage("reading the scene")
    folder, trust = domain.settings.path.parent, domain.trusted
    return parse_scene(domain.settings.scene, facts.class_names, facts.entity_names, folder=folder, trust=trust)


def with_learned(domain: Domain, sources: tuple[Source, ...]) -> Domain:
    """Return a domain with learned invariants, each stated as ``impossible(F,G)``.

    Raises:
        DomainError: the sources state something else, or speak of what the domain does not declare.
    """
    program = Program(each_once((*domain.program.sources, *sources)))
    impossible = check_learned(program, sources).impossible
    known = {frozenset(pair) for pair in domain.facts.impossible}
    added = {frozenset(pair): pair for pair in impossible if frozenset(pair) not in known}
    return replace(
        domain,
        program=program,
        facts=replace(domain.facts, impossible=impossible, static=()),
        reduction=None,
        learned=tuple(added.values()),
    )
