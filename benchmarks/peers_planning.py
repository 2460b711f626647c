"""Count the plans of a planning task: python benchmarks/peers_planning.py SECONDS TOOL DOMAIN PROBLEM LENGTH.

It runs in a process of its own. Each tool is timed from the two files in PDDL to the count: reading, grounding and all.
"""

from __future__ import annotations

import re
import resource
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

from peers_counting import by_ganak
from peers_process import limit_processor_time, tell, timed

from prag_asp import TaskSpace, load_domain

MEMORY = 4 * 2**30
FOUND = re.compile(r"Plan length: (\d+) step")


def by_engine(name: str) -> Callable[[Path, Path, int], int]:
    """Return how one of our engines counts."""

    def count(domain: Path, problem: Path, length: int) -> int:
        read = load_domain(domain, problem)
        tell(accepted=True)
        return TaskSpace(read, length, engine=name).count("plan")

    return count


def by_pyganak(domain: Path, problem: Path, length: int) -> int:
    """Count the models of our clauses with pyganak, projected."""
    return by_ganak(load_domain(domain, problem), "plan", length)


def by_kstar(domain: Path, problem: Path, length: int) -> int:
    """Have K* list all plans of least cost; no other lengths can be asked for."""
    from kstar_planner import planners  # noqa: PLC0415

    found = planners.plan_topq(domain, problem, quality_bound=1.0)
    plans = [plan for plan in found["plans"] if len(plan["actions"]) == length]
    if not plans or found["timeout_triggered"]:
        raise SystemExit("no plans")
    return len(plans)


def shortest(domain: Path, problem: Path, _length: int) -> int:
    """Return how long the shortest plan is that Fast Downward finds.

    Raises:
        SystemExit: it finds none.
    """
    import up_fast_downward  # noqa: PLC0415

    driver = Path(up_fast_downward.__file__).parent / "downward" / "fast-downward.py"
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, str(driver), str(domain), str(problem), "--search", "astar(lmcut())"]
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    told = FOUND.search(done.stdout)
    if told is None:
        raise SystemExit("no plan was found")
    return int(told[1])


TOOLS: dict[str, Callable[[Path, Path, int], int]] = {
    "prag_asp": by_engine("auto"),
    "clingo": by_engine("clingo"),
    "pyganak": by_pyganak,
    "kstar": by_kstar,
    "shortest": shortest,
}


def main() -> None:
    """Count, and tell the count and the seconds."""
    seconds, tool, domain, problem, length = sys.argv[1:]
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    limit_processor_time(float(seconds))
    count, taken = timed(lambda: TOOLS[tool](Path(domain), Path(problem), int(length)))
    tell(count=count, seconds=taken)


if __name__ == "__main__":
    main()
