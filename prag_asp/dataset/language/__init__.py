"""Instructions: tasks in words that refer to objects by their appearance, and a reader that parses them.

>>> from prag_asp import TaskSpace, load_domain
>>> from prag_asp.dataset.language import instruction_writer_of
>>> space = TaskSpace(load_domain("tabletop"), length=2)
>>> instruction_writer_of(space.domain).instructions(space[100], seed=0).default
'Please pick up the yellow brick from the table, and then set it down on the table to the right of the tray.'
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from prag_asp.lazy import names_from

if TYPE_CHECKING:
    from prag_asp.dataset.language.descriptions import InstructionContext
    from prag_asp.dataset.language.instruction_reader import Reading, context_of, read_instruction
    from prag_asp.dataset.language.instruction_writer import Instructions, InstructionWriter, instruction_writer_of
    from prag_asp.dataset.language.plain import instruction, sentence

__all__ = [
    "InstructionContext",
    "InstructionWriter",
    "Instructions",
    "Reading",
    "context_of",
    "instruction",
    "instruction_writer_of",
    "read_instruction",
    "sentence",
]

_HOMES = {
    "prag_asp.dataset.language.plain": ("instruction", "sentence"),
    "prag_asp.dataset.language.instruction_reader": ("Reading", "read_instruction", "context_of"),
    "prag_asp.dataset.language.instruction_writer": ("Instructions", "InstructionWriter", "instruction_writer_of"),
    "prag_asp.dataset.language.descriptions": ("InstructionContext",),
}

__getattr__ = names_from(__name__, _HOMES)


def __dir__() -> list[str]:
    return __all__
