"""Read a domain from disk."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from prag_asp.domain.atom import parse_atom
from prag_asp.domain.facts import Facts
from prag_asp.domain.lint import check
from prag_asp.domain.paths import data_folder, domain_folder
from prag_asp.domain.settings import Settings
from prag_asp.domain.sources import Program, Source, core_sources, read_sources
from prag_asp.errors import DomainError


@dataclass(frozen=True)
class Domain:
    """A domain that has passed every check.

    `program` is the whole logic program (the encodings, the domain's own files and the rules asked for), `facts` what
    its base part states.
    """

    name: str
    folder: Path
    encodings: Path
    program: Program
    facts: Facts
    settings: Settings


def load_domain(
    name_or_folder: str | Path, *, rules: tuple[str, ...] = (), encodings: str | Path | None = None
) -> Domain:
    """Read and check a domain, given as a shipped name or as a folder.

    `rules` are names of files in the encodings' folder ``rules``; one with arguments, such as ``at_most(grasp,2)``, is
    also stated as a fact. `encodings` is a folder to use in place of the shipped encodings.

    Raises:
        DomainError: something is wrong with the files; the message has one line for each problem.
    """
    folder = domain_folder(name_or_folder)
    encodings = Path(encodings) if encodings is not None else data_folder("encodings")
    core = core_sources(encodings)
    own = read_sources(folder / "domain.lp", encodings, own=folder)
    asked = tuple(source for rule in rules for source in _rule_sources(rule, encodings))
    known = {source.path.resolve() for source in core}
    extra = tuple(source for source in (*own, *asked) if source.path.resolve() not in known)
    program = Program((*core, *_unique(extra)))
    facts, settings = check(program, folder)
    return Domain(folder.resolve().name, folder, encodings, program, facts, settings)


def _unique(sources: tuple[Source, ...]) -> tuple[Source, ...]:
    return tuple({(source.path.resolve(), source.text): source for source in sources}.values())


def _rule_sources(rule: str, encodings: Path) -> tuple[Source, ...]:
    atom = parse_atom(rule)
    path = encodings / "rules" / f"{atom.name}.lp"
    if not atom.name.isidentifier() or not path.is_file():
        found = ", ".join(sorted(each.stem for each in path.parent.glob("*.lp")))
        raise DomainError(f"{rule}: no such rule; there are {found or 'none'} in {path.parent}")
    if atom.name == "at_most" and atom.arguments and not (len(atom.arguments) == 2 and atom.arguments[1].isdecimal()):
        raise DomainError(f"{rule}: write the name of an action and how often it may occur, as in at_most(grasp,2)")
    stated = (Source(path.with_name(f"{path.name} ({rule})"), f"{atom}."),) if atom.arguments else ()
    return (*read_sources(path, encodings), *stated)
