"""Noun phrases of a language: written from descriptions, and read back into what they mean."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cached_property
from itertools import product

from prag_asp.dataset.language.appearance import Looks
from prag_asp.dataset.language.descriptions import PLACES, SIZES, Crowd, Description, Relation, View
from prag_asp.dataset.language.sentences import Clauses, Modifier
from prag_asp.grammar.reader import Grammar, Noun, plain
from prag_asp.grammar.template import Template, agrees, parse_template

KEPT = 1 << 14
"""Texts of which it is kept what they mean in a picture."""


class Phrases:
    """All noun phrases for the things of a domain."""

    def __init__(self, grammar: Grammar, looks: Looks, clauses: Clauses) -> None:
        self.grammar, self.words, self.looks, self.clauses = grammar, grammar.words, looks, clauses
        self._written: dict[tuple[Description, str], str] = {}
        self._nouns: dict[str, Noun] = {}
        for noun in grammar.nouns.values():
            self._nouns.setdefault(noun.word, noun)
        self.pronouns = frozenset(
            self.words.agreeing("it", gender, case) for gender, case in product(self.words.genders, self.words.cases)
        )

    def gender(self, entity: str) -> str:
        """Return the gender of the word for an entity."""
        nouns = self.looks.nouns.get(entity, ())
        return self._nouns[nouns[0]].gender if nouns else self.words.genders[0]

    def pronoun(self, entity: str, case: str) -> str:
        """Return the pronoun for an entity."""
        return self.words.agreeing("it", self.gender(entity), case)

    def write(self, view: View, value: str, case: str, variant: int = 0) -> str:
        """Return an entity in words, as it is to be told in a state; of what is no entity, the word for it.

        Where a relation tells an entity from others, variants after the first are harder to misunderstand.
        """
        if value not in self.looks.nouns:
            return self.value(value)
        what = view.describe(value)
        case = case or self.words.cases[0]
        if what.relation is None:
            return self.plain(what, case)
        gender = self.gender(value)
        modifier = next(self._modifiers(what.relation, gender))
        where = self._where(view.crowd, what.relation, modifier)
        forms = [each for each in self._modified if not each.genders or gender in each.genders]
        if modifier.template.genders:  # it is a clause with a verb
            variant = 0
        return forms[min(variant, len(forms) - 1)].fill([self.plain(what._replace(relation=None), case), where])

    def value(self, value: str) -> str:
        """Return what is neither an entity nor a class in words."""
        return self.grammar.values.get(value) or plain(value)

    def plain(self, what: Description, case: str) -> str:
        """Return a description without a relation in words."""
        text = self._written.get((what, case))
        if text is None:
            text = self._written[what, case] = self._plain(what, case)
        return text

    def _plain(self, what: Description, case: str) -> str:
        noun = self._nouns.get(what.noun)
        gender = noun.gender if noun else self.words.genders[0]
        word = noun.forms[case] if noun else ""
        the = self.words.agreeing("the", gender, case)
        if what.name:
            name = self.looks.names.get(what.name, plain(what.name))
            return " ".join(str(self.words.table["named"]).format(the=the, noun=word, name=name).split())
        parts = {"the": the, "noun": word}
        for part in ("color", "size", "place"):
            term = getattr(what, part)
            parts[part] = self.words.adjective(f"{part}s", term, gender, case) if term else ""
        return " ".join(parts[part] for part in self.words.table["phrase"] if parts[part])

    def _where(self, crowd: Crowd, relation: Relation, modifier: Modifier) -> str:
        """Return what a relation says of its subject; the other things are meant without a relation themselves."""
        words = []
        for value, slot in zip(modifier.arguments(relation), modifier.template.slots, strict=True):
            best = crowd.best(value) if value in self.looks.nouns else None
            words.append(self.plain(best, slot.case or self.words.cases[0]) if best else self.value(value))
        return modifier.template.fill(words)

    def _modifiers(self, relation: Relation, gender: str = "") -> Iterator[Modifier]:
        """Yield what says a relation of something of a gender, and nothing else."""
        for modifier in self.clauses.modifiers.get((relation.name, len(relation.others) + 1), ()):
            genders = modifier.template.genders
            if gender and genders and gender not in genders:
                continue
            if modifier.subject == relation.subject and len(modifier.meant(modifier.arguments(relation))) == 1:
                yield modifier

    def can_say(self, relation: Relation) -> bool:
        """Tell whether the language has words for a relation that mean no other."""
        return any(self._modifiers(relation))

    @cached_property
    def _modified(self) -> tuple[Template, ...]:
        """The ways to say a relation: a phrase, then where it is."""
        found = []
        for text in self.words.table["modified"]:
            spelled = text.replace("{phrase}", "{0}").replace("{where}", "{1}")
            for gender in self.words.genders if agrees(spelled) else ("",):
                verbs = {"is": self.words.agreeing("is", gender)} if gender else {}
                genders = frozenset([gender] if gender else [])
                found.append(parse_template(spelled, self.words.cases, 2, verbs, genders))
        return tuple(found)

    @cached_property
    def _known(self) -> Mapping[str, tuple[Description, ...]]:
        """The descriptions that each phrase without a relation stands for: as many as there are, made once."""
        found: dict[str, list[Description]] = {}
        looks, cases = self.looks, self.words.cases
        nouns = list(dict.fromkeys(noun for own in looks.nouns.values() for noun in own))
        sizes = ["", *(size for size in SIZES if size in looks.sayable)] if looks.sizes else [""]
        places = ["", *(place for place in PLACES if place in looks.sayable)] if looks.places else [""]
        for noun, color, size, place, case in product(nouns, ["", *looks.terms], sizes, places, cases):
            what = Description(noun, color, size, place)
            found.setdefault(self.plain(what, case), []).append(what)
        for entity, own in looks.nouns.items():
            for case in cases:
                what = Description(own[0] if own else "", name=entity)
                found.setdefault(self.plain(what, case), []).append(what)
        return {text: tuple(dict.fromkeys(whats)) for text, whats in found.items()}

    @cached_property
    def _values(self) -> Mapping[str, frozenset[str]]:
        """The values, neither entities nor classes, that each text stands for."""
        found: dict[str, set[str]] = {}
        clauses = [clause for each in (*self.clauses.actions.values(), *self.clauses.facts.values()) for clause in each]
        for atoms in {id(clause.atoms): clause.atoms for clause in clauses}.values():
            for atom in atoms:
                for argument in atom.arguments:
                    if argument not in self.looks.nouns:
                        found.setdefault(self.value(argument), set()).add(argument)
        return {text: frozenset(values) for text, values in found.items()}

    def read(self, view: View, text: str) -> tuple[frozenset[str], bool]:
        """Return what a phrase or the word for a value can mean in a state, and whether that depends on the state."""
        crowd = view.crowd
        known = crowd.read.get(text) or view.read.get(text)
        if known is None:
            found, related = self._plainly(crowd, text), False
            for whats, where in self._modifications(text):
                for relation in self._relations(crowd, where):
                    related = True
                    entities = (view.meant(what._replace(relation=relation)) for what in whats if not what.name)
                    found |= {entity for entity in entities if entity is not None}
            if len(crowd.read) > KEPT:
                crowd.read.clear()
            known = (view.read if related else crowd.read)[text] = frozenset(found), related
        return known

    def _modifications(self, text: str) -> Iterator[tuple[tuple[Description, ...], str]]:
        """Yield the descriptions that a text can begin with, and where it then says that their things are."""
        for template in self._modified:
            first, between, last = template.texts
            if text.startswith(first) and text.endswith(last):
                inner = text[len(first) : len(text) - len(last)]
                at = inner.find(between, 1)
                while at >= 0:
                    if inner[:at] in self._known:
                        yield self._known[inner[:at]], inner[at + len(between) :]
                    at = inner.find(between, at + 1)

    def vocabulary(self) -> list[str]:
        """Return all texts that a phrase can be made of."""
        where = [
            text for each in self.clauses.modifiers.values() for modifier in each for text in modifier.template.texts
        ]
        return [*self._known, *self._values, *where]

    def fitting(self, view: View, text: str) -> list[str] | None:
        """Return the entities that a phrase without a relation may mean, None where a text is no such phrase."""
        if text not in self._known:
            return None
        crowd = view.crowd
        return [
            each for each in crowd.entities if any(crowd.fits(what, each) is not False for what in self._known[text])
        ]

    def _relations(self, crowd: Crowd, text: str) -> Iterator[Relation]:
        """Yield the relations that a text can stand for."""
        for modifiers in self.clauses.modifiers.values():
            for modifier in modifiers:
                for words in modifier.template.find(text):
                    choices = [self._plainly(crowd, word) for word in words]
                    for arguments in product(*choices):
                        meant = modifier.meant(arguments)
                        if len(meant) == 1:
                            yield from meant

    def _plainly(self, crowd: Crowd, text: str) -> set[str]:
        found = {entity for what in self._known.get(text, ()) if (entity := crowd.meant(what)) is not None}
        return found | self._values.get(text, frozenset())
