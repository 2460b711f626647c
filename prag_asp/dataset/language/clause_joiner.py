"""Join clear sentences into one text: actions in their order, and facts, which are merged if they share words."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from prag_asp.dataset.language.descriptions import View
from prag_asp.dataset.language.instruction_reader import InstructionReader
from prag_asp.dataset.language.sentence_writer import ClearSentence, PhraseRng
from prag_asp.grammar.phrasings import Phrasings

SEVERAL = 2
"""The number of clauses that one conjunction joins."""

PLACE = 1
"""The rank of a place among the predicates of a subject: "clean and on the table", "on the table and aimed at it"."""


class ClauseJoiner:
    """A joiner of the sentences of a language into texts that a reader parses back."""

    def __init__(self, reader: InstructionReader, phrasings: Phrasings) -> None:
        self._reader, self._words, self._phrasings = reader, reader.lexicon.words, phrasings

    def in_order(self, clauses: Sequence[ClearSentence], rng: PhraseRng) -> str:
        """Return the sentences for actions joined into one text.

        Within a sentence, joints occur in the order of their list, and do not repeat the first word of the sentence. No
        word occurs in three consecutive joints.
        """
        joints, latest, begun = self._phrasings.of(self._words.joints("sentences")), -1, set[str]()
        text, before, last = clauses[0].text, set[str](), set[str]()
        for clause in clauses[1:]:
            allowed = [place for place, each in enumerate(joints) if place > latest or begins_sentence(each)]
            fresh = [place for place in allowed if place != latest]
            varied = []
            for place in fresh:
                avoided = before & last | (set() if begins_sentence(joints[place]) else begun)
                varied += [place] if avoided.isdisjoint(words_of(joints[place])) else []
            latest = rng.pick(varied or fresh or allowed or range(len(joints)))
            before, last = last, set(words_of(joints[latest]))
            begun = last if begins_sentence(joints[latest]) else begun
            text += joints[latest] + clause.text
        return text

    def facts(self, view: View, facts: Sequence[ClearSentence], kind: str, topic: str | None = None) -> str:
        """Return the sentences for facts joined into one text, where "it" means the topic."""
        words = self._words
        merged, joint = self._merged(view, facts, topic), words.joints("facts")[0]
        between, last = words.many or (joint, joint)
        two = last
        if kind == "goal" and words.goal:
            between, last, two = words.goal
        if len(merged) <= SEVERAL:  # a comma separates clauses that have "and" themselves
            return (last if any(joint in text for text in merged) else two).join(merged)
        return f"{between.join(merged[:-1])}{last}{merged[-1]}"

    def entailed(self, facts: Sequence[str]) -> set[str]:
        """Return those of the sentences for facts that another sentence entails.

        For example, "on the left side of the table" entails "on the table".
        """
        words, within = self._words, str(self._words.table.get("within", ""))
        found = set[str]()
        for fact in facts if within else ():
            start = words.verb_phrase(fact)
            preposition, _, landmark = fact[start:].partition(" ")
            if start and landmark.split(" ")[0] in words.articles:
                wholes = [
                    other[start:]
                    for other in facts
                    if other.startswith(f"{fact[:start]}{preposition} ") and other.endswith(f"{within}{landmark}")
                ]
                found |= {fact for whole in wholes if not whole.startswith(words.adjoined)}
        return found

    def _merged(self, view: View, facts: Sequence[ClearSentence], topic: str | None) -> list[str]:
        """Return sentences for facts; those with the same subject, and verb if possible, are merged.

        "it is red and clean", "the arm holds it and is over the table". If two subjects have the same predicate, their
        sentences are merged, too: "both the drawer and the cupboard are open".
        """
        groups: dict[str, list[str]] = {}
        for fact in facts:
            groups.setdefault(fact.subject or fact.text, []).append(fact.text)
        merged, plural = list[str](), dict[str, list[str]]()
        for subject, texts in groups.items():
            begins = {text[: self._words.verb_phrase(text)] for text in texts}
            shared = begins.pop() if len(begins) == 1 else ""
            shared = shared if len(shared) > len(subject) else subject
            rest = [text[len(shared) :] for text in texts]
            if not begins and len(rest) > 1:
                rest.sort(key=self._order)
            text = self._conjunction(view, shared, rest, topic)
            merged.append(text)
            predicate = self._words.in_plural(text[len(subject) :]) if len(texts) == 1 and subject != text else ""
            if predicate:
                plural.setdefault(predicate, []).append(subject)
        return self._pairs(merged, plural)

    def _pairs(self, merged: list[str], plural: Mapping[str, Sequence[str]]) -> list[str]:
        """Merge the sentences of two subjects with the same predicate; `plural` maps plural predicates to subjects."""
        words = self._words
        for predicate, subjects in plural.items() if words.both else ():
            if len(subjects) == SEVERAL:
                first, second = subjects
                both = f"{words.both[0]}{first.rstrip()}{words.both[1]}{second}{predicate}"
                single = {f"{subject}{verb}" for subject in subjects for verb in words.in_singular(predicate)}
                places = [place for place, text in enumerate(merged) if text in single]
                merged[places[0]] = both
                del merged[places[1]]
        return merged

    def _conjunction(self, view: View, shared: str, predicates: Sequence[str], topic: str | None) -> str:
        """Return a sentence with several predicates, some without a conjunction: "on the table behind the can"."""
        words, joint = self._words, self._words.joints("facts")[0]
        if len(predicates) >= SEVERAL and self._order(predicates[0]) == PLACE:
            place, second, *rest = predicates
            if any(second.startswith(f"{each} ") for each in words.adjoined):
                text = f"{shared}{place} {second}"
                meanings = {
                    frozenset(parsed[:2] for parsed in found) for found in self._reader.facts(view, text, topic)
                }
                if len(meanings) == 1:
                    return joint.join([text, *rest])
        return shared + joint.join(predicates)

    def _order(self, predicate: str) -> int:
        """Return the rank of a predicate: a word such as "clean" precedes `PLACE`, and all others follow it."""
        words = self._words
        preposition, article, *_ = (*predicate.split(), "", "")
        is_place = preposition in words.table.get("implied", ()) and article in words.articles
        return PLACE - 1 if not article else PLACE if is_place else PLACE + 1


def begins_sentence(joint: str) -> bool:
    """Return whether a text between two sentences ends the first one."""
    return joint.lstrip().startswith(".")


def words_of(text: str) -> list[str]:
    """Return the words of a text in lower case."""
    return text.casefold().replace(",", " ").replace(".", " ").split()
