"""Count the plans of a planning task: python benchmarks/peers_planning.py SECONDS TOOL DOMAIN PROBLEM LENGTH SHORTEST.

It runs in a process of its own. Each tool is timed from the two files in PDDL to the count: reading, grounding and all.
"""

from __future__ import annotations

import re
import resource
import subprocess
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from peers_counting import by_ganak
from peers_process import limit_processor_time, tell, timed
from planning_answers import UNFINISHED

from prag_asp import Limits, TaskSpace, load_domain

MEMORY = 4 * 2**30
FOUND = re.compile(r"Plan length: (\d+) step")
UNSUPPORTED = 34
"""The code with which Fast Downward ends where an estimate does not know what a task has."""

OUT_OF_TIME = {21, 23}
"""The codes with which it ends where it has used up its processor time, translating or searching."""


@dataclass(frozen=True)
class Question:
    """A domain, a problem, a number of actions, the smallest number that reaches the goal, and processor seconds."""

    domain: Path
    problem: Path
    length: int
    shortest: int
    seconds: float


def by_engine(name: str) -> Callable[[Question], int]:
    """Return how one of our engines counts."""

    def count(asked: Question) -> int:
        read = load_domain(asked.domain, asked.problem)
        tell(accepted=True)
        return TaskSpace(read, asked.length, engine=name, limits=Limits(cached=False)).count("plan")

    return count


def by_pyganak(asked: Question) -> int:
    """Count the models of our clauses with pyganak, projected."""
    return by_ganak(load_domain(asked.domain, asked.problem), "plan", asked.length)


def by_kstar(asked: Question) -> int:
    """Have K* list all plans up to a length, and count those that have it.

    Raises:
        SystemExit: there is none, the list is not whole, or the planner, a process of its own, used up its time.
    """
    from kstar_planner import planners  # noqa: PLC0415

    bound = (asked.length + 0.5) / asked.shortest if asked.length > asked.shortest else 1.0
    found = planners.plan_topq(asked.domain, asked.problem, quality_bound=bound)
    plans = [plan for plan in found["plans"] if len(plan["actions"]) == asked.length]
    if not plans or found["timeout_triggered"]:
        used = resource.getrusage(resource.RUSAGE_CHILDREN)
        out_of_time = used.ru_utime + used.ru_stime >= asked.seconds
        raise SystemExit(f"{UNFINISHED} after {asked.seconds:g} s" if out_of_time else "no plans")
    return len(plans)


def shortest(asked: Question) -> int:
    """Return how long the shortest plan is that Fast Downward finds.

    Its best estimate knows nothing of effects that depend on the state, nor of derived predicates; then it has none.

    Raises:
        SystemExit: it finds none.
    """
    import up_fast_downward  # noqa: PLC0415

    driver = Path(up_fast_downward.__file__).parent / "downward" / "fast-downward.py"
    for estimate in ("lmcut", "blind"):
        with tempfile.TemporaryDirectory() as folder:
            command = [sys.executable, str(driver), str(asked.domain), str(asked.problem)]
            search = ["--search", f"astar({estimate}())"]
            done = subprocess.run([*command, *search], cwd=folder, capture_output=True, text=True, check=False)
        if done.returncode != UNSUPPORTED:
            break
    found = FOUND.search(done.stdout)
    if found is None:
        raise SystemExit(UNFINISHED if done.returncode in OUT_OF_TIME else "no plan was found")
    return int(found[1])


TOOLS: dict[str, Callable[[Question], int]] = {
    "prag_asp": by_engine("auto"),
    "clingo": by_engine("clingo"),
    "pyganak": by_pyganak,
    "kstar": by_kstar,
    "shortest": shortest,
}


def main() -> None:
    """Count, and tell the count and the seconds."""
    seconds, tool, domain, problem, length, least = sys.argv[1:]
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    limit_processor_time(float(seconds))
    asked = Question(Path(domain), Path(problem), int(length), int(least), float(seconds))
    count, taken = timed(lambda: TOOLS[tool](asked))
    tell(count=count, seconds=taken)


if __name__ == "__main__":
    main()
