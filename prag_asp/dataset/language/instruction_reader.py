"""Parse instructions: the meaning of an instruction is a plan, or facts that have to hold at the end.

Parsing uses only the text and its context: the objects that are present, and the known facts of the initial state. A
phrase that fits no object or may fit two objects is refused, and so is a sentence that could mean two actions.
"""

from __future__ import annotations

import re
from bisect import bisect_right
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

BRACES = re.compile(r"\{[A-Za-z]+\}")

LONGEST_SENTENCE = 1_000
"""The maximum number of characters of a sentence in an instruction."""

MOST = 64
"""The maximum number of readings of a text to collect; two readings already make it ambiguous."""


@dataclass(frozen=True)
class Reading:
    """The meaning of an instruction: a plan, or a goal of facts that have to hold in the final state.

    If the instruction states the purpose of each action, `aims` holds one mapping of facts per action.
    """

    actions: tuple[Atom, ...] = ()
    goal: Mapping[Atom, bool] = field(default_factory=FrozenDict)
    aims: tuple[Mapping[Atom, bool], ...] = ()


class ParsedSentence(NamedTuple):
    """The meaning of a sentence: an action, or a fluent with its value; in the next sentence, "it" means `topic`.

    The next fact may omit the `subject`.
    """

    atom: Atom
    value: bool
    topic: str | None
    subject: str = ""


class InstructionReader:
    """A parser of instructions for a domain in one language."""

    def __init__(self, lexicon: Lexicon) -> None:
        self.lexicon = lexicon
        self._actions = tuple(clause for each in lexicon.sentences.actions.values() for clause in each)
        self._facts = tuple(clause for each in lexicon.sentences.facts.values() for clause in each)
        frames = lexicon.words.frames
        self._vague = tuple(map(_frame, frames["vague"]))
        self._default = tuple(map(_frame, (*frames["default"], frames["subgoal"])))
        self._exact = tuple(map(_frame, frames["exact"]))
        self._alone = (_frame(unnumbered(frames["exact"][1])),)
        sentences = [each.template for each in (*self._actions, *self._facts)]
        vocabulary = lexicon.phrases.vocabulary()
        self._joints, self._reach = dict[str, Sequence[re.Pattern[str]]](), dict[str, int]()
        for kind in ("sentences", "facts"):
            texts_between = lexicon.words.between_facts if kind == "facts" else lexicon.words.joints(kind)
            # Each occurrence of each joint; the look-ahead also finds those that overlap.
            joints = [re.compile(f"(?=({re.escape(joint)}))") for joint in sorted({*texts_between})]
            if kind == "facts" and lexicon.words.adjoined:
                joints.append(re.compile(f"(?=( )(?:{'|'.join(map(re.escape, lexicon.words.adjoined))}) )"))
            self._joints[kind] = joints
            # the number of joints that are tried as the end of a sentence: those at one position, and those that the
            # sentence may contain
            in_phrase = 3 * max((_occurrences(joints, text) for text in vocabulary), default=0)
            inside = (
                sum(_occurrences(joints, text) for text in each.texts) + in_phrase * len(each.slots)
                for each in sentences
            )
            pair = in_phrase + len(joints) if kind == "facts" and lexicon.words.both else 0  # of two subjects
            self._reach[kind] = 1 + len(joints) + max(inside, default=0) + pair
        self._parsed: dict[tuple[object, str, str | None, bool], frozenset[ParsedSentence]] = {}

    def read(self, start: InstructionContext, text: str) -> Reading:
        """Return the meaning of an instruction in a context.

        Raises:
            QueryError: the instruction has no meaning or several; the message quotes the faulty part.
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
            raise QueryError(f"{shortened(text)!r} could mean {plans[0]} or {plans[1]}; make it unambiguous")
        raise QueryError(self._why(view, text))

    def _readings(self, view: View, text: str) -> Iterator[Reading]:
        """Yield all meanings of a text."""
        if self.lexicon.words.number(1).casefold() == text[: len(self.lexicon.words.number(1))].casefold():
            yield from self._steps(view, text)
        for frame in self._alone:
            for words in frame.find(text):
                for action, aims in self._aimed(view, *words):
                    yield Reading((action,), aims=(aims,))
        for frame in self._vague:
            for (inner,) in frame.find(text):
                for parsed in self.facts(view, inner, None):
                    yield Reading(goal=FrozenDict({each.atom: each.value for each in parsed}))
        for frame in self._default:
            for (inner,) in frame.find(text):
                for parsed in self._list(view, inner, "sentences", None):
                    yield Reading(tuple(each.atom for each in parsed))

    def _steps(self, view: View, text: str) -> Iterator[Reading]:
        """Yield the plans that a text with numbered actions can mean."""
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
                if ordinal.casefold() == word.casefold():
                    yield from self._aimed(view, action, *aims)

    def _aimed(self, view: View, action: str, *aims: str) -> Iterator[tuple[Atom, Mapping[Atom, bool]]]:
        """Yield the meanings of an action's sentence, with the meanings of the facts that are its aims, if any."""
        for parsed in self.sentence(view, action, None, of_actions=True):
            if not aims:
                yield parsed.atom, FrozenDict()
            for facts in self.facts(view, aims[0], parsed.topic) if aims else ():
                yield parsed.atom, FrozenDict({each.atom: each.value for each in facts})

    def facts(self, view: View, text: str, topic: str | None) -> Iterator[tuple[ParsedSentence, ...]]:
        """Yield the lists of facts that a text can mean; "it" means the topic in all of them."""
        return self._list(view, text, "facts", topic)

    def _both(self, view: View, text: str, topic: str | None) -> Iterator[tuple[ParsedSentence, ...]]:
        """Yield the pairs of facts that a sentence with one predicate of two subjects can mean."""
        words = self.lexicon.words
        if not words.both or not text.startswith(words.both[0]):
            return
        inner = text[len(words.both[0]) :]
        for joint in re.finditer(f"(?=({re.escape(words.both[1])}))", inner):  # also those that overlap
            after = inner[joint.end(1) :]
            for blank in re.finditer(" ", after):
                subjects = inner[: joint.start()], after[: blank.start()]
                predicates = words.in_singular(after[blank.end() :])
                meanings = [
                    {
                        parsed
                        for predicate in predicates
                        for parsed in self.sentence(view, f"{subject} {predicate}", topic, of_actions=False)
                    }
                    for subject in subjects
                ]
                yield from product(*meanings)

    def _list(self, view: View, text: str, kind: str, topic: str | None) -> Iterator[tuple[ParsedSentence, ...]]:
        """Yield the lists of sentences that a text can mean; "it" refers to the topic of the previous sentence.

        In a list of facts, "it" has the same meaning in every sentence.
        """
        begun: dict[int, list[_Path]] = {0: [_Path(None, topic, None)]}
        breaks = sorted(
            (found.start(), found.end(1))
            for joint in self._joints[kind]
            for found in joint.finditer(text)
            if found.start() > 0 and found.end(1) < len(text)
        )
        for begin in sorted({0, *(end for _, end in breaks)}):
            paths, place = begun.pop(begin, []), bisect_right(breaks, (begin, len(text)))
            for end, after in (*breaks[place : place + self._reach[kind] - 1], (len(text), len(text))) if paths else ():
                if end - begin > LONGEST_SENTENCE or end <= begin:
                    continue
                found = begun.setdefault(after, [])
                for path in paths:
                    for part in dict.fromkeys(omitted + text[begin:end] for omitted in ("", *path.subjects)):
                        for parsed in self.sentence(view, part, path.topic, of_actions=kind == "sentences"):
                            verb = self.lexicon.words.verb_phrase(part)
                            subjects = (parsed.subject, part[:verb]) if kind == "facts" else ()
                            if len(found) <= MOST:
                                found.append(_Path(parsed, topic if kind == "facts" else parsed.topic, path, subjects))
                    for one, other in self._both(view, text[begin:end], topic) if kind == "facts" else ():
                        if len(found) <= MOST:
                            found.append(_Path(other, topic, _Path(one, topic, path)))
        yield from (path.sentences() for path in begun.get(len(text), ()))

    def sentence(self, view: View, text: str, topic: str | None, *, of_actions: bool) -> frozenset[ParsedSentence]:
        """Return the meanings of a sentence in a state; "it" means `topic`."""
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
                        if sentence.sources:
                            relations = self.lexicon.phrases.stated(view, words[sentence.moved])
                            meant = sentence.meant_from(arguments, relations.get(arguments[sentence.moved], set()))
                        else:
                            meant = sentence.meant(arguments)
                        for atom in meant:
                            subject = self.subject(sentence.template, words)
                            found.add(ParsedSentence(atom, sentence.value, self.topic(arguments), subject))
        known = frozenset(found)
        if not of_state:
            if len(self._parsed) > LONGEST:
                self._parsed.clear()
            self._parsed[key] = known
        return known, of_state

    def phrase(self, view: View, text: str, topic: str | None) -> tuple[frozenset[str], bool]:
        """Return the possible meanings of a phrase, and whether they depend on the state."""
        if topic is not None and text in self.lexicon.phrases.pronouns:
            return frozenset([topic]), False
        return self.lexicon.phrases.read(view, text)

    def subject(self, template: Template, words: Sequence[str]) -> str:
        """Return the subject at the beginning of a sentence, followed by a space, or "" if it begins otherwise."""
        begins = bool(words) and not template.texts[0] and template.texts[1].startswith(" ")
        return f"{words[0]} " if begins else ""

    def topic(self, arguments: Sequence[str]) -> str | None:
        """Return the meaning of "it" after a sentence: the first movable object in the sentence, or else the first one.

        That is its highest-ranked centre in centering theory (Grosz, Joshi and Weinstein 1995).
        """
        appearance = self.lexicon.appearance
        things = [each for each in arguments if each in appearance.nouns]
        return next((each for each in things if each not in appearance.seen), things[0] if things else None)

    def _why(self, view: View, text: str) -> str:
        """Return the reason why a text has no meaning, as a message about a phrase or a sentence."""
        known = f"of {self.lexicon.domain.name} in {self.lexicon.words.name}"
        frames = sorted((*self._vague, *self._default), key=lambda frame: -sum(map(len, frame.texts)))
        first = self.lexicon.words.number(1)
        for frame in (*(self._exact if text.casefold().startswith(first.casefold()) else ()), *frames):
            for inner in frame.find(text):
                clauses = self._parts(inner[1] if frame in self._exact else inner[0], "sentences")
                for clause in (each for text in clauses for each in self._parts(text, "facts")):
                    part = clause[:LONGEST_SENTENCE]
                    problem = self._unclear(view, part)
                    if problem:
                        return problem
                    if not any(self.sentence(view, part, None, of_actions=each) for each in (True, False)):
                        return f"{shortened(part)!r} is not a sentence {known}; write one as sample does"
        return f"{shortened(text)!r} is not an instruction {known}; write one as sample does"

    def _parts(self, text: str, kind: str) -> list[str]:
        """Return the parts of a text between joints; at each position, the longest joint counts."""
        words = self.lexicon.words
        joints = sorted(words.between_facts if kind == "facts" else words.joints(kind), key=len, reverse=True)
        return re.split("|".join(map(re.escape, joints)), text)

    def _unclear(self, view: View, part: str) -> str | None:
        """Return a message about a phrase of a sentence that fits nothing or is ambiguous, or None if all are clear."""
        for clause in (*self._actions, *self._facts):
            for words in clause.template.find(part[:1].lower() + part[1:]):
                for word in words:
                    things = self.lexicon.phrases.fitting(view, word)
                    if things is not None and not self.phrase(view, word, None)[0]:
                        if not things:
                            return f"{word!r} fits no object that is present; name another one"
                        return f"{word!r} may be {' or '.join(things)}; state its colour, size or place"
        return None


class _Path(NamedTuple):
    """A sentence in a list, the meaning of "it" after this sentence, and the previous sentences.

    The next fact may omit one of the `subjects`, with or without the verb: "it is on the table and behind the can".
    """

    parsed: ParsedSentence | None
    topic: str | None
    before: _Path | None
    subjects: tuple[str, ...] = ()

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
        QueryError: the text is not an instruction of the domain in this language, or could mean several plans.
    """
    reader = domain if isinstance(domain, InstructionReader) else InstructionReader(Lexicon(domain, language))
    return reader.read(context_of(start) if isinstance(start, Task) else start, text)


def context_of(task: Task, number: int = 0) -> InstructionContext:
    """Return the context before the action of a task with the index `number`."""
    return InstructionContext(frozenset(task.entities), {}).at(task.states[number - 1] if number else task.initial)


def capital(text: str) -> str:
    """Return a text with its first letter capitalized."""
    return text[:1].upper() + text[1:]


def shortened(text: str, most: int = 60) -> str:
    """Return a text, shortened if it is too long for a message."""
    return text if len(text) <= most else f"{text[:most]}..."


def unnumbered(frame: str) -> str:
    """Return the frame of an exact instruction with a single action, which does not need to be numbered."""
    lower = frame.casefold()
    return frame[max(lower.find("{action}"), 0) :] if lower.find("{number}") < lower.find("{action}") else frame


def _frame(text: str) -> Template:
    """Return a frame as a template, with its slots numbered in order."""
    text = BRACES.sub(lambda match: match[0].lower(), text)
    names = ["{number}", "{action}", "{actions}", "{facts}"]
    places = sorted((text.find(name), name) for name in names if name in text)
    for index, (_, name) in enumerate(places):
        text = text.replace(name, f"{{{index}}}")
    return parse_template(text, (), 4)


def _occurrences(joints: Sequence[re.Pattern[str]], text: str) -> int:
    """Return the number of occurrences of joints in a text, which is part of a longer text."""
    return sum(len(joint.findall(f" {text} ")) for joint in joints)


def _key(facts: Mapping[Atom, bool]) -> object:
    return frozenset(facts.items())
