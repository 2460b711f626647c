"""Read a suite from its TOML file; each problem is reported with its line."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from prag_asp.atom import split_terms
from prag_asp.dataset.suites.suite_spec import HeldOutCondition, Suite, SuitePart
from prag_asp.dataset.suites.suite_tables import (
    LONGEST,
    OWN_OF_COPIES,
    PartTable,
    PhysicsTable,
    SuiteTable,
    texts,
)  # fmt: skip
from prag_asp.domain.load import load_domain
from prag_asp.errors import QueryError
from prag_asp.grammar.phrasings import Phrasings
from prag_asp.program.paths import shipped_domains, suite_file
from prag_asp.program.sources import Source, read_text
from prag_asp.space.conditions.condition import Condition
from prag_asp.space.lengths import parse_range
from prag_asp.space.task_space import TaskSpace
from prag_asp.space.without_replacement import Division
from prag_asp.tables.json_fields import read_entry
from prag_asp.tables.report import TableEntry, TableReport
from prag_asp.tables.toml_text import parse_toml
from prag_asp.wording import did_you_mean, unknown

if TYPE_CHECKING:
    from prag_asp.domain.load import Domain
    from prag_asp.physics import Budget, Staging

Kind = TypeVar("Kind")

NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*")
"""The pattern of names of parts, which are also names of folders and of splits for loaders."""

STARTS = "starts "
"""The prefix of a condition on the initial state."""

LONGEST_SIZE = 20
"""The maximum number of characters in the size of camera images; Python does not convert arbitrarily many digits."""


def load_suite(name_or_path: str | Path, *, domain: Domain | None = None, trust: bool = False) -> Suite:
    """Return a shipped suite, or the suite that a TOML file defines.

    The domain of the suite is a shipped domain or one next to the file, unless another `domain` is given. With `trust`,
    physics may run the Python files of the domain.

    Raises:
        QueryError: there is no such suite, or the file has problems; the message contains a line for each, with its
            location.
        DomainError: the file cannot be read or is not TOML, or something is wrong with the domain.
    """
    path = suite_file(name_or_path)
    return read_suite(Source(path, read_text(path)), domain=domain, trust=trust)


def read_suite(source: Source, *, domain: Domain | None = None, trust: bool = False) -> Suite:
    """Return the suite that a TOML text defines.

    Raises:
        QueryError: the suite has problems.
        DomainError: the text is not TOML, or the domain has problems.
    """
    return _SuiteReader(source, trust).suite(domain)


class _SuiteReader:
    """A reader of a suite from a TOML text; it collects the problems of the text."""

    def __init__(self, source: Source, trust: bool) -> None:
        self._source, self._trust, self._report = source, trust, TableReport()
        root = TableEntry(self._report, (), parse_toml(source.path, source.text))
        root.require_known(SuiteTable.__struct_fields__)
        parts = {name: self._read(entry, PartTable) for name, entry in root.at("parts").entries()}
        table = read_entry(root, SuiteTable)
        physics = self._read(root.at("physics"), PhysicsTable) if isinstance(root.value.get("physics"), dict) else None
        if table is not None and not parts:
            root.at("parts").add("a suite needs parts; write tables such as [parts.train]")
        self._raise_problems()
        assert table is not None
        self._table, self._physics_table = table, physics or PhysicsTable()
        self._parts = {name: part for name, part in parts.items() if part is not None}
        self._parts_entry = root.at("parts")

    def _read(self, entry: TableEntry, kind: type[Kind]) -> Kind | None:
        """Return a table as a struct, or None if it has problems."""
        fields: tuple[str, ...] = kind.__struct_fields__  # type: ignore[attr-defined]
        entry.require_known(fields)
        return read_entry(entry, kind)

    def _raise_problems(self) -> None:
        """Raise the problems collected so far."""
        self._report.raise_problems(QueryError, self._source.path, self._source.text)

    def suite(self, domain: Domain | None) -> Suite:
        """Return the suite.

        Raises:
            QueryError: the file has problems; the message contains a line for each.
            DomainError: something is wrong with the domain.
        """
        name = self._table.domain
        path = Path(name) if name in shipped_domains() else self._source.path.parent / name
        if domain is None and name not in shipped_domains() and not (name and path.exists()):
            hint = did_you_mean(name, shipped_domains(), "name a shipped domain, or a folder or file beside the suite")
            self._report.add(("domain",), f"no domain {name!r}; {hint}")
        self._raise_problems()
        self._domain = domain or load_domain(path, trust=self._trust)
        with self._report.errors_at("phrasings"):
            Phrasings.parse(self._table.phrasings)
        budget, staging, demonstrate = self._physics()
        held = self._held_outs()
        parts: dict[str, SuitePart] = {}
        for name, table in self._parts.items():
            part = self._part(name, table, held, checked=budget is not None) if table.of is None else None
            parts |= {} if part is None else {name: part}
        for name, table in self._parts.items():
            if table.of is not None:
                with self._report.errors_at("parts", name, "of"):
                    parts |= {part.name: part for part in self._copy(name, table, table.of, parts)}
        for name, table in self._parts.items():
            others = [each for each in self._parts if each != name]
            for other in texts(table.shares):
                if other not in others:
                    self._report.add(("parts", name, "shares"), unknown(other, others, "part"))
            self._check_distances(name, table)
        self._raise_problems()
        return Suite(
            self._source.path.stem, self._domain, {name: parts[name] for name in self._parts}, self._table.title,
            self._table.description, self._table.uniform, budget, staging, demonstrate, tuple(held.values()),
            self._source.path, self._source.text,
        )  # fmt: skip

    def _check_distances(self, name: str, table: PartTable) -> None:
        """Report distances from parts that do not exist or have no tasks of their own."""
        others = [each for each, other in self._parts.items() if each != name and other.of is None]
        for other in table.distance:
            if other not in others:
                hint = unknown(other, others, "other part with tasks of its own")
                self._report.add(("parts", name, "distance", other), hint)
        if table.distance and table.skeletons:
            self._report.add(("parts", name, "skeletons"), "a part with a distance is split by tasks; leave it out")

    def _physics(self) -> tuple[Budget | None, Staging | None, bool]:
        """Return the budget of physics, the staging, and whether tasks are demonstrated; no budget means no physics.

        By default, physics is on if the domain has a scene.
        """
        setting, scene, table = self._table.physics, bool(self._domain.settings.scene), self._physics_table
        if setting is False or (setting is None and not scene):
            return None, None, False
        from prag_asp.physics import TIERS, Budget, Staging

        budget, staging = Budget(), None
        with self._report.errors_at("physics", "budget"):
            if not scene:
                raise QueryError(f"{self._domain.label} has no scene; leave physics out")
            budget = Budget.parse(table.budget)
        with self._report.errors_at("physics", "tier"):
            if table.tier not in TIERS:
                raise QueryError(unknown(table.tier, TIERS, "tier of checks"))
            tier = "demonstration" if table.demonstrate else table.tier
            budget = replace(budget, tier=TIERS[TIERS.index(tier)])
        if not table.cameras and not table.vary:
            return budget, None, table.demonstrate
        with self._report.errors_at("physics", "cameras" if table.cameras else "vary"):
            if not table.demonstrate:
                raise QueryError("cameras record demonstrations; add demonstrate = true")
            rate = {} if table.rate is None else {"rate": table.rate}
            size = None
            if table.size is not None:
                width, _, height = table.size.partition("x")
                if not (width.isdecimal() and height.isdecimal() and len(table.size) <= LONGEST_SIZE):
                    raise QueryError(f"size {table.size!r}: write WIDTHxHEIGHT in pixels, such as 480x420")
                size = int(width), int(height)
            staging = Staging(tuple(table.cameras), size, vary=tuple(table.vary), **rate)
        return budget, staging, True

    def _held_outs(self) -> dict[str, HeldOutCondition]:
        """Return the conditions for each `unseen` entry of the parts, by its text."""
        held: dict[str, HeldOutCondition] = {}
        for name, table in self._parts.items():
            lengths = self._lengths(name, table) if table.unseen else None
            for what in texts(table.unseen) if lengths else ():
                with self._report.errors_at("parts", name, "unseen"):
                    held[what] = self._held_out(what, TaskSpace(self._domain, max(lengths or ())))
        return held

    def _held_out(self, what: str, space: TaskSpace) -> HeldOutCondition:
        """Return the conditions for holding something out: an initial value, or an argument of `TaskSpace.hold_out`."""
        if what.startswith(STARTS):
            fluent = what.removeprefix(STARTS).strip()
            if len(split_terms(fluent)) > 1:
                raise QueryError(f"{what!r} names several fluents; hold each out by itself")
            positive = fluent.removeprefix("not ").strip()
            negation = positive if positive != fluent else f"not {fluent}"
            having, lacking = str(Condition.parse(what)), str(Condition.parse(f"{STARTS}{negation}"))
            space.where(having)
            return HeldOutCondition(what, having, lacking)
        without, with_it = space.hold_out(what)
        return HeldOutCondition(what, str(with_it.condition), str(without.condition))

    def _lengths(self, name: str, table: PartTable) -> range | None:
        """Return the lengths of a part, by default those of the suite; report invalid ones, and return None."""
        lengths = self._table.lengths if table.lengths is None else table.lengths
        of_suite = table.lengths is None and lengths is not None
        with self._report.errors_at(*(("lengths",) if of_suite else ("parts", name, "lengths"))):
            if lengths is None:
                raise QueryError("missing; write lengths = '1..3', for this part or for all")
            found = parse_range(str(lengths), f"lengths {lengths!r}", longest=LONGEST)
            return range(found, found + 1) if isinstance(found, int) else found
        return None

    def _part(
        self, name: str, table: PartTable, held: Mapping[str, HeldOutCondition], *, checked: bool
    ) -> SuitePart | None:
        """Return a part with its own tasks, or None if its lengths or conditions have problems.

        `checked` is true if physics checks the tasks.
        """
        report, keys = self._report, ("parts", name)
        if not NAME.fullmatch(name):
            report.add(keys, "is not a valid name of a part; write one of letters, digits and _, such as train")
        lengths = self._lengths(name, table)
        if lengths is None:
            return None
        space = TaskSpace(self._domain, max(lengths))
        for place, words in ((("where",), self._table.where), ((*keys, "where"), table.where)):
            with report.errors_at(*place):
                space.where(*texts(words))
        if not report.is_sound(("where",)) or not report.is_sound((*keys, "where")):
            return None
        own = texts(table.unseen)
        clauses = [each.having if each.what in own else each.without for each in held.values()]
        where = Condition.parse(*texts(self._table.where), *texts(table.where)) & Condition.parse(*clauses)
        shares = {part: str(share) for part, share in table.split.items()} or None
        with report.errors_at(*keys, "split" if shares else "skeletons"):
            Division.parse(shares, skeletons=table.skeletons)
        if table.evenly and self._domain.settings.weights and not self._table.uniform:
            text = "evenly needs uniform sampling; add uniform = true to the suite"
            report.add((*keys, "evenly"), text)
        if table.starts > 1 and not checked:
            report.add((*keys, "starts"), f"starts = {table.starts} needs physics; leave it out, or add a scene")
        part = SuitePart(
            name, table.tasks, lengths, tuple(map(str, where.clauses)), own, None, texts(table.shares), table.about,
            self._table.seed if table.seed is None else table.seed, table.starts, shares, table.skeletons, table.evenly,
            distance=table.distance,
        )  # fmt: skip
        return self._with_phrasings(part, table, self._table.language, self._table.phrasings)

    def _copy(self, name: str, table: PartTable, of: str, parts: Mapping[str, SuitePart]) -> Iterator[SuitePart]:
        """Yield a part with the tasks of another part in different phrasings, or nothing if that part has problems."""
        if of not in self._parts or self._parts[of].of is not None:
            raise QueryError(f"{unknown(of, self._parts, 'part')}, with tasks of its own")
        if of not in parts:
            return
        source = parts[of]
        other = next((key for key in self._parts_entry.at(name).value if key not in OWN_OF_COPIES), None)
        if other is not None:
            raise QueryError(f"{name} has the tasks of {source.name}; leave {other} out")
        if table.tasks > source.tasks:
            raise QueryError(f"{name} has tasks of {source.name}, which has {source.tasks}; request at most that many")
        part = replace(source, name=name, tasks=table.tasks, of=source.name, about=table.about, shares=())
        part = self._with_phrasings(part, table, source.language, source.phrasings)
        if not part.apart(source):
            text = f"{name} has the tasks of {source.name}, but shares phrasings with it"
            raise QueryError(f"{text}; write phrasings = '1 of 2' for one and '2 of 2' for the other")
        yield part

    def _with_phrasings(self, part: SuitePart, table: PartTable, language: str, phrasings: str) -> SuitePart:
        """Return a part with its language and its phrasings, unchanged if the domain does not have them."""
        from prag_asp.dataset.language import instruction_writer_of

        language = table.language or language
        phrasings = phrasings if table.phrasings is None else table.phrasings
        key = "language" if table.phrasings is None else "phrasings"
        with self._report.errors_at("parts", part.name, key):
            normalized = str(Phrasings.parse(phrasings))
            instruction_writer_of(self._domain, language, phrasings=normalized)
            return replace(part, language=language, phrasings=normalized)
        return part
