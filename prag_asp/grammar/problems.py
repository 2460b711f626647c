"""The checks of the tables of a domain's languages: unknown names, wrong braces, missing forms, ambiguous sentences."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from itertools import combinations

from prag_asp.errors import QueryError
from prag_asp.grammar.completeness import check_forms, check_kinds
from prag_asp.grammar.reader import FIRST, PARTS, GrammarReader, languages, split_key, tables
from prag_asp.grammar.template import BRACKETED, agrees, parse_template
from prag_asp.grammar.ways import Signature
from prag_asp.grammar.word_table import shipped_languages
from prag_asp.program.facts import Facts
from prag_asp.program.settings import Settings
from prag_asp.tables.report import TableEntry, TableProblem, TableReport
from prag_asp.wording import did_you_mean, listed

FACT_KEYS = ("is", "not", "initially", "where", "of", "silent")


def grammar_problems(settings: Settings, facts: Facts) -> list[TableProblem]:
    """Return the problems with a domain's languages and with the sentences directly under ``[language]``."""
    own_tables, problems = tables(settings), list[TableProblem]()
    for code in languages(settings):
        entry = TableEntry(TableReport(), ("language", code), own_tables.get(code, {}))
        _check_language(entry, settings, facts, code)
        problems += entry.report.problems
    return problems


def _check_language(entry: TableEntry, settings: Settings, facts: Facts, code: str) -> None:
    """Report the problems with a language of a domain; sentences are checked only if its parts and words are valid.

    Missing entries that instructions need are reported only if all other entries are valid.
    """
    entry.require_known(PARTS)
    for part, table in entry.entries():
        if part in PARTS:
            table.is_table(f"[language.{code}.{part}] with a name = ... below it")
    words = entry.at("words", {})
    check_kinds(words)
    if code not in shipped_languages() and not words.value:
        hint = did_you_mean(code, shipped_languages(), f"those that have words are {listed(shipped_languages())}")
        entry.add(f"no words of this language; {hint}")
    if not entry.is_sound:
        return
    try:
        reader = GrammarReader(settings, facts, code)
    except QueryError as error:
        entry.add(str(error))
        return
    if entry.value:
        check_forms(words, reader.words)
    if not entry.is_sound:
        return
    _check_terms(entry, reader)
    _check_facts(entry, reader)
    _check_nouns(entry, reader)
    _check_ambiguity(entry, reader)
    if all(problem.warning for problem in entry.report.problems):
        lacking: dict[str, list[str]] = {}
        for part, name in reader.missing():
            lacking.setdefault(part, []).append(name)
        for part, names in lacking.items():
            text = f"has no words for {listed(dict.fromkeys(names))}; write them under [language.{code}.{part}]"
            entry.at(part).add(text, "no-words")


def _check_terms(language: TableEntry, reader: GrammarReader) -> None:
    """Report wrong sentences for actions, and wrong words for arguments that are not entities."""
    actions, fluents = reader.states.action_arguments, reader.states.fluent_arguments
    arities = _arities(actions)
    for key, entry in language.at("actions").entries():
        name = _checked_key(key, entry, actions, reader)
        if name not in arities:
            entry.add(f"there is no such action; {did_you_mean(name, arities, f'actions are {listed(arities)}')}")
        else:
            _check_sentences(entry, reader, arities[name])
    places = (place for each in (actions, fluents) for places in each.values() for place in places)
    arguments = set[str]().union(*places).difference(reader.states.entity_names)
    for name, entry in language.at("values").entries():
        if name not in arguments:
            hint = did_you_mean(name, arguments, f"arguments that are no entities are {listed(arguments)}")
            entry.add(f"no action or fluent has such an argument; {hint}")
        elif not isinstance(entry.value, str) or not entry.value.strip():
            entry.needs("a word in quotes")


def _check_facts(language: TableEntry, reader: GrammarReader) -> None:
    """Report wrong and missing sentences of fluents."""
    arities = _arities(reader.states.fluent_arguments)
    for key, entry in language.at("facts").entries():
        name = _checked_key(key, entry, reader.states.fluent_arguments, reader)
        if name not in arities:
            entry.add(f"there is no such fluent; {did_you_mean(name, arities, f'fluents are {listed(arities)}')}")
            continue
        forms = entry if isinstance(entry.value, Mapping) else replace(entry, value={"is": entry.value})
        forms.require_known(FACT_KEYS)
        for part in ("is", "not", "initially", "where"):
            if part in forms.value:
                _check_sentences(forms.at(part) if forms is entry else entry, reader, arities[name])
        if "is" not in forms.value:
            entry.add('does not say that it is so; add is = "..."')
        elif "not" not in forms.value and not any(map(agrees, _texts(forms.value["is"]))):
            entry.add('does not say that it is not so; add not = "...", or write {is} for its verb', "no-words")


def _checked_key(key: str, entry: TableEntry, arguments: Iterable[Signature], reader: GrammarReader) -> str:
    """Return the name in a key such as ``pick(_,_,sink)``; report a wrong number of arguments, and unknown ones."""
    name, only = split_key(key)
    arities = {arity for each, arity in arguments if each == name}
    if only and arities and len(only) not in arities:
        entry.add(f"{name} has {listed(map(str, sorted(arities)))} arguments; write as many, and _ for any")
    declared = {"_", *map(str, reader.states.classes), *reader.states.entity_names}
    for each in only:
        if each not in declared:
            entry.add(f"there is no class or entity {each}; {did_you_mean(each, declared, 'write _ for any')}")
    return name


def _check_nouns(language: TableEntry, reader: GrammarReader) -> None:
    """Report nouns for unknown names, nouns without a word, and nouns of an unknown gender."""
    states, words = reader.states, reader.words
    declared = {*map(str, states.classes), *states.entity_names}
    for name, entry in language.at("nouns").entries():
        if name not in declared:
            hint = did_you_mean(name, declared, "give the name of a class or an entity")
            entry.add(f"there is no such class or entity; {hint}")
            continue
        entry.require_known(("noun", "gender", *words.cases))
        gender = entry.at("gender", words.genders[0])
        if gender.value not in words.genders:
            gender.needs(f"a gender ({', '.join(words.genders)})")
        elif entry.is_sound and reader.noun(entry.value) is None:
            entry.needs('a word, "..." or { noun = "..." }')


def _check_sentences(entry: TableEntry, reader: GrammarReader, arity: int) -> None:
    """Report the wrong sentences in an entry."""
    texts = _texts(entry.value)
    if not texts or len(texts) < (len(entry.value) if isinstance(entry.value, list) else 1):
        entry.needs("a sentence in quotes, or several in a list")
        return
    for text in texts:
        if set(BRACKETED.sub("", text)) & set("[]"):
            entry.add("has brackets that do not match; write text for actions that restore a state as [ back]")
        try:
            parse_template(text, reader.words.cases, arity, {"is": "is"})
        except QueryError as error:
            entry.add(str(error))


def _check_ambiguity(language: TableEntry, reader: GrammarReader) -> None:
    """Report actions that share a sentence; the problem is placed at the sentence, here or under ``[language]``."""
    own = language.at("actions", {})
    above = reader.settings.language if reader.code == FIRST else {}
    named = [*(name for name in above if name not in own.value), *own.value]
    entries = {
        name: own.at(name) if name in own.value else TableEntry(own.report, ("language", name)) for name in named
    }
    sentences, arguments = reader.actions(), reader.states.action_arguments
    ordered = sorted((each for each in sentences if each[0] in named), key=lambda each: named.index(each[0]))
    spelled = [(signature, template) for signature in ordered for template in sentences[signature]]
    reported = set[tuple[str, str]]()
    for (one, first), (other, second) in combinations(spelled, 2):
        if first.texts != second.texts or (one == other and first.slots == second.slots):
            continue
        pairs = zip(first.arguments, second.arguments, strict=True)
        overlap = all(arguments[one][i] & arguments[other][j] for i, j in pairs)
        if overlap and (one[0], other[0]) not in reported:
            reported.add((one[0], other[0]))
            like = f"a sentence is also used for {one[0]}" if one != other else "two sentences are equal"
            entries[other[0]].add(
                f"{like}, so the actions cannot be distinguished; change one of the sentences", "sounds-alike"
            )
    for signature, template in spelled:
        places = enumerate(arguments[signature])
        omitted = [index for index, values in places if len(values) > 1 and index not in template.arguments]
        if not omitted or (signature[0], "") in reported:
            continue
        alike = [each.arguments for each in reader.states.declared_actions if each.match(*signature)]
        if len({tuple(str(each[index]) for index in template.arguments) for each in alike}) < len(alike):
            reported.add((signature[0], ""))
            text = f"a sentence omits {{{omitted[0]}}}, so two actions have the same sentence; add it"
            entries[signature[0]].add(text, "sounds-alike")


def _texts(sentences: object) -> Sequence[str]:
    return [each for each in (sentences if isinstance(sentences, list) else [sentences]) if isinstance(each, str)]


def _arities(arguments: Iterable[Signature]) -> dict[str, int]:
    """Return the largest arity of each name."""
    arities: dict[str, int] = {}
    for name, arity in arguments:
        arities[name] = max(arity, arities.get(name, 0))
    return arities
