"""The summary of bodies from files in ``prag-asp check``: their dimensions, resting pose, cavity and grasps."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

from prag_asp.atom import atom_of
from prag_asp.domain.load import Domain
from prag_asp.program.problem import Problem
from prag_asp.scene.read.decomposition import can_decompose
from prag_asp.scene.read.mesh import is_concave, mesh_parts
from prag_asp.scene.read.scene_values import ancestors
from prag_asp.scene.robots import robot_of
from prag_asp.scene.scene import BodyModel, Cavity, Scene, Shape
from prag_asp.wording import plural

FAR = math.radians(30.0)
"""The tilt in radians above which a resting pose is probably unintended; scans often lean by a few degrees."""


def body_lines(scene: Scene) -> Iterator[str]:
    """Yield a summary of each body from a file: size, mass, parts, resting pose, cavity and grasps."""
    for shape, entities in _models(scene).items():
        model = shape.model
        assert model is not None
        size = " x ".join(f"{side * 1000:.3g}" for side in shape.size)
        parts = plural(sum(len(mesh_parts(s.mesh, s.size)) if s.mesh else 1 for s in model.solids), "convex part")
        cavity = model.cavity
        room = "" if cavity is None else f"; cavity: {cavity_text(cavity)}"
        rest = f"; {rest_text(model)}" if model.settled > 0.0 else ""
        concave = not can_decompose() and any(s.mesh and is_concave(s.mesh, s.size) for s in model.solids)
        hull = '; its mesh is not convex, so its hull is used: pip install "prag_asp[meshes]"' if concave else ""
        ways = f"; {grasps_text(scene, entities[0])}"
        yield f"{', '.join(entities)}: {size} mm, {model.mass:.3g} kg, {parts}{rest}{room}{ways}{hull}"


def cavity_text(cavity: Cavity) -> str:
    """Describe the dimensions of a cavity, and its rotation relative to the body."""
    turned = f", turned by {math.degrees(cavity.yaw):.1f} degrees" if cavity.yaw else ""
    return f"{' x '.join(f'{side * 1000:.3g}' for side in cavity.sides)} mm{turned}"


def grasps_text(scene: Scene, entity: str) -> str:
    """Describe the numbers of grasps that were found for a body from a file, by direction of the hand."""
    from prag_asp.physics.grasps.antipodal import SIDEWAYS, SLANTED
    from prag_asp.physics.grasps.body_grasps import body_grasps
    from prag_asp.physics.grasps.pads import ParallelGripper
    from prag_asp.physics.predicates.grip_friction import pad_friction

    gripper = ParallelGripper.of(robot_of(scene, next(iter(scene.robots))))
    tilts = [grasp.tilt for grasp in body_grasps(scene.shapes[entity], gripper, pad_friction(scene, entity))]
    above, side = sum(tilt < SLANTED for tilt in tilts), sum(tilt >= SIDEWAYS for tilt in tilts)
    return f"grasps: {above} from above, {len(tilts) - above - side} at an angle, {side} from the side"


def solid_containers(domain: Domain, scene: Scene) -> Iterator[Problem]:
    """Yield a warning for each shape from a file that has no cavity, although the logic may put objects into it."""
    from prag_asp.physics.predicates import PREDICATES

    filled = dict[Shape, list[str]]()
    for fluent in map(atom_of, domain.facts.fluents):
        predicate, arguments = PREDICATES.get(scene.meaning(fluent) or ""), fluent.arguments
        if predicate is None or not predicate.places or predicate.impossible is None:
            continue
        shape = scene.shapes[arguments[-1]]
        if shape.model is not None and not shape.hollow and any(predicate.impossible(scene, arguments)):
            several = filled.setdefault(shape, [])
            several += [arguments[-1]] if arguments[-1] not in several else []
    for entities in filled.values():
        text = (
            f"{', '.join(entities)} is not a container: its file has no cavity; give it one, or a floor without holes"
        )
        yield Problem(domain.settings.path, _shape_line(domain, entities[0]), text, "no-cavity")


def tilted(domain: Domain, scene: Scene) -> Iterator[Problem]:
    """Yield a warning for each shape that tips by more than `FAR` before it comes to rest."""
    for shape, entities in _models(scene).items():
        model = shape.model
        assert model is not None
        if model.settled > FAR:
            text = f"{', '.join(entities)} does not stand as in its file and {rest_text(model)}; rotate it in the file"
            yield Problem(domain.settings.path, _shape_line(domain, entities[0]), text, "tips-over")


def _shape_line(domain: Domain, entity: str) -> int:
    """Return the number of the line in domain.toml that gives an entity its shape."""
    line = ancestors(domain.facts.entity_names[entity], domain.facts.class_names)
    owner = next(name for name in line if name in domain.settings.scene["shapes"])
    return domain.settings.line_of("scene", "shapes", owner)


def rest_text(model: BodyModel) -> str:
    """Return a description of how a body comes to rest."""
    return f"comes to rest turned by {math.degrees(model.settled):.1f} degrees"


def _models(scene: Scene) -> Mapping[Shape, list[str]]:
    """Return the entities of each shape that is loaded from a file."""
    models: dict[Shape, list[str]] = {}
    for entity, shape in scene.shapes.items():
        if shape.model is not None:
            models.setdefault(shape, []).append(entity)
    return models
