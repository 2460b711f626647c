"""Static stability: the contacts from below, and the centre of mass of a body together with all bodies on it.

Bodies stand upright. In a stack, the centre of mass includes everything that rests on a body.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from prag_asp.physics.predicates.inside import floor_height, hollow
from prag_asp.physics.situation import Situation
from prag_asp.scene.forms import Outline, Point, rectangle
from prag_asp.scene.geometry import base, centre_of_mass, crown, hull, inside_by, intersection, yaw_of
from prag_asp.scene.solids import weight

CONTACT = 0.002
BALANCE = 1e-6
LEAST_MARGIN, TENTH = 0.005, 0.1
"""The smallest desired margin, in metres, of a placed object's centre of mass within its support, and the share of the
width of its base that is always enough."""
TABLE = ""


@dataclass(frozen=True)
class Contact:
    """A contact with a support below (`TABLE` for the table): the overlap of the two outlines, seen from above."""

    support: str
    region: Outline


def contacts(situation: Situation, entity: str, others: Iterable[str]) -> list[Contact]:
    """Return the contacts of a body with surfaces below it: tops of bodies, floors of containers and the table."""
    return _contacts(situation, entity, list(_tops(situation, others)))


def _contacts(situation: Situation, entity: str, tops: Iterable[tuple[str, float]]) -> list[Contact]:
    """Return the contacts of a body with surfaces, which are given with their heights in metres."""
    (at_x, at_y), (half_x, half_y) = _table(situation)
    bottom = situation.bottom(entity)
    below: Outline = ()
    contacts = []
    for support, height in tops:
        if support != entity and abs(bottom - height) <= CONTACT:
            below = below or base(situation.shape(entity), situation.pose(entity))
            inside = support == TABLE and all(abs(x - at_x) <= half_x and abs(y - at_y) <= half_y for x, y in below)
            region = below if inside else ()
            region = region or intersection(below, _top(situation, support, height))
            if region:
                contacts.append(Contact(support, region))
    return contacts


def resting_height(situation: Situation, entity: str, others: Iterable[str]) -> float:
    """Return the height of the highest surface below a body, in metres."""
    below = base(situation.shape(entity), situation.pose(entity))
    bottom = situation.bottom(entity) + CONTACT
    heights = [
        height
        for support, height in _tops(situation, others)
        if support != entity and height <= bottom and intersection(below, _top(situation, support, height))
    ]
    return max(heights, default=0.0)


def unsupported(situation: Situation, entities: Iterable[str], needs_margin: bool = False) -> str | None:
    """Return a body that would fall or tip over, or None; held bodies are stable and can bear other bodies.

    The centre of mass has to be over the contacts below the body. With `needs_margin`, the distance of the centre of
    mass from their edge has to be at least the margin of the scene or, if that is less, a tenth of the width of the
    body's base, but at least `LEAST_MARGIN`; on a small contact, half of its radius is enough.
    """
    bodies = list(entities)
    still = {*(arm.held for arm in situation.arms.values()), *situation.scene.fixed}
    loose = [body for body in bodies if body not in still]
    (at_x, at_y), (half_x, half_y) = _table(situation)
    high = []
    for body in loose:
        # The usual case is checked first: a body that stands on the table, with its centre over it, is stable. A body
        # with a model has to be entirely over the table, because its base may be at its side.
        measured = situation.body(body)
        x, y, _ = measured.centre
        dx, dy = (0.0, 0.0) if situation.scene.shapes[body].model is None else measured.half[:2]
        over = abs(x - at_x) + dx <= half_x and abs(y - at_y) + dy <= half_y
        if not (abs(measured.low[2]) <= CONTACT and over):
            high.append(body)
    tops = list(_tops(situation, bodies)) if high else []
    resting = {body: _contacts(situation, body, tops) for body in high}
    bearing = {contact.support for touching in resting.values() for contact in touching}
    resting.update({body: contacts(situation, body, ()) for body in loose if body in bearing and body not in high})
    for body, touching in resting.items():
        ground = hull([point for contact in touching for point in contact.region])
        needed = 0.0
        if needs_margin and ground:
            needed = min(_margin(situation, body), max(0.0, inside_by(ground, _middle(ground)) / 2))
        if not ground or inside_by(ground, _load(situation, body, resting)[1]) < needed - BALANCE:
            return body
    return None


def _margin(situation: Situation, body: str) -> float:
    """Return the desired margin, in metres, of a body's centre of mass within its support."""
    below = base(situation.shape(body), situation.pose(body))
    width = 2 * inside_by(below, _middle(below))
    return min(situation.scene.balance, max(LEAST_MARGIN, TENTH * width))


def riders(situation: Situation, entity: str, others: Iterable[str]) -> list[str]:
    """Return the bodies that rest on or in a body, directly or indirectly, and therefore move with it."""
    candidates = list(others)
    bodies = [entity]
    for current in bodies:
        for height in _surfaces(situation, current):
            for other in candidates:
                if other not in bodies and abs(situation.bottom(other) - height) <= CONTACT:
                    outer = base(situation.shape(other), situation.pose(other))
                    if intersection(outer, _top(situation, current, height)):
                        bodies.append(other)
    return bodies[1:]


def _tops(situation: Situation, others: Iterable[str]) -> Iterable[tuple[str, float]]:
    """Yield every surface on which a body can rest: its owner and its height in metres."""
    yield TABLE, 0.0
    for other in others:
        for height in _surfaces(situation, other):
            yield other, height


def _surfaces(situation: Situation, support: str) -> list[float]:
    """Return the heights in metres of a body's top and of a container's floor; a ball has neither.

    A body from a file with a cavity has both: objects can stand in it, or on its rim.
    """
    shape = situation.shape(support)
    floors = [floor_height(situation, support)] if shape.hollow else []
    return [*floors, situation.top(support)] if shape.traits.flat and not shape.traits.hollow else floors


def _top(situation: Situation, support: str, height: float) -> Outline:
    """Return the outline of a support's surface; for a container, the outline of the floor between its walls."""
    if support == TABLE:
        (x, y), (half_x, half_y) = _table(situation)
        return rectangle(x, y, half_x, half_y, 0.0)
    shape = situation.shape(support)
    if not shape.hollow or (shape.model is not None and height > floor_height(situation, support)):
        return crown(shape, situation.pose(support))
    pose, inner = hollow(situation, support)
    x, y, _ = pose.position
    return rectangle(x, y, inner[0] / 2, inner[1] / 2, yaw_of(pose.quaternion))


def _table(situation: Situation) -> tuple[Point, Point]:
    """Return the centre of the table top and half of its dimensions, in metres."""
    table = situation.scene.table
    return table.centre, (table.size[0] / 2, table.size[1] / 2)


def _load(situation: Situation, body: str, resting: Mapping[str, list[Contact]]) -> tuple[float, Point]:
    """Return the mass of a body together with all bodies on it, and the point where this load acts, seen from above.

    A body that rests on one support loads it at the body's centre of mass; a body that bridges several supports loads
    each with an equal share, at the centre of the contact.
    """
    total = weight(situation.scene, body)
    centre = centre_of_mass(situation.shape(body), situation.pose(body))
    x, y = total * centre[0], total * centre[1]
    for rider, touching in resting.items():
        for contact in touching:
            if contact.support == body:
                mass, at = _load(situation, rider, resting)
                if len(touching) > 1:
                    mass /= len(touching)
                    at = _middle(contact.region)
                total, x, y = total + mass, x + mass * at[0], y + mass * at[1]
    return total, (x / total, y / total)


def _middle(region: Outline) -> Point:
    """Return the mean of the corners of an outline."""
    return sum(x for x, _ in region) / len(region), sum(y for _, y in region) / len(region)
