"""Shipped domains that the tests of one process share: loading and grounding them anew took an eighth of their time.

Commands that run in a process of their own load them anew.
"""

from __future__ import annotations

from functools import lru_cache, wraps
from inspect import signature
from typing import Any

from prag_asp.domain import load
from prag_asp.program.paths import shipped_domains

MOST = 50
"""The maximum number of domains in memory, with their logic (up to 30 MB each)."""

FLAGS = {"flat", "trust", "learned", "strict"}
"""The options of `load_domain` with which domains are shared; with others, each test has its own."""


def share_shipped_domains() -> None:
    """Have `load_domain` return the same domain for the same name; call it before any module imports the function."""
    original, shipped = load.load_domain, frozenset(shipped_domains())
    defaults = {name: each.default for name, each in signature(original).parameters.items()}

    @lru_cache(maxsize=MOST)
    def shared(name: str, **options: bool) -> load.Domain:
        return original(name, **options)

    @wraps(original)
    def load_domain(*given: Any, **options: Any) -> load.Domain:
        chosen = {name: value for name, value in options.items() if value not in (defaults.get(name), {}, ())}
        if len(given) == 1 and given[0] in shipped and chosen.keys() <= FLAGS:
            return shared(*given, **chosen)
        return original(*given, **options)

    load.load_domain = load_domain
