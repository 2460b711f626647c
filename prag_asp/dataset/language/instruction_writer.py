"""Write instructions for tasks on three levels of detail, a sentence for each subgoal, and captions.

A `SentenceWriter` writes the sentences; this module chooses, orders and joins them.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence, Set
from copy import copy
from dataclasses import dataclass
from typing import TYPE_CHECKING

from prag_asp.atom import Atom, atom_of
from prag_asp.dataset.language.clause_joiner import ClauseJoiner, words_of
from prag_asp.dataset.language.descriptions import InstructionContext, View
from prag_asp.dataset.language.instruction_reader import InstructionReader, Reading, capital, context_of, unnumbered
from prag_asp.dataset.language.lexicon import Lexicon
from prag_asp.dataset.language.plain import sentence
from prag_asp.dataset.language.recurrences import REPETITIONS, recurrences
from prag_asp.dataset.language.sentence_writer import ClearSentence, PhraseRng, SentenceWriter
from prag_asp.errors import QueryError
from prag_asp.grammar.phrasings import Phrasings
from prag_asp.grammar.template import Recurrence
from prag_asp.task import FrozenDict, State, Task

if TYPE_CHECKING:
    from prag_asp.domain.load import Domain

START_FACTS, CAPTION_FACTS = 4, 2
"""The maximum numbers of facts in the caption of the initial state and in the captions of other states."""

STEM = 6
"""The number of initial letters in which words with the same stem agree."""

SEVERAL = 2
"""The number of objects from which on "it" is ambiguous, and the number of clauses that one conjunction joins."""

SHORT = 3
"""The maximum number of letters of words that do not count as parts of other words."""

COLOR = re.compile(r"#[0-9a-fA-F]{6}")
CACHED = 1 << 16
"""The maximum number of cached aims of actions; the tasks of a space share most of them."""


@dataclass(frozen=True)
class Instructions:
    """The instructions of a task.

    `vague` states the goal, `default` the actions, and `exact` also the purpose of each action; all refer to objects as
    they are in the initial state. `subgoals` holds a sentence for each action, written for the state before that
    action. `named` holds the entities that are referred to by name, because nothing visible distinguishes them.
    """

    vague: str
    default: str
    exact: str
    subgoals: tuple[str, ...]
    named: tuple[str, ...] = ()


class InstructionWriter:
    """A writer and parser of instructions for a domain in one language."""

    def __init__(
        self, domain: Domain, language: str = "en", colors: Mapping[str, str] | None = None, phrasings: str = ""
    ) -> None:
        """Read a domain's tables for a language; `colors` override those of the scene.

        Only the chosen `phrasings` are written, but all phrasings are parsed.

        Raises:
            QueryError: the domain does not have the language or such phrasings.
        """
        self.lexicon = Lexicon(domain, language, colors)
        self.reader = InstructionReader(self.lexicon)
        self.phrasings = Phrasings.parse(phrasings)
        self.phrasings.require(self.lexicon.grammar.actions, self.lexicon.words.frames, language)
        self._sentences = SentenceWriter(self.reader, self.phrasings)
        self._joiner = ClauseJoiner(self.reader, self.phrasings)
        self._aims: dict[State, State] = {}

    def recoloured(self, colors: Mapping[str, str]) -> InstructionWriter:
        """Return a writer for pictures in which some entities have the given colours."""
        if not colors:
            return self
        other = copy(self)
        other.lexicon = self.lexicon.recoloured(colors)
        other.reader = InstructionReader(other.lexicon)
        other._sentences, other._aims = SentenceWriter(other.reader, self.phrasings), {}
        other._joiner = ClauseJoiner(other.reader, self.phrasings)
        return other

    def instructions(self, task: Task, seed: int = 0) -> Instructions:
        """Return the instructions for a task; the seed determines which phrasings are used.

        Raises:
            QueryError: the task is not one of this domain, or an action has no unambiguous sentence.
        """
        plan, initial = str(task), context_of(task)
        vague, default, exact, each = (
            PhraseRng(f"{seed} {level} {plan}") for level in ("vague", "default", "exact", "each")
        )
        view = self.lexicon.view(initial)
        named: dict[str, None] = {}
        written, frames = self.lexicon.words.contracted, self.lexicon.words.frames
        subgoals = []
        again = recurrences(task, self.lexicon.grammar)
        for number, action in enumerate(task.actions):
            here = self.lexicon.view(initial.at(task.states[number - 1]) if number else initial)
            step = self._sentences.write(here, action, None, each, recurrence=again[number]).text
            subgoals.append(written(capital(str(frames["subgoal"]).format(action=step))))
            self._note(here, [action], named)
        goal, aims = self.goal(task), []
        for subgoal in task.subgoals:
            frozen = subgoal if isinstance(subgoal, FrozenDict) else FrozenDict(subgoal)
            if frozen not in self._aims:
                if len(self._aims) > CACHED:
                    self._aims.clear()
                self._aims[frozen] = notable_facts(frozen, self.lexicon)
            aims.append(self._aims[frozen])
        self._note(view, [*task.actions, *goal, *(fluent for aim in aims for fluent in aim)], named)
        last = task.states[-1] if task.states else task.initial
        changed = view.outdated({each for fluent in goal for each in fluent.arguments}, last)
        facts = self._sentences.facts(view, goal, None, vague, changed)
        clauses = list[ClearSentence]()
        states = (task.initial, *task.states)
        outdated = [view.outdated(action.arguments, state) for action, state in zip(task.actions, states, strict=False)]
        for action, recurrence, old in zip(task.actions, again, outdated, strict=True):
            topic = self._topic(task, clauses)
            clause = self._sentences.write(view, action, topic, default, recurrence=recurrence, outdated=old)
            clauses.append(clause)
        return Instructions(
            written(self._framed(view, "vague", "goal", facts, vague)),
            written(self._framed(view, "default", "sentences", clauses, default)),
            written(self._exact(view, task.actions, aims, again, outdated, exact)),
            tuple(subgoals),
            tuple(sorted(named)),
        )

    def captions(self, task: Task) -> list[tuple[str, str]]:
        """Return a heading and a caption for the picture of each state, including the initial state.

        The heading is the action that leads to the state, and the caption states its effects; the caption of the
        initial state has known facts about the objects in the actions. Of several phrasings, the first one is used.
        """
        handled = {argument for action in task.actions for argument in action.arguments} - self.lexicon.appearance.seen
        known = {fluent: True for fluent, value in task.initial.items() if value}
        view = self.lexicon.view(context_of(task))
        shown = []
        for fluent in notable_facts(known, self.lexicon):
            things = [each for each in fluent.arguments if each in self.lexicon.appearance.nouns]
            relations = [(thing, view.describe(thing).relation) for thing in things]
            described = [relation.about(thing) for thing, relation in relations if relation is not None]
            if not handled.isdisjoint(fluent.arguments) and fluent not in described:
                shown.append(fluent)
        start = self._sentences.facts(view, dict.fromkeys(shown[:START_FACTS], True), recurrence="initial")
        captions = [(str(self.lexicon.words.frames["start"]), start)]
        for number, (action, subgoal) in enumerate(zip(task.actions, task.subgoals, strict=True), 1):
            before = self.lexicon.view(context_of(task, number - 1))
            try:
                heading, topic, _ = self._sentences.write(before, action, None, None)
            except QueryError:  # all sentences are ambiguous: the plain instruction names the objects
                heading, topic = sentence(action, self.lexicon.domain.settings.language), None
            made = dict(list(notable_facts(subgoal, self.lexicon).items())[:CAPTION_FACTS])
            moved = topic is not None and before.describe(topic).relation is not None
            captions.append((f"{number}. {heading}", self._sentences.facts(before, made, topic if moved else None)))
        written = self.lexicon.words.contracted
        return [(written(heading), written(", ".join(fact.text for fact in facts))) for heading, facts in captions]

    def read(self, start: InstructionContext | Task, text: str) -> Reading:
        """Return the meaning of an instruction at the start of a task, or in another context.

        Raises:
            QueryError: the text is not an instruction, or could mean several plans.
        """
        return self.reader.read(context_of(start) if isinstance(start, Task) else start, text)

    def goal(self, task: Task) -> Mapping[Atom, bool]:
        """Return the goal that the vague instruction states: the notable facts that the task changes in the end.

        Facts that others imply are left out: "the cup is in a corner of the tray" and therefore in the tray. If only
        silent facts change, these are the goal. The goal of a task that changes nothing in the end is the aim of its
        last action, which holds in the initial state if the task is trivial.
        """
        made: dict[Atom, bool] = {}
        for subgoal in task.subgoals:
            made.update(subgoal)
        last = task.states[-1] if task.states else task.initial
        changed = {
            fluent: value for fluent, value in made.items() if last.get(fluent) == value != task.initial.get(fluent)
        }
        aim = task.subgoals[-1] if task.subgoals else {}
        if not changed and not task.trivial:
            aim = {fluent: value for fluent, value in aim.items() if task.initial.get(fluent) != value}
        facts = (
            notable_facts(changed, self.lexicon) or dict(sorted(changed.items())) or notable_facts(aim, self.lexicon)
        )
        return self._without_entailed(task, facts)

    def _without_entailed(self, task: Task, facts: Mapping[Atom, bool]) -> Mapping[Atom, bool]:
        """Return facts without those that the sentence for another fact entails."""
        if len({fluent.arguments[:1] for fluent in facts}) == len(facts):
            return facts
        view = self.lexicon.view(context_of(task))
        texts = {
            fact.text: fluent
            for fluent, value in facts.items()
            for fact in self._sentences.facts(view, {fluent: value})
        }
        entailed = {texts[text] for text in self._joiner.entailed(list(texts))}
        return {fluent: value for fluent, value in facts.items() if fluent not in entailed}

    def _topic(self, task: Task, clauses: Sequence[ClearSentence]) -> str | None:
        """Return what "it" means in the next sentence: the topic of the previous one, or None if it is not clear.

        After two like actions, "it" could be the topic of either if the next action were possible with both: "open the
        cupboard, then open the drawer".
        """
        topic, number, actions = clauses[-1].topic if clauses else None, len(clauses), task.actions
        other = clauses[-SEVERAL].topic if number >= SEVERAL else None
        if topic is None or other in {None, topic} or actions[number - 1].name != actions[number - SEVERAL].name:
            return topic
        action = actions[number]
        alike = Atom(action.name, tuple(str(other) if each == topic else each for each in action.arguments))
        facts, state = self.lexicon.domain.facts, task.states[number - 1]
        term = facts.actions_by_text.get(str(alike))
        if alike == action or term is None:
            return topic
        known = ((state.get(atom_of(fluent)), value == "true") for fluent, value in facts.preconditions.get(term, ()))
        return topic if any(now is not None and now != needed for now, needed in known) else None

    def _note(self, view: View, atoms: Sequence[Atom], named: dict[str, None]) -> None:
        """Record the entities that are referred to by name."""
        certain = view.context.certain
        for atom in atoms:
            if not certain.issuperset(atom.arguments):
                for argument in atom.arguments:
                    if argument in self.lexicon.appearance.nouns and view.describe(argument).name:
                        named[argument] = None

    def _framed(self, view: View, level: str, kind: str, clauses: Sequence[ClearSentence], rng: PhraseRng) -> str:
        """Return sentences joined in the frame of a level, or "" if there are none."""
        if not clauses:
            return ""
        frame = rng.pick(self.phrasings.of(self.lexicon.words.frames[level]))
        text = self._joiner.in_order(clauses, rng) if kind == "sentences" else self._joiner.facts(view, clauses, kind)
        return capital(frame.format(facts=text, actions=text, Actions=capital(text)))

    def _exact(
        self,
        view: View,
        actions: Sequence[Atom],
        aims: Sequence[State],
        again: Sequence[Recurrence],
        outdated: Sequence[Set[str]],
        rng: PhraseRng,
    ) -> str:
        """Return the exact instruction: the actions, with the aim of each one unless its sentence states the aim."""
        words, steps = self.lexicon.words, []
        alone, aimed = words.frames["exact"]
        steps_of = zip(actions, aims, again, outdated, strict=True)
        for number, (action, aim, recurrence, old) in enumerate(steps_of, 1):
            clause = self._sentences.write(view, action, None, rng, recurrence=recurrence, outdated=old)
            movable = {*action.arguments} & self.lexicon.appearance.nouns.keys() - self.lexicon.appearance.seen
            topic = clause.topic if len(movable) < SEVERAL else None  # "it" could be any of several
            facts = self._sentences.facts(view, aim, topic, rng, old) if recurrence not in REPETITIONS else []
            said = {*words_of(clause.text), *self._words_for(action)}
            said |= words.implications(said)
            entailed = self._joiner.entailed([fact.text for fact in facts])
            facts = [
                fact
                for fact in facts
                if fact.text not in entailed and not is_stated(fact.text, said, words.function_words)
            ]
            frame = aimed if facts else alone
            frame = unnumbered(frame) if len(actions) == 1 else frame
            step = frame.format(
                number=words.number(number),
                action=clause.text,
                Action=capital(clause.text),
                facts=self._joiner.facts(view, facts, "facts", topic) if facts else "",
            )
            steps.append(capital(step))
        return str(words.table["joints"]["steps"]).join(steps)

    def _words_for(self, action: Atom) -> set[str]:
        """Return the words of all sentences for an action, apart from its arguments."""
        templates = self.lexicon.grammar.actions.get((action.name, len(action.arguments)), ())
        return {word for template in templates for text in template.texts for word in words_of(text)}


def instruction_writer_of(
    domain: Domain, language: str = "en", colors: Mapping[str, str] | None = None, phrasings: str = ""
) -> InstructionWriter:
    """Return the instruction writer of a domain in a language.

    `colors` of entities (``#rrggbb``) override those of the scene. With `phrasings`, only some of the sentences are
    written: ``1 of 2`` selects every second one from the first on, and shares no sentence with ``2 of 2``.

    Raises:
        QueryError: the domain does not have the language or such phrasings, or a colour is malformed.
        SceneError: the scene is invalid.
    """
    for entity, color in (colors or {}).items():
        if entity not in domain.facts.entity_names or not COLOR.fullmatch(color):
            raise QueryError(
                f"{entity} = {color!r} is not a colour of an entity; write one of {domain.name} and #rrggbb"
            )
    return InstructionWriter(domain, language, colors, phrasings)


def is_stated(fact: str, said: Set[str], function_words: Set[str]) -> bool:
    """Return whether every word of a fact, except function words, occurs in `said`.

    An example is "it is open" after "open the drawer".

    Two words count as the same if one begins with or contains the other, or if both have the same stem: "in" and
    "into", "öffne" and "geöffnet", "entferne" and "entfernt".
    """

    def same(one: str, other: str) -> bool:
        short, long = sorted((one, other), key=len)
        begins = len(short) > 1 and long.startswith(short[:STEM])
        return one == other or begins or (len(short) > SHORT and short in long)

    return all(word in function_words or any(same(word, each) for each in said) for word in words_of(fact))


def notable_facts(facts: State, lexicon: Lexicon) -> Mapping[Atom, bool]:
    """Return the notable facts, which are not silent: the true ones or, if there are none, the false ones.

    A fact is left out if another one implies it by a state constraint of the domain.
    """
    forms = lexicon.grammar.facts
    known = {fluent: forms.get((fluent.name, len(fluent.arguments))) for fluent in facts}
    loud = {fluent: value for fluent, value in facts.items() if (form := known[fluent]) is not None and not form.silent}
    true = {fluent: value for fluent, value in loud.items() if value}
    for fluent in sorted(true) if lexicon.implied else ():
        for other in lexicon.implied.get(fluent, frozenset()) - {fluent} if fluent in true else ():
            true.pop(other, None)
    return dict(sorted((true or loud).items()))
