"""Spaces under several conditions number the rules of the domain without conditions only once."""

from __future__ import annotations

import pytest

from prag_asp import TaskSpace, load_domain
from prag_asp.logic.symmetry import symmetry
from prag_asp.logic.symmetry.atom_numbering import Atoms

LIGHTS = """
class(lamp). entity((lamp_1;lamp_2;lamp_3), lamp).
fluent(lit(L)) :- entity(L,lamp).
action(press(L)) :- entity(L,lamp).
postcondition(press(L),lit(L),true) :- entity(L,lamp).
initially(lit(L),false) :- entity(L,lamp).
"""


def test_the_rules_without_conditions_are_numbered_once_for_all_conditions(monkeypatch: pytest.MonkeyPatch) -> None:
    numbered: list[object] = []
    init = Atoms.__init__

    def record(self: Atoms, ground: object, entities: object) -> None:
        numbered.append(ground)
        init(self, ground, entities)  # type: ignore[arg-type]

    monkeypatch.setattr(symmetry.Atoms, "__init__", record)
    space = TaskSpace(load_domain(text=LIGHTS), 2)
    # A task presses one lamp twice, or two lamps; the condition on lamp_1 leaves the other two interchangeable.
    assert space.where("nontrivial").count() == 2
    assert space.where("has at least 2 press").count() == 2
    assert space.where("uses lamp_1").count() == 3
    assert len(numbered) == 4 and len(set(map(id, numbered))) == 4  # three conditions, and the domain itself
