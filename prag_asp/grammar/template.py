"""Sentence templates with slots for arguments, such as ``pick up {1} from {2:dat}``: filled, or matched with texts."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass, field
from functools import cached_property
from string import Formatter
from typing import Literal, NamedTuple

from prag_asp.errors import QueryError

VERBS = ("is",)
"""Words in braces that agree with the first argument of a sentence, and have a negated form."""


BRACKETED = re.compile(r"\[([^\[\]]*)\]")
"""Text that is used only in the sentence for an action that restores earlier facts."""

Recurrence = Literal["new", "restored", "redone", "repeated", "varied", "initial"]
"""How an action relates to the past; facts are new or of the initial state.

It makes facts that are new, it restores facts that held earlier, or it is an earlier action that restores them. An
action that changes nothing repeats an earlier action, or it has the aim of another one.
"""

SLOT = re.compile(r"\{([0-9]+)[^{}]*\}")
"""A slot in the text of a sentence, with the number of its argument."""


class Slot(NamedTuple):
    """The slot for an argument in a sentence, with its case; "" is the default case."""

    argument: int
    case: str = ""


@dataclass(frozen=True)
class Template:
    """A sentence of alternating texts and slots, which begins and ends with a text.

    If a word agrees with the first argument, `genders` are the genders of arguments for which this sentence is used.
    `phrasing` is its index, from 0, among the paraphrases. With `recurrences`, the sentence is only for such actions;
    `only` holds the class or the value that each argument must have, or "_". The particle of a verb in `phrasal` comes
    before its object unless this is a pronoun: "pick up the can", "pick it up".
    """

    texts: tuple[str, ...]
    slots: tuple[Slot, ...]
    genders: frozenset[str] = frozenset()
    phrasing: int = field(default=0, compare=False)
    recurrences: frozenset[Recurrence] = field(default=frozenset(), compare=False)
    only: tuple[str, ...] = field(default=(), compare=False)
    phrasal: tuple[str, ...] = field(default=(), compare=False)

    def fill(self, words: Sequence[str], pronouns: Set[int] = frozenset()) -> str:
        """Return the sentence with words in its slots, in order; `pronouns` are the indices of slots with pronouns."""
        early = self._early
        texts = early[1] if early and early[0] not in pronouns else self.texts
        parts = [texts[0]]
        for word, text in zip(words, texts[1:], strict=True):
            parts += (word, text)
        return "".join(parts)

    def find(self, text: str, fits: Callable[[str], bool] = bool) -> Iterator[tuple[str, ...]]:
        """Yield every assignment of fitting words to the slots with which this sentence equals the text."""
        if not self.slots:
            if text == self.texts[0]:
                yield ()
            return
        for texts in (self.texts, self._early[1]) if self._early else (self.texts,):
            first, last = texts[0], texts[-1]
            if text.startswith(first) and text.endswith(last) and len(text) > len(first) + len(last):
                yield from self._split(texts, text[len(first) : len(text) - len(last)], 1, fits)

    def _split(
        self, texts: Sequence[str], text: str, number: int, fits: Callable[[str], bool]
    ) -> Iterator[tuple[str, ...]]:
        """Yield the ways to split a text at the texts between slots, starting at a given slot."""
        if number == len(self.slots):
            if fits(text):
                yield (text,)
            return
        between = texts[number]
        at = text.find(between, 1)
        while at >= 0:
            if fits(text[:at]):
                for rest in self._split(texts, text[at + len(between) :], number + 1, fits):
                    yield (text[:at], *rest)
            at = text.find(between, at + 1)

    @cached_property
    def _early(self) -> tuple[int, tuple[str, ...]] | None:
        """The slot of the object of a phrasal verb, and the texts with the particle before it, or None."""
        for index in range(len(self.slots) if self.phrasal else 0):
            before, (particle, *_) = self.texts[index], (*self.texts[index + 1].split(), "")
            after = self.texts[index + 1][1 + len(particle) :]
            verb = before.rstrip().rpartition(" ")[2]
            last = index + 1 == len(self.slots)
            if f"{verb} {particle}" in self.phrasal and before.endswith(" ") and (after.startswith(" ") or last):
                return index, (*self.texts[:index], f"{before}{particle} ", after, *self.texts[index + 2 :])
        return None

    @cached_property
    def arguments(self) -> tuple[int, ...]:
        """The arguments of the slots, in order."""
        return tuple(slot.argument for slot in self.slots)


def parse_template(
    text: str,
    cases: Sequence[str],
    arity: int,
    verbs: Mapping[str, str] | None = None,
    genders: frozenset[str] = frozenset(),
) -> Template:
    """Parse a sentence; `verbs` holds the forms of verbs in braces for given `genders`.

    Raises:
        QueryError: the braces are wrong; the message gives the problem and the remedy.
    """
    unmatched = QueryError("has braces that do not match; write each as {0} or {0:case}")
    try:
        fields = list(Formatter().parse(text))
    except ValueError:
        raise unmatched from None
    texts, slots = [""], list[Slot]()
    for literal, name, case, conversion in fields:
        if conversion is not None or "{" in (case or ""):
            raise unmatched
        texts[-1] += literal
        if name is None:
            continue
        if verbs is not None and name in verbs:
            texts[-1] += verbs[name]
            continue
        if not name.isdecimal() or int(name) >= arity:
            places = ", ".join(f"{{{index}}}" for index in range(arity)) or "no braces"
            raise QueryError(f"has braces that name no argument; use {places}")
        if case and case not in cases:
            raise QueryError(f"has {{{name}:{case}}}, which is not a case; cases are {', '.join(cases)}")
        slots.append(Slot(int(name), case or ""))
        texts.append("")
    if any(not text_between for text_between in texts[1:-1]):
        raise QueryError("has two pairs of braces side by side; write a word or a blank between them")
    if not slots and not texts[0].strip():
        raise QueryError("is empty; write a sentence")
    return Template(tuple(texts), tuple(slots), genders)


@dataclass(frozen=True)
class RecurrenceWords:
    """How a language says that an action restores, repeats or varies what was done before.

    `repeated` is a pattern with ``{action}``, or a text instead of the one in brackets; `varied` is a pattern with
    ``{action}`` and ``{manner}``. The texts in `second` mean that the action itself was done before.
    """

    repeated: str = ""
    varied: str = ""
    second: frozenset[str] = frozenset()

    def forms(self, text: str, *, restores: bool = True) -> dict[str, frozenset[Recurrence]]:
        """Map the forms of a sentence with text in brackets, ``put {1}[ back] into {2}``, to the actions they are for.

        Unless it `restores`, the text "again" is only for actions that were done before. A sentence without brackets is
        for all actions.
        """
        whole, bare = BRACKETED.sub(r"\1", text), BRACKETED.sub("", text)
        if whole == text:
            return {text: frozenset()}
        found: dict[str, set[Recurrence]] = {}
        forms: tuple[tuple[Recurrence, str], ...] = (
            ("new", bare),
            ("restored", bare if not restores and self.says_again(text) else whole),
            ("redone", whole),
            ("repeated", self._repeated(text, bare)),
            ("varied", self._varied(text) or self._repeated(text, bare)),
        )
        for recurrence, form in forms:
            found.setdefault(form, set()).add(recurrence)
        return {form: frozenset(recurrences) for form, recurrences in found.items()}

    def says_again(self, text: str) -> bool:
        """Return whether the text in brackets means that the action itself was done before."""
        return {match[1].strip() for match in BRACKETED.finditer(text)} <= self.second

    def _repeated(self, text: str, bare: str) -> str:
        if "{action}" in self.repeated:
            return self.repeated.replace("{action}", bare)
        return BRACKETED.sub("", BRACKETED.sub(self.repeated.replace("\\", r"\\"), text, count=1))

    def _varied(self, text: str) -> str:
        """Return the form of an action that has the aim of another one, or "" if the sentence has no manner.

        The manner is a text of several words before the brackets, or at the end: "along the guide".
        """
        opening, closing = text.index("["), text.index("]") + 1
        before, after = text[:opening], BRACKETED.sub("", text[closing:])
        for head, manner, rest in (_after_slot(before, after), _after_slot(before + after, "")):
            if self.varied and len(manner.split()) > 1:
                return self.varied.replace("{action}", head + rest).replace("{manner}", manner.strip())
        return ""


def _after_slot(before: str, after: str) -> tuple[str, str, str]:
    """Return a text up to its last slot, what follows this slot, and another text."""
    end = max((match.end() for match in SLOT.finditer(before)), default=len(before))
    return before[:end], before[end:], after


def admits(only: Sequence[str], arguments: Sequence[str], memberships: Set[tuple[str, str]]) -> bool:
    """Return whether each argument is what `only` allows, given the pairs of entities and their classes."""
    return all(
        kind in {"_", argument} or (argument, kind) in memberships
        for argument, kind in zip(arguments, only, strict=True)
    )


def agrees(text: str) -> bool:
    """Return whether some word in a sentence agrees with the first argument."""
    return any(f"{{{verb}}}" in text for verb in VERBS)
