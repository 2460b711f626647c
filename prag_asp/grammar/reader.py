"""The reader of a domain's tables for a language: ``[language.en]`` with its actions, facts, nouns and values."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import islice
from typing import Any, NamedTuple

from prag_asp.atom import parse_atom
from prag_asp.errors import QueryError
from prag_asp.grammar.template import SLOT, Recurrence, RecurrenceWords, Template, agrees, parse_template
from prag_asp.grammar.ways import Signature, Way, common_ways, ways_of_actions
from prag_asp.grammar.word_table import Words, words_of
from prag_asp.program.facts import Facts
from prag_asp.program.settings import Settings

CAMEL = re.compile(r"([a-z0-9])([A-Z](?![A-Z]))")
NUMBERED = re.compile(r"(?<=[a-z]{3})(?=[0-9]+\b)")
"""The ends of words in names such as ``pickUp`` and ``cube12``."""

FIRST = "en"
"""The language of the sentences directly under ``[language]``."""

PARTS = ("actions", "facts", "nouns", "values", "words")
"""The names of the tables that a language can have in a domain."""


@dataclass(frozen=True)
class Noun:
    """A noun, with its gender and its text in each case."""

    gender: str
    forms: Mapping[str, str]

    @property
    def word(self) -> str:
        """The noun in the default case."""
        return next(iter(self.forms.values()))


@dataclass(frozen=True)
class Where:
    """A noun modifier derived from a fluent: ``on {1}`` describes the argument of the fluent at position `subject`."""

    template: Template
    subject: int


@dataclass(frozen=True)
class FactForms:
    """The sentences for a fluent that is true or false, and its modifiers; a `silent` fluent is not mentioned."""

    true: tuple[Template, ...] = ()
    false: tuple[Template, ...] = ()
    where: tuple[Where, ...] = ()
    silent: bool = False

    def extended(self, other: FactForms, only: tuple[str, ...]) -> FactForms:
        """Return these forms together with `other` forms, which are for certain arguments only."""
        true, false = (
            tuple(replace(template, only=only) for template in templates) for templates in (other.true, other.false)
        )
        where = tuple(Where(replace(each.template, only=only), each.subject) for each in other.where)
        return FactForms((*self.true, *true), (*self.false, *false), (*self.where, *where), self.silent)

    def names_all(self, arity: int) -> bool:
        """Return whether the sentences name all arguments of a fluent."""
        return bool(self.true) and all(set(template.arguments) == set(range(arity)) for template in self.true)


class PlainSentence(NamedTuple):
    """A default sentence and its actions; an empty set stands for all actions of the signature."""

    template: Template
    actions: frozenset[str]


@dataclass(frozen=True)
class Grammar:
    """All sentences of a domain in one language, and its nouns by the names of classes and entities.

    `values` are the words for other arguments. `plain` and `spare` are the default sentences for actions and for
    fluents, which need no tables. `sources` holds, for each action that moves an object away from a place, the position
    of the place among the action's arguments, and the `Way`.
    """

    words: Words
    actions: Mapping[Signature, tuple[Template, ...]]
    plain: Mapping[Signature, tuple[PlainSentence, ...]]
    facts: Mapping[Signature, FactForms]
    spare: Mapping[Signature, FactForms]
    nouns: Mapping[str, Noun]
    values: Mapping[str, str] = field(default_factory=dict)
    sources: Mapping[Signature, Mapping[str, tuple[int, Way]]] = field(default_factory=dict)


AGENTS = frozenset(["agent", "arm", "gripper", "hand", "robot"])
"""The classes whose members act if no scene defines which entities are robots."""


class GrammarReader:
    """A reader of a domain's tables for a language, which ignores wrong entries, because the linter reports them."""

    def __init__(self, settings: Settings, facts: Facts, code: str) -> None:
        """Read the settings and the facts of a domain.

        Raises:
            QueryError: there is no word table for the language.
        """
        own = settings.grammar.get(code, {})
        self.own: Mapping[str, Any] = own if isinstance(own, Mapping) else {}
        self.settings, self.states, self.code = settings, facts, code
        self.words = words_of(code, self._table("words"))

    def grammar(self) -> Grammar:
        """Return the grammar."""
        return Grammar(
            self.words,
            self.actions(),
            self.plain(),
            self.facts(),
            self.spare(),
            self.nouns(),
            self.values(),
            self.sources(),
        )

    def sources(self) -> dict[Signature, dict[str, tuple[int, Way]]]:
        """Return the first source of each action that moves an object: the position of the place, and the way."""
        found: dict[Signature, dict[str, tuple[int, Way]]] = {}
        for signature, ways_of in self.ways.items():
            for action, ways in ways_of.items():
                for place, way in ways.items():
                    if way.word == "from" and way.moved >= 0:
                        found.setdefault(signature, {}).setdefault(action, (place, way))
        return found

    def actions(self) -> dict[Signature, tuple[Template, ...]]:
        """Return the sentences for each action, from the language's table or (in English) directly under [language]."""
        table, sentences = self._table("actions"), {}
        articles = self.words.articles | {"a", "an"}
        for name, arity in self.states.action_arguments:
            texts = listed(table.get(name))
            if not texts and self.code == FIRST:  # a noun phrase has its own article
                short = listed(self.settings.grammar.get(name))
                texts = tuple(text for text in short if not any(f"{article} {{" in text for article in articles))
            own = (
                replace(template, only=only)
                for entry, only in special_entries(table, name, arity)
                for template in self.templates(listed(entry), arity, action=name)
            )
            sentences[name, arity] = (*self.templates(texts, arity, action=name), *own)
        return sentences

    def _restores(self, text: str, name: str, arity: int) -> bool:
        """Return whether a sentence may say "again" of an action that only restores facts.

        It may not if it names the place from which an object is taken: "put the lid on the pot, then take it off it".
        """
        named = {int(slot[1]) for slot in SLOT.finditer(text)}
        return not any(
            way.word == "from" and way.moved >= 0 and place in named
            for ways in self.ways.get((name, arity), {}).values()
            for place, way in ways.items()
        )

    def plain(self) -> dict[Signature, tuple[PlainSentence, ...]]:
        """Return default sentences for actions, built from their names and arguments, without constant arguments.

        The object that an action moves is named even if it is constant: "take the cup from the table", not "take the
        table". If all arguments are constant, the first that is not a robot is named. The preposition before a place
        depends on the predicate that relates the object to it, so actions with the same name may have different
        sentences. The one robot among several arguments is the agent: "with the left arm". The `verbs` of the language
        replace some names.
        """
        defaults = self.words.table.get("defaults", {})
        if "action" not in defaults:
            return {}
        directed = "from" in defaults and "to" in defaults
        names = {name for name, _ in self.states.action_arguments}
        verbs = {name: verb for name, verb in defaults.get("verbs", {}).items() if verb not in names}
        sentences = {}
        for (name, arity), places in self.states.action_arguments.items():
            varying = {index for index, arguments in enumerate(places) if len(arguments) > 1}
            ways_of = self.ways.get((name, arity), {}) if directed else {}
            common = common_ways(ways_of.values())
            moved = {way.moved for index, way in common.items() if index in varying and way.moved >= 0}
            things = (i for i, arguments in enumerate(places) if self._robots.isdisjoint(map(str, arguments)))
            named = sorted(varying | moved or {*islice(things, 1)})
            led = sorted(index for index in common if index in varying)
            relations = relations_in(ways_of, led, defaults)
            other = [index for index in named if index not in led and index not in relations]
            robots = [index for index in other if self._robots.issuperset(map(str, places[index]))]
            agent = ""
            if len(robots) == 1 and len(other) > 1 and "agent" in defaults:
                other.remove(robots[0])
                agent = str(defaults["agent"]).replace("{0}", f"{{{robots[0]}}}")
            every = _joined([f"{{{index}}}" for index in other], defaults["all"])
            text, carry = (
                _with_particle(str(defaults["action"]).format(name=verb, all=every).strip(), verb, every, defaults)
                for verb in (verbs.get(name, plain(name)), defaults.get("carry", {}).get(name, plain(name)))
            )
            again = "" if any(way.word == "to" for way in common.values()) else str(defaults.get("again", ""))
            resting = _below(defaults, "rest")
            rest = resting if verbs.get(name, plain(name)) in listed(resting.get("verbs")) else {}
            actions_of: dict[str, set[str]] = {text: set()} if not led else {}
            for action, ways in ways_of.items() if led else ():
                vague = any(ways[i].word == "to" and ways[i].predicate not in defaults["to"] for i in led)
                whole = carry if vague else text
                for index in led:
                    by_predicate = {**defaults[ways[index].word], **(rest if ways[index].word == "to" else {})}
                    phrase = by_predicate.get(ways[index].predicate, by_predicate["any"])
                    whole += str(phrase).replace("{0}", f"{{{index}}}")
                actions_of.setdefault(whole, set()).add(action)
            actions_of = {
                whole + agent + ("" if "[" in whole else again): actions for whole, actions in actions_of.items()
            }
            sentences[name, arity] = tuple(
                PlainSentence(template, frozenset(actions))
                for whole, actions in actions_of.items()
                for template in self.templates([whole], arity)
            )
        return sentences

    @cached_property
    def ways(self) -> Mapping[Signature, Mapping[str, Mapping[int, Way]]]:
        """The sources and destinations of each action, by the action's signature and the action."""
        return ways_of_actions(self.states, _below(self.settings.scene, "predicates"), self._robots)

    @cached_property
    def _robots(self) -> frozenset[str]:
        """The bodies and classes of robots in the scene, the classes in `AGENTS`, and the members of all of these."""
        shapes = _below(self.settings.scene, "shapes")
        kinds = {name for name, shape in shapes.items() if isinstance(shape, Mapping) and shape.get("kind") == "robot"}
        kinds |= AGENTS
        return frozenset(kinds | {str(entity) for entity, name in self.states.memberships if str(name) in kinds})

    def facts(self) -> dict[Signature, FactForms]:
        """Return the sentences for each fluent, from the language's table, its spatial predicate, or its name."""
        from prag_asp.scene.predicate_names import PREDICATE_ROLES  # noqa: PLC0415 - not needed for counting

        table, scene = self._table("facts"), self.settings.scene
        usual = {} if scene else _below(self.words.table, "fluents")
        forms = {}
        for name, arity in self.states.fluent_arguments:
            own = _below(_below(scene, "own"), name)
            meaning = _below(scene, "predicates").get(name, name)
            if table.get(name):
                entry = table[name]
            elif "sentence" in own and self.code == FIRST:
                entry = own["sentence"]
            elif name in usual and self.forms(usual[name], arity).names_all(arity):
                entry = usual[name]
            elif meaning in PREDICATE_ROLES and len(PREDICATE_ROLES[meaning]) == arity:
                entry = _below(_below(self.words.table, "facts"), meaning)
            else:
                entry = self._default(name, arity)
            forms[name, arity] = self.forms(entry, arity)
            for special, only in special_entries(table, name, arity):
                forms[name, arity] = forms[name, arity].extended(self.forms(special, arity), only)
        return forms

    def spare(self) -> dict[Signature, FactForms]:
        """Return the default sentences for each fluent, made from its name."""
        return {
            (name, arity): self.forms(self._default(name, arity), arity) for name, arity in self.states.fluent_arguments
        }

    def _default(self, name: str, arity: int) -> Mapping[str, Any]:
        """Return the default forms of a fluent: its name and its arguments.

        They have no modifier, because the fluent may not be visible in an image.
        """
        defaults = _below(self.words.table, "defaults")
        every = _joined([f"{{{index}}}" for index in range(arity)], defaults.get("all", (", ", ", ")))
        forms = _below(defaults, "state" if arity == 0 else "property" if arity == 1 else "fact")
        return {key: str(text).replace("{name}", plain(name)).replace("{all}", every) for key, text in forms.items()}

    def forms(self, entry: object, arity: int) -> FactForms:
        """Return the sentences for a fluent in an entry: a sentence, a list of sentences, or a table of forms."""
        table = entry if isinstance(entry, Mapping) else {"is": entry}
        true = listed(table.get("is"))
        initial = [
            replace(template, recurrences=frozenset(["initial"]))
            for template in self.templates(listed(table.get("initially")), arity)
        ]
        new: frozenset[Recurrence] = frozenset(["new"] if initial else [])
        false = listed(table.get("not"))
        modifiers = []
        for template in self.templates(listed(table.get("where")), arity):
            missing = [index for index in range(arity) if index not in template.arguments]
            if table.get("of") in missing:
                modifiers.append(Where(template, int(str(table["of"]))))
            elif len(missing) == 1:
                modifiers.append(Where(template, missing[0]))
        return FactForms(
            (*(replace(template, recurrences=new) for template in self.templates(true, arity)), *initial),
            tuple(self.templates(false, arity) if false else self.templates(filter(agrees, true), arity, "is_not")),
            tuple(modifiers),
            table.get("silent") is True,
        )

    def templates(
        self, texts: Sequence[str] | Iterator[str], arity: int, verb: str = "is", action: str = ""
    ) -> Iterator[Template]:
        """Yield the templates in texts: one for each form of an agreeing word, with and without text in brackets.

        The sentences that a domain gives for an `action` may say "again" of one that only restores facts.
        """
        table = self.words.table
        recurrent = RecurrenceWords(
            str(table.get("repeated", "")), str(table.get("varied", "")), frozenset(listed(table.get("second", ())))
        )
        for phrasing, whole in enumerate(map(self.words.expanded, texts)):
            restores = bool(action) and (not recurrent.says_again(whole) or self._restores(whole, action, arity))
            for text, recurrences in recurrent.forms(whole, restores=restores).items():
                forms: dict[str, set[str]] = {}
                for gender in self.words.genders if agrees(text) else ():
                    forms.setdefault(self.words.agreeing(verb, gender), set()).add(gender)
                for form, genders in forms.items() or [("", set[str]())]:
                    try:
                        template = parse_template(text, self.words.cases, arity, {"is": form}, frozenset(genders))
                    except QueryError:
                        continue
                    phrasal = listed(_below(table, "defaults").get("phrasal"))
                    yield replace(template, phrasing=phrasing, recurrences=recurrences, phrasal=phrasal)

    def nouns(self) -> dict[str, Noun]:
        """Return the noun for each class, and for each entity with a separate noun."""
        table = self._table("nouns")
        nouns = {name: noun for name, entry in table.items() if (noun := self.noun(entry)) is not None}
        for name in map(str, self.states.classes):
            if name not in nouns and self.code == FIRST:
                nouns[name] = Noun(self.words.genders[0], dict.fromkeys(self.words.cases, plain(name)))
        return nouns

    def noun(self, entry: object) -> Noun | None:
        """Return the noun in an entry of a table, or None if it is invalid."""
        table = entry if isinstance(entry, Mapping) else {"noun": entry}
        word, gender = table.get("noun"), table.get("gender", self.words.genders[0])
        if not isinstance(word, str) or not word.strip() or gender not in self.words.genders:
            return None
        texts = {case: table.get(case, word) for case in self.words.cases}
        forms = {case: self.words.expanded(form) for case, form in texts.items() if isinstance(form, str)}
        return Noun(str(gender), forms) if len(forms) == len(self.words.cases) else None

    def values(self) -> dict[str, str]:
        """Return the words for arguments that are neither entities nor classes."""
        words = {**self._rotations(), **self._table("values")}.items()
        return {name: self.words.expanded(text) for name, text in words if isinstance(text, str)}

    def _rotations(self) -> dict[str, str]:
        """Return the default words for the rotations of the scene, such as "the 90-degree position"."""
        pattern, angles = (
            str(_below(self.words.table, "defaults").get("rotation", "")),
            _below(self.settings.scene, "rotations"),
        )
        return {
            name: pattern.replace("{angle}", f"{angle:g}")
            for name, angle in angles.items()
            if pattern and isinstance(angle, int | float)
        }

    def missing(self) -> Iterator[tuple[str, str]]:
        """Yield the table and the name of each missing entry that instructions need."""
        table = self._table("actions")
        if "action" not in _below(self.words.table, "defaults"):
            yield from (
                ("actions", name)
                for name in dict.fromkeys(n for n, _ in self.states.action_arguments)
                if name not in table
            )
        nouns = self.nouns()
        for entity, name in self.states.entity_names.items():
            if entity not in nouns and name not in nouns:
                yield "nouns", name

    def _table(self, part: str) -> Mapping[str, Any]:
        return _below(self.own, part)


def relations_in(ways_of: Mapping[str, Mapping[int, Way]], led: Sequence[int], defaults: Mapping[str, Any]) -> set[int]:
    """Return the positions of arguments that name the relation of the moved object to a place in all actions.

    The phrase for the place already states such a relation: `behind` in ``place(panda,can_1,behind,bin_1)``.
    """
    found: set[int] | None = None
    for action, ways in ways_of.items():
        stated = {
            name
            for way in (ways[index] for index in led)
            if way.predicate in defaults[way.word]
            for name in (way.fluent.name, way.predicate)
        }
        here = {index for index, argument in enumerate(parse_atom(action).arguments) if argument in stated}
        found = here if found is None else found & here
    return found or set()


def special_entries(table: Mapping[str, Any], name: str, arity: int) -> Iterator[tuple[Any, tuple[str, ...]]]:
    """Yield the entries of a name for certain arguments only, such as ``pick(_,_,sink)``, with these arguments."""
    for key, entry in table.items():
        called, only = split_key(key)
        if called == name and len(only) == arity:
            yield entry, only


def split_key(key: str) -> tuple[str, tuple[str, ...]]:
    """Return the name in a key such as ``pick(_,_,sink)``, and its arguments, which are empty for a name alone."""
    name, bracket, rest = key.partition("(")
    if not bracket or not rest.endswith(")"):
        return key, ()
    return name.strip(), tuple(part.strip() for part in rest[:-1].split(","))


def languages(settings: Settings) -> tuple[str, ...]:
    """Return the codes of a domain's languages: English, and those that have tables."""
    return tuple(dict.fromkeys([FIRST, *tables(settings)]))


def tables(settings: Settings) -> Mapping[str, Mapping[str, Any]]:
    """Return the tables for a domain's languages by their codes."""
    return {code: table for code, table in settings.grammar.items() if isinstance(table, Mapping)}


def listed(texts: object) -> tuple[str, ...]:
    """Return a text or a list of texts as a tuple; other values are dropped."""
    each = texts if isinstance(texts, list | tuple) else (texts,)
    return tuple(text for text in each if isinstance(text, str))


def plain(name: str) -> str:
    """Return a name as words for a sentence: ``pick up`` for ``pick_up`` or ``pickUp``, ``disc 1`` for ``disc(1)``."""
    name = CAMEL.sub(lambda match: f"{match[1]} {match[2].lower()}", name)
    return " ".join(
        NUMBERED.sub(" ", name)
        .replace("_", " ")
        .replace("(", " ")
        .replace(")", " ")
        .replace(",", " ")
        .replace('"', " ")
        .split()
    )


def _joined(words: Sequence[str], between: Sequence[str]) -> str:
    """Return words joined with the first separator, except the last word, which is joined with the second one."""
    return between[1].join(part for part in (between[0].join(words[:-1]), *words[-1:]) if part)


def _with_particle(text: str, verb: str, objects: str, defaults: Mapping[str, Any]) -> str:
    """Return a sentence in which the particle of the verb follows its object: "put it down", not "put down it"."""
    head, _, particle = verb.rpartition(" ")
    if not head or not objects or particle not in defaults.get("particles", ()):
        return text
    return text.replace(f"{verb} {objects}", f"{head} {objects} {particle}")


def _below(table: object, key: str) -> Mapping[str, Any]:
    """Return the subtable with a key, or an empty table."""
    value = table.get(key) if isinstance(table, Mapping) else None
    return value if isinstance(value, Mapping) else {}
