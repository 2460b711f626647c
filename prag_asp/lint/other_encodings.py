"""The comparison of a copy of the encodings with the shipped encodings, about which the library makes assumptions.

Pruning, the refusal of unknown values, explanations, PDDL and physics assume that the encodings mean what the shipped
ones do. Engines compute from the ground rules; `automaton` and `symbolic` assume only that each step has one action,
and refuse a copy with a different rule for actions (see ``logic/ground/stationary.py``).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import zip_longest
from pathlib import Path

from clingo.ast import ASTType

from prag_asp.program.parse import parse_sources
from prag_asp.program.paths import BY_LIBRARY, data_folder
from prag_asp.program.problem import Problem
from prag_asp.program.sources import (
    REACHABLE,
    Program,
    Source,
    core_sources,
    encodings_folder,
    owned,
    read_sources,
    read_text,
)
from prag_asp.program.syntax import Statement

FOLDERS = ("rules", "conditions")


def edited_encodings(program: Program, statements: Sequence[Statement]) -> Mapping[Path, int]:
    """Return files named like a shipped encoding that have different statements, each with the line of the first one.

    These are files of a copy of the encodings, including those that only the library adds to a program, and files of a
    domain in a folder `rules` or `conditions`. A file that is missing from a copy has line 0. `#defined` is ignored.
    """
    encodings, shipped = encodings_folder(program), data_folder("encodings")
    by_path: dict[Path, list[Statement]] = {}
    for each in statements:
        by_path.setdefault(each.path, []).append(each)
    edited: dict[Path, int] = {}
    for source, own in owned(program):
        path = source.path
        name = Path(path.parent.name, path.name) if path.parent.name in FOLDERS else Path(path.name)
        is_copy = path.parent.name in FOLDERS if own else encodings is not None
        if is_copy and (shipped / name).is_file() and path.resolve() != (shipped / name).resolve():
            line = _first_difference(source, by_path.get(path, []), shipped / name)
            edited |= {path: line} if line else {}
    if encodings is not None and encodings.resolve() != shipped.resolve():
        edited |= _edited_besides(encodings, {source.path for source in program.sources})
    return edited


def _edited_besides(encodings: Path, read: set[Path]) -> dict[Path, int]:
    """Return the edited files in a copy that only the library reads, and the required files that the copy lacks.

    `read` contains the files of the program, which have already been compared.
    """
    shipped = data_folder("encodings")
    edited: dict[Path, int] = {}
    conditions = (path.relative_to(shipped) for path in sorted((shipped / "conditions").glob("*.lp")))
    for name in (Path(REACHABLE), *(Path("rules", f"{rule}.lp") for rule in sorted(BY_LIBRARY)), *conditions):
        path = encodings / name
        if path not in read and path.is_file() and read_text(path) != read_text(shipped / name):
            source = read_sources(path, encodings)[-1]
            line = _first_difference(source, parse_sources([(source, False)])[0], shipped / name)
            edited |= {path: line} if line else {}
    core = [encodings / source.path.relative_to(shipped) for source in core_sources(shipped)]
    return edited | {path: 0 for path in core if not path.is_file()}


def _first_difference(source: Source, statements: Sequence[Statement], shipped: Path) -> int:
    """Return the line of the first statement that differs from the shipped file, or 0 if there is none."""
    expected, _ = parse_sources([(read_sources(shipped, data_folder("encodings"))[-1], False)])
    for here, there in zip_longest(*([each for each in file if each.kind != ASTType.Defined]
                                     for file in (statements, expected))):  # fmt: skip
        if here is None or there is None or here.text != there.text:
            return here.line if here is not None else max(source.text.count("\n"), 1)
    return 0


def encoding_problems(edited: Mapping[Path, int]) -> Iterator[Problem]:
    """Yield a warning for each edited or missing encoding."""
    for path, line in edited.items():
        if line:
            which = f"this is not the shipped {path.name}: counts follow it"
            remedy = "state other rules in a file of another name"
        else:
            which = f"these encodings have no {path.name}: counts do without it"
            remedy = "copy the shipped file, and state other rules in a file of another name"
        text = (
            f"{which}, but nothing is pruned or reduced, and PDDL, explanations and physics assume the shipped one; "
            f"{remedy}"
        )
        yield Problem(path, max(line, 1), text, "other-encoding")
