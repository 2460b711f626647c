"""Chance in tests: the same in every run, or, with `pytest --fresh`, other seeds and ten times the examples.

A test with `@given` says `max_examples=examples(60)`; one with a generator of its own takes the fixture `chance`, and
from it `chance.generator(3)`, `chance.seed(3)` and `chance.examples(60)`. Where a number is part of what is expected,
as the seed of bytes that never change is, it is written down as it is.
"""

from __future__ import annotations

import random
import re
from base64 import b64decode, b64encode
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING

from hypothesis import HealthCheck, settings
from hypothesis.database import ExampleDatabase, ReadOnlyDatabase
from hypothesis.internal.conjecture import providers

if TYPE_CHECKING:
    from collections.abc import Iterable

FRESH_TIMES = 10
FOUND = Path(__file__).parent / "found"


@dataclass(frozen=True)
class Chance:
    """Where seeds come from, and how often more than as a rule a test is tried; no base, no chance."""

    base: int | None = None
    times: int = 1

    def seed(self, number: int) -> int:
        """Return a seed for a place that has a number of its own: that, or what it makes with the base."""
        if self.base is None:
            return number
        return int.from_bytes(sha256(f"{self.base} {number}".encode()).digest()[:4], "big")

    def generator(self, number: int) -> random.Random:
        """Return a generator of random numbers for a place that has a number of its own."""
        return random.Random(self.seed(number))

    def examples(self, number: int) -> int:
        """Return how many examples are tried where it is this many as a rule."""
        return number * self.times


_now = Chance()


def now() -> Chance:
    """Return what holds in this run."""
    return _now


def examples(number: int) -> int:
    """Return how many examples a test with `@given` is tried with where it is this many as a rule."""
    return _now.examples(number)


def fix(found: Path = FOUND) -> None:
    """Have hypothesis draw the same in every run, after what was found before."""
    # A profile that is derandomized would have no database; one that is made from it may.
    settings.register_profile("ci", settings(_settings(), derandomize=True), database=ReadOnlyDatabase(Found(found)))
    settings.load_profile("ci")


def freshen(base: int, found: Path = FOUND) -> None:
    """Have all tests draw anew, hypothesis after what was found before, and ten times as often."""
    global _now  # noqa: PLW0603 - Tests read it while they are imported.
    _now = Chance(base, FRESH_TIMES)
    settings.register_profile("fresh", _settings(), max_examples=examples(100), database=Found(found))
    settings.load_profile("fresh")


def _settings() -> settings:
    """Return what holds in every run: no test fails because the machine is busy."""
    _draw_no_constants_of_modules()
    # Where the variable CI is set, hypothesis would draw the same whatever the seed.
    return settings(deadline=None, suppress_health_check=[HealthCheck.too_slow], derandomize=False)


def _draw_no_constants_of_modules() -> None:
    """Have hypothesis not try the constants of the modules that happen to be there.

    Which these are depends on the tests that ran before in the same process.
    """
    providers.is_local_module_file = lambda file: False


class Found(ExampleDatabase):
    """Examples that tests have failed for, a folder for each test, by its name: so they outlive an edit or a move.

    What was found in an earlier run stays until somebody removes it, though the test passes now.
    """

    def __init__(self, folder: Path) -> None:
        super().__init__()
        self.folder = folder
        self._ours: set[Path] = set()

    def fetch(self, key: bytes) -> Iterable[bytes]:
        return [b64decode(file.read_text()) for file in sorted(self._folder(key).glob("*.txt"))]

    def save(self, key: bytes, value: bytes) -> None:
        file = self._file(key, value)
        if not key.endswith((b".secondary", b".pareto")) and not file.exists():  # These are steps on the way.
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(b64encode(value).decode() + "\n")
            self._ours.add(file)

    def delete(self, key: bytes, value: bytes) -> None:
        file = self._file(key, value)
        if file in self._ours:
            self._ours.remove(file)
            file.unlink()

    def _folder(self, key: bytes) -> Path:
        return self.folder / re.sub(r"\W+", "_", key.decode())

    def _file(self, key: bytes, value: bytes) -> Path:
        return self._folder(key) / f"{sha256(value).hexdigest()[:16]}.txt"
