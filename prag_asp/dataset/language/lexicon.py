"""The lexicon of a domain in one language: sentences and noun phrases, with their meanings in each state."""

from __future__ import annotations

from collections.abc import Mapping
from copy import copy
from functools import cached_property, lru_cache, partial
from typing import TYPE_CHECKING

from prag_asp.atom import Atom, atom_of
from prag_asp.dataset.language.appearance import appearance_of
from prag_asp.dataset.language.descriptions import ContextSet, InstructionContext, View
from prag_asp.dataset.language.phrases import NounPhrases
from prag_asp.dataset.language.sentences import SentenceTable
from prag_asp.errors import QueryError
from prag_asp.grammar.reader import GrammarReader, languages
from prag_asp.grammar.word_table import shipped_languages
from prag_asp.wording import did_you_mean, listed

if TYPE_CHECKING:
    from prag_asp.domain.load import Domain
    from prag_asp.task import State

CACHED = 256
"""The maximum number of cached contexts and states; the tasks of a space share most of them."""


class Lexicon:
    """The sentences and noun phrases of a domain in one language."""

    def __init__(self, domain: Domain, language: str, colors: Mapping[str, str] | None = None) -> None:
        """Read a domain's tables for a language; `colors` override those of the scene.

        Raises:
            QueryError: the domain does not have the language, or lacks words in it.
            SceneError: the scene is invalid.
        """
        reader = _reader(domain, language)
        self.domain, self.language, self.words = domain, language, reader.words
        self.grammar = reader.grammar()
        self.appearance = appearance_of(domain, self.grammar, colors)
        self.sentences = SentenceTable(self.grammar, domain.facts)
        self.phrases = NounPhrases(self.grammar, self.appearance, self.sentences)
        self._entities = frozenset(domain.facts.entity_names)
        self._subjects: Mapping[tuple[str, int], frozenset[int]] = {
            signature: frozenset(modifier.subject for modifier in modifiers)
            for signature, modifiers in self.sentences.modifiers.items()
        }
        self._reset_caches()

    def recoloured(self, colors: Mapping[str, str]) -> Lexicon:
        """Return the lexicon for pictures in which some entities have the given colours."""
        other = copy(self)
        other.appearance = self.appearance.recoloured(colors)
        other.phrases = NounPhrases(self.grammar, other.appearance, self.sentences)
        other._reset_caches()
        return other

    @cached_property
    def implied(self) -> Mapping[Atom, frozenset[Atom]]:
        """The fluents that each fluent implies, by the state constraints of the domain."""
        found: dict[Atom, set[Atom]] = {}
        for fluent, other in self.domain.facts.implies:
            found.setdefault(atom_of(fluent), set()).add(atom_of(other))
        return {fluent: frozenset(others) for fluent, others in found.items()}

    def _reset_caches(self) -> None:
        """Create empty caches of contexts and states."""
        self._context = lru_cache(maxsize=CACHED)(partial(ContextSet, self.appearance))
        self._context_of = lru_cache(maxsize=CACHED)(self._known_context)
        self._view = lru_cache(maxsize=CACHED)(self._new_view)

    def view(self, known: InstructionContext) -> View:
        """Return the view of a state.

        The view is cached only if descriptions depend on the state, because otherwise a lookup takes longer than
        creating it.

        Raises:
            QueryError: the domain has no such entity.
        """
        context = self._context_of(known.entities)
        return self._new_view(context, known.state) if context.settled else self._view(context, known.state)

    def _new_view(self, context: ContextSet, state: State) -> View:
        return View(context, state, self._subjects, self.phrases.can_say)

    def _known_context(self, entities: frozenset[str]) -> ContextSet:
        unknown = entities - self._entities
        if unknown:
            hint = did_you_mean(min(unknown), self._entities)
            raise QueryError(f"{self.domain.name} has no entity {min(unknown)}; {hint}")
        return self._context(entities | self.appearance.seen if self.appearance.pictured else self._entities)


def _reader(domain: Domain, language: str) -> GrammarReader:
    """Return the reader of a domain's tables for a language."""
    known = languages(domain.settings)
    if language not in known:
        if language not in shipped_languages():
            raise QueryError(f"{domain.name} has no sentences in {language!r}; it has those in {listed(known)}")
        raise QueryError(
            f"{domain.name} has no sentences in {language!r}; write its sentences under [language.{language}.actions], "
            f"or use {listed(known)}"
        )
    reader = GrammarReader(domain.settings, domain.facts, language)
    for table, name in reader.missing():
        where = f"{domain.settings.path}:{domain.settings.line_of('language', language)}"
        raise QueryError(
            f"{where}: {name} has no words in {language!r}; write {name} under [language.{language}.{table}]"
        )
    return reader
