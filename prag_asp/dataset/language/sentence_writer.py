"""Write unambiguous sentences: each one is parsed before it is used, and replaced by another if it is ambiguous."""

from __future__ import annotations

from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass, field
from hashlib import blake2b
from typing import NamedTuple, TypeVar

from prag_asp.atom import Atom
from prag_asp.dataset.language.descriptions import View
from prag_asp.dataset.language.instruction_reader import InstructionReader
from prag_asp.dataset.language.sentences import Sentence
from prag_asp.errors import QueryError
from prag_asp.grammar.phrasings import Phrasings
from prag_asp.grammar.template import Recurrence

Option = TypeVar("Option")

VARIANTS = (0, 1)
"""The variants of phrases with a relation, the shorter one first."""

CACHED = 1 << 16
"""The maximum number of cached sentences; the tasks of a space share most of them."""


class ClearSentence(NamedTuple):
    """An unambiguous sentence, its topic, and its subject, as `InstructionReader.subject` returns it."""

    text: str
    topic: str | None
    subject: str


class PhraseRng:
    """A random generator seeded with a text; it is the same on every machine and in every version of Python.

    The random numbers are digits of a digest of the text in a mixed base.
    """

    def __init__(self, text: str) -> None:
        self._seed = text.encode()
        self._value, self._left = 0, 1

    def number(self, options: int) -> int:
        """Return a random number from 0 to `options` - 1."""
        if self._left < options << 32:
            self._seed = blake2b(self._seed).digest()
            self._value, self._left = int.from_bytes(self._seed, "big"), 1 << 512
        self._value, found = divmod(self._value, options)
        self._left //= options
        return found

    def pick(self, options: Sequence[Option]) -> Option:
        """Return a random option."""
        return options[self.number(len(options))]


@dataclass(frozen=True)
class _Paraphrases:
    """The sentences for an action or a fluent: `given` ones, and `spare` ones in case all given ones are ambiguous.

    `shorter` sentences omit the place from which an object is moved, for phrases that already name this place. `things`
    holds the entities in the action or fluent, `known` is true if the domain has the action or fluent, and `clear`
    caches the unambiguous sentence for each combination of descriptions of the entities.
    """

    given: tuple[Sentence, ...]
    spare: tuple[Sentence, ...]
    shorter: tuple[Sentence, ...]
    things: tuple[str, ...]
    known: bool
    clear: dict[object, ClearSentence | None] = field(default_factory=dict)


class SentenceWriter:
    """A writer of sentences that a reader parses back to exactly one action, or one fluent and its value."""

    def __init__(self, reader: InstructionReader, phrasings: Phrasings) -> None:
        self._reader, self._lexicon, self._phrasings = reader, reader.lexicon, phrasings
        self._paraphrases: dict[tuple[Atom, bool, bool, Recurrence], _Paraphrases] = {}
        self._cached = 0

    def write(
        self,
        view: View,
        atom: Atom,
        topic: str | None,
        rng: PhraseRng | None,
        *,
        value: bool = True,
        fact: bool = False,
        recurrence: Recurrence = "new",
        outdated: Set[str] = frozenset(),
    ) -> ClearSentence:
        """Return an unambiguous sentence for an action, or for a `fact` with its value, and the topic of the sentence.

        The sentence of an action may state its `recurrence`, as in "put it back into the tray". Relations in the
        phrases for `outdated` objects no longer hold when the action begins.

        Raises:
            QueryError: every sentence for the atom could mean something else.
        """
        key = (atom, value, fact, recurrence)
        sentences = self._paraphrases.get(key)
        if sentences is None:
            sentences = self._paraphrases[key] = self._find_paraphrases(*key)
        first = rng.number(len(sentences.given)) if sentences.given and rng else 0
        old = frozenset(each for each in sentences.things if each in outdated)
        way = (view.context, topic, first, view.related(sentences.things), old)
        try:
            found = sentences.clear[way]
        except KeyError:
            ordered = (*sentences.given[first:], *sentences.given[:first], *sentences.spare)
            shorter = sentences.shorter if self._names_source(view, sentences.shorter, atom, topic) else ()
            found, of_state = self._search(view, (*shorter, *ordered), key[:3], topic, old)
            if not of_state:
                if self._cached > CACHED:
                    for each in self._paraphrases.values():
                        each.clear.clear()
                    self._cached = 0
                sentences.clear[way] = found
                self._cached += 1
        if found is not None:
            return found
        domain, language = self._lexicon.domain.name, self._lexicon.language
        if not sentences.known:
            raise QueryError(
                f"{atom} is not {'a fluent' if fact else 'an action'} of {domain}; give tasks of that domain"
            )
        raise QueryError(
            f"no unambiguous sentence for {atom}; write one that names all its arguments "
            f"under [language.{language}.{'facts' if fact else 'actions'}]"
        )

    def _names_source(self, view: View, shorter: Sequence[Sentence], atom: Atom, topic: str | None) -> bool:
        """Return whether the phrase for the object of an action names the place from which the action moves it."""
        if not shorter:
            return False
        thing = shorter[0].arguments(atom)[shorter[0].moved]
        relation = view.describe(thing).relation if thing in self._lexicon.appearance.nouns else None
        return thing != topic and relation is not None and relation.about(thing) == shorter[0].sources.get(atom)

    def facts(
        self,
        view: View,
        facts: Mapping[Atom, bool],
        topic: str | None = None,
        rng: PhraseRng | None = None,
        outdated: Set[str] = frozenset(),
        *,
        recurrence: Recurrence = "new",
    ) -> list[ClearSentence]:
        """Return a sentence for each fact for which there is an unambiguous one."""
        texts = []
        for fluent, value in facts.items():
            try:
                sentence = self.write(
                    view, fluent, topic, rng, value=value, fact=True, recurrence=recurrence, outdated=outdated
                )
                texts.append(sentence)
            except QueryError:
                continue
        return texts

    def _search(
        self,
        view: View,
        sentences: Sequence[Sentence],
        meaning: tuple[Atom, bool, bool],
        topic: str | None,
        outdated: Set[str],
    ) -> tuple[ClearSentence | None, bool]:
        """Return the first unambiguous sentence, and whether the choice depends on the state.

        Dependence on the descriptions of the objects alone does not count.
        """
        (atom, value, fact), of_state, phrases = meaning, False, self._lexicon.phrases
        for variant in VARIANTS:
            for clause in sentences:
                words, pronouns = list[str](), set[int]()
                for slot in clause.template.slots:
                    thing = atom.arguments[slot.argument]
                    if thing == topic and not (words and thing in self._lexicon.appearance.robots):
                        pronouns.add(len(words))
                        words.append(phrases.pronoun(thing, slot.case))
                    else:
                        words.append(phrases.write(view, thing, slot.case, variant, outdated=thing in outdated))
                text = clause.template.fill(words, pronouns)
                meanings, unsure = self._reader.parse_sentence(view, text, topic, of_actions=not fact)
                of_state |= unsure
                if {(parsed.atom, parsed.value) for parsed in meanings} == {(atom, value)}:
                    topics = {parsed.topic for parsed in meanings}
                    subject = self._reader.subject(clause.template, words)
                    return ClearSentence(text, topics.pop() if len(topics) == 1 else None, subject), of_state
        return None, of_state

    def _find_paraphrases(self, atom: Atom, value: bool, fact: bool, recurrence: Recurrence) -> _Paraphrases:
        """Return the sentences; if only some phrasings are written, an action has no spare sentences."""
        lexicon = self._lexicon
        table = lexicon.sentences.facts if fact else lexicon.sentences.actions
        known = [each for each in table.get((atom.name, len(atom.arguments)), ()) if each.value == value]
        usable, shorter = [], []
        for each in known:
            template = each.template
            if template.recurrences and recurrence not in template.recurrences:
                continue
            if each.sources:
                shorter += [each] if atom in each.sources else []
                continue
            first = lexicon.phrases.gender(atom.arguments[template.arguments[0]]) if template.slots else ""
            if not template.genders or first in template.genders:
                usable.append(each)
        given = [each for each in usable if not each.spare and each.identifies(atom, lexicon.appearance.robots)]
        if fact:  # a single robot need not be named
            fewest = min((len(each.template.slots) for each in given), default=0)
            given = [each for each in given if len(each.template.slots) == fewest]
        chosen = [each for each in given if self._phrasings.has(each.template.phrasing)]
        if chosen or not fact:
            given = chosen
        spare = [each for each in usable if each.spare and (fact or self._phrasings.all <= 1)]
        things = tuple(each for each in atom.arguments if each in lexicon.appearance.nouns)
        shorter = [each for each in shorter if each.spare or self._phrasings.has(each.template.phrasing)]
        named = any(atom in clause.atoms for clause in known)
        return _Paraphrases(tuple(given), tuple(spare), tuple(shorter), things, named)
