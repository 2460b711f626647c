"""Read suites of problems, each from a folder in one of the known formats."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from importlib import import_module
from pathlib import Path

from prag_asp.audit.audited_problem import AuditedProblem
from prag_asp.audit.auditing import BenchmarkAudit, Progress, audit_problems
from prag_asp.audit.problem_checks import AuditFinding
from prag_asp.audit.sources import lerobot_suites
from prag_asp.audit.sources.problem_source import FailedRead, ProblemSource
from prag_asp.errors import QueryError
from prag_asp.processes.progress_events import report_progress

LEROBOT = "LeRobot"
"""The format that has instructions but no problems; their problems are looked up in other suites."""

FORMATS: Mapping[str, str] = {
    "BDDL": "prag_asp.audit.sources.bddl_source",
    "prag_asp datasets": "prag_asp.audit.sources.dataset_suites",
    "PDDL": "prag_asp.audit.sources.pddl_suites",
}
"""The formats, each with its module, which is a `ProblemSource`."""


def read_suites(folders: Sequence[str | Path]) -> tuple[list[AuditedProblem], list[FailedRead]]:
    """Read each folder as a suite with the folder's name; return the problems, and the files that cannot be read.

    Raises:
        QueryError: a folder does not exist, or has no problems in a known format.
    """
    by_format: dict[str, dict[str, Path]] = {}
    names: dict[str, Path] = {}
    for path in map(Path, folders):
        if path.is_file():
            raise QueryError(f"{path}: a file, but audits are of folders; give {path.parent}")
        if not path.is_dir():
            raise QueryError(f"{path}: no such folder; give folders of problems")
        name = _suite_name(path, names)
        names[name] = path
        by_format.setdefault(_format_of(path), {})[name] = path
    texts = [*lerobot_suites.read_texts(by_format.pop(LEROBOT, {}))]
    found = [each for name, suites in by_format.items() for each in _source(name).read(suites)]
    found += lerobot_suites.matched(texts, [each for each in found if isinstance(each, AuditedProblem)])
    order = list(names)
    problems = sorted(
        (each for each in found if isinstance(each, AuditedProblem)), key=lambda each: order.index(each.suite)
    )
    return problems, [each for each in found if isinstance(each, FailedRead)]


def audit(
    *folders: str | Path, train: Sequence[str] = (), reach: bool = True, progress: Progress = report_progress
) -> BenchmarkAudit:
    """Audit folders of problems, each as a suite with the folder's name.

    For each problem, the nearest problem is searched for in the suites `train` or, by default, in all other suites.
    Without `reach`, goals are not checked for reachability, which is faster.

    Raises:
        QueryError: a folder has no problems, or there is no such suite.
    """
    problems, failures = read_suites(folders)
    suites = {each.suite for each in problems} | {each.suite for each in failures}
    for name in train:
        if name not in suites:
            raise QueryError(f"no suite {name!r}; the suites are {', '.join(sorted(suites))}")
    unreadable = [(each.suite, AuditFinding("unreadable", each.place, each.text)) for each in failures]
    return audit_problems(problems, unreadable, train=train, reach=reach, progress=progress)


def _suite_name(path: Path, names: Mapping[str, Path]) -> str:
    """Return the name of a folder, preceded by as many parent folders as distinguish it from other suites."""
    parts = path.resolve().parts
    return next(name for depth in range(1, len(parts) + 1) if (name := "/".join(parts[-depth:])) not in names)


def _format_of(path: Path) -> str:
    if lerobot_suites.recognizes(path):
        return LEROBOT
    for name in FORMATS:
        if _source(name).recognizes(path):
            return name
    raise QueryError(f"{path}: no problems in this folder; it needs files of {', '.join([*FORMATS, LEROBOT])}")


def _source(name: str) -> ProblemSource:
    source: ProblemSource = import_module(FORMATS[name])
    return source
