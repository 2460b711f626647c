"""Files that are written whole or not at all, and files of lines that go on where a run was broken off."""

from prag_asp.output.atomic_files import replace_file
from prag_asp.output.folders import building, file_in, make_folder
from prag_asp.output.lines import Lines
from prag_asp.output.steps import Steps
from prag_asp.output.trees import growing, whole_file

__all__ = ["Lines", "Steps", "building", "file_in", "growing", "make_folder", "replace_file", "whole_file"]
