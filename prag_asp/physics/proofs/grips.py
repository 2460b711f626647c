"""Warn about bodies that a gripper may hold according to the domain but that none can hold."""

from __future__ import annotations

from collections.abc import Iterator

from prag_asp.atom import atom_of
from prag_asp.domain.load import Domain
from prag_asp.physics.grasps.body_grasps import body_grasps
from prag_asp.physics.grasps.opposite_faces import is_never_spanned
from prag_asp.physics.grasps.pads import ParallelGripper
from prag_asp.physics.predicates import PREDICATES, Gripper
from prag_asp.physics.predicates.grip_friction import bearable, pad_friction
from prag_asp.physics.predicates.grip_geometry import CLEARANCE
from prag_asp.program.problem import Problem
from prag_asp.scene.read.scene_values import ancestors
from prag_asp.scene.robots import robot_of
from prag_asp.scene.scene import Scene
from prag_asp.scene.solids import weight

LIFTED = 0.85
"""The measured share of the load borne by static friction that a robot can lift, because lifting accelerates the load.
"""


def never_gripped(domain: Domain, scene: Scene) -> Iterator[Problem]:
    """Yield a warning for each shape whose bodies may be held, but which no gripper can hold in any of its sizes.

    Grasps are from above, so what counts is the smallest width of a body seen from above.
    """
    shapes_by_line: dict[tuple[str, int, str], list[str]] = {}
    for fluent in map(atom_of, domain.facts.fluents):
        meaning = PREDICATES.get(scene.meaning(fluent) or "")
        if meaning is not None and meaning.gripper is Gripper.HOLDS:
            robot, entity = fluent.arguments
            for name, table, text in _faults(scene, robot, entity):
                several = shapes_by_line.setdefault((name, _line(domain, table, entity), text), [])
                several += [entity] if entity not in several else []
    for (name, line, text), several in shapes_by_line.items():
        are = "is" if len(several) == 1 else "are"
        yield Problem(domain.settings.path, line, f"{', '.join(several)} {are} {text}", name)


def _faults(scene: Scene, name: str, entity: str) -> Iterator[tuple[str, str, str]]:
    """Yield reasons why a robot cannot hold a body in its easiest size: the warning's name, the table and a text."""
    robot, shapes = robot_of(scene, name), scene.ranges.get(entity, (scene.shapes[entity],))
    limit = (robot.opening - CLEARANCE) * 1000
    closes = f"the gripper closes around at most {limit:.3g} mm (it opens to {robot.opening * 1000:.3g} mm)"
    if shapes[0].model is not None:
        gripper = ParallelGripper.of(robot)._replace(opening=robot.opening - CLEARANCE)
        if is_never_spanned(shapes[0], gripper, pad_friction(scene, entity)):
            wide = f"wider than {limit:.3g} mm between all opposite sides, edges and corners"
            yield "too-wide", "shapes", f"{wide}, but {closes}; make it narrower"
        elif not body_grasps(shapes[0], ParallelGripper.of(robot), pad_friction(scene, entity)):
            text = "not held by any grasp that was found (two flat pads on opposite sides or edges)"
            yield "no-grasp", "shapes", f"{text}; give it a rim, a handle or parallel sides"
    else:
        width = min(shape.breadth(widest=False) for shape in shapes)
        if width > robot.opening - CLEARANCE:
            yield "too-wide", "shapes", f"{width * 1000:.3g} mm wide, but {closes}; make it narrower"
    mass = min(weight(scene.with_shapes({entity: shape}), entity) for shape in shapes)
    bears = bearable(scene, entity, name)
    if mass > robot.payload:
        text = f"too heavy ({mass:.3g} kg): the robot carries at most {robot.payload:.3g} kg"
        yield "too-heavy", "materials", f"{text}; make it lighter"
    elif mass > LIFTED * bears:
        friction = scene.material(entity).friction
        text = f"too heavy ({mass:.3g} kg): with a friction of {friction:.3g}, the gripper holds {bears:.3g} kg at rest"
        yield "too-heavy", "materials", f"{text} and lifts about {LIFTED * bears:.3g} kg; make it lighter or rougher"


def _line(domain: Domain, table: str, entity: str) -> int:
    """Return the line in domain.toml of an entity's entry in a table of the scene, or else the line of its shape."""
    facts = domain.facts
    line = ancestors(facts.entity_names[entity], facts.class_names)
    for each in (table, "shapes"):
        entries = domain.settings.scene.get(each, {})
        owner = next((name for name in line if name in entries), None)
        if owner is not None:
            return domain.settings.line_of("scene", each, owner)
    return 1
