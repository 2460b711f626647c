"""Run one peer in a process of its own, with a time limit: one that hangs, aborts or is missing harms no other."""

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
"""What a line with a result begins with: some peers write noise to stdout."""

PATIENCE = 8
"""How much longer by the clock than in processor time a peer may take: the machine may be busy."""


@dataclass(frozen=True)
class Run:
    """The results of one peer, in the order in which it told them, and why there are no more, if there are none."""

    results: tuple[dict[str, Any], ...]
    failure: str


def measured(script: Path, arguments: Sequence[str], limit: float) -> Run:
    """Run a script until it ends or has used up its processor time, and return the results that it told until then."""
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
        failure = f"not finished after {PATIENCE * limit:g} s by the clock"
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
    """Have the system end this process once it has used up some seconds of processor time."""
    soft = math.ceil(processor_seconds() + seconds)
    resource.setrlimit(resource.RLIMIT_CPU, (soft, soft + 1))


def tell(**result: Any) -> None:
    """Tell a result to the process that measures."""
    sys.stdout.write(f"\n{MARK}{json.dumps(result)}\n")
    sys.stdout.flush()


def processor_seconds() -> float:
    """Return the seconds of processor time of this process and of those that it has waited for."""
    used = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(each.ru_utime + each.ru_stime for each in used)


def timed(work: Callable[[], Any]) -> tuple[Any, float]:
    """Return the result of some work, and the seconds of processor time that it took."""
    begun = processor_seconds()
    result = work()
    return result, processor_seconds() - begun


def lengths_up_to(last: int) -> Iterator[int]:
    """Yield the lengths that an enumerator tries, one after the other."""
    yield from range(5, last + 1)
