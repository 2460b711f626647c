"""Write a domain as a starting point: a small domain, or a copy of a shipped domain."""

from __future__ import annotations

import re
from pathlib import Path

from prag_asp.domain.templates import PLAIN_LOGIC, PLAIN_SETTINGS, ROBOT_LOGIC, ROBOT_SETTINGS
from prag_asp.errors import DomainError
from prag_asp.output import make_folder, new_folder, replace_file
from prag_asp.program.paths import shipped_domains
from prag_asp.wording import did_you_mean

NAME = re.compile(r"[A-Za-z][A-Za-z0-9_-]*")


def write_new_domain(name: str, parent: Path = Path(), *, plain: bool = False, like: str | None = None) -> Path:
    """Write a domain as a starting point into a new folder `name` in `parent`, and return the folder.

    By default, it is a small commented domain with a robot, and its tasks are feasible; a `plain` domain has no robot.
    `like` is the name of a shipped domain to copy instead, without its known counts.

    Raises:
        DomainError: the name is invalid, the folder exists, or `like` is not a shipped domain or is given with
            `plain`.
        OutputError: the folder cannot be written; in this case it is not created.
    """
    folder = parent / name
    if not NAME.fullmatch(Path(name).name) or name.endswith(("/", "\\")):
        raise DomainError(f"{name!r} cannot name a domain; use letters, digits, - and _, beginning with a letter")
    if folder.name in shipped_domains():
        raise DomainError(f"{folder.name}: a shipped domain has this name; choose another")
    if folder.exists():
        raise DomainError(f"{folder}: exists already; choose another name, or remove it first")
    if like is not None and plain:
        raise DomainError("--plain does not apply to a copy of a shipped domain; leave --plain or --from out")
    files = _small_domain(folder.name, plain=plain) if like is None else _shipped_files(like)
    with new_folder(folder) as part:
        for file, content in files.items():
            home = part if "/" not in file else make_folder((part / file).parent)
            replace_file(home / Path(file).name, content, follow=False)
    return folder


def _small_domain(name: str, *, plain: bool) -> dict[str, bytes]:
    """Return the files of a small domain."""
    logic, settings = (PLAIN_LOGIC, PLAIN_SETTINGS) if plain else (ROBOT_LOGIC, ROBOT_SETTINGS)
    return {"domain.lp": logic.format(name=name).encode(), "domain.toml": settings.format(name=name).encode()}


def _shipped_files(name: str) -> dict[str, bytes]:
    """Return the files of a shipped domain by their paths in its folder, without its known counts.

    Raises:
        DomainError: there is no such domain.
    """
    shipped = shipped_domains()
    if name not in shipped:
        raise DomainError(f"{name}: no such shipped domain; {did_you_mean(name, shipped, ', '.join(shipped))}")
    paths = sorted(path for path in shipped[name].rglob("*") if path.is_file() and path.name != "counts.toml")
    return {path.relative_to(shipped[name]).as_posix(): path.read_bytes() for path in paths}
