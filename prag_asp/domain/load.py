"""Load a domain: find, read and check its files.

A domain is given as the name of a shipped domain, a folder, files, standard input, or a string.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import clingo

from prag_asp.atom import parse_atom
from prag_asp.errors import DomainError, SceneError
from prag_asp.lint import check, check_learned
from prag_asp.lint.allowed_warnings import allowed_names, not_allowed
from prag_asp.processes.progress_events import stage
from prag_asp.program.constants import Constant, parse_constants, set_constants
from prag_asp.program.facts import Facts, flattened
from prag_asp.program.parse import parse_sources
from prag_asp.program.paths import PDDL, data_folder, domain_folder, is_file_name, rule_names
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
    standard_input,
    text_source,
)
from prag_asp.reduction.reduction import Reduction, find_reduction
from prag_asp.safe_reading import STANDARD_INPUT, is_inside, read_bytes
from prag_asp.wording import did_you_mean

if TYPE_CHECKING:
    from prag_asp.scene.scene import Scene

LEARNED = "learned.lp"
"""The file of invariants that physics has proved, written by `prag-asp learn`."""

NO_SETTINGS = Path("<no domain.toml>")
"""The path that stands for the settings of a domain without a folder."""

MESH = re.compile(rb"""filename\s*=\s*["']([^"']+)["']""")
"""The pattern of the file names of meshes in a URDF."""

BOTH = "give a domain, then its problem: DOMAIN.pddl PROBLEM.pddl"


@dataclass(frozen=True)
class Domain:
    """A domain that has passed every check.

    `program` is the whole logic program (encodings, files of the domain and selected rules), and `facts` are the facts
    of its base part. `folder` is None unless the domain was loaded by its name or folder. Physics runs the Python files
    of the domain only if it is `trusted`. `learned` holds the impossible pairs of fluents that only the file of learned
    invariants states, and `constants` are the values set for ``#const``s, by name. `reduction` is the small-model
    reduction of `program`, if there is one: counts use it, whereas `facts` is ground with all entities. `irreducible`
    is the reason why a domain with many interchangeable entities has no reduction. `derived` caches values that are
    computed from the domain, such as its logic, by name; it is neither compared nor pickled.
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
    derived: dict[str, Any] = field(default_factory=dict, init=False, repr=False, compare=False)

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "derived": {}}

    @property
    def label(self) -> str:
        """The name of the domain, followed by the constants that are set: ``hanoi (discs=4)``."""
        settings = ", ".join(f"{name}={value}" for name, value in self.constants.items())
        return f"{self.name} ({settings})" if settings else self.name


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
    untimed: bool = False,
) -> Domain:
    """Read and check a domain, given by the name of a shipped domain, a folder, files that end in .lp, or a text.

    Files (``-`` is standard input) and a text together form one domain, named after the first. Includes are resolved in
    the folder of the file or, for a text, in the working directory; such a domain has no domain.toml. Two files that
    end in .pddl are a PDDL domain and its problem; a single file may contain both. `constants` are values for
    ``#const``s of the domain. `settings` is a file to read in place of the folder's domain.toml; paths in it are
    relative to the folder that contains it.

    `rules` are names of files in the encodings' folder ``rules``; a rule with arguments, such as ``at_most(grasp,2)``,
    is also stated as a fact. `encodings` is a folder to use in place of the shipped encodings. With `flat`, the
    composites of the domain are ignored: any sequence of its actions can be a plan. With `trust`, physics may run the
    Python files that domain.toml names; nothing else runs them. Without `learned`, the folder's file of learned
    invariants is not read. It is not read with `settings` either, because these settings may describe a different
    scene. With `strict`, warnings are errors. With `untimed`, durative actions in PDDL are read as instantaneous ones.

    Raises:
        DomainError: the files have problems; the message contains one line for each problem.
    """
    stage("reading the domain")
    name, folder, entries, remarks = _find_domain(given, text, untimed=untimed)
    values = parse_constants(constants or {})
    encodings = Path(encodings) if encodings is not None else data_folder("encodings")
    core = core_sources(encodings)
    own = each_once(each for entry in entries for each in read_sources(entry, encodings, own=folder))
    program = _whole_program(core, set_constants(own, values, name) if values else own, rules, encodings)
    table_file = _settings_file(settings, folder)
    learned_path = folder / LEARNED if learned and folder and settings is None else None
    if learned_path and not os.path.lexists(learned_path):
        learned_path = None
    outcome = None if learned_path else find_reduction(program, table_file)
    reduction, irreducible = (outcome, "") if isinstance(outcome, Reduction) else (None, outcome or "")
    checked = reduction.checked if reduction else check(program, table_file)
    warnings = (*remarks, *checked.warnings)
    if strict:
        raise_problems(each.as_error() for each in first_of_each(warnings))
    facts = flattened(checked.facts) if flat else checked.facts
    if reduction:
        facts = reduction.whole_facts()
    elif not facts.composites:
        program = Program(tuple(each for each in program.sources if each.path != encodings / HIERARCHY))
    domain = Domain(
        name, folder, encodings, program, facts, checked.settings, trust,
        constants=values, warnings=warnings, reduction=reduction, irreducible=irreducible,
    )  # fmt: skip
    return with_learned(domain, read_sources(learned_path, encodings, own=folder)) if learned_path else domain


def _find_domain(
    names: Sequence[str | Path | Source], text: str | None, *, untimed: bool
) -> tuple[str, Path | None, list[Path | Source], tuple[Problem, ...]]:
    """Return the name of a domain, its folder (if any), its files and texts in order, and warnings about PDDL.

    The arguments are one name or folder, or any number of files and at most one text.

    Raises:
        DomainError: the domain does not exist, the arguments mix several kinds, or PDDL files cannot be imported.
    """
    files = list(dict.fromkeys([*names, *([] if text is None else [text_source("text", text)])]))
    if not files:
        raise DomainError("no domain; give a shipped domain's name, a folder, .lp files, two PDDL files, or a text")
    named = [str(each) for each in names if not isinstance(each, Source) and not is_file_name(each)]
    if named and len(files) > 1:
        listing = " ".join(str(each.path if isinstance(each, Source) else each) for each in files)
        if any(Path(each).suffix == PDDL for each in names if not isinstance(each, Source)):
            raise DomainError(f"{listing}: {named[0]} is not a file that ends in .pddl; {BOTH}")
        raise DomainError(
            f"{listing}: {named[0]} is not a file that ends in .lp; give one name or folder, or files alone"
        )
    if named:
        folder = domain_folder(named[0])
        return folder.resolve().name, folder, [folder / "domain.lp"], ()
    planning = [each for each in files if not isinstance(each, Source) and Path(each).suffix == PDDL]
    entries = [
        each if isinstance(each, Source) else standard_input() if str(each) == STANDARD_INPUT else Path(each)
        for each in files
        if each not in planning
    ]
    if planning:
        from prag_asp.pddl import read
        from prag_asp.pddl.syntax.sections import holds_both

        if len(planning) == 1 and holds_both(Path(str(planning[0]))):
            planning = planning * 2
        if len(planning) != 2:
            problem = "one file" if len(planning) == 1 else f"{len(planning)} files"
            raise DomainError(f"{' '.join(map(str, planning))}: {problem} of PDDL; {BOTH}")
        imported = read(*map(str, planning), untimed=untimed)
        return imported.name, None, [*imported.sources, *entries], imported.warnings
    first = entries[0].path if isinstance(entries[0], Source) else entries[0]
    return first.stem.strip("<>"), None, entries, ()


def _whole_program(core: tuple[Source, ...], own: tuple[Source, ...], rules: Iterable[str], encodings: Path) -> Program:
    """Combine the core encodings, the encodings that a domain's `own` files need, these files, and `rules`.

    Raises:
        DomainError: the rule does not exist, or takes a different number of arguments.
    """
    core_paths = {each.path.resolve() for each in core}
    selected = (each for rule in rules for each in _rule_sources(rule, encodings))
    added = each_once((*asked_sources(own, encodings), *own, *selected))
    return Program((*core, *(each for each in added if each.path.resolve() not in core_paths)))


def _settings_file(settings: str | Path | None, folder: Path | None) -> Source:
    """Return the settings file as a source: the given file, or the one in the folder; empty if there is none.

    Raises:
        DomainError: the given file does not exist, or a file cannot be read.
    """
    if settings is not None:
        if not os.path.lexists(settings):
            raise DomainError(f"{settings}: no such file of settings; give one written like a domain.toml")
        return Source(Path(settings), read_text(Path(settings)))
    if folder is None:
        return Source(NO_SETTINGS, "")
    path = folder / "domain.toml"
    return Source(path, read_text(path, folder) if os.path.lexists(path) else "")


def _rule_sources(rule: str, encodings: Path) -> tuple[Source, ...]:
    """Return the files of a rule; if it has arguments, they also include a source that states it as a fact.

    Raises:
        DomainError: the rule does not exist, or takes a different number of arguments.
    """
    atom = parse_atom(rule)
    folder = encodings / "rules"
    names = rule_names(encodings)
    if atom.name not in names:
        otherwise = f"there are {', '.join(names) or 'none'} in {folder}"
        raise DomainError(f"{rule}: no such rule; {did_you_mean(atom.name, names, otherwise)}")
    sources = read_sources(folder / f"{atom.name}.lp", encodings)
    if not atom.arguments:
        return sources
    statements, _ = parse_sources((source, False) for source in sources)
    read = (each for statement in statements for each in statement.body if each.name == atom.name)
    counts_taken = {len(each.arguments) for each in read}
    if len(atom.arguments) not in counts_taken:
        if not counts_taken:
            raise DomainError(f"{rule}: the rule {atom.name} takes no arguments; write {atom.name}")
        counts = " or ".join(map(str, sorted(counts_taken)))
        raise DomainError(
            f"{rule}: the rule {atom.name} takes {counts} arguments, not {len(atom.arguments)}; "
            f"see the head of {folder / atom.name}.lp"
        )
    return (*sources, Source(Path(f"rule {atom}"), f"{atom}."))


def load_scene(domain: Domain) -> Scene:
    """Return the scene of a domain; its Python predicates are trusted if the domain is.

    Raises:
        SceneError: the domain has no scene, or it is invalid.
    """
    if not domain.settings.scene:
        if domain.settings.path == NO_SETTINGS:
            problem = f"{domain.name}: files have no [scene] of their own; give settings"
            raise SceneError(f"{problem} (--settings FILE), or use --no-physics")
        raise SceneError(f"{domain.settings.path}:1: {domain.name} has no [scene]; add one, or use --no-physics")
    facts = domain.facts
    from prag_asp.scene.scene_loader import parse_scene

    stage("reading the scene")
    folder, trust = domain.settings.path.parent, domain.trusted
    return parse_scene(domain.settings.scene, facts.class_names, facts.entity_names, folder=folder, trust=trust)


def scene_files(table: object, folder: Path) -> Iterator[Path]:
    """Yield the files that a scene table names, and the meshes of its URDF files."""
    for text in sorted(set(_texts(table))):
        path = folder / text
        if len(text) < 256 and "\0" not in text and is_inside(path, folder) and path.is_file():
            yield path
            if path.suffix.lower() == ".urdf":
                meshes = (path.parent / name.decode(errors="replace") for name in MESH.findall(read_bytes(path)))
                yield from (mesh for mesh in meshes if is_inside(mesh, folder) and mesh.is_file())


def _texts(value: Any) -> Iterator[str]:
    if isinstance(value, str):
        yield value
    elif isinstance(value, Mapping):
        for each in value.values():
            yield from _texts(each)
    elif isinstance(value, Sequence):
        for each in value:
            yield from _texts(each)


def with_learned(domain: Domain, sources: tuple[Source, ...]) -> Domain:
    """Return a domain with learned invariants, each stated as ``impossible(F,G)``.

    Raises:
        DomainError: the sources state anything but invariants, or use undeclared fluents.
    """
    program = Program(each_once((*domain.program.sources, *sources)))
    impossible = check_learned(program, sources).impossible
    stated = {frozenset(pair) for pair in domain.facts.impossible}
    added = {frozenset(pair): pair for pair in impossible if frozenset(pair) not in stated}
    return replace(
        domain,
        program=program,
        facts=replace(domain.facts, impossible=impossible, static=()),
        reduction=None,
        learned=tuple(added.values()),
    )


def shown_warnings(warnings: Iterable[Problem], settings: Settings) -> Iterator[Problem]:
    """Yield the warnings that no comment in domain.toml allows."""
    return not_allowed(warnings, allowed_names((), settings))
