"""Atomic files and folders, and journals from which runs are resumed.

The names below are loaded at first use, because a count writes nothing.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from prag_asp.lazy import names_from

if TYPE_CHECKING:
    from prag_asp.output.atomic_file import open_atomic, replace_file, whole_file
    from prag_asp.output.atomic_folder import file_in, make_folder, new_folder
    from prag_asp.output.journal import Journal

__all__ = ["Journal", "file_in", "make_folder", "new_folder", "open_atomic", "replace_file", "whole_file"]

_HOMES = {
    "prag_asp.output.atomic_file": ("open_atomic", "replace_file", "whole_file"),
    "prag_asp.output.atomic_folder": ("file_in", "make_folder", "new_folder"),
    "prag_asp.output.journal": ("Journal",),
}

__getattr__ = names_from(__name__, _HOMES)
