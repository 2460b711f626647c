"""The cache of explored automata for the next run of the same program."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import clingo
import numpy as np
from numpy.typing import NDArray

from prag_asp.logic.domain_logic import DomainLogic
from prag_asp.logic.symmetry.symmetries import Unit
from prag_asp.output.digests import digest, files_digest
from prag_asp.program.paths import PACKAGE
from prag_asp.space.automaton.automaton import Automaton, Completions
from prag_asp.space.automaton.exploration import Renamings
from prag_asp.space.engines.cache import CacheEntry, read_entry, write_entry
from prag_asp.space.engines.reachability import Reach

ROOMS = ("program", "domain", "logic", "space")
"""The packages whose code affects explorations."""

RENAMINGS = {"multiplicities": ("i", 1), "order_of": ("i", 1), "orders": ("i", 2), "twins": ("b", 2)}
ARRAYS = {"offsets": ("i", 1), "letters": ("i", 1), "targets": ("i", 1), "accepting": ("b", 1), **RENAMINGS}
"""The dtype kind and the number of dimensions of each array; the arrays `RENAMINGS` belong to merged states."""


@dataclass(frozen=True)
class AutomatonSlot:
    """The place in the cache for the automaton of one level of a domain."""

    folder: Path
    key: str

    def read(self) -> Reach | None:
        """Return the cached automaton if it is valid, or else None."""
        entry = read_entry(self.folder, self.key, ARRAYS)
        try:
            return _restore(entry) if entry and entry.texts["code"] == code_digest() else None
        except (KeyError, TypeError, ValueError, RuntimeError):  # clingo raises a RuntimeError if a text is not a term
            return None

    def write(self, reach: Reach) -> bool:
        """Write an automaton, and return whether that succeeded."""
        base = reach.merged.base if reach.merged else reach.completions.automaton
        arrays: dict[str, NDArray[Any]] = {
            name: getattr(base, name) for name in ("offsets", "letters", "targets", "accepting")
        }
        groups: Sequence[Sequence[Unit]] = ()
        if reach.merged:
            arrays |= {name: getattr(reach.merged.renamings, name) for name in RENAMINGS}
            groups = reach.merged.groups
        texts = {
            "code": code_digest(),
            "letters": reach.letters,
            "names": reach.names,
            "horizon": base.horizon,
            "groups": [[list(map(str, unit)) for unit in group] for group in groups],
        }
        return write_entry(self.folder, self.key, CacheEntry(texts, arrays))


OF_TASKS = ("canonical_names", "joint_names", "closed_invariants")
"""The rules that select tasks among plans."""


def automaton_slot(folder: Path, model: DomainLogic, level: str, merge: bool | None) -> AutomatonSlot | None:
    """Return the slot for a level of a domain in the cache folder, or None if the encodings cannot be read.

    The key covers everything that the arrays depend on except the code: the rules of tasks, and the program with its
    unreachable actions, also for the model without conditions and for the models of which this model is a part. The
    entry itself contains the digest of the code, which is computed only if there is an entry.
    """
    domain = model.domain
    rules = [domain.encodings / "rules" / f"{name}.lp" for name in OF_TASKS] if level == "task" else []
    try:
        values = [domain.program.text, *(path.read_text(encoding="utf-8") for path in rules)]
    except OSError:
        return None
    values += map(str, domain.facts.unreachable)
    others = [model.bare]
    while model.part_of is not None:  # innermost first
        model = model.part_of
        others.append(model)
    for other in others:
        values += [other.domain.program.text, *map(str, other.domain.facts.unreachable)] if other else [""]
    values += [level, str(merge), clingo.__version__, np.__version__, sys.version]
    return AutomatonSlot(folder, digest(values))


@cache
def code_digest() -> str:
    """Return a digest of the code that affects explorations."""
    paths = [*PACKAGE.glob("*.py"), *(path for room in ROOMS for path in (PACKAGE / room).rglob("*.py"))]
    return files_digest(paths, PACKAGE)


def _restore(entry: CacheEntry) -> Reach | None:
    """Return the exploration stored in a cache entry, or None if its arrays are inconsistent."""
    arrays, texts = entry.arrays, entry.texts
    merged = "twins" in arrays
    expected = {name: kind for name, kind in ARRAYS.items() if merged or name not in RENAMINGS}
    if {name: (array.dtype.kind, array.ndim) for name, array in arrays.items()} != expected:
        return None
    letters, names, horizon = tuple(texts["letters"]), tuple(texts["names"]), texts["horizon"]
    automaton = Automaton(
        arrays["offsets"], arrays["letters"], arrays["targets"], arrays["accepting"], horizon=horizon
    )  # fmt: skip
    edges = len(automaton.letters)
    sound = (
        len(names) == len(letters)
        and len(automaton.offsets) == automaton.states + 1
        and automaton.offsets[0] == 0
        and automaton.offsets[-1] == edges == len(automaton.targets)
        and (np.diff(automaton.offsets) >= 0).all()
        and _within(automaton.letters, len(letters))
        and _within(automaton.targets, automaton.states)
    )
    if not sound:
        return None
    if not merged:
        return Reach(letters, names, Completions(automaton))
    from prag_asp.logic.symmetry.term_patterns import read_patterns
    from prag_asp.space.automaton.merged_states import MergedAutomaton

    groups = tuple(tuple(tuple(map(clingo.parse_term, unit)) for unit in group) for group in texts["groups"])
    actions = read_patterns([clingo.parse_term(letter) for letter in letters], groups)
    renamings = Renamings(*(arrays[name] for name in RENAMINGS))
    entities = sum(map(len, groups))
    shapes = [array.shape for array in (renamings.multiplicities, renamings.order_of, renamings.twins)]
    if actions is None or shapes != [(edges,), (edges,), (automaton.states, entities)]:
        return None
    return Reach.of_merged(letters, names, MergedAutomaton(automaton, renamings, actions, groups))


def _within(numbers: NDArray[Any], size: int) -> bool:
    return bool(((numbers >= 0) & (numbers < size)).all())
