"""BDDL problems: the files in a folder and its subfolders."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path

from prag_asp.audit.audited_problem import AuditedProblem
from prag_asp.audit.sources.problem_source import FailedRead
from prag_asp.bddl.bddl_reader import bddl_files, read_bddl
from prag_asp.bddl.domain_writer import SuiteDomain
from prag_asp.bddl.ground_problems import GroundProblem, ground_problem
from prag_asp.domain.load import Domain, load_domain
from prag_asp.errors import DomainError


def recognizes(folder: Path) -> bool:
    """Return whether a folder contains BDDL problems."""
    return bool(bddl_files(folder))


def read(folders: Mapping[str, Path]) -> Iterator[AuditedProblem | FailedRead]:
    """Yield the problems in the folders of suites; the actions that objects allow are derived from all of them."""
    found: dict[str, tuple[str, Path, GroundProblem, tuple[str, ...]]] = {}
    for suite, folder in folders.items():
        for path in bddl_files(folder):
            try:
                given = read_bddl(path)
                remarks = tuple(f"{path}:{line}: {text}" for line, text in given.remarks)
                found[str(path)] = suite, path, ground_problem(given, path), remarks
            except DomainError as error:
                place, _, text = error.lines[0].partition(": ")
                yield FailedRead(suite, place, text)
    domain = SuiteDomain({name: problem for name, (_, _, problem, _) in found.items()}, "All problems of an audit.")
    for name, (suite, path, problem, remarks) in found.items():

        def load(name: str = name) -> Domain:
            return load_domain(text=domain.program(name))

        label = str(path.relative_to(folders[suite]).with_suffix(""))
        yield AuditedProblem(suite, label, f"{path}:1", problem, load, domain.own_fact, remarks)
