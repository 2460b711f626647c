"""Compare a copy of the encodings with the shipped ones, about which the library makes assumptions.

Pruning, the refusal of unknown values, explanations, PDDL and physics assume the meaning of the shipped encodings.
Engines compute from the ground rules; `automaton` and `symbolic` assume only that each step has one action, and refuse
a copy with another rule for actions (see ``logic/ground/stationary.py``).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import zip_longest
from pathlib import Path

from prag_asp.program.parse import parse_sources
from prag_asp.program.paths import data_folder
from prag_asp.program.problem import Problem
from prag_asp.program.sources import CONTRACT, Program, encodings_folder, owned, read_sources
from prag_asp.program.syntax import Statement

FOLDERS = ("rules", "conditions")


def edited_encodings(program: Program, statements: Sequence[Statement]) -> Mapping[Path, int]:
    """Return files named like a shipped encoding with other statements, each with the line of the first one.

    These are files of a copy of the encodings, and files of a domain in a folder `rules` or `conditions`.
    """
    encodings, shipped = encodings_folder(program), data_folder("encodings")
    by_path: dict[Path, list[Statement]] = {}
    for each in statements:
        by_path.setdefault(each.path, []).append(each)
    edited: dict[Path, int] = {}
    for source, own in owned(program):
        path = source.path
        name = Path(path.parent.name, path.name) if path.parent.name in FOLDERS else Path(path.name)
        original = shipped / name
        is_copy = path.parent.name in FOLDERS if own else encodings is not None
        if not is_copy or name.name == CONTRACT or not original.is_file() or path.resolve() == original.resolve():
            continue
        expected, _ = parse_sources([(read_sources(original, shipped)[-1], False)])
        for here, there in zip_longest(by_path.get(path, []), expected):
            if here is None or there is None or here.text != there.text:
                edited[path] = here.line if here is not None else max(source.text.count("\n"), 1)
                break
    return edited


def encoding_problems(edited: Mapping[Path, int]) -> Iterator[Problem]:
    """Yield a warning for each edited encoding."""
    for path, line in edited.items():
        text = (
            f"this is not the shipped {path.name}: counts follow it, but nothing is pruned or reduced, and PDDL, "
            "explanations and physics assume the shipped one; state other rules in a file of another name"
        )
        yield Problem(path, line, text, "other-encoding")
