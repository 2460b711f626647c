"""The data for comparing tasks of a domain as plain values: classes, preconditions and interchangeable entities."""

from __future__ import annotations

from prag_asp.atom import atom_of
from prag_asp.logic.symmetry.symmetries import Symmetries
from prag_asp.program.facts import Facts
from prag_asp.similarity.background import Background
from prag_asp.similarity.interchange import Interchange
from prag_asp.task import FrozenDict


def background_of(facts: Facts, symmetries: Symmetries) -> Background:
    """Return the data of a domain that comparisons use."""
    fluents = {fluent: atom_of(fluent) for fluent in facts.fluents}
    preconditions = {
        atom_of(action): FrozenDict(
            {fluents[fluent]: value == "true" for fluent, value in facts.preconditions.get(action, ())}
        )
        for action in facts.actions
    }
    return Background(facts.entity_names, facts.class_names, interchange_of(symmetries), preconditions)


def interchange_of(symmetries: Symmetries) -> Interchange[str]:
    """Return the symmetries, with entities as texts."""
    return Interchange(
        tuple(tuple(map(str, group)) for group in symmetries.groups),
        tuple(tuple(tuple(map(str, unit)) for unit in units) for units in symmetries.joint),
    )
