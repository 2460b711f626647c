"""Files that are written whole or not at all, and files of lines that go on where a run was broken off.

The names below are loaded when they are first used: a count writes nothing.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from prag_asp.lazy import names_from

if TYPE_CHECKING:
    from prag_asp.output.atomic_files import replace_file
    from prag_asp.output.folders import building, file_in, make_folder
    from prag_asp.output.lines import Lines
    from prag_asp.output.steps import Steps
    from prag_asp.output.trees import growing, whole_file

__all__ = ["Lines", "Steps", "building", "file_in", "growing", "make_folder", "replace_file", "whole_file"]

_HOMES = {
    "prag_asp.output.atomic_files": ("replace_file",),
    "prag_asp.output.folders": ("building", "file_in", "make_folder"),
    "prag_asp.output.lines": ("Lines",),
    "prag_asp.output.steps": ("Steps",),
    "prag_asp.output.trees": ("growing", "whole_file"),
}

__getattr__ = names_from(__name__, _HOMES)
