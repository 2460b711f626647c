"""Write instructions of tasks at three levels, a sentence for each subgoal, and captions.

Each sentence is parsed back before it is used: an ambiguous one is replaced by another wording.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from copy import copy
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from prag_asp.atom import Atom
from prag_asp.dataset.language.descriptions import InstructionContext, View
from prag_asp.dataset.language.instruction_reader import InstructionReader, Reading, capital, context_of
from prag_asp.dataset.language.lexicon import Lexicon
from prag_asp.dataset.language.phrase_rng import PhraseRng
from prag_asp.dataset.language.plain import sentence
from prag_asp.dataset.language.sentences import Sentence
from prag_asp.errors import QueryError
from prag_asp.grammar.phrasings import Phrasings
from prag_asp.task import FrozenDict, State, Task

if TYPE_CHECKING:
    from prag_asp.domain.load import Domain

START_FACTS, CAPTION_FACTS = 4, 2
"""The most facts in the caption of the initial state, and in those of the others."""

COLOR = re.compile(r"#[0-9a-fA-F]{6}")
VARIANTS = (0, 1)
"""Wordings of a relation, the shorter one first."""

CACHED = 1 << 16
"""Sentences that are cached: tasks of one space share most of them."""


@dataclass(frozen=True)
class Instructions:
    """The instructions of a task.

    `vague` has the goal, `default` the actions, `exact` also the purpose of each action; all refer to the initial
    state. `subgoals` has a sentence for each action, which refers to the state before it. `named` are the entities
    that are referred to by name, because nothing visible distinguishes them.
    """

    vague: str
    default: str
    exact: str
    subgoals: tuple[str, ...]
    named: tuple[str, ...] = ()


ClearSentence = tuple[str, str | None]
"""An unambiguous sentence and its topic."""


@dataclass(frozen=True)
class _Paraphrases:
    """The sentences for an action or a fluent: those `given`, and `spare` ones for where all of them are ambiguous.

    `things` are the entities in it, `known` is set where the domain has it at all, and `clear` caches the unambiguous
    sentence for each way in which the things are described.
    """

    given: tuple[Sentence, ...]
    spare: tuple[Sentence, ...]
    things: tuple[str, ...]
    known: bool
    clear: dict[object, ClearSentence | None] = field(default_factory=dict)

    def ways(self, first: int) -> Iterator[tuple[Sentence, int]]:
        """Yield the sentences with each wording of relations, beginning with the sentence of number `first`."""
        for variant in VARIANTS:
            for clause in (*self.given[first:], *self.given[:first], *self.spare):
                yield clause, variant


class InstructionWriter:
    """Writes and parses instructions of a domain in one language."""

    def __init__(
        self, domain: Domain, language: str = "en", colors: Mapping[str, str] | None = None, phrasings: str = ""
    ) -> None:
        """Read the language's tables of a domain; `colors` override those of the scene.

        Only some `phrasings` are written; all are parsed.

        Raises:
            QueryError: the domain does not have the language or such phrasings.
        """
        self.lexicon = Lexicon(domain, language, colors)
        self.reader = InstructionReader(self.lexicon)
        self.phrasings = Phrasings.parse(phrasings)
        self.phrasings.require(self.lexicon.grammar.actions, self.lexicon.words.frames, language)
        self._reset_cache()

    def _reset_cache(self) -> None:
        """Create empty caches; `_cached` counts the sentences in them."""
        self._sentences: dict[tuple[Atom, bool, bool], _Paraphrases] = {}
        self._cached = 0
        self._aims: dict[State, State] = {}

    def recoloured(self, colors: Mapping[str, str]) -> InstructionWriter:
        """Return a writer for pictures with other colours of some entities."""
        if not colors:
            return self
        other = copy(self)
        other.lexicon = self.lexicon.recoloured(colors)
        other.reader = InstructionReader(other.lexicon)
        other._reset_cache()
        return other

    def instructions(self, task: Task, seed: int = 0) -> Instructions:
        """Return the instructions of a task; the seed chooses among phrasings, the same ones for the same seed.

        Raises:
            QueryError: the task is not one of this domain, or an action has no sentence that means nothing else.
        """
        plan, initial = str(task), context_of(task)
        vague, default, exact, each = (
            PhraseRng(f"{seed} {level} {plan}") for level in ("vague", "default", "exact", "each")
        )
        view = self.lexicon.view(initial)
        named: dict[str, None] = {}
        written = self.lexicon.words.contracted
        subgoals = []
        for number, action in enumerate(task.actions):
            here = self.lexicon.view(initial.at(task.states[number - 1]) if number else initial)
            clause, _ = self._sentence(here, action, True, None, each)
            subgoals.append(written(capital(self._frame("subgoal").format(action=clause))))
            self._note(here, [action], named)
        goal = self.goal(task)
        aims = list(map(self._aim, task.subgoals))
        self._note(view, [*task.actions, *goal, *(fluent for aim in aims for fluent in aim)], named)
        return Instructions(
            written(self._vague(view, goal, vague)),
            written(self._default(view, task.actions, default)),
            written(self._exact(view, task.actions, aims, exact)),
            tuple(subgoals),
            tuple(sorted(named)),
        )

    def captions(self, task: Task) -> list[tuple[str, str]]:
        """Return a heading and a caption for a picture of each state, the initial one included.

        The heading is the action that leads to the state, the caption its effects; that of the initial state has the
        known facts about the things that the actions name. The first of several sentences is used.
        """
        handled = {argument for action in task.actions for argument in action.arguments} - self.lexicon.appearance.seen
        known = {fluent: True for fluent, value in task.initial.items() if value}
        view = self.lexicon.view(context_of(task))
        shown = [
            fluent
            for fluent in notable_facts(known, self.lexicon)
            if not handled.isdisjoint(fluent.arguments) and fluent not in self._said_by_names(view, fluent)
        ]
        captions = [(self._frame("start"), self._caption(view, dict.fromkeys(shown[:START_FACTS], True), None))]
        for number, (action, subgoal) in enumerate(zip(task.actions, task.subgoals, strict=True), 1):
            before = self.lexicon.view(context_of(task, number - 1))
            heading, topic = self._heading(before, action)
            made = dict(list(notable_facts(subgoal, self.lexicon).items())[:CAPTION_FACTS])
            moved = topic is not None and before.describe(topic).relation is not None
            captions.append((f"{number}. {heading}", self._caption(before, made, topic if moved else None)))
        written = self.lexicon.words.contracted
        return [(written(heading), written(caption)) for heading, caption in captions]

    def _heading(self, view: View, action: Atom) -> tuple[str, str | None]:
        """Return the sentence of an action; where all are ambiguous, the plain one with the names of things."""
        try:
            return self._sentence(view, action, True, None, None)
        except QueryError:
            return sentence(action, self.lexicon.domain.settings.language), None

    def _said_by_names(self, view: View, fluent: Atom) -> Iterator[Atom]:
        """Yield the relations that are already in the descriptions of a fluent's things."""
        for thing in fluent.arguments:
            relation = view.describe(thing).relation if thing in self.lexicon.appearance.nouns else None
            if relation is not None:
                yield relation.about(thing)

    def _caption(self, view: View, facts: State, topic: str | None) -> str:
        texts = [text for fluent, value in facts.items() for text in self._fact_texts(view, fluent, value, topic, None)]
        return ", ".join(texts)

    def read(self, start: InstructionContext | Task, text: str) -> Reading:
        """Return the meaning of an instruction at the start of a task, or in another context.

        Raises:
            QueryError: it is no instruction, or it could mean several plans.
        """
        return self.reader.read(context_of(start) if isinstance(start, Task) else start, text)

    def goal(self, task: Task) -> Mapping[Atom, bool]:
        """Return the goal in the vague instruction of a task: the notable facts that it changes lastingly.

        For a task that changes nothing lastingly, it is the aim of the last action.
        """
        made: dict[Atom, bool] = {}
        for subgoal in task.subgoals:
            made.update(subgoal)
        last = task.states[-1] if task.states else task.initial
        changed = {
            fluent: value for fluent, value in made.items() if last.get(fluent) == value != task.initial.get(fluent)
        }
        notable = notable_facts(changed, self.lexicon)
        return notable or notable_facts(task.subgoals[-1] if task.subgoals else {}, self.lexicon)

    def _aim(self, subgoal: State) -> State:
        """Return the notable effects of an action, cached: tasks of one space share them."""
        frozen = subgoal if isinstance(subgoal, FrozenDict) else FrozenDict(subgoal)
        if frozen not in self._aims:
            if len(self._aims) > CACHED:
                self._aims.clear()
            self._aims[frozen] = notable_facts(frozen, self.lexicon)
        return self._aims[frozen]

    def _note(self, view: View, atoms: Sequence[Atom], named: dict[str, None]) -> None:
        """Record the entities that are referred to by name."""
        certain = view.context.certain
        for atom in atoms:
            if not certain.issuperset(atom.arguments):
                for argument in atom.arguments:
                    if argument in self.lexicon.appearance.nouns and view.describe(argument).name:
                        named[argument] = None

    def _frame(self, level: str) -> str:
        return str(self.lexicon.words.frames[level])

    def _vague(self, view: View, goal: Mapping[Atom, bool], rng: PhraseRng) -> str:
        """Return the vague instruction: the goal."""
        clauses = [
            clause for fluent, value in goal.items() for clause in self._fact_texts(view, fluent, value, None, rng)
        ]
        if not clauses:
            return ""
        frame = rng.pick(self.phrasings.of(self.lexicon.words.frames["vague"]))
        return capital(frame.format(facts=self._joined(clauses, "facts", rng)))

    def _default(self, view: View, actions: Sequence[Atom], rng: PhraseRng) -> str:
        """Return the default instruction: the actions, with "it" for the topic of the sentence before."""
        clauses, topic = [], None
        for action in actions:
            clause, topic = self._sentence(view, action, True, topic, rng)
            clauses.append(clause)
        if not clauses:
            return ""
        frame = rng.pick(self.phrasings.of(self.lexicon.words.frames["default"]))
        return capital(frame.format(actions=self._joined(clauses, "sentences", rng)))

    def _exact(self, view: View, actions: Sequence[Atom], aims: Sequence[State], rng: PhraseRng) -> str:
        """Return the exact instruction: the actions and the aim of each."""
        words, steps = self.lexicon.words, []
        alone, aimed = words.frames["exact"]
        for number, (action, aim) in enumerate(zip(actions, aims, strict=True), 1):
            clause, topic = self._sentence(view, action, True, None, rng)
            facts = [
                text for fluent, value in aim.items() for text in self._fact_texts(view, fluent, value, topic, rng)
            ]
            frame = aimed if facts else alone
            step = frame.format(
                number=words.number(number), action=clause, facts=self._joined(facts, "facts", rng) if facts else ""
            )
            steps.append(capital(step))
        return str(words.table["joints"]["steps"]).join(steps)

    def _joined(self, clauses: Sequence[str], kind: str, rng: PhraseRng) -> str:
        """Return sentences joined into one text."""
        text, joints, joint = clauses[0], self.phrasings.of(self.lexicon.words.joints(kind)), ""
        for clause in clauses[1:]:
            joint = rng.pick([each for each in joints if each != joint] or joints)
            text += joint + clause
        return text

    def _fact_texts(self, view: View, fluent: Atom, value: bool, topic: str | None, rng: PhraseRng | None) -> list[str]:
        """Return the sentence of a fact in a list, which is empty where no sentence is unambiguous."""
        try:
            return [self._sentence(view, fluent, value, topic, rng, of_actions=False)[0]]
        except QueryError:
            return []

    def _sentence(
        self, view: View, atom: Atom, value: bool, topic: str | None, rng: PhraseRng | None, *, of_actions: bool = True
    ) -> ClearSentence:
        """Return an unambiguous sentence of an action, or of a fluent and its value, and its topic.

        Raises:
            QueryError: there is none.
        """
        sentences = self._paraphrases_of(atom, value, of_actions)
        first = rng.number(len(sentences.given)) if sentences.given and rng else 0
        key = (view.context, topic, first, view.related(sentences.things))
        try:
            found = sentences.clear[key]
        except KeyError:
            found, of_state = self._search(view, sentences.ways(first), (atom, value, of_actions), topic)
            if not of_state:
                self._keep(sentences, key, found)
        if found is not None:
            return found
        where = "actions" if of_actions else "facts"
        if not sentences.known:
            kind = "action" if of_actions else "fluent"
            raise QueryError(f"{atom} is no {kind} of {self.lexicon.domain.name}; give tasks of that domain")
        raise QueryError(
            f"no sentence for {atom} that means nothing else; write one that names all that it speaks of "
            f"under [language.{self.lexicon.language}.{where}]"
        )

    def _keep(self, sentences: _Paraphrases, key: object, found: ClearSentence | None) -> None:
        """Cache an unambiguous sentence; clear the caches where there are too many."""
        if self._cached > CACHED:
            for each in self._sentences.values():
                each.clear.clear()
            self._cached = 0
        sentences.clear[key] = found
        self._cached += 1

    def _search(
        self, view: View, ways: Iterator[tuple[Sentence, int]], what: tuple[Atom, bool, bool], topic: str | None
    ) -> tuple[ClearSentence | None, bool]:
        """Return the first unambiguous sentence of some, and whether that depends on the state.

        It does not where it depends on the descriptions of the things alone.
        """
        (atom, value, of_actions), of_state = what, False
        for clause, variant in ways:
            text = self._written(view, clause, atom, topic, variant)
            meanings, unsure = self.reader.parse_sentence(view, text, topic, of_actions=of_actions)
            of_state |= unsure
            if len(meanings) == 1:
                (parsed,) = meanings
                if (parsed.atom, parsed.value) == (atom, value):
                    return (text, parsed.topic), of_state
        return None, of_state

    def _paraphrases_of(self, atom: Atom, value: bool, of_actions: bool) -> _Paraphrases:
        """Return the sentences of an action, or of a fluent and its value."""
        key = (atom, value, of_actions)
        found = self._sentences.get(key)
        if found is None:
            found = self._sentences[key] = self._find_paraphrases(atom, value, of_actions)
        return found

    def _find_paraphrases(self, atom: Atom, value: bool, of_actions: bool) -> _Paraphrases:
        """Collect the sentences; where only some phrasings are written, an action has no other ones."""
        clauses = self.lexicon.sentences.actions if of_actions else self.lexicon.sentences.facts
        known = [each for each in clauses.get((atom.name, len(atom.arguments)), ()) if each.value == value]
        gender = self._gender
        usable = [each for each in known if not each.template.genders or gender(each, atom) in each.template.genders]
        given = [each for each in usable if not each.spare and each.identifies(atom, self.lexicon.appearance.robots)]
        if not of_actions:  # with one robot it needs no mention
            fewest = min((len(each.template.slots) for each in given), default=0)
            given = [each for each in given if len(each.template.slots) == fewest]
        chosen = [each for each in given if self.phrasings.has(each.template.phrasing)]
        if chosen or of_actions:
            given = chosen
        spare = [] if of_actions and self.phrasings.all > 1 else [each for each in usable if each.spare]
        things = tuple(each for each in atom.arguments if each in self.lexicon.appearance.nouns)
        return _Paraphrases(tuple(given), tuple(spare), things, any(atom in clause.atoms for clause in known))

    def _gender(self, clause: Sentence, atom: Atom) -> str:
        """Return the gender of the first thing in a sentence."""
        return (
            self.lexicon.phrases.gender(atom.arguments[clause.template.arguments[0]]) if clause.template.slots else ""
        )

    def _written(self, view: View, clause: Sentence, atom: Atom, topic: str | None, variant: int) -> str:
        """Return the text of a sentence with phrases for its things."""
        phrases, words = self.lexicon.phrases, []
        for slot in clause.template.slots:
            value = atom.arguments[slot.argument]
            if value == topic:
                words.append(phrases.pronoun(value, slot.case))
            else:
                words.append(phrases.write(view, value, slot.case, variant))
        return clause.template.fill(words)


def instruction_writer_of(
    domain: Domain, language: str = "en", colors: Mapping[str, str] | None = None, phrasings: str = ""
) -> InstructionWriter:
    """Return the instruction writer of a domain in a language.

    `colors` of entities (``#rrggbb``) override those of the scene. With `phrasings`, such as ``1 of 2``, only some of
    the sentences are written: every second one from the first on. The sentences of ``1 of 2`` and ``2 of 2`` are
    disjoint.

    Raises:
        QueryError: the domain does not have the language or such phrasings, or a colour is malformed.
        SceneError: something is wrong with the scene.
    """
    for entity, color in (colors or {}).items():
        if entity not in domain.facts.entity_names or not COLOR.fullmatch(color):
            raise QueryError(f"{entity} = {color!r} is no colour of an entity; write one of {domain.name} and #rrggbb")
    return InstructionWriter(domain, language, colors, phrasings)


def notable_facts(facts: State, lexicon: Lexicon) -> Mapping[Atom, bool]:
    """Return the notable facts: the true ones that are not silent, or the false ones where there are no others."""
    forms = lexicon.grammar.facts
    known = {fluent: forms.get((fluent.name, len(fluent.arguments))) for fluent in facts}
    loud = {fluent: value for fluent, value in facts.items() if (form := known[fluent]) is not None and not form.silent}
    true = {fluent: value for fluent, value in loud.items() if value}
    return dict(sorted((true or loud).items()))
