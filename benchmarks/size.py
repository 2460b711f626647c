"""Time and memory for counting large spaces, measured on whole processes: python benchmarks/size.py."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from time import perf_counter

from rich.console import Console
from rich.table import Table

HERE = Path(__file__).parent
RUNS = 7
"""The number of runs of the small case; the table shows the minimum and the median."""

LARGE: tuple[tuple[str, str, dict[str, int], int, str], ...] = (
    ("lamps, 10^6 states", "lamps", {"lamps": 20}, 20, "plan"),
    ("8 objects, 9 places of one each", "places", {"objects": 8, "places": 9}, 20, "plan"),
    ("100 objects, unread places", "transport", {"objects": 100}, 15, "plan"),
    ("the same", "transport", {"objects": 100}, 15, "task"),
    ("100 objects, 4 places, 2 poses", "storage", {"objects": 100}, 15, "plan"),
    ("the same", "storage", {"objects": 100}, 15, "task"),
    ("10 objects, 4 places, 2 poses", "storage", {"objects": 10}, 60, "plan"),
    ("20 blocks in towers", "towers", {"blocks": 20}, 30, "plan"),
    ("the same", "towers", {"blocks": 20}, 20, "task"),
    ("40 blocks in towers", "towers", {"blocks": 40}, 15, "plan"),
    ("the same", "towers", {"blocks": 40}, 15, "task"),
    ("1,000 cubes, small-model reduction", "cubes", {"cubes": 1000}, 7, "plan"),
    ("the same", "cubes", {"cubes": 1000}, 7, "task"),
)
"""For each case: a description, the folder, its constants, the length and the level."""


@dataclass(frozen=True)
class Run:
    """The output of a process, its wall-clock and processor time in seconds, and its peak memory in bytes."""

    answer: str
    seconds: float
    processor: float
    memory: int


def run(arguments: Sequence[str], cache: str = "") -> Run:
    """Run `prag-asp` with a cache folder, or without a cache."""
    begun = perf_counter()
    process = subprocess.Popen(
        [sys.executable, "-c", "from prag_asp.cli import main; main()", *arguments],
        stdout=subprocess.PIPE,
        env={**os.environ, "PRAG_ASP_CACHE": cache},
        text=True,
    )
    assert process.stdout is not None
    answer = process.stdout.read().strip()
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode:
        raise SystemExit(f"prag-asp {' '.join(arguments)} failed")
    return Run(answer, perf_counter() - begun, usage.ru_utime + usage.ru_stime, usage.ru_maxrss * 1024)


def copy_domain(folder: str, constants: dict[str, int], target: Path) -> Path:
    """Copy a benchmark's domain with different constants, and return its folder."""
    text = (HERE / folder / "domain.lp").read_text(encoding="utf-8")
    for name, value in constants.items():
        text = re.sub(rf"#const {name} = \d+\.", f"#const {name} = {value}.", text)
    copy = target / "_".join([folder, *map(str, constants.values())])
    copy.mkdir(exist_ok=True)
    (copy / "domain.lp").write_text(text, encoding="utf-8")
    return copy


def small(cache: Path) -> Iterator[tuple[str, ...]]:
    """Yield the rows of the small case: with an empty cache, then with a filled cache."""
    arguments = ["count", "prag", "--length", "15", "--by", "skeleton"]
    cold = [run(arguments, str(cache / f"cold_{number}")) for number in range(RUNS)]
    run(arguments, str(cache / "warm"))
    warm = [run(arguments, str(cache / "warm")) for _ in range(RUNS)]
    for name, runs in (("prag, skeletons, cold", cold), ("the same again", warm)):
        seconds = [each.seconds for each in runs]
        best = f"{min(seconds):.2f}, median {median(seconds):.2f}"
        processor = f"{min(each.processor for each in runs):.2f}"
        yield name, "15", runs[0].answer, best, processor, f"{runs[0].memory / 1e6:.0f}", ""


def main() -> None:
    """Print the table."""
    table = Table("space", "length", "count", "seconds", "processor, s", "MB", "again, s")
    with TemporaryDirectory() as folder:
        place = Path(folder)
        for row in small(place / "small"):
            table.add_row(*row)
        for name, source, constants, length, level in LARGE:
            domain = copy_domain(source, constants, place)
            arguments = ["count", str(domain), "--length", str(length), "--by", level]
            first = run(arguments, str(place / "large"))
            again = run(arguments, str(place / "large"))
            assert first.answer == again.answer
            count = int(first.answer)
            shown = f"{count:,}" if count < 10**13 else f"{first.answer[0]}.{first.answer[1:3]}e{len(first.answer) - 1}"
            table.add_row(
                name,
                f"{length} {level}s",
                shown,
                f"{first.seconds:.1f}",
                f"{first.processor:.1f}",
                f"{first.memory / 1e6:,.0f}",
                f"{again.seconds:.1f}",
            )
    Console(width=120).print(table)


if __name__ == "__main__":
    main()
