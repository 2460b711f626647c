"""Check the tables of a domain's languages: unknown names, wrong braces, missing forms, ambiguous sentences."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import combinations
from typing import Any

from prag_asp.errors import QueryError
from prag_asp.grammar.completeness import check_forms, check_kinds
from prag_asp.grammar.reader import FIRST, PARTS, GrammarReader, Signature, languages, tables
from prag_asp.grammar.template import Template, agrees, parse_template
from prag_asp.grammar.word_table import shipped_languages
from prag_asp.program.facts import Facts
from prag_asp.program.settings import Settings
from prag_asp.tables.report import TableEntry, TableProblem, TableReport
from prag_asp.wording import did_you_mean, listed

FACT_KEYS = ("is", "not", "where", "of", "silent")


def grammar_problems(settings: Settings, facts: Facts) -> list[TableProblem]:
    """Return the problems of a domain's languages, and of the sentences directly under ``[language]``."""
    own_tables, problems = tables(settings), list[TableProblem]()
    for code in languages(settings):
        report = TableReport()
        _check_language(TableEntry(report, ("language", code), own_tables.get(code, {})), settings, facts, code)
        problems += report.problems
    return problems


def _check_language(entry: TableEntry, settings: Settings, facts: Facts, code: str) -> None:
    """Report the problems of one language of a domain; sentences are checked only if its parts are valid."""
    _check_parts(entry, code)
    if not entry.is_sound:
        return
    try:
        reader = GrammarReader(settings, facts, code)
    except QueryError as error:
        entry.add(str(error))
        return
    if entry.value:
        check_forms(entry.at("words"), reader.words)
    if entry.is_sound:
        _LanguageChecker(entry, reader, code).check()


def _check_parts(entry: TableEntry, code: str) -> None:
    """Report unknown parts, and words whose value has another type than in English."""
    entry.require_known(PARTS)
    for part, table in entry.entries():
        if part in PARTS:
            table.is_table(f"[language.{code}.{part}] with a name = ... below it")
    words = entry.at("words", {})
    check_kinds(words)
    if code not in shipped_languages() and not words.value:
        hint = did_you_mean(code, shipped_languages(), f"those that have words are {listed(shipped_languages())}")
        entry.add(f"no words of this language; {hint}")


class _LanguageChecker:
    """Checks the sentences, nouns and values of one language of a domain."""

    def __init__(self, entry: TableEntry, reader: GrammarReader, code: str) -> None:
        self.entry, self.reader, self.code, self.cases = entry, reader, code, reader.words.cases

    def check(self) -> None:
        """Report wrong entries; if there are none, also missing entries that instructions need."""
        self._check_actions()
        self._check_facts()
        self._check_nouns()
        self._check_values()
        self._check_ambiguity()
        if all(problem.warning for problem in self.entry.report.problems):
            self._check_missing()

    def _check_missing(self) -> None:
        """Report missing entries that instructions need."""
        lacking: dict[str, list[str]] = {}
        for table, name in self.reader.missing():
            lacking.setdefault(table, []).append(name)
        for table, names in lacking.items():
            where = f"[language.{self.code}.{table}]"
            text = f"has no words for {listed(dict.fromkeys(names))}; write them under {where}"
            self.entry.at(table).add(text, "no-words")

    def _check_actions(self) -> None:
        arities = _arities(self.reader.action_arguments)
        for name, entry in self.entry.at("actions").entries():
            if name not in arities:
                entry.add(f"there is no such action; {did_you_mean(name, arities, f'actions are {listed(arities)}')}")
            else:
                self._check_sentences(entry, arities[name])

    def _check_facts(self) -> None:
        arities = _arities(self.reader.fluent_arguments)
        for name, entry in self.entry.at("facts").entries():
            if name not in arities:
                entry.add(f"there is no such fluent; {did_you_mean(name, arities, f'fluents are {listed(arities)}')}")
                continue
            forms = (
                entry if isinstance(entry.value, Mapping) else TableEntry(entry.report, entry.keys, {"is": entry.value})
            )
            forms.require_known(FACT_KEYS)
            for key in ("is", "not", "where"):
                if key in forms.value:
                    place = forms.at(key) if forms is entry else entry
                    self._check_sentences(place, arities[name])
            if "is" not in forms.value:
                entry.add('does not say that it is so; add is = "..."')
            elif "not" not in forms.value and not any(agrees(text) for text in _texts(forms.value["is"])):
                text = 'does not say that it is not so; add not = "...", or write {is} for its verb'
                entry.add(text, "no-words")

    def _check_nouns(self) -> None:
        states, words = self.reader.states, self.reader.words
        declared = {*map(str, states.classes), *states.entity_names}
        for name, entry in self.entry.at("nouns").entries():
            if name not in declared:
                hint = did_you_mean(name, declared, "give the name of a class or an entity")
                entry.add(f"there is no such class or entity; {hint}")
                continue
            entry.require_known(("noun", "gender", *words.cases))
            gender = entry.at("gender", words.genders[0])
            if gender.value not in words.genders:
                gender.needs(f"a gender ({', '.join(words.genders)})")
            elif entry.is_sound and self.reader.noun(entry.value) is None:
                entry.needs('a word, "..." or { noun = "..." }')

    def _check_values(self) -> None:
        places = (*self.reader.action_arguments.values(), *self.reader.fluent_arguments.values())
        entities = set(self.reader.states.entity_names)
        arguments = {value for each in places for values in each for value in values} - entities
        for name, entry in self.entry.at("values").entries():
            if name not in arguments:
                hint = did_you_mean(name, arguments, f"arguments that are no entities are {listed(arguments)}")
                entry.add(f"no action or fluent has such an argument; {hint}")
            elif not isinstance(entry.value, str) or not entry.value.strip():
                entry.needs("a word in quotes")

    def _check_sentences(self, entry: TableEntry, arity: int) -> None:
        """Report the wrong sentences of an entry."""
        texts = _texts(entry.value)
        if not texts or len(texts) < (len(entry.value) if isinstance(entry.value, list) else 1):
            entry.needs("a sentence in quotes, or several in a list")
            return
        for text in texts:
            try:
                parse_template(text, self.cases, arity, {"is": "is"})
            except QueryError as error:
                entry.add(str(error))

    def _check_ambiguity(self) -> None:
        """Report actions that a sentence does not distinguish."""
        own = self.entry.at("actions", {}).value
        above = self.reader.settings.language if self.code == FIRST else {}
        named = [*(name for name in above if name not in own), *own]
        sentences = self.reader.actions()
        ordered = sorted((each for each in sentences if each[0] in named), key=lambda each: named.index(each[0]))
        spelled = [(signature, template) for signature in ordered for template in sentences[signature]]
        reported = set[tuple[str, str]]()
        for (one, first), (other, second) in combinations(spelled, 2):
            pair = (one[0], other[0])
            if pair not in reported and self._overlap(one, first, other, second):
                reported.add(pair)
                like = f"a sentence is like one of {one[0]}" if one != other else "two sentences are alike"
                self._place(other[0], own).add(f"{like}; nobody could distinguish them: change one", "sounds-alike")
        for signature, template in spelled:
            omitted = self._left_open(signature, template)
            if omitted is not None and (signature[0], "") not in reported:
                reported.add((signature[0], ""))
                text = f"a sentence leaves {{{omitted}}} open, so that two actions sound alike; name it"
                self._place(signature[0], own).add(text, "sounds-alike")

    def _place(self, action: str, own: Mapping[str, Any]) -> TableEntry:
        """Return the entry of the sentences of an action: in the language's table, or directly under ``[language]``."""
        return (
            self.entry.at("actions").at(action)
            if action in own
            else TableEntry(self.entry.report, ("language", action))
        )

    def _overlap(self, one: Signature, first: Template, other: Signature, second: Template) -> bool:
        """Return whether two sentences can be the same text for different actions."""
        if first.texts != second.texts or (one == other and first.slots == second.slots):
            return False
        places = self.reader.action_arguments
        pairs = zip(first.arguments, second.arguments, strict=True)
        return all(places[one][i] & places[other][j] for i, j in pairs)

    def _left_open(self, signature: Signature, template: Template) -> int | None:
        """Return an argument that a sentence omits although it distinguishes actions, or None."""
        places = self.reader.action_arguments[signature]
        omitted = [index for index, values in enumerate(places) if len(values) > 1 and index not in template.arguments]
        if not omitted:
            return None
        name, arity = signature
        actions = [
            each for each in self.reader.states.declared_actions if (each.name, len(each.arguments)) == (name, arity)
        ]
        distinct = {tuple(str(each.arguments[index]) for index in template.arguments) for each in actions}
        return omitted[0] if len(distinct) < len(actions) else None


def _texts(sentences: object) -> Sequence[str]:
    return [each for each in (sentences if isinstance(sentences, list) else [sentences]) if isinstance(each, str)]


def _arities(arguments: Mapping[Signature, object]) -> dict[str, int]:
    """Return the largest arity of each name."""
    arities: dict[str, int] = {}
    for name, arity in arguments:
        arities[name] = max(arities.get(name, 0), arity)
    return arities
