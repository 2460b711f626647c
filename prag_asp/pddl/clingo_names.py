"""Names of PDDL as names of clingo: readable and unique.

A hyphen becomes an underscore. A name that is then taken or reserved gets a prefix for its kind (``the_``, ``do_``,
``some_``, ``is_``), and a number at its end if that is taken, too. The mapping is returned, so that plans can be
translated back to PDDL's names.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Mapping

RESERVED = frozenset([
    "not", "true", "false", "unknown", "inf", "sup", "class", "entity", "is_a", "fluent", "action", "precondition",
    "postcondition", "initially", "exclusive", "implies", "impossible", "goal", "composite", "stage", "free", "at_most",
    "ever", "occurs", "holds", "changed", "name", "mentions", "adds", "deletes", "t",
])  # fmt: skip
"""Names with a meaning in clingo, in the contract or in the translation of effects, with any number of arguments."""

TERMS = frozenset(["not", "true", "false", "unknown", "t"])
"""Names that no fluent may have: fluents are terms, not predicates; t is the number of a step."""

CLINGO = re.compile(r"[a-z][a-z0-9_]*")


def clingo_names(
    names: Iterable[str], word: str, taken: Collection[str] = (), reserved: Collection[str] = RESERVED
) -> Mapping[str, str]:
    """Return clingo's name for each name of PDDL, unique among themselves and among those `taken` by other kinds.

    Names that need no change keep theirs, however others are called.
    """
    given = list(dict.fromkeys(names))
    used = {*reserved, *taken}
    found = {name: name for name in given if CLINGO.fullmatch(name) and name not in used}
    used |= found.keys()
    for name in given:
        if name not in found:
            plain = re.sub(r"[^a-z0-9_]", "_", name)
            found[name] = _free(plain, f"{word}_{plain}", used)
            used.add(found[name])
    return {name: found[name] for name in given}


def _free(name: str, other: str, used: Collection[str]) -> str:
    if name not in used and CLINGO.fullmatch(name):
        return name
    number, free = 2, other
    while free in used:
        free, number = f"{other}_{number}", number + 1
    return free


def variable_name(name: str, taken: Collection[str]) -> str:
    """Return clingo's name for a variable of PDDL, other than those taken."""
    plain = re.sub(r"[^A-Za-z0-9_]", "_", str(name)).lower()
    found = first = plain[0].upper() + plain[1:]
    number = 2
    while found in taken:
        found, number = f"{first}_{number}", number + 1
    return found
