"""Names of clingo as names of PDDL: small letters, digits, hyphens and underscores, and no two things with one name."""

from __future__ import annotations

import re
from collections.abc import Hashable

KEYWORDS = frozenset([
    "and", "or", "not", "imply", "forall", "exists", "when", "either", "object", "number", "define", "domain",
    "problem", "assign", "increase", "decrease", "scale-up", "scale-down", "minimize", "maximize", "oneof",
    "preference", "always", "sometime", "within", "over", "at", "start", "end", "all", "total-cost", "total-time",
])  # fmt: skip
"""What means something to PDDL; `at` does in some of its dialects."""


class Spelling:
    """Gives each thing a name, the same whenever it is asked for; no two share one, for some readers refuse that."""

    def __init__(self) -> None:
        self._names: dict[Hashable, str] = {}
        self._taken: set[str] = set(KEYWORDS)

    def name(self, thing: Hashable, text: str) -> str:
        """Return the name of a thing, which is like a text."""
        if thing not in self._names:
            plain = re.sub(r"[^a-z0-9_]+", "-", text.lower()).strip("-_")
            first = plain if re.match("[a-z]", plain) else f"n{plain}"
            found, number = first, 2
            while found in self._taken:
                found, number = f"{first}-{number}", number + 1
            self._taken.add(found)
            self._names[thing] = found
        return self._names[thing]
