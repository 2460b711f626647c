"""The scenarios of a domain: from tasks to ids, and from ids back to tasks and initial states."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import cached_property
from hashlib import blake2b
from pathlib import Path
from typing import TYPE_CHECKING

from clingo.ast import ASTType

from prag_asp.dataset.jsonl import Record
from prag_asp.dataset.scenario import DIGITS, Scenario, SearchStart
from prag_asp.domain.load import scene_files
from prag_asp.errors import QueryError
from prag_asp.output.digests import digest
from prag_asp.program.parse import parse_sources
from prag_asp.safe_reading import lines_of, open_text, read_bytes
from prag_asp.space.task_space import TaskSpace
from prag_asp.space.word_set import WordSet
from prag_asp.task import FrozenDict, Task
from prag_asp.wording import plural

if TYPE_CHECKING:
    from prag_asp.domain.load import Domain
    from prag_asp.physics import Staging, Validator, Verdict


class Scenarios:
    """The scenarios of a domain.

    A scenario belongs to the domain if the digests are equal. The digest covers the statements of the program
    (regardless of their order), whether composites count, and the table and the files of the scene, but not comments,
    weights or sentences.
    """

    def __init__(self, domain: Domain, space: TaskSpace | None = None) -> None:
        """Use the engines of `space`, if it is given, for tasks that satisfy its conditions."""
        self.domain = domain
        self._whole = None if space is None else space.whole
        self._spaces: dict[tuple[tuple[str, ...], int], TaskSpace] = {}

    @cached_property
    def digest(self) -> str:
        """The digest of the domain."""
        domain = self.domain
        statements, _ = parse_sources((source, True) for source in domain.program.sources)
        program = sorted(
            [each.part, *each.parameters, str(each.node)] for each in statements if each.kind != ASTType.Program
        )
        scene, folder = domain.settings.scene, domain.settings.path.parent
        files = sorted(blake2b(read_bytes(path)).hexdigest() for path in scene_files(scene, folder)) if scene else []
        table = json.dumps(scene, sort_keys=True, default=str)
        return digest([program, bool(domain.facts.composites), table, files])[:DIGITS]

    def ranked(self, where: Sequence[str], length: int, rank: int, start: SearchStart | None = None) -> Scenario:
        """Return the scenario of a task, given its length and its rank among the tasks that satisfy the conditions."""
        name, constants = self.domain.name, FrozenDict(self.domain.constants)
        return Scenario(name, self.digest, length, rank, start, tuple(sorted(where)), constants)

    def of(self, space: TaskSpace, task: Task, start: SearchStart | None = None) -> Scenario:
        """Return the scenario of a task from a space; the task may have a length that the space lacks.

        Raises:
            QueryError: the space has no such task; a plan with renamed interchangeable entities is not a task.
        """
        word, whole = tuple(map(str, task.actions)), space.whole
        engines = (whole if len(word) in whole.lengths else whole.at(len(word))).engines
        rank = WordSet(engines, "task", len(word)).engine.rank(word)
        if rank is None:
            raise QueryError(f"{task} is not a task of {space.title}, so it has no rank and no scenario")
        return self.ranked(_clauses(space.whole), len(word), rank, start)

    def check(self, scenario: Scenario) -> None:
        """Check that a scenario belongs to this domain in its current version.

        Raises:
            QueryError: the scenario has a different domain or different constants, or the domain has changed.
        """
        domain, other = self.domain, scenario
        if (other.domain, dict(other.constants)) != (domain.name, dict(domain.constants)):
            name = Scenario(other.domain, "", 0, 0, constants=other.constants)
            raise QueryError(f"scenario {scenario}: belongs to {str(name).partition(':')[0]}, not to {domain.label}")
        if other.digest != self.digest:
            raise QueryError(
                f"scenario {scenario}: the domain {domain.label} or its scene has changed since (its digest is now "
                f"{self.digest}); use that state, and the same --rule, --flat and --encodings"
            )

    def task(self, scenario: Scenario) -> Task:
        """Return the task of a scenario.

        Raises:
            QueryError: the scenario belongs to another domain or to another version of this one, or there is no such
                rank.
        """
        self.check(scenario)
        space = self.space(scenario.where, scenario.length)
        if scenario.rank >= space.count():
            tasks = plural(space.count(), "task")
            raise QueryError(f"scenario {scenario}: there are only {tasks} of this length, ranked from 0")
        return space[scenario.rank]

    def space(self, where: tuple[str, ...], length: int) -> TaskSpace:
        """Return the tasks of a given length that satisfy the conditions.

        Raises:
            QueryError: the domain has no such conditions, or they are not in the form that ids use.
        """
        key = where, length
        if key not in self._spaces:
            if self._whole is not None and where == _clauses(self._whole):
                self._spaces[key] = self._whole.at(length)
            else:
                self._spaces[key] = TaskSpace(self.domain, length).where(*where)
            if _clauses(self._spaces[key]) != where:
                raise QueryError(f"an id has the conditions {_clauses(self._spaces[key])!r:.200}, not {where!r:.200}")
        return self._spaces[key]


def verdict_of(task: Task, start: SearchStart, validator: Validator) -> Verdict:
    """Return the verdict that the search of a scenario yields on its task."""
    from prag_asp.physics import Staging

    staging = Staging(vary=start.vary)
    return validator.validate(task, seed=start.seed, index=start.index, budget=start.budget, staging=staging)


def searched(task: Task, start: SearchStart, validator: Validator) -> Record:
    """Return a task with the verdict and the witness that the search of its scenario finds.

    Raises:
        QueryError: the search finds no witness, because the versions of prag_asp or PyBullet differ.
    """
    verdict = verdict_of(task, start, validator)
    if verdict.witness is None:
        raise QueryError(
            f"the search {start} finds no witness of {task}; use the versions of prag_asp and PyBullet that found one"
        )
    values = verdict.to_json()
    witness = values.pop("witness")
    return Record(task, values, witness)


def start_of(record: Record, staging: Staging | None = None) -> SearchStart | None:
    """Return the search that found the witness of a record, if any; `staging` is that of the demonstration."""
    if record.verdict is None:
        return None
    from prag_asp.physics import Budget

    verdict = record.verdict
    return SearchStart.of(verdict["seed"], verdict["index"], Budget(**verdict["budget"]), staging)


def read_scenarios(file: str | Path) -> Iterator[Scenario]:
    """Yield the scenarios in a file with one id per line; blank lines are skipped.

    Raises:
        OSError: the file cannot be read.
        QueryError: a line is not a scenario id; the message gives the line.
    """
    with open_text(file) as stream:
        for number, line in enumerate(lines_of(stream), 1):
            if line.strip():
                try:
                    yield Scenario.parse(line.strip())
                except QueryError as error:
                    raise QueryError(f"{file}:{number}: {error}") from None


def exclude(space: TaskSpace, scenarios: Iterable[Scenario]) -> Callable[[Task], bool]:
    """Return a predicate that is true for the tasks of a space that belong to none of the given scenarios.

    Initial states do not matter. If the tasks of the scenarios are left out of a sample without replacement, the
    remaining tasks are a sample without replacement from all other tasks.

    Raises:
        QueryError: a scenario and the space have different domains or conditions, or a scenario has no task.
    """
    here, clauses = Scenarios(space.domain, space), _clauses(space.whole)
    excluded = {here.space(clauses, length).plan_at(rank) for length, rank in excluded_ranks(space, scenarios, here)}
    return lambda task: tuple(map(str, task.actions)) not in excluded


def excluded_ranks(
    space: TaskSpace, scenarios: Iterable[Scenario], here: Scenarios | None = None
) -> Iterator[tuple[int, int]]:
    """Yield the lengths and ranks of the tasks of scenarios; `here` may hold the `Scenarios` of the domain.

    Raises:
        QueryError: the domain or the conditions of a scenario differ from those of the space.
    """
    clauses = _clauses(space.whole)
    for scenario in scenarios:
        if scenario.where != clauses:
            what = " and ".join(clauses) or "no condition"
            raise QueryError(f"scenario {scenario}: cannot be excluded from {space.title} ({what}); "
                             "the scenario has other conditions")  # fmt: skip
        here = here or Scenarios(space.domain, space)
        here.check(scenario)
        yield scenario.length, scenario.rank


def _clauses(space: TaskSpace) -> tuple[str, ...]:
    """Return the conditions of a space as sorted texts, because ranks do not depend on the order of conditions."""
    return tuple(sorted(str(clause) for clause in space.condition.clauses))
