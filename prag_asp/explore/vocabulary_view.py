"""What conditions can refer to: the parts from which users compose conditions with clicks."""

from __future__ import annotations

from dataclasses import dataclass

from prag_asp.explore.explored_domain import ExploredDomain
from prag_asp.explore.physics_view import LONGEST
from prag_asp.program.entity_names import action_name
from prag_asp.space.conditions.keywords import EXAMPLES, WHOLE


@dataclass(frozen=True)
class VocabularyView:
    """The names of a domain, and the kinds of conditions, with an example of each.

    A keyword in `whole` is a complete condition. `composites` are the names of the domain's composites.
    Physics may take `longest_physics` seconds for each view of a task.
    """

    domain: str
    names: tuple[str, ...]
    entities: tuple[tuple[str, str], ...]
    classes: tuple[str, ...]
    facts: tuple[str, ...]
    keywords: tuple[tuple[str, str], ...]
    whole: tuple[str, ...]
    composites: tuple[str, ...]
    weighted: bool
    has_scene: bool
    longest_physics: int


def vocabulary_view(explored: ExploredDomain) -> VocabularyView:
    """Return what conditions on the tasks of a domain can name."""
    domain, facts = explored.domain, explored.domain.facts
    return VocabularyView(
        domain.label,
        tuple(sorted(set(map(action_name, facts.actions)))),
        tuple(facts.entity_names.items()),
        tuple(sorted(map(str, facts.classes))),
        tuple(map(str, facts.fluents)),
        tuple(EXAMPLES.items()),
        tuple(sorted(WHOLE)),
        tuple(sorted({action_name(composite) for composite in facts.composites})),
        bool(domain.settings.weights),
        bool(domain.settings.scene),
        LONGEST,
    )
