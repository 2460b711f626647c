"""Read a suite from its TOML file; what is wrong is told with the line that says it."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from prag_asp.atom import split_terms
from prag_asp.dataset.suites.suite_spec import Held, Part, Suite
from prag_asp.dataset.suites.suite_tables import (
    KNOWN,
    OWN_OF_COPIES,
    PartTable,
    PhysicsTable,
    SuiteTable,
    lengths_of,
    texts,
)  # fmt: skip
from prag_asp.domain.load import load_domain
from prag_asp.errors import QueryError
from prag_asp.fields import FieldError, read
from prag_asp.grammar.phrasings import Phrasings
from prag_asp.program.paths import shipped_domains, suite_file
from prag_asp.program.settings import key_line, parse_table
from prag_asp.program.sources import Source, read_text
from prag_asp.space.conditions.condition import Condition
from prag_asp.space.task_space import TaskSpace
from prag_asp.space.without_replacement import Division
from prag_asp.wording import did_you_mean, unknown

if TYPE_CHECKING:
    from prag_asp.domain.load import Domain
    from prag_asp.physics import Budget, Staging

NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*")
"""A name of a part: of a folder, and of a split for loaders."""

STARTS = "starts "
LONGEST_SIZE = 20


def load_suite(name_or_path: str | Path, *, domain: Domain | None = None, trust: bool = False) -> Suite:
    """Return a suite that is shipped, or that a TOML file spells.

    Its domain is one that is shipped, or one beside the file; give another one in place of it as `domain`. With
    `trust`, physics may run the Python files of the domain.

    Raises:
        QueryError: there is no such suite, or something is wrong with it; the message begins with the line.
        DomainError: the file cannot be read or is not TOML, or something is wrong with the domain.
    """
    path = suite_file(name_or_path)
    return read_suite(Source(path, read_text(path)), domain=domain, trust=trust)


def read_suite(source: Source, *, domain: Domain | None = None, trust: bool = False) -> Suite:
    """Return the suite that a text spells.

    Raises:
        QueryError: something is wrong with it.
        DomainError: it is not TOML, or something is wrong with the domain.
    """
    return _Reader(source, trust).suite(domain)


class _Reader:
    """Reads one text."""

    def __init__(self, source: Source, trust: bool) -> None:
        self._path, self._text, self._trust = source.path, source.text, trust
        told = parse_table(source)
        self._refuse_unknown(told)
        try:
            self._table = read(told, SuiteTable, "")
        except FieldError as error:
            raise QueryError(f"{self._place(*map(str, error.trail))}: {error}") from None
        self._written: Mapping[str, Mapping[str, Any]] = told["parts"]

    def suite(self, domain: Domain | None) -> Suite:
        """Return the suite.

        Raises:
            QueryError: something is wrong with it.
        """
        if not self._table.parts:
            raise QueryError(f"{self._place('parts')}: a suite needs parts; write tables such as [parts.train]")
        self._domain = domain or self._loaded()
        budget, staging, demonstrate = self._physics()
        with self._told("phrasings"):
            Phrasings.parse(self._table.phrasings)
        held = self._held()
        parts = {name: self._part(name, table, held) for name, table in self._table.parts.items() if table.of is None}
        for name, table in self._table.parts.items():
            if table.of is not None:
                parts[name] = self._copy(name, table, parts)
        parts = {name: parts[name] for name in self._table.parts}
        for part in parts.values():
            self._refuse_unknown_shares(part, parts)
        return Suite(
            self._path.stem, self._domain, parts, self._table.title, self._table.description, self._table.uniform,
            budget, staging, demonstrate, tuple(held.values()), self._path, self._text,
        )  # fmt: skip

    def _place(self, *keys: str) -> str:
        return f"{self._path}:{key_line(self._text, keys)}"

    @contextmanager
    def _told(self, *keys: str) -> Iterator[None]:
        """Say of an error where the key stands that it is about."""
        try:
            yield
        except QueryError as error:
            raise QueryError(f"{self._place(*keys)}: {error}") from None

    def _refuse_unknown(self, table: Mapping[str, Any]) -> None:
        """Refuse keys that nothing reads.

        Raises:
            QueryError: there is one.
        """
        for pattern, known in KNOWN.items():
            for keys, found in _tables(table, pattern):
                for key in found:
                    if key not in known:
                        where = f" in [{'.'.join(keys)}]" if keys else ""
                        raise QueryError(f"{self._place(*keys, key)}: no key {key}{where}; {did_you_mean(key, known)}")

    def _loaded(self) -> Domain:
        """Return the domain that the suite names: a shipped one, or one beside its file.

        Raises:
            DomainError: there is none, or something is wrong with it.
        """
        name = self._table.domain
        found = Path(name) if name in shipped_domains() else self._path.parent / name
        if name not in shipped_domains() and not (name and found.exists()):
            hint = did_you_mean(name, shipped_domains(), "name a shipped domain, or a folder or file beside the suite")
            raise QueryError(f"{self._place('domain')}: no domain {name!r}; {hint}")
        return load_domain(found, trust=self._trust)

    def _physics(self) -> tuple[Budget | None, Staging | None, bool]:
        """Return what is asked of physics; by default it is asked where the domain has a scene.

        Raises:
            QueryError: something about it is wrong.
        """
        given, scene = self._table.physics, bool(self._domain.settings.scene)
        table = given if isinstance(given, PhysicsTable) else PhysicsTable()
        if given is False or (given is None and not scene):
            return None, None, False
        from prag_asp.physics import TIERS, Budget, Staging

        with self._told("physics", "budget"):
            if not scene:
                raise QueryError(f"{self._domain.label} has no scene; leave physics out")
            tries = Budget.parse(table.budget)
        with self._told("physics", "tier"):
            if table.tier not in TIERS:
                raise QueryError(unknown(table.tier, TIERS, "tier of checks"))
            dearest = "demonstration" if table.demonstrate else table.tier
            budget = replace(tries, tier=TIERS[TIERS.index(dearest)])
        if not table.cameras and not table.vary:
            return budget, None, table.demonstrate
        with self._told("physics", "cameras" if table.cameras else "vary"):
            if not table.demonstrate:
                raise QueryError("cameras film demonstrations; add demonstrate = true")
            rate = {} if table.rate is None else {"rate": table.rate}
            staging = Staging(tuple(table.cameras), _pixels(table.size), vary=tuple(table.vary), **rate)
        return budget, staging, True

    def _held(self) -> dict[str, Held]:
        """Return all that only some parts have, by its words.

        Raises:
            QueryError: one is nothing that can be held out.
        """
        found: dict[str, Held] = {}
        for name, table in self._table.parts.items():
            for what in texts(table.unseen):
                with self._told("parts", name, "unseen"):
                    found[what] = self._held_out(what, name)
        return found

    def _held_out(self, what: str, name: str) -> Held:
        """Return the conditions of something that is held out: a start, or what `hold_out` takes."""
        space = TaskSpace(self._domain, max(self._lengths(name, self._table.parts[name])))
        if what.startswith(STARTS):
            fluent = what.removeprefix(STARTS).strip()
            if len(split_terms(fluent)) > 1:
                raise QueryError(f"{what!r} names several fluents; hold each out by itself")
            no = fluent.removeprefix("not ").strip()
            other = no if no != fluent else f"not {fluent}"
            given = str(Condition.parse(what)), str(Condition.parse(f"{STARTS}{other}"))
            space.where(given[0])
            return Held(what, *given)
        without, having = space.hold_out(what)
        return Held(what, str(having.condition), str(without.condition))

    def _lengths(self, name: str, table: PartTable) -> range:
        """Return the lengths of a part, or those of the suite.

        Raises:
            QueryError: there are none.
        """
        given = self._table.lengths if table.lengths is None else table.lengths
        with self._told(*(("lengths",) if table.lengths is None and given is not None else ("parts", name, "lengths"))):
            if given is None:
                raise QueryError(f"the part {name} has no lengths; write lengths = '1..3', for it or for all parts")
            return lengths_of(given)

    def _part(self, name: str, table: PartTable, held: Mapping[str, Held]) -> Part:
        """Return a part that has tasks of its own.

        Raises:
            QueryError: something about it is wrong.
        """
        with self._told("parts", name):
            if not NAME.fullmatch(name):
                raise QueryError(f"part {name!r}: write a name of letters, digits and _, such as train")
        own = texts(table.unseen)
        clauses = [each.having if each.what in own else each.without for each in held.values()]
        space = TaskSpace(self._domain, max(self._lengths(name, table)))
        for keys, words in ((("where",), self._table.where), (("parts", name, "where"), table.where)):
            with self._told(*keys):
                space.where(*texts(words))
        where = Condition.parse(*texts(self._table.where), *texts(table.where)) & Condition.parse(*clauses)
        shares = {part: str(share) for part, share in table.split.items()} or None
        with self._told("parts", name, "split" if shares else "skeletons"):
            Division.parse(shares, skeletons=table.skeletons)
        with self._told("parts", name, "evenly"):
            if table.evenly and self._domain.settings.weights and not self._table.uniform:
                raise QueryError("lengths come evenly where tasks are drawn uniformly; add uniform = true to the suite")
        if table.starts > 1 and self._physics()[0] is None:
            with self._told("parts", name, "starts"):
                raise QueryError(f"starts = {table.starts} needs physics")
        return self._worded(
            Part(
                name, table.tasks, self._lengths(name, table), tuple(map(str, where.clauses)), own, None,
                texts(table.shares), table.about, self._table.seed if table.seed is None else table.seed, table.starts,
                shares, table.skeletons, table.evenly,
            ),
            table, self._table.language, self._table.phrasings,
        )  # fmt: skip

    def _copy(self, name: str, table: PartTable, parts: Mapping[str, Part]) -> Part:
        """Return a part that has the tasks of another one, in other words.

        Raises:
            QueryError: it asks for more, or for something else.
        """
        with self._told("parts", name, "of"):
            assert table.of is not None
            if table.of not in parts or parts[table.of].of is not None:
                raise QueryError(f"{unknown(table.of, parts, 'part')}, with tasks of its own")
            source = parts[table.of]
            other = next((key for key in self._written[name] if key not in OWN_OF_COPIES), None)
            if other is not None:
                raise QueryError(f"{name} has the tasks of {source.name}; leave {other} out")
            if table.tasks > source.tasks:
                raise QueryError(f"{name} has tasks of {source.name}, which has {source.tasks}; ask for no more")
            part = replace(source, name=name, tasks=table.tasks, of=source.name, about=table.about, shares=())
            part = self._worded(part, table, source.language, source.phrasings)
            if not part.apart(source):
                told = f"{name} has the tasks of {source.name}, and phrasings that it has, too"
                raise QueryError(f"{told}; write phrasings = '1 of 2' for one and '2 of 2' for the other")
        return part

    def _worded(self, part: Part, table: PartTable, language: str, phrasings: str) -> Part:
        """Return a part with its language and its phrasings.

        Raises:
            QueryError: the domain does not have them.
        """
        from prag_asp.dataset.language import teller_of

        language = table.language or language
        phrasings = phrasings if table.phrasings is None else table.phrasings
        key = "language" if table.phrasings is None else "phrasings"
        with self._told("parts", part.name, key):
            told = str(Phrasings.parse(phrasings))
            teller_of(self._domain, language, phrasings=told)
        return replace(part, language=language, phrasings=told)

    def _refuse_unknown_shares(self, part: Part, parts: Mapping[str, Part]) -> None:
        """Refuse a part that declares tasks in common with none.

        Raises:
            QueryError: it does.
        """
        for other in part.shares:
            if other not in parts or other == part.name:
                with self._told("parts", part.name, "shares"):
                    raise QueryError(unknown(other, [each for each in parts if each != part.name], "part"))


def _tables(table: Mapping[str, Any], pattern: tuple[str, ...]) -> Iterator[tuple[tuple[str, ...], Mapping[str, Any]]]:
    """Yield the tables below a table that a pattern of keys leads to, with the keys that lead there."""
    if not pattern:
        yield (), table
        return
    first, *rest = pattern
    for key in table if first == "*" else (first,):
        inner = table.get(key)
        if isinstance(inner, Mapping):
            for keys, found in _tables(inner, tuple(rest)):
                yield (key, *keys), found


def _pixels(text: str | None) -> tuple[int, int] | None:
    """Return width and height that a text spells, None where there is none.

    Raises:
        QueryError: it spells none.
    """
    if text is None:
        return None
    width, _, height = text.partition("x")
    if not (width.isdecimal() and height.isdecimal() and len(text) <= LONGEST_SIZE):
        raise QueryError(f"size {text!r}: write WIDTHxHEIGHT in pixels, such as 480x420")
    return int(width), int(height)
