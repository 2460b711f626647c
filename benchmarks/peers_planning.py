"""Count the plans of a planning task: python benchmarks/peers_planning.py SECONDS TOOL DOMAIN PROBLEM LENGTH SHORTEST.

Each tool runs in a separate process, timed from the two PDDL files to the count, including parsing and grounding.
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
from peers_process import limit_processor_time, report, timed
from planning_answers import UNFINISHED

from prag_asp import Limits, TaskSpace, load_domain

MEMORY = 4 * 2**30
PLAN_LENGTH = re.compile(r"Plan length: (\d+) step")
UNSUPPORTED = 34
"""The exit code of Fast Downward if a heuristic does not support a feature of a task."""

OUT_OF_TIME = {21, 23}
"""Its exit codes if it exceeds the processor time, in translation or in search."""


@dataclass(frozen=True)
class Question:
    """A domain, a problem, a plan length, the shortest plan length, and the limit in processor seconds."""

    domain: Path
    problem: Path
    length: int
    shortest: int
    seconds: float


def by_engine(name: str) -> Callable[[Question], int]:
    """Return a function that counts with one of our engines."""

    def count(question: Question) -> int:
        domain = load_domain(question.domain, question.problem)
        report(accepted=True)
        return TaskSpace(domain, question.length, engine=name, limits=Limits(cached=False)).count("plan")

    return count


def by_pyganak(question: Question) -> int:
    """Count the models of our clauses with pyganak, with projection."""
    return by_ganak(load_domain(question.domain, question.problem), "plan", question.length)


def by_kstar(question: Question) -> int:
    """Let K* list all plans up to a length, and count those of that length.

    Raises:
        SystemExit: there is no plan, the list is incomplete, or the planner exceeded its time.
    """
    from kstar_planner import planners  # noqa: PLC0415

    bound = (question.length + 0.5) / question.shortest if question.length > question.shortest else 1.0
    result = planners.plan_topq(question.domain, question.problem, quality_bound=bound)
    plans = [plan for plan in result["plans"] if len(plan["actions"]) == question.length]
    if not plans or result["timeout_triggered"]:
        used = resource.getrusage(resource.RUSAGE_CHILDREN)
        out_of_time = used.ru_utime + used.ru_stime >= question.seconds
        raise SystemExit(f"{UNFINISHED} after {question.seconds:g} s" if out_of_time else "no plans")
    return len(plans)


def shortest(question: Question) -> int:
    """Return the length of the shortest plan, found by Fast Downward.

    LM-cut does not support conditional effects and derived predicates; for these the search is blind.

    Raises:
        SystemExit: no plan was found.
    """
    import up_fast_downward  # noqa: PLC0415

    driver = Path(up_fast_downward.__file__).parent / "downward" / "fast-downward.py"
    for heuristic in ("lmcut", "blind"):
        with tempfile.TemporaryDirectory() as folder:
            command = [sys.executable, str(driver), str(question.domain), str(question.problem)]
            search = ["--search", f"astar({heuristic}())"]
            process = subprocess.run([*command, *search], cwd=folder, capture_output=True, text=True, check=False)
        if process.returncode != UNSUPPORTED:
            break
    match = PLAN_LENGTH.search(process.stdout)
    if match is None:
        raise SystemExit(UNFINISHED if process.returncode in OUT_OF_TIME else "no plan was found")
    return int(match[1])


TOOLS: dict[str, Callable[[Question], int]] = {
    "prag_asp": by_engine("auto"),
    "clingo": by_engine("clingo"),
    "pyganak": by_pyganak,
    "kstar": by_kstar,
    "shortest": shortest,
}


def main() -> None:
    """Report the count and the seconds."""
    seconds, tool, domain, problem, length, least = sys.argv[1:]
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    limit_processor_time(float(seconds))
    question = Question(Path(domain), Path(problem), int(length), int(least), float(seconds))
    count, taken = timed(lambda: TOOLS[tool](question))
    report(count=count, seconds=taken)


if __name__ == "__main__":
    main()
