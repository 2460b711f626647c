"""Referring expressions: the shortest description that fits an object in a state and nothing else.

Unknown facts may hold: a description distinguishes an object from another only if it is known not to fit the other.
Therefore, a description never fits two objects in a picture, in any state that the task allows.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import cached_property
from itertools import combinations
from typing import NamedTuple

from prag_asp.atom import Atom
from prag_asp.dataset.language.appearance import APART, LARGER, Appearance
from prag_asp.task import FrozenDict, State

NEARLY = 1.05
"""The ratio up to which extents count as equal, because such a difference is not visible."""


Signature = tuple[str, int]
"""The name of a fluent, and the number of its arguments."""


class InstructionContext(NamedTuple):
    """The context of an instruction: the entities that are present, and the known facts of the state."""

    entities: frozenset[str]
    state: State

    def at(self, state: State) -> InstructionContext:
        """Return the context of another state with the same objects."""
        return self._replace(state=state if isinstance(state, FrozenDict) else FrozenDict(state))


class Relation(NamedTuple):
    """A property of an object: a fluent with its name, the index of the object, and the other arguments."""

    name: str
    subject: int
    others: tuple[str, ...]

    def about(self, entity: str) -> Atom:
        """Return the fluent that states this property of an entity."""
        return Atom(self.name, (*self.others[: self.subject], entity, *self.others[self.subject :]))


class Description(NamedTuple):
    """The content of a noun phrase: the noun, and properties that distinguish an object from others of this kind.

    `name` is the entity itself if no property distinguishes it.
    """

    noun: str
    color: str = ""
    size: str = ""
    place: str = ""
    relation: Relation | None = None
    name: str = ""


class ContextSet:
    """The objects in a picture, and the descriptions that fit them in every state; `read` caches phrases."""

    def __init__(self, appearance: Appearance, entities: frozenset[str]) -> None:
        self.appearance = appearance
        self.entities = tuple(sorted(entities))
        self._groups: dict[str, tuple[str, ...]] = {}
        self._best: dict[str, Description | None] = {}
        self._short: dict[str, Description | None] = {}
        self._meant: dict[Description, str | None] = {}
        self.read: dict[str, tuple[frozenset[str], bool]] = {}

    @cached_property
    def certain(self) -> frozenset[str]:
        """The objects whose best description is the same in every state."""
        return frozenset(entity for entity in self.entities if self.short(entity) is not None)

    @property
    def settled(self) -> bool:
        """Whether the best description of every entity is the same in all states."""
        return len(self.certain) == len(self.entities)

    def fits(self, what: Description, entity: str) -> bool | None:
        """Return whether a description, apart from its relation, fits an entity, or None if this is in doubt."""
        if what.name:
            return what.name == entity
        if what.noun not in self.appearance.nouns.get(entity, ()):
            return False
        verdicts = (
            self._has_color(what.color, entity) if what.color else True,
            self._has_size(what.size, what.noun, entity) if what.size else True,
            self._has_place(what.place, what.noun, entity) if what.place else True,
        )
        return False if False in verdicts else None if None in verdicts else True

    def best(self, entity: str) -> Description | None:
        """Return the shortest description without a relation that fits only this entity, or None if there is none."""
        if entity not in self._best:
            found = (each for each in self.properties(entity) if self.meant(each) == entity)
            self._best[entity] = next(found, None)
        return self._best[entity]

    def short(self, entity: str) -> Description | None:
        """Return the best description of an entity if, in every state, no description with a relation is better."""
        if entity not in self._short:
            best = self.best(entity)
            enough = best is not None and (not self.appearance.pictured or sum(map(bool, best[1:])) <= 1)
            self._short[entity] = best if enough else None
        return self._short[entity]

    def properties(self, entity: str) -> Iterator[Description]:
        """Yield the descriptions of an entity that use its properties, shortest first (full brevity, Dale 1989).

        Among descriptions of the same length, colour comes before size, and size before place, as people prefer (the
        preference order of the incremental algorithm, Dale and Reiter 1995).
        """
        nouns = self.appearance.nouns.get(entity, ())
        if not nouns:
            return
        known = [
            ("color", [term for term, sure in self.appearance.colors.get(entity, {}).items() if sure]),
            ("size", [size for size in SIZES if self._has_size(size, nouns[0], entity)]),
            ("place", [place for place in PLACES if self._has_place(place, nouns[0], entity)]),
        ]
        choices = [(kind, value) for kind, values in known for value in values if value in self.appearance.sayable]
        for number in range(len(known) + 1):
            for chosen in combinations(choices, number):
                words = dict(chosen)
                if len(words) == number:
                    yield Description(nouns[0], words.get("color", ""), words.get("size", ""), words.get("place", ""))

    def meant(self, what: Description) -> str | None:
        """Return the entity that a description without a relation surely fits if it can fit no other, or None."""
        if what not in self._meant:
            fitting = [entity for entity in self.entities if self.fits(what, entity) is not False]
            sure = len(fitting) == 1 and self.fits(what, fitting[0])
            self._meant[what] = fitting[0] if sure else None
        return self._meant[what]

    def _has_color(self, term: str, entity: str) -> bool | None:
        terms = self.appearance.colors.get(entity)
        if terms is None:
            return None
        return (terms[term] or None) if term in terms else False

    def _has_size(self, size: str, noun: str, entity: str) -> bool | None:
        sizes = self.appearance.sizes
        if entity not in sizes:
            return None
        known = [sizes[each] for each in self._group(noun) if each in sizes]
        sign = 1 if size == "large" else -1
        ratio = max((each / sizes[entity]) ** sign for each in known)
        if ratio >= LARGER:
            return False
        differ = max(known) / min(known) >= LARGER
        return True if ratio <= NEARLY and differ else None

    def _has_place(self, place: str, noun: str, entity: str) -> bool | None:
        places = self.appearance.places
        if entity not in places:
            return None
        axis, sign = PLACES[place]
        known = [sign * places[each][axis] for each in self._group(noun) if each in places]
        behind = sign * places[entity][axis] - min(known)
        if behind >= APART:
            return False
        return True if not behind and max(known) - min(known) >= APART else None

    def _group(self, noun: str) -> tuple[str, ...]:
        """Return the entities that a noun fits."""
        if noun not in self._groups:
            nouns = self.appearance.nouns
            self._groups[noun] = tuple(each for each in self.entities if noun in nouns.get(each, ()))
        return self._groups[noun]


PLACES: Mapping[str, tuple[int, int]] = {"left": (0, 1), "right": (0, -1), "front": (1, 1), "back": (1, -1)}
"""The axis of each place word, and the direction along it."""


SIZES = ("large", "small")
"""The words for the size of an object compared with others of its kind."""


class View:
    """A state as its pictures show it; `read` caches the meanings of phrases in this state."""

    def __init__(
        self,
        context: ContextSet,
        state: State,
        subjects: Mapping[Signature, frozenset[int]],
        can_say: Callable[[Relation], bool],
    ) -> None:
        self.context, self.state, self._subjects, self._can_say = context, state, subjects, can_say
        self.read: dict[str, tuple[frozenset[str], bool]] = {}
        self._described: dict[str, Description] = {}

    def describe(self, entity: str) -> Description:
        """Return the shortest description that fits an entity and nothing else, or its name if there is none."""
        if entity not in self._described:
            self._described[entity] = self.context.short(entity) or self._search(entity)
        return self._described[entity]

    def related(self, things: tuple[str, ...]) -> tuple[Description | None, ...]:
        """Return each object's description if it uses a relation, otherwise None; or nothing if no object has one."""
        if self.context.certain.issuperset(things):
            return ()
        return tuple(each if each.relation is not None else None for each in map(self.describe, things))

    def outdated(self, things: Iterable[str], later: State) -> frozenset[str]:
        """Return the objects whose descriptions use a relation whose facts differ in a later state."""
        if self.context.settled:
            return frozenset()
        found = set()
        for thing in self.context.certain.symmetric_difference(self.context.entities).intersection(things):
            relation = self.describe(thing).relation
            about = [relation.about(each) for each in self.context.entities] if relation is not None else []
            if any(self.state.get(fluent) != later.get(fluent) for fluent in about):
                found.add(thing)
        return frozenset(found)

    def _search(self, entity: str) -> Description:
        """Return the best description; a relation counts like a property, but is tried after all properties."""
        best = self.context.best(entity)
        named = Description(next(iter(self.context.appearance.nouns.get(entity, ())), ""), name=entity)
        if not self.context.appearance.pictured:
            return best or named
        relations = self.relations.get(entity, ())
        for plain in self.context.properties(entity) if relations else ():
            if best is not None and sum(map(bool, plain[1:])) + 1 >= sum(map(bool, best[1:])):
                break
            for relation in relations:
                found = plain._replace(relation=relation)
                if self.meant(found) == entity:
                    return found
        return best or named

    def meant(self, what: Description) -> str | None:
        """Return the entity that a description certainly fits if it can fit no other one, or None."""
        relation = what.relation
        if relation is None:
            return self.context.meant(what)
        fitting = []
        for entity in self.context.entities:
            related = False if entity in relation.others else self.state.get(relation.about(entity))
            if related is not False and self.context.fits(what, entity) is not False:
                fitting.append((entity, related and self.context.fits(what, entity)))
        return fitting[0][0] if len(fitting) == 1 and fitting[0][1] else None

    @cached_property
    def relations(self) -> Mapping[str, tuple[Relation, ...]]:
        """The known relations of each entity to objects that have a description without a relation."""
        found: dict[str, list[Relation]] = {}
        nouns, best = self.context.appearance.nouns, self.context.best
        for fluent in sorted(fluent for fluent, value in self.state.items() if value):
            for subject in sorted(self._subjects.get((fluent.name, len(fluent.arguments)), ())):
                others = (*fluent.arguments[:subject], *fluent.arguments[subject + 1 :])
                relation = Relation(fluent.name, subject, others)
                if all(each not in nouns or best(each) is not None for each in others) and self._can_say(relation):
                    found.setdefault(fluent.arguments[subject], []).append(relation)
        return {entity: tuple(relations) for entity, relations in found.items()}
