"""BDDL as LIBERO reads it: one file per task, with the objects, the initial state, the goal and the instruction.

The grammar is that of https://github.com/Lifelong-Robot-Learning/LIBERO, ``libero/envs/bddl_utils.py``: expressions in
parentheses, in lower case. Facts known to be false are written as ``(not ...)``; facts that are not listed are unknown.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from prag_asp.dataset.formats.episode_source import NO_TASK, EpisodeSource
from prag_asp.dataset.formats.export_format import Progress
from prag_asp.dataset.formats.provenance import write_provenance
from prag_asp.errors import QueryError
from prag_asp.output import file_in, new_folder, replace_file
from prag_asp.scene.geometry import yaw_of
from prag_asp.scene.variation import table_of
from prag_asp.wording import plural

if TYPE_CHECKING:
    from prag_asp.atom import Atom
    from prag_asp.dataset.store.entry import DatasetEntry
    from prag_asp.physics import Witness

BRACKETS = str.maketrans("()", "[]")
"""The replacements for the parentheses of a term such as ``disc(1)``, which BDDL would parse as an expression."""

INSTRUCTION_CHARACTERS = str.maketrans("();", "[],")
"""The replacements for characters of an instruction that are syntax in BDDL."""

WORD = re.compile(r"[^\s();A-Z]+")
Region = tuple[str, tuple[float, float, float, float], float]
"""A region of the table: its name, the minimum x and y and the maximum x and y in metres, and a yaw in radians."""


@dataclass(frozen=True)
class Bddl:
    """The format with one file per task, ``PART-NUMBER.bddl``."""

    def write(self, source: EpisodeSource, target: Path, progress: Progress) -> None:
        """Write the folder; the files have regions if the domain has a scene.

        Raises:
            QueryError: there is no task, or a name is invalid in BDDL.
            OutputError: the folder cannot be written.
        """
        total = sum(note.rows("tasks") for note in source.data.manifest.parts if note.name in source.data.parts)
        with new_folder(target) as folder:
            count = 0
            for count, (entry, witness) in enumerate(_tasks(source), 1):
                text = problem(source, entry, witness)
                replace_file(file_in(folder, f"{entry.part}-{entry.number:06d}.bddl"), text.encode())
                progress(plural(count, "task"), count, total)
            if not count:
                raise QueryError(f"{source.data.folder}: {NO_TASK}")
            write_provenance(folder, source, "bddl")


def _tasks(source: EpisodeSource) -> Iterator[tuple[DatasetEntry, Witness | None]]:
    """Yield each task with the witness from its first initial state, or None if there is no witness."""
    witnesses = ((entry, witness) for entry, start, witness in source.data.witnesses() if start == 0)
    following = next(witnesses, None)
    for entry in source.data.entries():
        if following is not None and (following[0].part, following[0].number) == (entry.part, entry.number):
            yield entry, following[1]
            following = next(witnesses, None)
        else:
            yield entry, None


def problem(source: EpisodeSource, entry: DatasetEntry, witness: Witness | None = None) -> str:
    """Return a task as a problem in BDDL.

    Raises:
        QueryError: a name is invalid in BDDL.
    """
    task = entry.task
    fixtures = {}  # robots, the table, zones, and entities with a fixed pose in the scene
    if source.data.domain.settings.scene:
        scene = source.scene
        still = {name for name, shape in scene.shapes.items() if name in scene.fixed or not shape.traits.body}
        fixtures = {table_of(scene): "table"}
        fixtures |= {name: kind for name, kind in task.entities.items() if name in still | {*scene.robots}}
    objects = {name: kind for name, kind in task.entities.items() if name not in fixtures}
    of_interest = [name for name in objects if any(name in fluent.arguments for fluent in task.goal)]
    init = [f"    {_fact(fluent, value)}" for fluent, value in task.initial.items()]
    goal = " ".join(_fact(fluent, value) for fluent, value in task.goal.items())
    lines = [
        f"(define (problem prag_asp_{_word(task.domain)})",
        "  (:domain robosuite)",
        f"  (:language {source.instruction(entry).translate(INSTRUCTION_CHARACTERS)})",
        "  (:regions",
        *_regions(source, witness),
        "  )",
        "  (:fixtures",
        *_typed(fixtures),
        "  )",
        "  (:objects",
        *_typed(objects),
        "  )",
        "  (:obj_of_interest",
        *(f"    {_word(name)}" for name in of_interest),
        "  )",
        "  (:init",
        *init,
        "  )",
        "  (:goal",
        f"    (and {goal})" if goal else "    (and)",
        "  )",
        ")",
    ]
    return "\n".join(lines) + "\n"


def _regions(source: EpisodeSource, witness: Witness | None) -> Iterator[str]:
    """Yield the lines of the regions: zones of the table, and the initial positions of objects."""
    if not source.data.domain.settings.scene:
        return
    table, regions = _word(table_of(source.scene)), list[Region]()
    for name, (x, y, yaw) in source.scene.fixed.items():
        shape = source.scene.shapes.get(name)
        if shape is not None and shape.traits.surface:
            long, wide, _ = shape.half
            along, across = abs(math.cos(yaw)), abs(math.sin(yaw))
            right, far = long * along + wide * across, long * across + wide * along
            regions.append((name, (x - right, y - far, x + right, y + far), 0.0))
    for name, pose in witness.moments[0].poses.items() if witness else ():
        x, y, _ = pose.position
        regions.append((f"{name}_init_region", (x, y, x, y), yaw_of(pose.quaternion)))
    for name, sides, yaw in regions:
        numbers = " ".join(f"{side:.6g}" for side in sides)
        yield f"    ({_word(name)}"
        yield f"      (:target {table})"
        yield f"      (:ranges (({numbers})))"
        yield f"      (:yaw_rotation (({yaw:.6g} {yaw:.6g})))"
        yield "    )"


def _typed(entities: Mapping[str, str]) -> list[str]:
    """Return one line per class with all its entities; if a class had two lines, LIBERO would read only the last."""
    kinds = dict.fromkeys(entities.values())
    of = {kind: " ".join(_word(name) for name, each in entities.items() if each == kind) for kind in kinds}
    return [f"    {names} - {_word(kind)}" for kind, names in of.items()]


def _fact(fluent: Atom, value: bool) -> str:
    text = " ".join(map(_word, (fluent.name, *fluent.arguments)))
    return f"({text})" if value else f"(not ({text}))"


def _word(text: str) -> str:
    """Return a name as a word of BDDL."""
    word = text.translate(BRACKETS)
    if not WORD.fullmatch(word):
        raise QueryError(f"BDDL has no name {text}: it accepts only lower-case letters, without blanks or ;; rename it")
    return word
