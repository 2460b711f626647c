"""Parse instructions: an instruction means a plan, or facts that have to hold at the end.

Parsing uses only the text and its context: the things present, and the known facts of the initial state. A phrase that
fits no thing, or may fit two, is refused, and so is a sentence that could mean two actions.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import islice, product
from typing import TYPE_CHECKING, NamedTuple

from prag_asp.atom import Atom, symbol_of
from prag_asp.dataset.language.descriptions import InstructionContext, View
from prag_asp.dataset.language.lexicon import Lexicon
from prag_asp.errors import QueryError
from prag_asp.grammar.template import Template, parse_template
from prag_asp.task import FrozenDict, Task

if TYPE_CHECKING:
    from prag_asp.domain.load import Domain

LONGEST = 100_000
"""The maximum number of characters of an instruction."""

LONGEST_SENTENCE = 1_000
"""The maximum number of characters of a sentence in an instruction."""

MOST = 64
"""The number of readings of a text after which no more are collected: two already make it ambiguous."""


@dataclass(frozen=True)
class Reading:
    """The meaning of an instruction: a plan, or a goal of facts that have to hold in the final state.

    If it gives the purpose of each action, `aims` has these facts, in one mapping per action.
    """

    actions: tuple[Atom, ...] = ()
    goal: Mapping[Atom, bool] = field(default_factory=FrozenDict)
    aims: tuple[Mapping[Atom, bool], ...] = ()


class ParsedSentence(NamedTuple):
    """The meaning of a sentence: an action, or a fluent with its value; "it" in the next sentence means the `topic`."""

    atom: Atom
    value: bool
    topic: str | None


class InstructionReader:
    """Parses instructions in one language of a domain."""

    def __init__(self, lexicon: Lexicon) -> None:
        self.lexicon = lexicon
        self._actions = tuple(clause for each in lexicon.sentences.actions.values() for clause in each)
        self._facts = tuple(clause for each in lexicon.sentences.facts.values() for clause in each)
        frames = lexicon.words.frames
        self._vague = tuple(map(_frame, frames["vague"]))
        self._default = tuple(map(_frame, (*frames["default"], frames["subgoal"])))
        self._exact = tuple(map(_frame, frames["exact"]))
        texts = [text for clause in (*self._actions, *self._facts) for text in clause.template.texts]
        texts += lexicon.phrases.vocabulary()
        self._joints, self._reach = dict[str, re.Pattern[str]](), dict[str, int]()
        for kind in ("sentences", "facts"):
            joints = sorted(lexicon.words.joints(kind), key=len, reverse=True)
            self._joints[kind] = joint = re.compile("|".join(map(re.escape, joints)))
            # The number of joints tried as the end of a sentence: more than two if sentences contain joints.
            self._reach[kind] = 6 if any(joint.search(f" {text} ") for text in texts) else 2
        self._parsed: dict[tuple[object, str, str | None, bool], frozenset[ParsedSentence]] = {}

    def read(self, start: InstructionContext, text: str) -> Reading:
        """Return the meaning of an instruction in a context.

        Raises:
            QueryError: the instruction has no meaning or several; the message quotes the part at fault.
        """
        if len(text) > LONGEST:
            raise QueryError(f"an instruction has at most {LONGEST:,} characters; this one has {len(text):,}")
        view, text = self.lexicon.view(start), self.lexicon.words.expanded(" ".join(text.split()))
        if not text:
            return Reading()
        found: dict[object, Reading] = {}
        for reading in self._readings(view, text):
            found[reading.actions, _key(reading.goal), tuple(map(_key, reading.aims))] = reading
            if len(found) > MOST:
                break
        if len(found) == 1:
            reading = next(iter(found.values()))
            for action, aims in zip(reading.actions, reading.aims, strict=False):
                effects = self.lexicon.domain.facts.postconditions.get(symbol_of(action), ())
                made = {str(fluent): value for fluent, value in effects}
                for fluent, value in aims.items():
                    if made.get(str(fluent)) not in (str(value).lower(), None):
                        raise QueryError(f"{action} does not make {fluent} {str(value).lower()}; fix the instruction")
            return reading
        if found:
            plans = [
                " ".join(map(str, reading.actions)) or str(list(map(str, reading.goal))) for reading in found.values()
            ]
            raise QueryError(f"{shortened(text)!r} could mean {plans[0]} or {plans[1]}; say it so that one is left")
        raise QueryError(self._why(view, text))

    def _readings(self, view: View, text: str) -> Iterator[Reading]:
        """Yield all meanings of a text."""
        if self.lexicon.words.number(1).casefold() == text[: len(self.lexicon.words.number(1))].casefold():
            yield from self._steps(view, text)
        for frame in self._vague:
            for (inner,) in frame.find(text):
                for parsed in self._list(view, inner, "facts", None):
                    yield Reading(goal=FrozenDict({each.atom: each.value for each in parsed}))
        for frame in self._default:
            for (inner,) in frame.find(text):
                for parsed in self._list(view, inner, "sentences", None):
                    yield Reading(tuple(each.atom for each in parsed))

    def _steps(self, view: View, text: str) -> Iterator[Reading]:
        """Yield the plans of a text with numbered actions."""
        words, between = self.lexicon.words, str(self.lexicon.words.table["joints"]["steps"])
        parts, rest, number = list[str](), text, 2
        while True:
            at = rest.casefold().find(f".{between}{words.number(number)}".casefold())
            parts.append(rest if at < 0 else rest[: at + 1])
            if at < 0:
                break
            rest, number = rest[at + 1 + len(between) :], number + 1
        steps = [list(self._step(view, part, number)) for number, part in enumerate(parts, 1)]
        for chosen in islice(product(*steps), MOST + 1):
            yield Reading(tuple(action for action, _ in chosen), aims=tuple(aims for _, aims in chosen))

    def _step(self, view: View, text: str, number: int) -> Iterator[tuple[Atom, Mapping[Atom, bool]]]:
        """Yield the meanings of a numbered step: an action and its aims."""
        word = self.lexicon.words.number(number)
        for frame in self._exact:
            for ordinal, action, *aims in frame.find(text):
                if ordinal.casefold() != word.casefold():
                    continue
                for parsed in self.sentence(view, action, None, of_actions=True):
                    if not aims:
                        yield parsed.atom, FrozenDict()
                    for facts in self._list(view, aims[0], "facts", parsed.topic) if aims else ():
                        yield parsed.atom, FrozenDict({each.atom: each.value for each in facts})

    def _list(self, view: View, text: str, kind: str, topic: str | None) -> Iterator[tuple[ParsedSentence, ...]]:
        """Yield the lists of sentences that a text can mean; "it" refers to the topic of the sentence before.

        In a list of facts, "it" has the same meaning in every sentence.
        """
        begun: dict[int, list[_Path]] = {0: [_Path(None, topic, None)]}
        breaks = [
            found.span() for found in self._joints[kind].finditer(text) if found.start() > 0 and found.end() < len(text)
        ]
        for place in range(len(breaks) + 1):
            begin = breaks[place - 1][1] if place else 0
            paths = begun.pop(begin, [])
            for end, after in (*breaks[place : place + self._reach[kind] - 1], (len(text), len(text))) if paths else ():
                if end - begin > LONGEST_SENTENCE or end <= begin:
                    continue
                for path in paths:
                    for parsed in self.sentence(view, text[begin:end], path.topic, of_actions=kind == "sentences"):
                        found = begun.setdefault(after, [])
                        if len(found) <= MOST:
                            found.append(_Path(parsed, parsed.topic if kind == "sentences" else topic, path))
        yield from (path.sentences() for path in begun.get(len(text), ()))

    def sentence(self, view: View, text: str, topic: str | None, *, of_actions: bool) -> frozenset[ParsedSentence]:
        """Return the meanings of a sentence in a state, where "it" means `topic`."""
        return self.parse_sentence(view, text, topic, of_actions=of_actions)[0]

    def parse_sentence(
        self, view: View, text: str, topic: str | None, *, of_actions: bool
    ) -> tuple[frozenset[ParsedSentence], bool]:
        """Return the meanings of a sentence in a state, and whether they depend on the state."""
        key = (view.context, text, topic, of_actions)
        known = self._parsed.get(key)
        if known is not None:
            return known, False
        found, of_state = set[ParsedSentence](), False

        def fits(word: str) -> bool:
            nonlocal of_state
            meant, related = self.phrase(view, word, topic)
            of_state |= related
            return bool(meant)

        for sentence in self._actions if of_actions else self._facts:
            for spelled in (text, text[:1].lower() + text[1:]) if text[:1].isupper() else (text,):
                for words in sentence.template.find(spelled, fits):
                    for arguments in product(*(self.phrase(view, word, topic)[0] for word in words)):
                        for atom in sentence.meant(tuple(arguments)):
                            found.add(ParsedSentence(atom, sentence.value, self.topic(arguments)))
        known = frozenset(found)
        if not of_state:
            if len(self._parsed) > LONGEST:
                self._parsed.clear()
            self._parsed[key] = known
        return known, of_state

    def phrase(self, view: View, text: str, topic: str | None) -> tuple[frozenset[str], bool]:
        """Return what a phrase can mean, and whether that depends on the state."""
        if topic is not None and text in self.lexicon.phrases.pronouns:
            return frozenset([topic]), False
        return self.lexicon.phrases.read(view, text)

    def topic(self, arguments: Sequence[str]) -> str | None:
        """Return what "it" means after a sentence: the first movable thing that it names.

        That is its highest-ranked centre in centering theory (Grosz, Joshi and Weinstein 1995).
        """
        appearance = self.lexicon.appearance
        return next((each for each in arguments if each in appearance.nouns and each not in appearance.seen), None)

    def _why(self, view: View, text: str) -> str:
        """Return why a text has no meaning, as a message about a phrase or a sentence."""
        known = f"of {self.lexicon.domain.name} in {self.lexicon.words.name}"
        frames = sorted((*self._vague, *self._default), key=lambda frame: -sum(map(len, frame.texts)))
        first = self.lexicon.words.number(1)
        for frame in (*(self._exact if text.casefold().startswith(first.casefold()) else ()), *frames):
            for inner in frame.find(text):
                clauses = self._joints["sentences"].split(inner[1] if frame in self._exact else inner[0])
                for clause in (each for text in clauses for each in self._joints["facts"].split(text)):
                    part = clause[:LONGEST_SENTENCE]
                    problem = self._unclear(view, part)
                    if problem:
                        return problem
                    if not any(self.sentence(view, part, None, of_actions=each) for each in (True, False)):
                        return f"{shortened(part)!r} is no sentence {known}; write one as sample does"
        return f"{shortened(text)!r} is no instruction {known}; write one as sample does"

    def _unclear(self, view: View, part: str) -> str | None:
        """Return which phrase of a sentence fits nothing or is ambiguous, or None if all are clear."""
        for clause in (*self._actions, *self._facts):
            for words in clause.template.find(part[:1].lower() + part[1:]):
                for word in words:
                    things = self.lexicon.phrases.fitting(view, word)
                    if things is not None and not self.phrase(view, word, None)[0]:
                        if not things:
                            return f"{word!r} fits nothing that there is; name another thing"
                        return f"{word!r} may be {' or '.join(things)}; say its colour, its size or where it is"
        return None


class _Path(NamedTuple):
    """A sentence of a list, what "it" means after it, and the sentences before."""

    parsed: ParsedSentence | None
    topic: str | None
    before: _Path | None

    def sentences(self) -> tuple[ParsedSentence, ...]:
        """Return the sentences from the first one to this one."""
        found, path = list[ParsedSentence](), self
        while path.parsed is not None and path.before is not None:
            found.append(path.parsed)
            path = path.before
        return tuple(reversed(found))


def read_instruction(
    domain: Domain | InstructionReader, start: InstructionContext | Task, text: str, language: str = "en"
) -> Reading:
    """Return the meaning of an instruction given at the start of a task, or in any other context.

    To read many instructions, pass an `InstructionReader` instead of the domain.

    Raises:
        QueryError: the text is not an instruction of the domain in this language, or it could mean several plans.
    """
    reader = domain if isinstance(domain, InstructionReader) else InstructionReader(Lexicon(domain, language))
    return reader.read(context_of(start) if isinstance(start, Task) else start, text)


def context_of(task: Task, number: int = 0) -> InstructionContext:
    """Return the context before an action of a task, given the action's number from 0."""
    return InstructionContext(frozenset(task.entities), {}).at(task.states[number - 1] if number else task.initial)


def capital(text: str) -> str:
    """Return a text with its first letter capitalized."""
    return text[:1].upper() + text[1:]


def shortened(text: str, most: int = 60) -> str:
    """Return a text shortened to fit into a message."""
    return text if len(text) <= most else f"{text[:most]}..."


def _frame(text: str) -> Template:
    """Return a frame as a template, its slots numbered in their order."""
    names = ["{number}", "{action}", "{actions}", "{facts}"]
    places = sorted((text.find(name), name) for name in names if name in text)
    for index, (_, name) in enumerate(places):
        text = text.replace(name, f"{{{index}}}")
    return parse_template(text, (), 4)


def _key(facts: Mapping[Atom, bool]) -> object:
    return frozenset(facts.items())
