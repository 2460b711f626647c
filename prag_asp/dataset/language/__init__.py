"""Tasks in words: instructions that name things as a picture shows them, and the reader that takes them back.

>>> from prag_asp import TaskSpace, load_domain
>>> from prag_asp.dataset.language import teller_of
>>> space = TaskSpace(load_domain("tabletop"), length=2)
>>> teller_of(space.domain).instructions(space[100], seed=0).default
'Please pick the yellow brick up from the table, and then set it down to the right of the tray.'
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from prag_asp.lazy import names_from

if TYPE_CHECKING:
    from prag_asp.dataset.language.descriptions import Start
    from prag_asp.dataset.language.instruction_reader import Reading, read_instruction, start_of
    from prag_asp.dataset.language.instruction_writer import Instructions, Teller, teller_of
    from prag_asp.dataset.language.plain import instruction, sentence

__all__ = [
    "Instructions",
    "Reading",
    "Start",
    "Teller",
    "instruction",
    "read_instruction",
    "sentence",
    "start_of",
    "teller_of",
]

_HOMES = {
    "prag_asp.dataset.language.plain": ("instruction", "sentence"),
    "prag_asp.dataset.language.instruction_reader": ("Reading", "read_instruction", "start_of"),
    "prag_asp.dataset.language.instruction_writer": ("Instructions", "Teller", "teller_of"),
    "prag_asp.dataset.language.descriptions": ("Start",),
}

__getattr__ = names_from(__name__, _HOMES)


def __dir__() -> list[str]:
    return __all__
