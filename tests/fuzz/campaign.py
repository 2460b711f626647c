"""Try mutants, several at once, and gather what is wrong."""

from __future__ import annotations

import multiprocessing
import os
import re
import shlex
import shutil
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

from prag_asp.cli.registry import COMMANDS
from tests.fuzz.isolated import Limits, Ran, command, run
from tests.fuzz.judged import fault
from tests.fuzz.mutant import Command, Mutant, secrets_changed

LEVEL = {"PRAG_ASP_CACHE": "", "PYTHONHASHSEED": "0", "COLUMNS": "200"}
"""The variables of every command."""

TIME = "10s"
"""The limit of time of every command: what is asked for may take years, but its end may not."""

SPECIFIC = {"traceback": 2, "signal": 2, "lines": 12, "placeless": 12}
"""How many words of what is wrong tell one cause from another."""

NAMES = r"'[^']*'|\[\d+m|\S*[\\()]\S*|(?<=\[.)\S+:"
"""What changes while a finding is made smaller."""


@dataclass(frozen=True)
class Finding:
    """Something that is wrong: a mutant, the command, what became of it."""

    mutant: Mutant
    arguments: Command
    ran: Ran
    what: str

    @property
    def signature(self) -> str:
        """What findings of one cause have in common, roughly."""
        words = re.sub(NAMES, "", self.what).split()
        return " ".join(words[: SPECIFIC.get(words[0].rstrip(":"), 1)])


@dataclass(frozen=True)
class Tried:
    """What became of one mutant: how many commands were run, whether the first accepted it, and what is wrong."""

    mutant: Mutant
    commands: int
    accepted: bool
    seconds: float
    finding: Finding | None


def trials(mutants: Iterable[Mutant], jobs: int, limits: Limits) -> Iterator[Tried]:
    """Yield what becomes of mutants, as they end; the calling process has to be warm."""
    if jobs == 1:
        yield from (attempt(mutant, limits) for mutant in mutants)
        return
    with multiprocessing.get_context("fork").Pool(jobs) as pool:
        yield from pool.imap_unordered(partial(attempt, limits=limits), mutants)


def attempt(mutant: Mutant, limits: Limits) -> Tried:
    """Run the commands of a mutant in a folder that is thrown away."""
    with TemporaryDirectory(prefix="mutant-") as name:
        folder = Path(name).resolve()
        try:
            return _attempt(mutant, folder, limits)
        finally:
            for path, _, _ in os.walk(folder):  # so that it can be removed, whatever has been made in it
                if not os.access(path, os.W_OK | os.X_OK):
                    Path(path).chmod(0o700)


def _attempt(mutant: Mutant, folder: Path, limits: Limits) -> Tried:
    own = mutant.write(folder)
    answers: dict[str, Command] = {}
    seconds = 0.0
    accepted = False
    for number, arguments in enumerate(mutant.commands, 1):
        variables = {**LEVEL, "HOME": str(folder), "TMPDIR": str(folder), **mutant.variables}
        ran = run(command(limited(arguments)), own, limits, mutant.given, variables)
        seconds += ran.seconds
        # What is accepted has nothing wrong in its files any more: a question may be, and an engine may not express it.
        what = fault(ran, arguments, mutant if number == 1 else replace(mutant, placed=False))
        changed = secrets_changed(folder)
        if changed:
            what = f"leak: {changed} outside of the folder is another"
        if number > 1 and ran.code == 0 and not what:
            answers.setdefault(ran.out.decode("utf-8", "replace"), arguments)
            if len(answers) > 1:
                what = "differ: " + " | ".join(f"{' '.join(each)}: {out.strip()}" for out, each in answers.items())
        if what:
            return Tried(mutant, number, accepted, seconds, Finding(mutant, arguments, ran, what))
        accepted |= ran.code == 0
        if not accepted:
            break
    return Tried(mutant, number, accepted, seconds, None)


def limited(arguments: Command) -> Command:
    """Return a command line with a limit of time, within which the command has to end, whatever it was asked for."""
    if not arguments or arguments[0] not in COMMANDS:
        return arguments
    return (arguments[0], "--time", TIME, *arguments[1:])


def keep(finding: Finding, folder: Path) -> Path:
    """Write a finding into a folder of its own within a folder, so that it can be tried by hand, and return that."""
    own = folder / finding.mutant.name
    shutil.rmtree(own, ignore_errors=True)
    own.mkdir(parents=True)
    finding.mutant.write(own)
    variables = "".join(f"{name}={shlex.quote(value)} " for name, value in finding.mutant.variables.items())
    redirect = " < ../given" if finding.mutant.given else ""
    (own / "run.sh").write_text(
        f'cd "$(dirname "$0")/own" && {variables}prag-asp {shlex.join(finding.arguments)}{redirect}\n',
        encoding="utf-8",
        errors="surrogateescape",
    )
    (own / "what").write_text(f"{finding.what}\n", encoding="utf-8", errors="replace")
    for name, content in (("given", finding.mutant.given), ("stdout", finding.ran.out), ("stderr", finding.ran.err)):
        (own / name).write_bytes(content)
    return own
