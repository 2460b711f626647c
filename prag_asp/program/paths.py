"""The folders of the shipped encodings, domains and suites, in a checkout or in the installed package."""

from __future__ import annotations

from pathlib import Path

from prag_asp.errors import DomainError, QueryError
from prag_asp.safe_reading import STANDARD_INPUT
from prag_asp.wording import did_you_mean

BY_LIBRARY = frozenset(["canonical_names", "joint_names", "closed_invariants", "same_start", "weights"])
"""Rules that only the library adds, most of them together with computed facts."""

PDDL = ".pddl"
"""The suffix of PDDL files."""

PACKAGE = Path(__file__).resolve().parent.parent


def data_folder(name: str) -> Path:
    """Return the data folder `name`, such as ``encodings``, in the package, or next to it in a checkout."""
    installed = PACKAGE / name
    return installed if installed.is_dir() else PACKAGE.parent / name


def shipped_domains() -> dict[str, Path]:
    """Return the folders of the shipped domains, by name."""
    return {path.parent.name: path.parent for path in sorted(data_folder("domains").glob("*/domain.lp"))}


def rule_names(encodings: Path) -> list[str]:
    """Return the names of the optional rules in a folder of encodings."""
    return sorted({path.stem for path in (encodings / "rules").glob("*.lp")} - BY_LIBRARY)


def is_file_name(name: str | Path) -> bool:
    """Return whether a domain argument is a logic or PDDL file or standard input, rather than a name or a folder."""
    return str(name) == STANDARD_INPUT or (Path(name).suffix in (".lp", PDDL) and not Path(name).is_dir())


def domain_folder(name_or_path: str | Path) -> Path:
    """Return the folder of a domain, given a shipped name or a folder path.

    Raises:
        DomainError: there is neither a shipped domain nor a folder with that name, the path is a file, or the folder
            has no domain.lp.
    """
    shipped = shipped_domains()
    if str(name_or_path) in shipped:
        return shipped[str(name_or_path)]
    folder = Path(name_or_path)
    if (folder / "domain.lp").is_file():
        return folder
    if folder.is_dir():
        raise DomainError(f"{folder}: this folder has no domain.lp; `prag-asp new NAME` writes one")
    if folder.is_file():
        raise DomainError(f"{folder}: a file, but its name does not end in .lp; rename it, or give the domain's folder")
    hint = did_you_mean(str(name_or_path), shipped, f"shipped are {', '.join(shipped)}; or give a folder or files")
    raise DomainError(f"{name_or_path}: no such domain; {hint}")


def shipped_suites() -> dict[str, Path]:
    """Return the files of the shipped suites, by name."""
    return {path.stem: path for path in sorted(data_folder("suites").glob("*.toml"))}


def suite_file(name_or_path: str | Path) -> Path:
    """Return the file of a suite, given a shipped name or a file path.

    Raises:
        QueryError: there is neither a shipped suite nor a file with that name.
    """
    shipped = shipped_suites()
    if str(name_or_path) in shipped:
        return shipped[str(name_or_path)]
    path = Path(name_or_path)
    if path.is_file():
        return path
    hint = did_you_mean(str(name_or_path), shipped, f"shipped are {', '.join(shipped)}; or give a TOML file")
    raise QueryError(f"{name_or_path}: no such suite; {hint}")
