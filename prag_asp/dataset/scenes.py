"""Load the scene of a domain for physics."""

from __future__ import annotations

from typing import TYPE_CHECKING

from prag_asp.domain.load import load_scene
from prag_asp.physics.predicates import own_predicates

if TYPE_CHECKING:
    from prag_asp.domain.load import Domain
    from prag_asp.scene.scene import Scene


def scene_of(domain: Domain) -> Scene:
    """Return the scene of a domain, and load its user-defined spatial predicates.

    Raises:
        SceneError: the domain has no scene, or one of its Python files is not trusted or fails.
    """
    scene = load_scene(domain)
    own_predicates(scene)
    return scene
