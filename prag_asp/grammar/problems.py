"""What is wrong with the tables of a language: unknown names, wrong braces, missing forms, sentences that are alike."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations
from typing import Any, NamedTuple

from prag_asp.errors import QueryError
from prag_asp.grammar.completeness import form_problems, kind_problems
from prag_asp.grammar.reader import FIRST, PARTS, GrammarReader, Signature, languages, tables
from prag_asp.grammar.template import Template, agrees, parse_template
from prag_asp.grammar.word_table import shipped_languages
from prag_asp.program.facts import Facts
from prag_asp.program.settings import Settings, key_shown
from prag_asp.wording import did_you_mean, listed

FACT_KEYS = ("is", "not", "where", "of", "silent")


class Fault(NamedTuple):
    """What is wrong below ``[language]``: the keys that lead to it, what to do, the name of a warning or ""."""

    keys: tuple[str, ...]
    text: str
    warning: str = ""


def grammar_problems(settings: Settings, facts: Facts) -> Iterator[Fault]:
    """Yield what is wrong with the languages of a domain, and with the sentences right under ``[language]``."""
    known = tables(settings)
    for code in languages(settings):
        for fault in _problems(settings, facts, code, known.get(code, {})):
            yield fault._replace(text=f"language {code}: {fault.text}")


def _problems(settings: Settings, facts: Facts, code: str, table: Mapping[str, Any]) -> Iterator[Fault]:
    """Yield what is wrong with one language of a domain, of its parts first."""
    faults = list(_shape_problems(code, table))
    yield from faults
    if faults:
        return
    try:
        reader = GrammarReader(settings, facts, code)
    except QueryError as error:
        yield Fault((code,), str(error))
        return
    wrong = [Fault((code, "words", name), text) for name, text in form_problems(reader.words)] if table else []
    yield from wrong
    if wrong:
        return
    judge = _Judge(reader, code)
    found = list(judge.problems())
    yield from found
    if all(each.warning for each in found):
        yield from judge.missing()


def _shape_problems(code: str, table: Mapping[str, Any]) -> Iterator[Fault]:
    """Yield parts that a language has not, and words of another kind than those of English."""
    for part, value in table.items():
        if part not in PARTS:
            hint = did_you_mean(part, PARTS)
            yield Fault((code, part), f"a language has no {key_shown(part)}; {hint}")
        elif not isinstance(value, Mapping):
            yield Fault((code, part), f"{part} is no table; write [language.{code}.{part}] with a name = ... below it")
    words = table.get("words", {})
    for name, text in kind_problems(words) if isinstance(words, Mapping) else ():
        yield Fault((code, "words", name), text)
    if code not in shipped_languages() and not words:
        has = f"those that have words are {listed(shipped_languages())}"
        hint = did_you_mean(code, shipped_languages(), has)
        yield Fault((code,), f"no words of the language {key_shown(code)}; {hint}")


class _Judge:
    """Judges one language of a domain."""

    def __init__(self, reader: GrammarReader, code: str) -> None:
        self.reader, self.code, self.cases = reader, code, reader.words.cases

    def problems(self) -> Iterator[Fault]:
        """Yield what is wrong with what is there."""
        yield from self._action_problems()
        yield from self._fact_problems()
        yield from self._noun_problems()
        yield from self._value_problems()
        yield from self._alike()

    def missing(self) -> Iterator[Fault]:
        """Yield what is not there, but instructions need."""
        lacking: dict[str, list[str]] = {}
        for table, name in self.reader.missing():
            lacking.setdefault(table, []).append(name)
        for table, names in lacking.items():
            where = f"[language.{self.code}.{table}]"
            text = f"no words in {self.code} for {listed(dict.fromkeys(names))}; write them under {where}"
            yield Fault((self.code, table), text, "no-words")

    def _fault(self, part: str, name: str, text: str, warning: str = "") -> Fault:
        return Fault((self.code, part, name), text, warning)

    def _action_problems(self) -> Iterator[Fault]:
        arities = _arities(self.reader.action_arguments)
        for name, given in self._entries("actions"):
            if name not in arities:
                hint = did_you_mean(name, arities, f"actions are {listed(arities)}")
                yield self._fault("actions", name, f"there is no action {key_shown(name)}; {hint}")
            else:
                yield from self._sentences("actions", name, given, arities[name])

    def _fact_problems(self) -> Iterator[Fault]:
        arities = _arities(self.reader.fluent_arguments)
        for name, given in self._entries("facts"):
            if name not in arities:
                hint = did_you_mean(name, arities, f"fluents are {listed(arities)}")
                yield self._fault("facts", name, f"there is no fluent {key_shown(name)}; {hint}")
                continue
            table = given if isinstance(given, Mapping) else {"is": given}
            unknown = next((key for key in table if key not in FACT_KEYS), None)
            if unknown is not None:
                yield self._fault("facts", name, f"{name} has no {unknown}; {did_you_mean(unknown, FACT_KEYS)}")
            for key in ("is", "not", "where"):
                if key in table:
                    yield from self._sentences("facts", name, table[key], arities[name])
            if "is" not in table:
                yield self._fault("facts", name, f'{name} does not say that it is so; add is = "..."')
            elif "not" not in table and not any(agrees(text) for text in _texts(table["is"])):
                text = f'{name} does not say that it is not so; add not = "...", or write {{is}} for its verb'
                yield self._fault("facts", name, text, "no-words")

    def _noun_problems(self) -> Iterator[Fault]:
        states, words = self.reader.states, self.reader.words
        known = {*map(str, states.classes), *states.entity_names}
        for name, given in self._entries("nouns"):
            table = given if isinstance(given, Mapping) else {"noun": given}
            unknown = next((key for key in table if key not in ("noun", "gender", *words.cases)), None)
            if name not in known:
                hint = did_you_mean(name, known, "give the name of a class or an entity")
                yield self._fault("nouns", name, f"there is no class or entity {key_shown(name)}; {hint}")
            elif unknown is not None:
                hint = did_you_mean(unknown, ("noun", "gender", *words.cases))
                yield self._fault("nouns", name, f"the noun of {name} has no {unknown}; {hint}")
            elif table.get("gender", words.genders[0]) not in words.genders:
                text = f"the noun of {name} has the gender {table['gender']}; genders are {', '.join(words.genders)}"
                yield self._fault("nouns", name, text)
            elif self.reader.noun(given) is None:
                yield self._fault("nouns", name, f'the noun of {name} is no word; write "..." or {{ noun = "..." }}')

    def _value_problems(self) -> Iterator[Fault]:
        places = (*self.reader.action_arguments.values(), *self.reader.fluent_arguments.values())
        known = {value for each in places for values in each for value in values} - set(self.reader.states.entity_names)
        for name, given in self._entries("values"):
            if name not in known:
                hint = did_you_mean(name, known, f"arguments that are no entities are {listed(known)}")
                yield self._fault("values", name, f"no action or fluent has the argument {key_shown(name)}; {hint}")
            elif not isinstance(given, str) or not given.strip():
                yield self._fault("values", name, f"the word for {name} is none; write it in quotes")

    def _sentences(self, part: str, name: str, given: object, arity: int) -> Iterator[Fault]:
        """Yield what is wrong with one sentence, or several."""
        if not _texts(given) or len(_texts(given)) < (len(given) if isinstance(given, list) else 1):
            yield self._fault(part, name, f"{name} is no sentence; write one in quotes, or several in a list")
            return
        for text in _texts(given):
            try:
                parse_template(text, self.cases, arity, {"is": "is"})
            except QueryError as error:
                yield self._fault(part, name, f"sentence of {name} {error}")

    def _alike(self) -> Iterator[Fault]:
        """Yield the actions that a sentence does not tell apart."""
        own = dict(self._entries("actions"))
        above = self.reader.settings.language if self.code == FIRST else {}
        given = [*(name for name in above if name not in own), *own]
        known = self.reader.actions()
        ordered = sorted((each for each in known if each[0] in given), key=lambda each: given.index(each[0]))
        spelled = [(signature, template) for signature in ordered for template in known[signature]]
        told = set[tuple[str, str]]()
        for (one, first), (other, second) in combinations(spelled, 2):
            pair = (one[0], other[0])
            if pair not in told and self._overlap(one, first, other, second):
                told.add(pair)
                what = (
                    f"sentences of {one[0]} and {other[0]} are alike"
                    if one != other
                    else f"two sentences of {one[0]} are alike"
                )
                text = f"{what}; nobody could tell them apart: change one"
                yield Fault(self._place(other[0], own), text, "sounds-alike")
        for signature, template in spelled:
            left = self._left_open(signature, template)
            if left is not None and (signature[0], "") not in told:
                told.add((signature[0], ""))
                text = f"a sentence of {signature[0]} leaves {{{left}}} open, so that two actions sound alike; name it"
                yield Fault(self._place(signature[0], own), text, "sounds-alike")

    def _place(self, action: str, own: Mapping[str, Any]) -> tuple[str, ...]:
        """Return the keys that lead to the sentences of an action: the language's own, or those right under it all."""
        return (self.code, "actions", action) if action in own else (action,)

    def _overlap(self, one: Signature, first: Template, other: Signature, second: Template) -> bool:
        """Tell whether two sentences can be the same text for different actions."""
        if first.texts != second.texts or (one == other and first.slots == second.slots):
            return False
        places = self.reader.action_arguments
        pairs = zip(first.arguments, second.arguments, strict=True)
        return all(places[one][i] & places[other][j] for i, j in pairs)

    def _left_open(self, signature: Signature, template: Template) -> int | None:
        """Return an argument that a sentence leaves out although it tells actions apart, None where it has none."""
        places = self.reader.action_arguments[signature]
        out = [index for index, known in enumerate(places) if len(known) > 1 and index not in template.arguments]
        if not out:
            return None
        name, arity = signature
        actions = [
            each for each in self.reader.states.declared_actions if (each.name, len(each.arguments)) == (name, arity)
        ]
        seen = {tuple(str(each.arguments[index]) for index in template.arguments) for each in actions}
        return out[0] if len(seen) < len(actions) else None

    def _entries(self, part: str) -> Iterator[tuple[str, Any]]:
        table = self.reader.own.get(part, {})
        yield from table.items()


def _texts(given: object) -> Sequence[str]:
    return [each for each in (given if isinstance(given, list) else [given]) if isinstance(each, str)]


def _arities(arguments: Mapping[Signature, object]) -> dict[str, int]:
    found: dict[str, int] = {}
    for name, arity in arguments:
        found[name] = max(found.get(name, 0), arity)
    return found
