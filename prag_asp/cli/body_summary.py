"""What ``prag-asp check`` says of bodies from files: what was read, and how they come to rest."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

from prag_asp.domain.load import Domain
from prag_asp.program.problem import Problem
from prag_asp.scene.read.decomposition import can_decompose
from prag_asp.scene.read.mesh import is_concave, mesh_parts
from prag_asp.scene.read.scene_values import ancestors
from prag_asp.scene.scene import BodyModel, Scene, Shape
from prag_asp.wording import plural

FAR = math.radians(30.0)
"""A body that tips by more to come to rest was probably meant to stand otherwise: scans lean by a few degrees."""


def body_lines(scene: Scene) -> Iterator[str]:
    """Yield what was read of each body from a file: size, mass, parts, and how it comes to rest."""
    for shape, entities in _models(scene).items():
        model = shape.model
        assert model is not None
        size = " x ".join(f"{side * 1000:.3g}" for side in shape.size)
        parts = plural(sum(len(mesh_parts(s.mesh, s.size)) if s.mesh else 1 for s in model.solids), "convex part")
        cavity = model.cavity
        sides = "" if cavity is None else " x ".join(f"{side * 1000:.0f}" for side in cavity.sides)
        room = f"; things can be in its cavity of {sides} mm" if sides else ""
        rest = f"; {rest_text(model)}" if model.settled > 0.0 else ""
        concave = not can_decompose() and any(s.mesh and is_concave(s.mesh, s.size) for s in model.solids)
        hull = '; its mesh is not convex and stands for its hull: pip install "prag_asp[meshes]"' if concave else ""
        yield f"{', '.join(entities)}: {size} mm, {model.mass:.3g} kg, {parts}{rest}{room}{hull}"


def tilted(domain: Domain, scene: Scene) -> Iterator[Problem]:
    """Yield a warning for each shape that tips by more than `FAR` to come to rest."""
    for shape, entities in _models(scene).items():
        model = shape.model
        assert model is not None
        if model.settled > FAR:
            line = ancestors(domain.facts.entity_names[entities[0]], domain.facts.class_names)
            owner = next(name for name in line if name in domain.settings.scene["shapes"])
            text = (
                f"{', '.join(entities)} does not stand as its file has it and {rest_text(model)}; turn it in the file"
            )
            yield Problem(domain.settings.path, domain.settings.line_of("scene", "shapes", owner), text, "tips-over")


def rest_text(model: BodyModel) -> str:
    """Return how a body comes to rest, in words."""
    return f"comes to rest turned by {math.degrees(model.settled):.1f} degrees"


def _models(scene: Scene) -> Mapping[Shape, list[str]]:
    """Return the entities of each shape from a file."""
    models: dict[Shape, list[str]] = {}
    for entity, shape in scene.shapes.items():
        if shape.model is not None:
            models.setdefault(shape, []).append(entity)
    return models
