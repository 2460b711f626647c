"""The memory of the machine, and the memory and processor time of processes, as Linux reports them."""

from __future__ import annotations

import os
import signal
import sys
from math import inf

SHARE = 80
"""The percentage of the machine's memory that a command may use by default."""

FALLBACK = 4 * 10**9
"""The number of bytes of memory that a machine is assumed to have if the system does not report it."""


def usual_memory() -> int:
    """Return the default memory limit of a command in bytes: a share of the memory of the machine or control group."""
    return machine_memory() * SHARE // 100


def machine_memory() -> int:
    """Return the memory of the machine in bytes, or of the control group of this process if that is less."""
    try:
        found = [os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")]
    except (ValueError, OSError):
        found = [FALLBACK]
    # the control groups (version 1 and 2) of this process
    for line in _lines("/proc/self/cgroup"):
        number, _, rest = line.partition(":")
        controllers, _, path = rest.partition(":")
        if number == "0" and not controllers:
            root, name = "/sys/fs/cgroup", "memory.max"
        elif "memory" in controllers.split(","):
            root, name = "/sys/fs/cgroup/memory", "memory.limit_in_bytes"
        else:
            continue
        # In a container, the path may be the host's; in that case, the root is the container's own group.
        parts = [part for part in path.split("/") if part]
        for depth in range(len(parts) + 1):
            place = "/".join([root, *parts[:depth], name])
            found += [int(text) for text in _lines(place) if text.isdecimal() and int(text)]
    return min(found)


def memory_of(processes: list[int]) -> int:
    """Return the resident memory of processes in bytes; a process that is gone counts as 0."""
    pages = 0
    for process in processes:
        try:
            with open(f"/proc/{process}/statm", "rb") as file:  # noqa: PTH123  read twenty times a second
                pages += int(file.read().split()[1])
        except (OSError, ValueError, IndexError):
            continue
    return pages * os.sysconf("SC_PAGE_SIZE")


def memory_in_use() -> int:
    """Return the resident memory of this process in bytes, or its peak if the system reports only the peak."""
    now = memory_of([os.getpid()])
    if now:
        return now
    import resource  # noqa: PLC0415

    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak if sys.platform == "darwin" else peak * 1024


def processor_time_of(process: int) -> float:
    """Return the processor time of a process in seconds, over all threads; infinity if it is gone or not reported."""
    try:
        with open(f"/proc/{process}/stat", "rb") as file:  # noqa: PTH123  read twenty times a second
            fields = file.read().rpartition(b")")[2].split()  # after the name, which may contain blanks
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
    except (OSError, ValueError, IndexError):
        return inf


def family_of(process: int) -> list[int]:
    """Return the ids of a process and of all its descendants."""
    found = [process]
    for each in found:
        try:
            threads = os.listdir(f"/proc/{each}/task")  # noqa: PTH208
        except OSError:
            continue
        for thread in threads:
            for line in _lines(f"/proc/{each}/task/{thread}/children"):
                found += map(int, line.split())
    return found


def signal_name(number: int) -> str:
    """Return the name of a signal, such as SIGKILL, or its number if it has none."""
    try:
        return signal.Signals(number).name
    except ValueError:
        return f"signal {number}"


def _lines(path: str) -> list[str]:
    try:
        with open(path, encoding="ascii", errors="replace") as file:  # noqa: PTH123
            return file.read().splitlines()
    except OSError:
        return []
