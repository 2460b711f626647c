"""One allocation of a command is refused, at moments spread over its run: ``python -m tests.cli.allocations``.

Each moment is a run of its own, in a process that refuses one allocation of Python's and no other. Then no file may be
cut, the same command once more has to end well and with the same bytes, and what is said is looked at: one line and the
code of a limit, or something else. The commands are started by a process in which the package is imported (``warm``),
or in one that has imported nothing but how commands begin (``cold``), so that imports are refused memory too.
"""

from __future__ import annotations

import _testcapi
import argparse
import importlib
import random
import resource
import sys
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from prag_asp.cli.exits import Exit
from tests.fuzz.isolated import Limits, Ran, command, run, warm
from tests.output.faults import content

COMMANDS: Mapping[str, tuple[str, ...]] = {
    "count": ("count", "prag", "-n", "3", "--no-cache"),
    "sample": ("sample", "prag", "-n", "3", "--no-physics", "--count", "5", "--no-cache", "-o", "drawn.txt"),
    "enumerate": ("enumerate", "blocks", "-n", "2", "--no-cache", "-o", "listed.txt"),
    "split": ("split", "blocks", "-n", "3", "a=1/2", "b=1/2", "--count", "3", "--no-cache", "-o", "parts"),
    "stats": ("stats", "blocks", "-n", "2", "--no-cache", "-o", "figures.txt"),
    "export": ("export", "blocks", "-n", "1", "-o", "plans.cnf"),
    "explain": ("explain", "prag", "drop(panda,can_1)", "drop(panda,can_1)"),
    "check": ("check", "prag"),
}

STEP = 100
"""Bytes of addresses that stand for one moment."""

LIMITS = Limits(60.0, 4 * 10**9)
VARIABLES = {"PRAG_ASP_CACHE": "", "PYTHONHASHSEED": "0", "COLUMNS": "200"}
BEGUN = ("prag_asp.cli.supervision", "prag_asp.cli.registry", "numpy", "clingo")
"""What a cold process has imported: what is refused memory earlier is Python's, and no command has begun."""


@dataclass(frozen=True)
class Met:
    """What became of a command to which one allocation was refused."""

    name: str
    moment: int
    ran: Ran

    @property
    def touched(self) -> bool:
        """Whether the refusal had an effect that is seen."""
        return self.ran.code not in (Exit.DONE, Exit.NOT_FOUND) or b"Traceback" in self.ran.err

    @property
    def told(self) -> bool:
        """Whether it was told in one line, and by the code of a limit."""
        lines = [line for line in self.ran.err.splitlines() if b".part keeps " not in line]
        return self.ran.code == Exit.LIMIT and len(lines) == 1

    @property
    def last(self) -> str:
        """What was said last."""
        lines = self.ran.err.decode(errors="replace").strip().splitlines()
        return f"{self.ran.code}: {lines[-1][:160] if lines else 'nothing'}"


def refused(arguments: tuple[str, ...], moment: int | None) -> Callable[[], None]:
    """Return what runs a command to which the allocation of a number is refused."""

    def work() -> None:
        begin = command(arguments)
        if moment is not None:
            _testcapi.set_nomemory(moment, moment + 1)
        begin()

    return work


def starved(arguments: tuple[str, ...], moment: int | None) -> Callable[[], None]:
    """Return what runs a command that may have so many hundreds of bytes of addresses more than it begins with."""

    def work() -> None:
        begin = command(arguments)
        if moment is not None:
            most = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize() + moment * STEP
            resource.setrlimit(resource.RLIMIT_AS, (most, most))
        begin()

    return work


Work = Callable[[tuple[str, ...], int | None], Callable[[], None]]


def attempt(name: str, moment: int | None, folder: Path, work: Work) -> Ran:
    """Run a command in a folder, with memory refused from or at a moment, or none."""
    return run(work(COMMANDS[name], moment), folder, LIMITS, variables=VARIABLES)


def moments(name: str, folder: Path, work: Work) -> int:
    """Return about how many moments a command has: from there on, a refusal changes nothing."""
    least, most = 0, 1 << 22
    while most - least > 2000:
        middle = (least + most) // 2
        found = Met(name, middle, attempt(name, middle, folder, work))
        least, most = (middle, most) if found.touched else (least, middle)
    return most


def campaign(count: int, seed: int, names: Sequence[str], work: Work) -> Iterator[Met]:
    """Yield what became of commands, by turns, at moments of which each stands for as many as any other.

    Raises:
        AssertionError: a file was cut, or the second run did not end as one that nothing was refused.
    """
    chance = random.Random(seed)
    with TemporaryDirectory() as made:
        home = Path(made)
        for name in names:
            right = home / name
            right.mkdir()
            reference = attempt(name, None, right, work)
            whole, total = content(right), moments(name, home, work)
            each = count // len(names)
            for stratum in range(each):
                moment = chance.randrange(total * stratum // each, total * (stratum + 1) // each + 1)
                folder = home / f"{name} {moment}"
                folder.mkdir(exist_ok=True)
                found = attempt(name, moment, folder, work)
                left = {file: text for file, text in content(folder).items() if not file.endswith((".part", ".run"))}
                assert all(whole.get(file) == text for file, text in left.items()), (name, moment, found.err)
                assert found.err or found.code != reference.code or found.out == reference.out, (name, moment, found)
                assert not found.hung and not found.outlived, (name, moment)
                again = attempt(name, None, folder, work)
                assert (again.code, again.out) == (reference.code, reference.out), (name, moment, again)
                assert content(folder) == whole, (name, moment)
                yield Met(name, moment, found)


def main(arguments: Sequence[str]) -> None:
    """Run the campaign that a command line asks for."""
    parser = argparse.ArgumentParser(prog="python -m tests.cli.allocations", description=__doc__)
    parser.add_argument("--count", type=int, default=400, help="How many moments, of all commands together.")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--cold", action="store_true", help="Refuse memory to imports of the package too.")
    parser.add_argument("--starve", action="store_true", help="Allow only so many addresses, in place of the moments.")
    parser.add_argument("commands", nargs="*", metavar="COMMAND", help=f"of {', '.join(COMMANDS)}; all by default")
    given = parser.parse_args(arguments)
    if given.cold or given.starve:
        for name in BEGUN:
            importlib.import_module(name)
    else:
        warm()
    met: Counter[str] = Counter()
    odd: Counter[str] = Counter()
    work = starved if given.starve else refused
    for found in campaign(given.count, given.seed, given.commands or list(COMMANDS), work):
        met["no effect" if not found.touched else "told" if found.told else "told otherwise"] += 1
        if found.touched and not found.told:
            odd[f"{found.name}: {found.last}"] += 1
            sys.stderr.write(f"{found.name}, allocation {found.moment}: {found.last}\n")
    total = sum(met.values())
    sys.stdout.write(f"{total} moments: {', '.join(f'{number} {what}' for what, number in met.most_common())}\n")
    for what, number in odd.most_common():
        sys.stdout.write(f"{number:4} {what}\n")
    sys.stdout.write("no file was cut, and every second run ended with the same bytes\n")


if __name__ == "__main__":
    main(sys.argv[1:])
