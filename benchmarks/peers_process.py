"""Run one tool in a separate process with a time limit, so that a hang or a crash does not affect the others."""

from __future__ import annotations

import json
import math
import os
import resource
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

MARK = "RESULT "
"""The prefix of a line with a result: some tools write other text to stdout."""

PATIENCE = 8
"""The wall-clock limit as a multiple of the limit of processor time, because the machine may be busy."""


@dataclass(frozen=True)
class Run:
    """The results of one tool in the order of their reports, and the reason if it failed."""

    results: tuple[dict[str, Any], ...]
    failure: str


def measured(script: Path, arguments: Sequence[str], limit: float) -> Run:
    """Run a script until it ends or exceeds its processor time, and return the results that it has reported."""
    process = subprocess.Popen(
        [sys.executable, str(script), str(limit), *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        errors="replace",
        start_new_session=True,
    )
    failure = ""
    try:
        printed, complaint = process.communicate(timeout=PATIENCE * limit)
    except subprocess.TimeoutExpired:
        failure = f"not finished after {PATIENCE * limit:g} s of wall-clock time"
    finally:
        with suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
    if failure:
        printed, complaint = process.communicate()
    elif process.returncode in (-signal.SIGXCPU, -signal.SIGKILL):
        failure = f"not finished after {limit:g} s"
    elif process.returncode:
        failure = (complaint.strip().splitlines() or [f"ended with code {process.returncode}"])[-1]
    lines = (line.removeprefix(MARK) for line in printed.splitlines() if line.startswith(MARK))
    results = tuple(json.loads(line) for line in lines if line.endswith("}"))
    return Run(results, failure or ("" if results else "ended without a result"))


def limit_processor_time(seconds: float) -> None:
    """Set a limit of `seconds` more of processor time for this process."""
    soft = math.ceil(processor_seconds() + seconds)
    resource.setrlimit(resource.RLIMIT_CPU, (soft, soft + 1))


def report(**result: Any) -> None:
    """Report a result to the measuring process."""
    sys.stdout.write(f"\n{MARK}{json.dumps(result)}\n")
    sys.stdout.flush()


def processor_seconds() -> float:
    """Return the seconds of processor time of this process and of its ended children."""
    usages = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(each.ru_utime + each.ru_stime for each in usages)


def timed(work: Callable[[], Any]) -> tuple[Any, float]:
    """Return the result of a function, and the seconds of processor time that it took."""
    begun = processor_seconds()
    result = work()
    return result, processor_seconds() - begun


def lengths_up_to(last: int) -> Iterator[int]:
    """Yield the lengths for an enumerator, in order."""
    yield from range(5, last + 1)
