"""Read instructions back: the plan that one spells, or what it wants to be so at the end.

Only the text is read, and what somebody sees who is told it: which things there are, and what is known of the first
state. A phrase that fits no thing, or may fit two, is refused, and so is a sentence that could mean two actions.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import islice, product
from typing import TYPE_CHECKING, NamedTuple

from prag_asp.atom import Atom, symbol_of
from prag_asp.dataset.language.descriptions import Start, View
from prag_asp.dataset.language.lexicon import Tongue
from prag_asp.dataset.language.sentences import Clause
from prag_asp.errors import QueryError
from prag_asp.grammar.template import Template, parse_template
from prag_asp.task import FrozenDict, Task

if TYPE_CHECKING:
    from prag_asp.domain.load import Domain

LONGEST = 100_000
"""Characters of an instruction that is read."""

LONGEST_SENTENCE = 1_000
"""Characters of one sentence of it."""

MOST = 64
"""Readings of a text that are looked at; where there are more, none of them is the only one."""


@dataclass(frozen=True)
class Reading:
    """What an instruction asks for: a plan, or facts that have to be known of the last state.

    Where it says what each action is for, these facts are in `aims`, one mapping an action.
    """

    actions: tuple[Atom, ...] = ()
    goal: Mapping[Atom, bool] = field(default_factory=FrozenDict)
    aims: tuple[Mapping[Atom, bool], ...] = ()


class Said(NamedTuple):
    """What one sentence says: an action, or a fluent with its value, and what "it" means in the next sentence."""

    atom: Atom
    value: bool
    topic: str | None


class Reader:
    """Reads texts in one language of a domain."""

    def __init__(self, tongue: Tongue) -> None:
        self.tongue = tongue
        self._actions = tuple(clause for each in tongue.clauses.actions.values() for clause in each)
        self._facts = tuple(clause for each in tongue.clauses.facts.values() for clause in each)
        frames = tongue.words.frames
        self._vague = tuple(map(_frame, frames["vague"]))
        self._default = tuple(map(_frame, (*frames["default"], frames["subgoal"])))
        self._exact = tuple(map(_frame, frames["exact"]))
        self._joints = {kind: _alternatives(tongue.words.joints(kind)) for kind in ("sentences", "facts")}
        self._reach = {kind: self._breaks_within(joint) for kind, joint in self._joints.items()}
        self._heard: dict[tuple[object, str, str | None, bool], frozenset[Said]] = {}

    def _breaks_within(self, joint: re.Pattern[str]) -> int:
        """Return how many joints are looked at for the end of a sentence: more than two where sentences have them."""
        texts = [text for clause in (*self._actions, *self._facts) for text in clause.template.texts]
        texts += self.tongue.phrases.vocabulary()
        return 6 if any(joint.search(f" {text} ") for text in texts) else 2

    def read(self, start: Start, text: str) -> Reading:
        """Return what an instruction asks for that is given in a state.

        Raises:
            QueryError: it is none, or it could mean several plans; the message says which part of it.
        """
        if len(text) > LONGEST:
            raise QueryError(f"an instruction has at most {LONGEST:,} characters; this one has {len(text):,}")
        view, text = self.tongue.view(start), self.tongue.words.expanded(" ".join(text.split()))
        if not text:
            return Reading()
        found: dict[object, Reading] = {}
        for reading in self._readings(view, text):
            found[reading.actions, _key(reading.goal), tuple(map(_key, reading.aims))] = reading
            if len(found) > MOST:
                break
        if len(found) == 1:
            reading = next(iter(found.values()))
            self._refuse_contradictions(reading)
            return reading
        if found:
            plans = [
                " ".join(map(str, reading.actions)) or str(list(map(str, reading.goal))) for reading in found.values()
            ]
            raise QueryError(f"{shortened(text)!r} could mean {plans[0]} or {plans[1]}; say it so that one is left")
        raise QueryError(self._why(view, text))

    def _readings(self, view: View, text: str) -> Iterator[Reading]:
        """Yield all that a text can ask for."""
        if self.tongue.words.number(1).casefold() == text[: len(self.tongue.words.number(1))].casefold():
            yield from self._steps(view, text)
        for frame in self._vague:
            for (inner,) in frame.find(text):
                for said in self._list(view, inner, "facts", None):
                    yield Reading(goal=FrozenDict({each.atom: each.value for each in said}))
        for frame in self._default:
            for (inner,) in frame.find(text):
                for said in self._list(view, inner, "sentences", None):
                    yield Reading(tuple(each.atom for each in said))

    def _steps(self, view: View, text: str) -> Iterator[Reading]:
        """Yield the plans of a text that numbers its actions."""
        words, between = self.tongue.words, str(self.tongue.words.table["joints"]["steps"])
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
        """Yield what one numbered step can say: an action, and what it is for."""
        word = self.tongue.words.number(number)
        for frame in self._exact:
            for told, action, *aims in frame.find(text):
                if told.casefold() != word.casefold():
                    continue
                for said in self.clause(view, action, None, of_actions=True):
                    if not aims:
                        yield said.atom, FrozenDict()
                    for facts in self._list(view, aims[0], "facts", said.topic) if aims else ():
                        yield said.atom, FrozenDict({each.atom: each.value for each in facts})

    def _list(self, view: View, text: str, kind: str, topic: str | None) -> Iterator[tuple[Said, ...]]:
        """Yield the sentences that a text can be a list of; "it" in one is what the sentence before is about.

        Facts of one list are all about the same: "it" means the same in each of them.
        """
        begun: dict[int, list[_Path]] = {0: [_Path(None, topic, None)]}
        breaks = self._breaks(text, kind)
        for place in range(len(breaks) + 1):
            begin = breaks[place - 1][1] if place else 0
            paths = begun.pop(begin, [])
            for end, after in (*breaks[place : place + self._reach[kind] - 1], (len(text), len(text))) if paths else ():
                if end - begin > LONGEST_SENTENCE or end <= begin:
                    continue
                for path in paths:
                    for said in self.clause(view, text[begin:end], path.topic, of_actions=kind == "sentences"):
                        found = begun.setdefault(after, [])
                        if len(found) <= MOST:
                            found.append(_Path(said, said.topic if kind == "sentences" else topic, path))
        yield from (path.sentences() for path in begun.get(len(text), ()))

    def _breaks(self, text: str, kind: str) -> list[tuple[int, int]]:
        """Return where a sentence of a list can end and the next one begin."""
        return [
            found.span() for found in self._joints[kind].finditer(text) if found.start() > 0 and found.end() < len(text)
        ]

    def clause(self, view: View, text: str, topic: str | None, *, of_actions: bool) -> frozenset[Said]:
        """Return what a sentence can say in a state, where "it" would mean `topic`."""
        return self.heard(view, text, topic, of_actions=of_actions)[0]

    def heard(self, view: View, text: str, topic: str | None, *, of_actions: bool) -> tuple[frozenset[Said], bool]:
        """Return what a sentence can say in a state, and whether that depends on what is known of the state."""
        key = (view.crowd, text, topic, of_actions)
        known = self._heard.get(key)
        if known is not None:
            return known, False
        said, of_state = self._clause(view, text, topic, self._actions if of_actions else self._facts)
        known = frozenset(said)
        if not of_state:
            if len(self._heard) > LONGEST:
                self._heard.clear()
            self._heard[key] = known
        return known, of_state

    def _clause(self, view: View, text: str, topic: str | None, clauses: Sequence[Clause]) -> tuple[set[Said], bool]:
        """Return what a sentence can say, and whether that depends on what is known of the state."""
        found, of_state = set[Said](), False

        def fits(word: str) -> bool:
            nonlocal of_state
            meant, related = self.phrase(view, word, topic)
            of_state |= related
            return bool(meant)

        for clause in clauses:
            for spelled in (text, text[:1].lower() + text[1:]) if text[:1].isupper() else (text,):
                for words in clause.template.find(spelled, fits):
                    for arguments in product(*(self.phrase(view, word, topic)[0] for word in words)):
                        for atom in clause.meant(tuple(arguments)):
                            found.add(Said(atom, clause.value, self.topic(arguments)))
        return found, of_state

    def phrase(self, view: View, text: str, topic: str | None) -> tuple[frozenset[str], bool]:
        """Return what a phrase can mean, and whether that depends on what is known of the state."""
        if topic is not None and text in self.tongue.phrases.pronouns:
            return frozenset([topic]), False
        return self.tongue.phrases.read(view, text)

    def topic(self, arguments: Sequence[str]) -> str | None:
        """Return what "it" means after a sentence: what it names first of what can be moved.

        That is its highest-ranked centre in centering theory (Grosz, Joshi and Weinstein 1995).
        """
        looks = self.tongue.looks
        return next((each for each in arguments if each in looks.nouns and each not in looks.seen), None)

    def _refuse_contradictions(self, reading: Reading) -> None:
        """Refuse a step that is said to be for something that its action does not bring about.

        Raises:
            QueryError: there is one.
        """
        known = self.tongue.domain.facts.postconditions
        for action, aims in zip(reading.actions, reading.aims, strict=False):
            effects = {str(fluent): value for fluent, value in known.get(symbol_of(action), ())}
            for fluent, value in aims.items():
                if effects.get(str(fluent)) not in (str(value).lower(), None):
                    raise QueryError(f"{action} does not make {fluent} {str(value).lower()}; mend the instruction")

    def _why(self, view: View, text: str) -> str:
        """Return what is wrong with a text that means nothing: a thing that it names, or a sentence."""
        known = f"of {self.tongue.domain.name} in {self.tongue.words.name}"
        frames = sorted((*self._vague, *self._default), key=lambda frame: -sum(map(len, frame.texts)))
        first = self.tongue.words.number(1)
        for frame in (*(self._exact if text.casefold().startswith(first.casefold()) else ()), *frames):
            for inner in frame.find(text):
                for part in self._parts(inner[1] if frame in self._exact else inner[0]):
                    told = self._unclear(view, part)
                    if told:
                        return told
                    if not any(self.clause(view, part, None, of_actions=each) for each in (True, False)):
                        return f"{shortened(part)!r} is no sentence {known}; write one as sample does"
        return f"{shortened(text)!r} is no instruction {known}; write one as sample does"

    def _unclear(self, view: View, part: str) -> str | None:
        """Return which thing of a sentence is not clear, None where that is not what is wrong with it."""
        for clause in (*self._actions, *self._facts):
            for words in clause.template.find(part[:1].lower() + part[1:]):
                for word in words:
                    things = self.tongue.phrases.fitting(view, word)
                    if things is not None and not self.phrase(view, word, None)[0]:
                        if not things:
                            return f"{word!r} fits nothing that there is; name another thing"
                        return f"{word!r} may be {' or '.join(things)}; say its colour, its size or where it is"
        return None

    def _parts(self, text: str) -> list[str]:
        """Return the sentences between the joints of a text, no longer than any sentence is."""
        parts = [each for part in self._joints["sentences"].split(text) for each in self._joints["facts"].split(part)]
        return [part[:LONGEST_SENTENCE] for part in parts]


class _Path(NamedTuple):
    """A sentence of a list, what "it" means after it, and the sentences before."""

    said: Said | None
    topic: str | None
    before: _Path | None

    def sentences(self) -> tuple[Said, ...]:
        """Return the sentences from the first one to this."""
        found, path = list[Said](), self
        while path.said is not None and path.before is not None:
            found.append(path.said)
            path = path.before
        return tuple(reversed(found))


def read_instruction(domain: Domain | Reader, start: Start | Task, text: str, language: str = "en") -> Reading:
    """Return what an instruction asks for that is given at the start of a task, or in any other state.

    Give a `Reader` in place of the domain where many are read.

    Raises:
        QueryError: it is no instruction of the domain in this language, or could mean several plans.
    """
    reader = domain if isinstance(domain, Reader) else Reader(Tongue(domain, language))
    return reader.read(start_of(start) if isinstance(start, Task) else start, text)


def start_of(task: Task, number: int = 0) -> Start:
    """Return what somebody sees before the action of a number of a task, from 0."""
    return Start(frozenset(task.entities), {}).at(task.states[number - 1] if number else task.initial)


def capital(text: str) -> str:
    """Return a text that begins with a capital letter."""
    return text[:1].upper() + text[1:]


def shortened(text: str, most: int = 60) -> str:
    """Return a text in a length that fits into a message."""
    return text if len(text) <= most else f"{text[:most]}..."


def _alternatives(texts: Iterable[str]) -> re.Pattern[str]:
    """Return a pattern of some texts, the longest first."""
    return re.compile("|".join(map(re.escape, sorted(texts, key=len, reverse=True))))


def _frame(text: str) -> Template:
    """Return what stands around sentences as a template, its braces in their order."""
    names = ["{number}", "{action}", "{actions}", "{facts}"]
    places = sorted((text.find(name), name) for name in names if name in text)
    for index, (_, name) in enumerate(places):
        text = text.replace(name, f"{{{index}}}")
    return parse_template(text, (), 4)


def _key(facts: Mapping[Atom, bool]) -> object:
    return frozenset(facts.items())
