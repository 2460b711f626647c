"""What memory the machine has for us, and what processes take of it, as Linux tells."""

from __future__ import annotations

import os
import sys

SHARE = 80
"""Per cent of the machine's memory that a command takes at most, unless it is told otherwise."""

FALLBACK = 4 * 10**9
"""Bytes that a machine is taken to have which does not tell."""


def usual_memory() -> int:
    """Return the bytes that a command may take where it is not told: a share of what the machine or its group has."""
    return machine_memory() * SHARE // 100


def machine_memory() -> int:
    """Return the bytes that the machine has, or the control group of this process where that is less."""
    try:
        found = [os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")]
    except (ValueError, OSError):
        found = [FALLBACK]
    found += _group_limits()
    return min(found)


def _group_limits() -> list[int]:
    """Return the limits of the control groups that this process belongs to, of both versions."""
    found = []
    for line in _lines("/proc/self/cgroup"):
        number, _, rest = line.partition(":")
        controllers, _, path = rest.partition(":")
        if number == "0" and not controllers:
            root, name = "/sys/fs/cgroup", "memory.max"
        elif "memory" in controllers.split(","):
            root, name = "/sys/fs/cgroup/memory", "memory.limit_in_bytes"
        else:
            continue
        # In a container the path may be the host's: what lies at the root is then its own group.
        parts = [part for part in path.split("/") if part]
        for depth in range(len(parts) + 1):
            place = "/".join([root, *parts[:depth], name])
            found += [int(text) for text in _lines(place) if text.isdecimal() and int(text)]
    return found


def memory_of(processes: list[int]) -> int:
    """Return the bytes that processes have in memory; one that is gone has none."""
    pages = 0
    for process in processes:
        try:
            with open(f"/proc/{process}/statm", "rb") as file:  # noqa: PTH123  read twenty times a second
                pages += int(file.read().split()[1])
        except (OSError, ValueError, IndexError):
            continue
    return pages * os.sysconf("SC_PAGE_SIZE")


def memory_in_use() -> int:
    """Return the memory of this process in bytes: what is resident now, or the most that ever was."""
    now = memory_of([os.getpid()])
    if now:
        return now
    import resource  # noqa: PLC0415

    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak if sys.platform == "darwin" else peak * 1024


def most_addresses() -> int:
    """Return the most bytes of addresses that this process has had, 0 where the system does not tell."""
    sizes = (line.split()[1] for line in _lines("/proc/self/status") if line.startswith("VmPeak:"))
    return 1024 * int(next(sizes, 0))


def family_of(process: int) -> list[int]:
    """Return a process and all that it, or one that it has started, has started."""
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


def _lines(path: str) -> list[str]:
    try:
        with open(path, encoding="ascii", errors="replace") as file:  # noqa: PTH123
            return file.read().splitlines()
    except OSError:
        return []
