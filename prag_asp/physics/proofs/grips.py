"""Bodies that no proof excludes from a gripper, though it never closes around them."""

from __future__ import annotations

from collections.abc import Iterator

from prag_asp.atom import atom_of
from prag_asp.domain.load import Domain
from prag_asp.physics.predicates import PREDICATES, Gripper
from prag_asp.physics.predicates.gripper import CLEARANCE
from prag_asp.program.allowed import allowed_names, not_allowed
from prag_asp.program.problem import Problem
from prag_asp.scene.model import Scene
from prag_asp.scene.read.report import ancestors
from prag_asp.scene.robots import robot_of


def never_gripped(domain: Domain, scene: Scene) -> Iterator[Problem]:
    """Yield a warning for each shape of bodies that could be held, but leave a gripper no room to close around them.

    A grip is from above, so what counts is how wide a body is where it is narrowest, seen from above; of a range of
    sizes that of the smallest. What a comment in domain.toml allows is left out.
    """
    return not_allowed(_too_wide(domain, scene), allowed_names((), domain.settings))


def _too_wide(domain: Domain, scene: Scene) -> Iterator[Problem]:
    found: dict[tuple[int, float, float], list[str]] = {}
    for fluent in map(atom_of, domain.facts.fluents):
        meaning = PREDICATES.get(scene.meaning(fluent) or "")
        if meaning is None or meaning.gripper is not Gripper.HOLDS:
            continue
        robot, entity = fluent.arguments
        opening = robot_of(scene, robot).opening
        width = min(shape.breadth(widest=False) for shape in scene.ranges.get(entity, (scene.shapes[entity],)))
        if opening - CLEARANCE < width <= opening:
            several = found.setdefault((_line(domain, entity), width, opening), [])
            several += [entity] if entity not in several else []
    for (line, width, opening), several in found.items():
        text = (
            f"{', '.join(several)} {'is' if len(several) == 1 else 'are'} {width * 1000:.3g} mm wide and the "
            f"gripper opens {opening * 1000:.3g} mm; it never closes around more than "
            f"{(opening - CLEARANCE) * 1000:.3g} mm, so make it narrower"
        )
        yield Problem(domain.settings.path, line, text, "too-wide")


def _line(domain: Domain, entity: str) -> int:
    """Return the line of domain.toml with the shape of an entity."""
    facts = domain.facts
    given = domain.settings.scene["shapes"]
    owner = next(name for name in ancestors(facts.entity_names[entity], facts.class_names) if name in given)
    return domain.settings.line_of("scene", "shapes", owner)
