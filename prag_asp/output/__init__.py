"""Files and folders that are written whole or not at all, and journals that a run is resumed from."""

from prag_asp.output.atomic_file import open_atomic, replace_file, whole_file
from prag_asp.output.atomic_folder import file_in, make_folder, new_folder
from prag_asp.output.journal import Journal

__all__ = ["Journal", "file_in", "make_folder", "new_folder", "open_atomic", "replace_file", "whole_file"]
