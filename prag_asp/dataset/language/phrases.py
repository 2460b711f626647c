"""The noun phrases of a language: written from descriptions, and parsed back into entities."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from itertools import product

from prag_asp.dataset.language.appearance import Appearance
from prag_asp.dataset.language.descriptions import PLACES, SIZES, ContextSet, Description, Relation, View
from prag_asp.dataset.language.sentences import Modifier, SentenceTable
from prag_asp.grammar.reader import Grammar, Noun, listed, plain
from prag_asp.grammar.template import Template, parse_template

CACHED = 1 << 14
"""The maximum number of phrases whose meaning in a context is cached; the tasks of a space share most of them."""


class NounPhrases:
    """All noun phrases for the objects of a domain."""

    def __init__(self, grammar: Grammar, appearance: Appearance, sentences: SentenceTable) -> None:
        self.grammar, self.words, self.appearance, self.sentences = grammar, grammar.words, appearance, sentences
        self._written: dict[tuple[Description, str], str] = {}
        self._nouns: dict[str, Noun] = {}
        for noun in grammar.nouns.values():
            self._nouns.setdefault(noun.word, noun)
        self.pronouns = frozenset(
            self.words.agreeing("it", gender, case) for gender, case in product(self.words.genders, self.words.cases)
        )

    def gender(self, entity: str) -> str:
        """Return the gender of the word for an entity."""
        nouns = self.appearance.nouns.get(entity, ())
        return self._nouns[nouns[0]].gender if nouns else self.words.genders[0]

    def pronoun(self, entity: str, case: str) -> str:
        """Return the pronoun for an entity."""
        return self.words.agreeing("it", self.gender(entity), case)

    def write(self, view: View, value: str, case: str, variant: int = 0, *, outdated: bool = False) -> str:
        """Return the noun phrase for an entity in a state, or the word for another value.

        If the phrase has a relation, later variants are less ambiguous than the first one. An `outdated` phrase says
        that the relation held originally.
        """
        if value not in self.appearance.nouns:
            return self.value(value)
        what = view.describe(value)
        case = case or self.words.cases[0]
        if what.relation is None:
            return self.plain(what, case)
        gender = self.gender(value)
        modifier = next(self._modifiers(what.relation, gender))
        words = []
        for other, slot in zip(modifier.arguments(what.relation), modifier.template.slots, strict=True):
            best = view.context.best(other) if other in self.appearance.nouns else None
            words.append(self.plain(best, slot.case or self.words.cases[0]) if best else self.value(other))
        where = modifier.template.fill(words)
        forms, formerly = (
            [each for each in templates if not each.genders or gender in each.genders]
            for templates in (self._modified, self._formerly)
        )
        if modifier.template.genders:  # the modifier has a verb
            variant = 0
        elif outdated and formerly:
            return formerly[0].fill([self.plain(what._replace(relation=None), case), where])
        return forms[min(variant, len(forms) - 1)].fill([self.plain(what._replace(relation=None), case), where])

    def value(self, value: str) -> str:
        """Return the word for a value that is neither an entity nor a class."""
        return self.grammar.values.get(value) or plain(value)

    def plain(self, what: Description, case: str) -> str:
        """Return the noun phrase for a description without a relation."""
        known = self._written.get((what, case))
        if known is not None:
            return known
        noun = self._nouns.get(what.noun)
        gender = noun.gender if noun else self.words.genders[0]
        word = noun.forms[case] if noun else ""
        the = self.words.agreeing("the", gender, case)
        if what.name:
            name = self._displayed(self.appearance.names.get(what.name, plain(what.name)))
            if word and name.endswith(f" {word}"):  # "the left arm", not "arm left arm"
                parts = f"{the} {name}".split()
            else:
                parts = str(self.words.table["named"]).format(the=the, noun=word, name=name).split()
        else:
            by_kind = {"the": the, "noun": word}
            for kind in ("color", "size", "place"):
                term = getattr(what, kind)
                by_kind[kind] = self.words.adjective(f"{kind}s", term, gender, case) if term else ""
            parts = [by_kind[kind] for kind in self.words.table["phrase"] if by_kind[kind]]
        self._written[what, case] = " ".join(parts)
        return self._written[what, case]

    def _displayed(self, name: str) -> str:
        """Return the name of an entity as it appears in phrases; a single letter is in upper case: "block A"."""
        upper = name.upper()
        return upper if len(name) == 1 and upper not in self.appearance.names.values() else name

    def _modifiers(self, relation: Relation, gender: str = "") -> Iterator[Modifier]:
        """Yield the modifiers that mean only this relation; `gender` is that of the subject, or "" for any."""
        for modifier in self.sentences.modifiers.get((relation.name, len(relation.others) + 1), ()):
            genders = modifier.template.genders
            if gender and genders and gender not in genders:
                continue
            if modifier.subject == relation.subject and len(modifier.meant(modifier.arguments(relation))) == 1:
                yield modifier

    def can_say(self, relation: Relation) -> bool:
        """Return whether the language has a modifier that means only this relation."""
        return any(self._modifiers(relation))

    @cached_property
    def _modified(self) -> tuple[Template, ...]:
        """The templates of a noun phrase followed by a modifier."""
        return tuple(self._with_modifier(self.words.table["modified"], "is"))

    @cached_property
    def _formerly(self) -> tuple[Template, ...]:
        """The templates of a noun phrase followed by a modifier that was true originally, if the language has any."""
        return tuple(self._with_modifier(listed(self.words.table.get("formerly", ())), "was"))

    def _with_modifier(self, texts: Sequence[str], verb: str) -> Iterator[Template]:
        """Yield templates of a noun phrase and a modifier: if a text has a verb, one for each of its forms."""
        for text in texts:
            spelled = text.replace("{phrase}", "{0}").replace("{where}", "{1}")
            for gender in self.words.genders if f"{{{verb}}}" in spelled else ("",):
                verbs = {verb: self.words.agreeing(verb, gender)} if gender else {}
                yield parse_template(spelled, self.words.cases, 2, verbs, frozenset([gender] if gender else []))

    @cached_property
    def _known(self) -> Mapping[str, tuple[Description, ...]]:
        """The descriptions that each phrase without a relation can mean."""
        found: dict[str, list[Description]] = {}
        appearance, cases = self.appearance, self.words.cases
        nouns = list(dict.fromkeys(noun for own in appearance.nouns.values() for noun in own))
        sizes = ["", *(size for size in SIZES if size in appearance.sayable)] if appearance.sizes else [""]
        places = ["", *(place for place in PLACES if place in appearance.sayable)] if appearance.places else [""]
        for noun, color, size, place, case in product(nouns, ["", *appearance.terms], sizes, places, cases):
            what = Description(noun, color, size, place)
            found.setdefault(self.plain(what, case), []).append(what)
        for entity, own in appearance.nouns.items():
            for case in cases:
                what = Description(own[0] if own else "", name=entity)
                found.setdefault(self.plain(what, case), []).append(what)
        return {text: tuple(dict.fromkeys(whats)) for text, whats in found.items()}

    @cached_property
    def _values(self) -> Mapping[str, frozenset[str]]:
        """The values other than entities and classes that each text can mean."""
        found: dict[str, set[str]] = {}
        sentences = [
            sentence for each in (*self.sentences.actions.values(), *self.sentences.facts.values()) for sentence in each
        ]
        for atoms in {id(sentence.atoms): sentence.atoms for sentence in sentences}.values():
            for atom in atoms:
                for argument in atom.arguments:
                    if argument not in self.appearance.nouns:
                        found.setdefault(self.value(argument), set()).add(argument)
        return {text: frozenset(values) for text, values in found.items()}

    def read(self, view: View, text: str) -> tuple[frozenset[str], bool]:
        """Return the possible meanings of a phrase in a state, and whether they depend on the state."""
        context = view.context
        known = context.read.get(text) or view.read.get(text)
        if known is None:
            related = any(True for _, where in self._modifications(text) for _ in self._relations(context, where))
            found = self._plainly(context, text) | self.stated(view, text).keys()
            if len(context.read) > CACHED:
                context.read.clear()
            known = (view.read if related else context.read)[text] = frozenset(found), related
        return known

    def stated(self, view: View, text: str) -> dict[str, set[Relation]]:
        """Return the relations that a phrase states about each entity that it can mean."""
        found: dict[str, set[Relation]] = {}
        for whats, where in self._modifications(text):
            for relation in self._relations(view.context, where):
                entities = (view.meant(what._replace(relation=relation)) for what in whats if not what.name)
                for entity in entities:
                    if entity is not None:
                        found.setdefault(entity, set()).add(relation)
        return found

    def _modifications(self, text: str) -> Iterator[tuple[tuple[Description, ...], str]]:
        """Yield the descriptions with which a text can begin, each with the modifier that follows."""
        for template in (*self._modified, *self._formerly):
            first, between, last = template.texts
            if text.startswith(first) and text.endswith(last):
                inner = text[len(first) : len(text) - len(last)]
                at = inner.find(between, 1)
                while at >= 0:
                    if inner[:at] in self._known:
                        yield self._known[inner[:at]], inner[at + len(between) :]
                    at = inner.find(between, at + 1)

    def vocabulary(self) -> list[str]:
        """Return all texts that can be part of a phrase."""
        where = [
            text for each in self.sentences.modifiers.values() for modifier in each for text in modifier.template.texts
        ]
        return [*self._known, *self._values, *where]

    def fitting(self, view: View, text: str) -> list[str] | None:
        """Return the entities that a phrase without a relation may fit, or None if the text is not such a phrase."""
        if text not in self._known:
            return None
        context = view.context
        return [
            each
            for each in context.entities
            if any(context.fits(what, each) is not False for what in self._known[text])
        ]

    def _relations(self, context: ContextSet, text: str) -> Iterator[Relation]:
        """Yield the relations that a text can mean."""
        for modifiers in self.sentences.modifiers.values():
            for modifier in modifiers:
                for words in modifier.template.find(text):
                    choices = [self._plainly(context, word) for word in words]
                    for arguments in product(*choices):
                        meant = modifier.meant(arguments)
                        if len(meant) == 1:
                            yield from meant

    def _plainly(self, context: ContextSet, text: str) -> set[str]:
        found = {entity for what in self._known.get(text, ()) if (entity := context.meant(what)) is not None}
        return found | self._values.get(text, frozenset())
