"""Kill commands that write, at random moments, and start them again: no file is cut, and all end with the same bytes.

``python -m tests.output.kills [--count N] [--seed N] [COMMAND...]`` does so N times, by turns over the commands.
"""

from __future__ import annotations

import argparse
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

from tests.commands import PRAG
from tests.output.faults import content
from tests.processes import computed, family

OLD = b"% what was there before\n"

TASKS = ("sample", "tabletop", "-n", "3", "--seed", "3", "--format", "jsonl")
DATA = ("generate", "tabletop", "-n", "1..2", "--seed", "3", "--tasks", "10", "--budget", "2x2")
COMMANDS: Mapping[str, tuple[str, ...]] = {
    "sample": (*TASKS, "--count", "12", "--demonstrate", "recorded", "-o", "drawn.jsonl"),
    "enumerate": ("enumerate", "prag", "-n", "7", "--format", "jsonl", "--limit", "12000", "-o", "listed.jsonl"),
    "validate": ("validate", "tasks.jsonl", "-o", "report.txt"),
    "split": ("split", "prag", "-n", "8", "train=0.8", "test=0.2", "--count", "6000", "-o", "parts"),
    "render": ("render", "tasks.jsonl", *map(str, range(1, 9)), "--size", "160x120", "-o", "pictures"),
    "generate": (
        *DATA, "--split", "train=0.5,test=0.5", "--shard", "2", "--starts", "2", "--demonstrate", "-o", "data",
    ),
    "merge": ("merge", "one", "two", "-o", "data"),
    "learn": ("learn", "mine", "-n", "2", "--count", "12", "--write"),
}  # fmt: skip
GROWS = frozenset(["data/dataset.json"])
"""Files that say how far a run is: each is whole JSON at every moment, and has its last bytes at the end."""

BEFORE = {
    "enumerate": ["listed.jsonl"],
    "validate": ["report.txt"],
    "split": ["parts/train.txt", "parts/test.txt"],
    "render": ["pictures/000001.png"],
    "learn": ["mine/learned.lp"],
}
"""Files that are there before a command writes them."""


WROTE = "while it wrote"
"""How a command is to be met: a file was begun that was not whole."""

ATTEMPTS = 5
"""Moments that are chosen for one kill, at most: a busy machine computes for longer than the undisturbed run did."""

AFTERWARDS = 0.02
"""Seconds for which a command goes on after the moment, at most."""


class Running(NamedTuple):
    """A command that is running, and where it writes."""

    process: subprocess.Popen[str]
    folder: Path


@dataclass(frozen=True)
class Reference:
    """What a command leaves that nobody disturbs: its exit code, its files, when it writes first and ends.

    These moments are seconds that it has computed with its children, which a busy machine stretches least.
    """

    code: int
    files: Mapping[str, bytes]
    first: float
    end: float


def prepare(folder: Path, names: Sequence[str]) -> None:
    """Write what the commands read."""
    if "merge" in names:
        for part, name in (("1/2", "one"), ("2/2", "two")):
            make = [*PRAG, *DATA, "--shard", "2", "--part", part, "-o", name]
            subprocess.run(make, cwd=folder, check=True, capture_output=True)
    if not {"validate", "render", "learn"} & {*names}:
        return
    for arguments in ((*TASKS, "--count", "24", "-o", "tasks.jsonl"), ("new", "mine")):
        subprocess.run([*PRAG, *arguments], cwd=folder, check=True, capture_output=True)


def place(name: str, prepared: Path, folder: Path) -> None:
    """Fill a folder with what a command reads, and with old files in place of those that it writes."""
    shutil.copytree(prepared, folder)
    for file in BEFORE.get(name, ()):
        (folder / file).parent.mkdir(exist_ok=True)
        (folder / file).write_bytes(OLD)


def started(name: str, folder: Path) -> subprocess.Popen[str]:
    """Start a command in a session of its own."""
    return subprocess.Popen(
        [*PRAG, *COMMANDS[name]], cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
        env={**os.environ, "PRAG_ASP_CACHE": ""}, start_new_session=True,
    )  # fmt: skip


def undisturbed(name: str, prepared: Path, folder: Path) -> Reference:
    """Run a command to its end."""
    place(name, prepared, folder)
    first, latest = None, 0.0
    process = started(name, folder)
    while process.poll() is None:
        latest = max(latest, seconds(process))
        if first is None and any(folder.rglob("*.part")):
            first = latest
        time.sleep(0.01)
    assert process.stderr is not None
    assert process.returncode in (0, 1), process.stderr.read()
    process.stderr.close()
    return Reference(process.returncode, content(folder), latest / 2 if first is None else first, latest)


def seconds(process: subprocess.Popen[str]) -> float:
    """Return for how many seconds a process and those that it has started have computed; 0 where it has ended."""
    return sum(map(computed, family(process.pid)))


def faults(found: Mapping[str, bytes], before: Mapping[str, bytes], whole: Mapping[str, bytes]) -> list[str]:
    """Return the files that are neither what they were nor what they are to be; parts are not looked into."""
    ours = {name: text for name, text in found.items() if ".part" not in name}
    for name in GROWS & ours.keys():
        assert json.loads(ours.pop(name))
    return [name for name, text in ours.items() if text not in (before.get(name), whole.get(name))]


def moment_of(reference: Reference, found: Mapping[str, bytes], chance: random.Random) -> Callable[[Running], bool]:
    """Return what tells a random moment of a command: so much is computed, or a file is there that is not `found` yet.

    The second kind comes close to the last steps, each of which writes a file and takes hardly any time.
    """
    missing = sorted(name for name, text in reference.files.items() if found.get(name) != text)
    if missing and chance.random() < 0.5:
        name = chance.choice(missing)
        before = found.get(name)
        return lambda running: _read(running.folder / name) not in (None, before)
    moment = chance.uniform(0.9 * reference.first, reference.end)
    return lambda running: seconds(running.process) >= moment


def _read(path: Path) -> bytes | None:
    return path.read_bytes() if path.is_file() else None


def kill(name: str, folder: Path, reference: Reference, chance: random.Random) -> str:
    """Start a command, kill it at a random moment, and return how it was met.

    Raises:
        AssertionError: a file was cut.
    """
    before = content(folder)
    comes = moment_of(reference, before, chance)
    process = started(name, folder)
    running = Running(process, folder)
    while process.poll() is None and not comes(running):
        time.sleep(0.002)
    time.sleep(chance.uniform(0.0, AFTERWARDS))
    with suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
    process.communicate()
    found = content(folder)
    cut = faults(found, before, reference.files)
    assert not cut, f"{name}: cut: {cut}"
    if any(".part" in file for file in found):
        return WROTE
    return "not: all was written" if found == reference.files else "before it wrote"


def kill_once(name: str, prepared: Path, folder: Path, reference: Reference, chance: random.Random) -> str:
    """Kill a command at a random moment, once or twice, run it to its end, and return how it was met.

    A moment that is not while it writes is chosen anew, up to `ATTEMPTS` times, from the beginning on.

    Raises:
        AssertionError: a file was cut, or the end is not that of a run that nobody disturbs.
    """
    for _ in range(ATTEMPTS):
        shutil.rmtree(folder, ignore_errors=True)
        place(name, prepared, folder)
        met = [kill(name, folder, reference, chance) for _ in range(chance.choice((1, 1, 2)))]
        if WROTE in met:
            met = [WROTE]
            break
    process = started(name, folder)
    told = process.communicate()[1]
    assert process.returncode == reference.code, f"{name}: {process.returncode}: {told}"
    left = content(folder)
    assert left.keys() == reference.files.keys(), f"{name}: {sorted(left.keys() ^ reference.files.keys())}"
    different = [file for file, text in left.items() if text != reference.files[file]]
    assert not different, f"{name}: other bytes: {different}"
    return f"{met[-1]}, and was resumed" if "goes on after" in told else met[-1]


def campaign(count: int, seed: int, names: Sequence[str]) -> Counter[tuple[str, str]]:
    """Kill commands by turns, and return how often each was met in which state.

    Raises:
        AssertionError: a file was cut, or the end is not that of a run that nobody disturbs.
    """
    chance, met = random.Random(seed), Counter[tuple[str, str]]()
    with TemporaryDirectory() as made:
        home = Path(made)
        (home / "prepared").mkdir()
        prepare(home / "prepared", names)
        references = {name: undisturbed(name, home / "prepared", home / name) for name in names}
        for number in range(count):
            name = names[number % len(names)]
            folder = home / str(number)
            how = kill_once(name, home / "prepared", folder, references[name], chance)
            met[name, how] += 1
            sys.stderr.write(f"{number + 1}: {name} was killed {how}\n")
            shutil.rmtree(folder)
    return met


def main(arguments: Sequence[str]) -> None:
    """Run the campaign that a command line asks for."""
    parser = argparse.ArgumentParser(prog="python -m tests.output.kills", description=__doc__)
    parser.add_argument("--count", type=int, default=40)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("commands", nargs="*", metavar="COMMAND", help=f"of {', '.join(COMMANDS)}; all by default")
    given = parser.parse_args(arguments)
    met = campaign(given.count, given.seed, given.commands or list(COMMANDS))
    for (name, how), times in sorted(met.items()):
        sys.stdout.write(f"{name:10} killed {times:3} times {how}\n")
    sys.stdout.write(f"{given.count} kills: no file was cut, and every run ended with the same bytes\n")


if __name__ == "__main__":
    main(sys.argv[1:])
