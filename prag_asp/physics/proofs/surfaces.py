"""Proofs about the table top and its zones: a body stands on exactly the surfaces under its centre.

A surface is a convex region in a plane, and a body stands on it if the body stands on the plane with its centre over
the region. The centre of a body that is known to stand on several surfaces is thus over their intersection.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from prag_asp.physics.predicates import PREDICATES
from prag_asp.physics.predicates.gaps import ROUNDING
from prag_asp.physics.predicates.predicate import words
from prag_asp.physics.symbolic_facts import Fact
from prag_asp.scene.forms import Outline, rectangle
from prag_asp.scene.geometry import cut, inside_by
from prag_asp.scene.scene import Scene

FLUSH = 1e-8
"""The tolerance in metres within which one region counts as contained in another, because coordinates are rounded."""


def surface_reasons(facts: Iterable[Fact], fresh: Iterable[Fact], scene: Scene) -> Iterator[str]:
    """Yield reasons why bodies cannot stand on some surfaces without standing on others."""
    bodies = dict.fromkeys(fact.arguments[0] for fact in fresh if _of_surface(fact, scene))
    about = [fact for fact in facts if _of_surface(fact, scene)] if bodies else []
    for entity in bodies:
        own = [fact for fact in about if fact.arguments[0] == entity]
        on, off = ([fact.arguments[1] for fact in own if fact.value is value] for value in (True, False))
        if not on:
            continue
        name, places = words(entity), " and ".join(map(words, on))
        common = outline_of(on[0], scene)
        for surface in on[1:]:
            common = within(common, outline_of(surface, scene))
        if not common:
            yield f"{name} cannot be on {places} at once, because they have no part in common"
            continue
        for surface in off:
            outline = outline_of(surface, scene)
            if all(inside_by(outline, corner) >= -FLUSH for corner in common):
                yield f"{name} cannot be on {places} and not on {words(surface)}, which covers all of {places}"


def outline_of(surface: str, scene: Scene) -> Outline:
    """Return the corners of the table top or of a zone, counter-clockwise."""
    if scene.shapes[surface].kind == "table":
        (x, y), (size_x, size_y) = scene.table.centre, scene.table.size
        return rectangle(x, y, size_x / 2, size_y / 2, 0.0)
    (x, y, yaw), half = scene.fixed[surface], scene.shapes[surface].half
    return rectangle(x, y, half[0], half[1], yaw)


def within(outline: Outline, other: Outline) -> Outline:
    """Return the intersection of two convex outlines, to within `ROUNDING`, or () if it is empty."""
    for (ax, ay), (bx, by) in zip(other, other[1:] + other[:1], strict=True):
        length = ((bx - ax) ** 2 + (by - ay) ** 2) ** 0.5
        a, b = (by - ay) / length, (ax - bx) / length
        outline = cut(outline, a, b, a * ax + b * ay + ROUNDING)
    return outline


def _of_surface(fact: Fact, scene: Scene) -> bool:
    """Return whether a fact states that a body is on the table or in a zone."""
    return fact.predicate is PREDICATES["on_top"] and scene.shapes[fact.arguments[1]].traits.surface
