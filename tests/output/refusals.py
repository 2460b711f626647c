"""Each allocation of small commands refused, one after another, from where they open their first file to their end.

``python -m tests.output.refusals [--count N] [--seed N] [COMMAND...]``; without ``--count``, every allocation.

A run comes to that moment once. There it divides, once for each allocation, so that this costs no more than what is
left of the run. How many there are, a first process tells, which asks at its end for what is left of a large number.
"""

from __future__ import annotations

import _testcapi
import argparse
import hashlib
import json
import operator
import os
import random
import shutil
import sys
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from itertools import repeat
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NoReturn

from prag_asp.cli.exits import Exit
from prag_asp.space.engines import automaton_engine
from tests.fuzz.isolated import Limits, Ran, command, run, warm
from tests.output.faults import content

LAMP = """
class(lamp). entity(one,lamp). fluent(on). action(on;off;wave).
precondition(on,on,false). postcondition(on,on,true). initially(on,false).
precondition(off,on,true). postcondition(off,on,false). postcondition(wave,on,true).
"""
COMMANDS: Mapping[str, tuple[str, ...]] = {
    "cache": ("count", "blocks", "-n", "2"),
    "stats": ("stats", "lamp.lp", "-n", "1", "--no-cache", "-o", "figures.txt"),
    "export": ("export", "lamp.lp", "-n", "1", "-o", "plans.cnf"),
    "new": ("new", "mine"),
    "pddl": ("export", "pddl", "lamp.lp", "-o", "planning"),
    "enumerate": ("enumerate", "lamp.lp", "-n", "1", "--no-cache", "-o", "listed.txt"),
    "sample": ("sample", "lamp.lp", "-n", "1", "--no-physics", "--count", "2", "--no-cache", "-o", "drawn.txt"),
}
VARIABLES = {"PRAG_ASP_CACHE": "kept", "COLUMNS": "200"}
LIMITS = Limits(20_000.0, 4 * 10**9)
UNTOLD = 0.1
"""The share of allocations at which native code may take the failure for something else, and say so."""

LATER = 1 << 22
"""An allocation that none of these commands comes to."""

Pick = Callable[[int], Sequence[int]]


@dataclass(frozen=True)
class Refused:
    """What became of a command to which an allocation was refused; `left` is the digest of its files."""

    allocation: int
    code: int
    out: str
    err: str
    left: str

    def told(self, notes: str) -> bool:
        """Whether it was told in one line beside notes, and by the code of a limit, or did no harm.

        Of a signal, the process tells that watches over the command, and that is not there.
        """
        if self.code < 0:
            return not self.err
        lines = [line for line in self.err.splitlines() if line not in notes]
        return (self.code, len(lines)) in ((Exit.LIMIT, 1), (Exit.DONE, 0))


def keeping(arguments: tuple[str, ...]) -> Callable[[], None]:
    """Return what runs a command that keeps what it has explored, however soon that was done."""

    def work() -> None:
        automaton_engine.WORTH_KEEPING = -1.0
        begin()

    begin = command(arguments)
    return work


def divided(arguments: tuple[str, ...], pick: Pick, home: Path) -> Callable[[], None]:
    """Return what runs a command up to its first file, and from there with each allocation refused that is picked."""

    def work() -> None:
        from prag_asp.cli import exit_control, supervision

        begin, open_really, divides, tell = keeping(arguments), os.open, True, list[int]()
        supervision.supervise = lambda: exit_control.begin(
            exit_control.Board()
        )  # its process would not divide with the command

        def opened(path: Any, flags: int, *more: Any, **others: Any) -> int:
            nonlocal divides
            if divides and ".part" in str(path) and flags & os.O_CREAT:
                divides = False
                _divide(pick, home, tell)
            return open_really(path, flags, *more, **others)

        def ended(code: object) -> NoReturn:
            if tell:
                os.write(tell[0], str(_unused()).encode())
            _testcapi.remove_mem_hooks()  # What follows is Python's own end.
            raise SystemExit(code)

        os.open, sys.exit = opened, ended
        begin()

    return work


def _unused() -> int:
    """Return how many allocations more there are until one is refused."""
    more = repeat(None, LATER)  # counts without an allocation of its own
    try:
        for _ in more:
            object()
    except MemoryError:
        return LATER - operator.length_hint(more)
    raise AssertionError


def _divide(pick: Pick, home: Path, tell: list[int]) -> None:
    """Go on in processes to which an allocation is refused; the first has where to tell what it did not use."""
    shutil.copytree(".", home / "before")
    numbers = iter([LATER])
    with (home / "told").open("w", buffering=1) as told:
        while (number := next(numbers, None)) is not None:
            reader, writer = os.pipe()
            child = os.fork()
            if not child:
                for stream, file in enumerate((home / "out", home / "err"), 1):
                    os.dup2(os.open(file, os.O_WRONLY | os.O_CREAT | os.O_TRUNC), stream)
                tell += [writer] if number == LATER else []
                _testcapi.set_nomemory(number, number + 1)
                return
            os.close(writer)
            unused = int(os.read(reader, 20) or 0)
            os.close(reader)
            code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
            out, err = ((home / file).read_text(errors="replace") for file in ("out", "err"))
            met = Refused(number, code, out, err, _kept(home / "left"))
            told.write(f"{json.dumps(asdict(met))}\n")
            if number == LATER:
                numbers = iter(pick(LATER - unused + 1))
            _put_back(home / "before")
    os._exit(0)


def _kept(folder: Path) -> str:
    """Keep a copy of what is in this folder below another one, under its digest, and return that."""
    digest = hashlib.sha256(repr(content(Path())).encode()).hexdigest()[:16]
    if not (folder / digest).exists():
        shutil.copytree(".", folder / digest)
    return digest


def _put_back(before: Path) -> None:
    for path in Path().iterdir():
        shutil.rmtree(path) if path.is_dir() else path.unlink()
    shutil.copytree(before, ".", dirs_exist_ok=True)


def refusals(name: str, pick: Pick, home: Path) -> list[tuple[Refused, bool]]:
    """Refuse a command the allocations that `pick` takes of so many, and return what became of it, and if it was told.

    Raises:
        AssertionError: a file was cut, or the second run did not end as one that nothing was refused.
    """
    folder, arguments = home / "work", COMMANDS[name]
    folder.mkdir(parents=True)
    (folder / "lamp.lp").write_text(LAMP)
    ran = run(divided(arguments, pick, home), folder, LIMITS, variables=VARIABLES)
    assert (ran.code, ran.err) == (0, b""), (name, ran)
    met = [Refused(**json.loads(line)) for line in (home / "told").read_text().splitlines()]
    right, *met = met
    whole, before = content(home / "left" / right.left), content(home / "before")
    for left in {each.left for each in met} - {right.left}:
        second = _second(arguments, home / "left" / left, before, whole, name)
        assert (second.code, second.out.decode()) == (right.code, right.out), (name, second)
    for each in met:
        assert each.code != Exit.DONE or (each.left, each.out) == (right.left, right.out), (name, each)
    return [(each, each.told(right.err)) for each in met]


def _second(
    arguments: tuple[str, ...], folder: Path, before: Mapping[str, bytes], whole: Mapping[str, bytes], name: str
) -> Ran:
    """Run a command once more where a refusal has left its files."""
    left = content(folder)
    cut = [file for file, text in left.items() if ".part" not in file]
    assert all(left[file] in (before.get(file), whole.get(file)) for file in cut), (name, cut)
    second = run(keeping(arguments), folder, LIMITS, variables=VARIABLES)
    assert content(folder) == whole, (name, sorted(left), second)
    return second


def spread(count: int, seed: int) -> Pick:
    """Return what picks so many allocations, each of which stands for as many as any other; all, where they are few."""

    def pick(total: int) -> Sequence[int]:
        chance = random.Random(seed)
        if total <= count:
            return range(1, total + 1)
        return [chance.randrange(total * each // count, total * (each + 1) // count) + 1 for each in range(count)]

    return pick


def main(arguments: Sequence[str]) -> int:
    """Run the campaign that a command line asks for, and return 1 where too much was told otherwise."""
    parser = argparse.ArgumentParser(prog="python -m tests.output.refusals", description=__doc__)
    parser.add_argument("--count", type=int, default=LATER, help="How many allocations of each command; all without.")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("commands", nargs="*", metavar="COMMAND", help=f"of {', '.join(COMMANDS)}; all by default")
    given = parser.parse_args(arguments)
    warm()
    odd: Counter[str] = Counter()
    too_many = False
    for name in given.commands or COMMANDS:
        with TemporaryDirectory() as made:
            met = refusals(name, spread(given.count, given.seed), Path(made))
        for each, told in met:
            if not told:
                odd[f"{name}: {each.code}: {(each.err.splitlines() or ['nothing'])[-1][:200]}"] += 1
                sys.stderr.write(f"{name}, allocation {each.allocation}: {each.code}: {each.err}\n")
        codes = ", ".join(f"{number} with code {code}" for code, number in Counter(m.code for m, _ in met).items())
        sys.stdout.write(
            f"{name:10} {len(met)} allocations: {codes}; {sum(not told for _, told in met)} told otherwise\n"
        )
        sys.stdout.flush()
        too_many |= sum(not told for _, told in met) > UNTOLD * len(met)
    for what, number in odd.most_common():
        sys.stdout.write(f"{number:5} {what}\n")
    sys.stdout.write("no file was cut, and every second run ended with the same bytes\n")
    return 1 if too_many else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
