"""Readable and unique clingo names for PDDL names.

A hyphen becomes an underscore. If the result is taken or reserved, it gets a prefix for its kind (``the_``, ``do_``,
``some_``, ``is_``) and, if that name is also taken, a number as a suffix. The mapping is returned, so that plans can be
translated back to PDDL names.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Mapping
from itertools import chain, count

RESERVED = frozenset([
    "not", "true", "false", "unknown", "inf", "sup", "class", "entity", "is_a", "fluent", "action", "precondition",
    "postcondition", "initially", "exclusive", "implies", "impossible", "goal", "composite", "stage", "free", "at_most",
    "ever", "occurs", "holds", "changed", "name", "mentions", "adds", "deletes", "t",
])  # fmt: skip
"""Names with a meaning in clingo, in the contract or in the translation of effects, with any number of arguments."""

TERMS = frozenset(["not", "true", "false", "unknown", "t"])
"""The reserved names of fluents, which are terms rather than predicates; t is the number of a step."""

CLINGO = re.compile(r"[a-z][a-z0-9_]*")


def clingo_names(
    names: Iterable[str], word: str, taken: Collection[str] = (), reserved: Collection[str] = RESERVED
) -> Mapping[str, str]:
    """Return distinct clingo names for PDDL names, which also differ from the `taken` names of other kinds.

    A name that is valid in clingo is unchanged, and takes precedence over translated names.
    """
    unique = list(dict.fromkeys(names))
    used = {*reserved, *taken}
    mapping = {name: name for name in unique if CLINGO.fullmatch(name) and name not in used}
    used |= mapping.keys()
    for name in unique:
        if name not in mapping:
            plain = re.sub(r"[^a-z0-9_]", "_", name)
            usable = plain not in used and CLINGO.fullmatch(plain)
            mapping[name] = plain if usable else unused(f"{word}_{plain}", used)
            used.add(mapping[name])
    return {name: mapping[name] for name in unique}


def unused(name: str, taken: Collection[str]) -> str:
    """Return a name that is not taken: the given name, with a number as a suffix if necessary."""
    return next(each for each in chain([name], (f"{name}_{number}" for number in count(2))) if each not in taken)


def variable_name(name: str, taken: Collection[str]) -> str:
    """Return an unused clingo name for a PDDL variable."""
    plain = re.sub(r"[^A-Za-z0-9_]", "_", str(name)).lower()
    return unused(plain[0].upper() + plain[1:] if plain[:1].isalpha() else f"V{plain}", taken)
