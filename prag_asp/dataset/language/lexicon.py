"""A language as it is spoken of one domain: its sentences, its phrases, and what each state lets them mean."""

from __future__ import annotations

from collections.abc import Mapping
from copy import copy
from functools import lru_cache
from typing import TYPE_CHECKING

from prag_asp.dataset.language.appearance import looks_of
from prag_asp.dataset.language.descriptions import Crowd, Start, View
from prag_asp.dataset.language.phrases import Phrases
from prag_asp.dataset.language.sentences import Clauses
from prag_asp.errors import QueryError
from prag_asp.grammar.reader import GrammarReader, languages
from prag_asp.grammar.word_table import shipped_languages
from prag_asp.wording import did_you_mean, listed

if TYPE_CHECKING:
    from prag_asp.domain.load import Domain
    from prag_asp.task import State

KEPT = 256
"""Pictures and states that are kept: tasks of one space share most of them."""


class Tongue:
    """Writes and reads noun phrases and sentences of a domain in one language."""

    def __init__(self, domain: Domain, language: str, colors: Mapping[str, str] | None = None) -> None:
        """Read the language's part of a domain; pictures show some entities in other `colors` than the scene's.

        Raises:
            QueryError: the domain does not speak the language, or not enough of it.
            SceneError: something is wrong with the scene.
        """
        reader = _reader(domain, language)
        self.domain, self.language, self.words = domain, language, reader.words
        self.grammar = reader.grammar()
        self.looks = looks_of(domain, self.grammar, colors)
        self.clauses = Clauses(self.grammar, domain.facts)
        self.phrases = Phrases(self.grammar, self.looks, self.clauses)
        self._entities = frozenset(domain.facts.entity_names)
        self._subjects: Mapping[tuple[str, int], frozenset[int]] = {
            signature: frozenset(modifier.subject for modifier in modifiers)
            for signature, modifiers in self.clauses.modifiers.items()
        }
        self._remember()

    def recoloured(self, colors: Mapping[str, str]) -> Tongue:
        """Return the language as it is spoken where pictures show some entities in other colours than the scene's."""
        other = copy(self)
        other.looks = self.looks.recoloured(colors)
        other.phrases = Phrases(self.grammar, other.looks, self.clauses)
        other._remember()
        return other

    def _remember(self) -> None:
        """Keep what was worked out for the last pictures and states."""
        self._crowd = lru_cache(maxsize=KEPT)(self._new_crowd)
        self._crowd_of = lru_cache(maxsize=KEPT)(self._known_crowd)
        self._view = lru_cache(maxsize=KEPT)(self._new_view)

    def view(self, start: Start) -> View:
        """Return a state as somebody sees it.

        It is kept where what is said depends on it: a state takes longer to be found again than a view to be made.

        Raises:
            QueryError: it speaks of an entity that the domain has not.
        """
        crowd = self._crowd_of(start.entities)
        return self._new_view(crowd, start.state) if crowd.settled else self._view(crowd, start.state)

    def _new_view(self, crowd: Crowd, state: State) -> View:
        return View(crowd, state, self._subjects, self.phrases.can_say)

    def _known_crowd(self, entities: frozenset[str]) -> Crowd:
        unknown = entities - self._entities
        if unknown:
            hint = did_you_mean(min(unknown), self._entities)
            raise QueryError(f"{self.domain.name} has no entity {min(unknown)}; {hint}")
        return self._crowd(entities | self.looks.seen if self.looks.pictured else self._entities)

    def _new_crowd(self, entities: frozenset[str]) -> Crowd:
        return Crowd(self.looks, entities)


def _reader(domain: Domain, language: str) -> GrammarReader:
    """Return what reads the language's part of a domain.

    Raises:
        QueryError: there are no words of the language, or the domain has no sentences in it.
    """
    known = languages(domain.settings)
    if language not in known:
        if language not in shipped_languages():
            raise QueryError(f"{domain.name} does not speak {language!r}; it speaks {listed(known)}")
        raise QueryError(
            f"{domain.name} does not speak {language!r}; write its sentences under [language.{language}.actions], "
            f"or take {listed(known)}"
        )
    reader = GrammarReader(domain.settings, domain.facts, language)
    for table, name in reader.missing():
        where = f"{domain.settings.path}:{domain.settings.line_of('language', language)}"
        raise QueryError(
            f"{where}: {name} has no words in {language!r}; write {name} under [language.{language}.{table}]"
        )
    return reader
