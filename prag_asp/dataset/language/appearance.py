"""The visible properties of the objects of a scene: kind, colour, size, and the position of fixed objects.

Each property is known to fit an object, known not to fit it, or in doubt. For a shade between orange and red, for
example, the nearer word fits, and the farther one is in doubt. A word in doubt neither describes the object nor
distinguishes another object from it.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from math import dist, prod
from typing import TYPE_CHECKING

from prag_asp.domain.load import load_scene
from prag_asp.grammar.reader import Grammar, plain
from prag_asp.scene.colours import WHITE

if TYPE_CHECKING:
    from prag_asp.domain.load import Domain
    from prag_asp.scene.scene import Scene

Lab = tuple[float, float, float]

BASIC: Mapping[str, tuple[str, ...]] = {
    "red": ("#d02020", "#a00000", "#ff3020", "#e05030"),
    "orange": ("#ffa500", "#ff8c1a", "#f07020", "#f06030"),
    "yellow": ("#f0d000", "#f5b830", "#ffe060"),
    "green": ("#2a8a3a", "#70b818", "#105020", "#70d070", "#3a9d6d", "#8a9a50"),
    "turquoise": ("#40b8b8", "#20c0a0"),
    "blue": ("#2080b0", "#2040c0", "#60a0e0", "#80c8f0", "#102060"),
    "purple": ("#8040a0", "#502070", "#b090e0"),
    "pink": ("#e05090", "#f090b0", "#ff60a0"),
    "brown": ("#8a5a38", "#60381c", "#a87848"),
    "beige": ("#e8dcc0", "#d8c4a0"),
    "white": ("#ffffff", "#f4f4f4"),
    "grey": ("#808080", "#b0b0b0", "#505050", "#cccccc"),
    "black": ("#000000", "#202020"),
}
"""The basic colour terms of English (Berlin and Kay 1969, plus turquoise and beige), with sample colours for each."""

DOUBT = 12.0
"""The distance in CIELAB, beyond that of the nearest colour term, up to which a term is in doubt, not excluded."""

LARGER = 1.25
"""The ratio of mean extents above which one object is visibly larger than another."""

APART = 0.10
"""The distance in metres above which one object is visibly to the left of another."""


@dataclass(frozen=True)
class Appearance:
    """The appearance of the entities of a domain, independent of the state.

    For each entity, `nouns` holds the words that fit it, most specific first; `names` holds its name, which is used if
    nothing visible distinguishes it; `colors` holds the colour terms that certainly fit it (true) or may fit it
    (false); `sizes` holds its mean extent in metres, and `places` holds its position if it is fixed: metres to the
    right and to the back. `seen` holds the entities in every picture; `pictured` is true if the domain has a scene.
    `sayable` holds the colours, sizes and places for which the language has adjectives, and `robots` holds the robots
    of the scene.
    """

    nouns: Mapping[str, tuple[str, ...]]
    names: Mapping[str, str]
    colors: Mapping[str, Mapping[str, bool]] = field(default_factory=dict)
    sizes: Mapping[str, float] = field(default_factory=dict)
    places: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    seen: frozenset[str] = frozenset()
    pictured: bool = False
    sayable: frozenset[str] = frozenset()
    robots: frozenset[str] = frozenset()

    def recoloured(self, colors: Mapping[str, str]) -> Appearance:
        """Return the appearance with different colours for the given entities."""
        new = {entity: color_terms(color) for entity, color in colors.items() if entity in self.nouns}
        return replace(self, colors={**self.colors, **new})

    @cached_property
    def terms(self) -> tuple[str, ...]:
        """The colour terms that fit something and that the language has."""
        sure = [term for terms in self.colors.values() for term, fits in terms.items() if fits]
        return tuple(term for term in dict.fromkeys(sure) if term in self.sayable)


def appearance_of(domain: Domain, grammar: Grammar, colors: Mapping[str, str] | None = None) -> Appearance:
    """Return the appearance of the entities of a domain in a language; `colors` override those of the scene."""
    entities = domain.facts.entity_names
    parents = domain.facts.class_names
    nouns = {
        entity: tuple(
            dict.fromkeys(grammar.nouns[name].word for name in _line(entity, kind, parents) if name in grammar.nouns)
        )
        for entity, kind in entities.items()
    }
    short = {entity: plain(entity.removeprefix(kind).lstrip("_(") or entity) for entity, kind in entities.items()}
    spelled = {entity: (nouns[entity][:1], name) for entity, name in short.items()}
    taken = Counter(spelled.values())
    names = {entity: name if taken[spelled[entity]] == 1 else entity for entity, name in short.items()}
    if not domain.settings.scene:
        return Appearance(nouns, names)
    scene = load_scene(domain)
    shown = {  # a robot has its own colours
        entity: scene.table.color if shape.kind == "table" else scene.colors[entity]
        for entity, shape in scene.shapes.items()
        if shape.kind == "table" or (shape.kind != "robot" and _has_colour(scene, entity))
    }
    shown |= colors or {}
    bodies = {entity: shape for entity, shape in scene.shapes.items() if entity in entities and shape.traits.body}
    still = {entity for entity, shape in scene.shapes.items() if entity in scene.fixed or not shape.traits.body}
    return Appearance(
        nouns,
        names,
        colors={entity: color_terms(color) for entity, color in shown.items() if entity in entities},
        sizes={entity: prod(shape.size) ** (1 / 3) for entity, shape in bodies.items() if entity not in scene.ranges},
        places={  # metres to the right and to the back, as seen by the viewer to whom the frame belongs
            entity: (y, -x) if scene.frame == "viewer" else (-y, x)
            for entity, (x, y, _) in scene.fixed.items()
            if entity in entities
        },
        seen=frozenset(still & set(entities)),
        pictured=True,
        robots=frozenset(scene.robots) & set(entities),
        sayable=frozenset(name for kind in ("colors", "sizes", "places") for name in grammar.words.table.get(kind, {})),
    )


def _has_colour(scene: Scene, entity: str) -> bool:
    """Return whether an entity has a single colour, not the colours in the file of its body."""
    model = scene.shapes[entity].model
    return entity in scene.colors and (model is None or not model.looks or scene.colors[entity] != WHITE)


def _line(entity: str, kind: str, parents: Mapping[str, tuple[str, ...]]) -> list[str]:
    """Return an entity, its class and its superclasses, nearest first."""
    found = [entity, kind]
    for name in found:
        found += [parent for parent in parents.get(name, ()) if parent not in found]
    return found


@lru_cache(maxsize=4096)
def color_terms(color: str) -> Mapping[str, bool]:
    """Return the basic terms that may describe a colour: true for the nearest term, false for terms in doubt."""
    here = lab(color)
    distances = {term: min(dist(here, lab(each)) for each in colors) for term, colors in BASIC.items()}
    nearest = min(distances, key=distances.__getitem__)
    doubtful = {term: False for term, far in distances.items() if far <= distances[nearest] + DOUBT}
    return {nearest: True, **{term: sure for term, sure in doubtful.items() if term != nearest}}


@lru_cache(maxsize=4096)
def lab(color: str) -> Lab:
    """Return a colour ``#rrggbb`` in CIELAB, relative to the white point of sRGB (IEC 61966-2-1, CIE 15)."""
    channels = [int(color[i : i + 2], 16) / 255 for i in (1, 3, 5)]
    red, green, blue = (each / 12.92 if each <= 0.04045 else ((each + 0.055) / 1.055) ** 2.4 for each in channels)
    x = (0.4124 * red + 0.3576 * green + 0.1805 * blue) / 0.95047
    y = 0.2126 * red + 0.7152 * green + 0.0722 * blue
    z = (0.0193 * red + 0.1192 * green + 0.9505 * blue) / 1.08883
    fx, fy, fz = (each ** (1 / 3) if each > 216 / 24389 else (24389 / 27 * each + 16) / 116 for each in (x, y, z))
    return 116 * fy - 16, 500 * (fx - fy), 200 * (fy - fz)
