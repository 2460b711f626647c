"""The sources of a domain: a shipped name, a folder, files, standard input, or a text from a program."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from prag_asp.errors import DomainError
from prag_asp.program.paths import PDDL, domain_folder, is_file_name
from prag_asp.program.sources import Source, standard_input, text_source
from prag_asp.safe_reading import STANDARD_INPUT

if TYPE_CHECKING:
    from prag_asp.pddl import Imported

BOTH = "give a domain, then its problem: DOMAIN.pddl PROBLEM.pddl"


def find_domain(names: Sequence[str | Path | Source], text: str | None) -> tuple[str, Path | None, list[Path | Source]]:
    """Return the name of a domain, its folder if it has one, and its files and texts in order.

    The arguments are one name or folder, or any number of files and at most one text.

    Raises:
        DomainError: there is no such domain, or the arguments are of several kinds.
    """
    files = list(dict.fromkeys([*names, *([] if text is None else [text_source("text", text)])]))
    if not files:
        raise DomainError("no domain; give a shipped name, a folder, files that end in .lp, two of PDDL, or a text")
    named = [str(each) for each in names if not isinstance(each, Source) and not is_file_name(each)]
    if named and len(files) > 1:
        listing = " ".join(str(each.path if isinstance(each, Source) else each) for each in files)
        if any(Path(each).suffix == PDDL for each in names if not isinstance(each, Source)):
            raise DomainError(f"{listing}: {named[0]} is no file that ends in .pddl; {BOTH}")
        raise DomainError(f"{listing}: {named[0]} is no file that ends in .lp; give one name or folder, or files alone")
    if named:
        folder = domain_folder(named[0])
        return folder.resolve().name, folder, [folder / "domain.lp"]
    planning = [each for each in files if not isinstance(each, Source) and Path(each).suffix == PDDL]
    imported = _imported(planning) if planning else None
    entries = [_entry(each) for each in files if each not in planning]
    if imported is not None:
        return imported.name, None, [*imported.sources, *entries]
    first = entries[0].path if isinstance(entries[0], Source) else entries[0]
    return first.stem.strip("<>"), None, entries


def _imported(files: Sequence[str | Path | Source]) -> Imported:
    """Return the logic program of a PDDL domain and problem.

    Raises:
        DomainError: there are not exactly two files, or they cannot be imported.
    """
    listing = " ".join(map(str, files))
    if len(files) != 2:
        raise DomainError(f"{listing}: {'one file' if len(files) == 1 else f'{len(files)} files'} of PDDL; {BOTH}")
    from prag_asp.pddl import read

    return read(*map(str, files))


def _entry(name: str | Path | Source) -> Path | Source:
    if isinstance(name, Source):
        return name
    return standard_input() if str(name) == STANDARD_INPUT else Path(name)
