"""Tell tasks in words: an instruction at three levels, and a sentence for each subgoal.

Each sentence is read back before it is given: one that could mean anything else is said in another way.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from copy import copy
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from prag_asp.atom import Atom
from prag_asp.dataset.language.descriptions import Start, View
from prag_asp.dataset.language.instruction_reader import Reader, Reading, capital, start_of
from prag_asp.dataset.language.lexicon import Tongue
from prag_asp.dataset.language.phrase_rng import Dice
from prag_asp.dataset.language.plain import sentence
from prag_asp.dataset.language.sentences import Clause
from prag_asp.errors import QueryError
from prag_asp.grammar.phrasings import Phrasings
from prag_asp.task import FrozenDict, State, Task

if TYPE_CHECKING:
    from prag_asp.domain.load import Domain

START_FACTS, CAPTION_FACTS = 4, 2
"""How many facts are told under a picture of the first state, and under the others."""

COLOR = re.compile(r"#[0-9a-fA-F]{6}")
VARIANTS = (0, 1)
"""Ways to say a relation, the shorter one first."""

KEPT = 1 << 16
"""Sentences that are kept: tasks of one space share most of them."""


@dataclass(frozen=True)
class Instructions:
    """What somebody can be told who is to do a task.

    `vague` says what is to be so at the end, `default` what is to be done, `exact` also what each action is for; all
    are said of the first state. `subgoals` has a sentence for each action, said of the state before it. `named` are the
    entities that had to be called by their names, because nothing that can be seen tells them from others.
    """

    vague: str
    default: str
    exact: str
    subgoals: tuple[str, ...]
    named: tuple[str, ...] = ()


Clear = tuple[str, str | None]
"""A sentence that means one thing alone, and what it is about."""


@dataclass(frozen=True)
class _Sentences:
    """The sentences that tell something: those `given`, and others for where none of them means it alone.

    `things` are what it speaks of, `known` tells whether the domain has it at all, and `clear` keeps which of them does
    where things are described in a way.
    """

    given: tuple[Clause, ...]
    spare: tuple[Clause, ...]
    things: tuple[str, ...]
    known: bool
    clear: dict[object, Clear | None] = field(default_factory=dict)

    def ways(self, first: int) -> Iterator[tuple[Clause, int]]:
        """Yield them and the ways to say relations in them, from the sentence of a number on."""
        for variant in VARIANTS:
            for clause in (*self.given[first:], *self.given[:first], *self.spare):
                yield clause, variant


class Teller:
    """Tells tasks of a domain in one language, and reads what it is told."""

    def __init__(
        self, domain: Domain, language: str = "en", colors: Mapping[str, str] | None = None, phrasings: str = ""
    ) -> None:
        """Read the language's part of a domain; pictures show some entities in other `colors` than the scene's.

        Only some `phrasings` are said (all are read).

        Raises:
            QueryError: the domain does not speak the language, or has no such phrasings.
        """
        self.tongue = Tongue(domain, language, colors)
        self.reader = Reader(self.tongue)
        self.phrasings = Phrasings.parse(phrasings)
        self.phrasings.require(self.tongue.grammar.actions, self.tongue.words.frames, language)
        self._forget()

    def _forget(self) -> None:
        """Begin to keep what tells actions and fluents, `_kept` sentences in all."""
        self._sentences: dict[tuple[Atom, bool, bool], _Sentences] = {}
        self._kept = 0
        self._aims: dict[State, State] = {}

    def recoloured(self, colors: Mapping[str, str]) -> Teller:
        """Return what tells and reads in pictures that show some entities in other colours than the scene's."""
        if not colors:
            return self
        other = copy(self)
        other.tongue = self.tongue.recoloured(colors)
        other.reader = Reader(other.tongue)
        other._forget()
        return other

    def instructions(self, task: Task, seed: int = 0) -> Instructions:
        """Return a task in words; the seed draws one of several phrasings, which are the same for the same seed.

        Raises:
            QueryError: the task is not one of this domain, or an action has no sentence that means nothing else.
        """
        plan, seen = str(task), start_of(task)
        vague, default, exact, each = (
            Dice(f"{seed} {level} {plan}") for level in ("vague", "default", "exact", "each")
        )
        view = self.tongue.view(seen)
        named: dict[str, None] = {}
        written = self.tongue.words.contracted
        subgoals = []
        for number, action in enumerate(task.actions):
            here = self.tongue.view(seen.at(task.states[number - 1]) if number else seen)
            clause, _ = self._clause(here, action, True, None, each)
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
        """Return a heading and a caption for a picture of each state, the first included, by the first sentence of all.

        The heading is the action that leads there, the caption what that made so; of the first state it is what is
        known of what the actions name.
        """
        handled = {argument for action in task.actions for argument in action.arguments} - self.tongue.looks.seen
        known = {fluent: True for fluent, value in task.initial.items() if value}
        view = self.tongue.view(start_of(task))
        told = [
            fluent
            for fluent in worth_telling(known, self.tongue)
            if not handled.isdisjoint(fluent.arguments) and fluent not in self._said_by_names(view, fluent)
        ]
        captions = [(self._frame("start"), self._caption(view, dict.fromkeys(told[:START_FACTS], True), None))]
        for number, (action, subgoal) in enumerate(zip(task.actions, task.subgoals, strict=True), 1):
            before = self.tongue.view(start_of(task, number - 1))
            heading, topic = self._heading(before, action)
            made = dict(list(worth_telling(subgoal, self.tongue).items())[:CAPTION_FACTS])
            moved = topic is not None and before.describe(topic).relation is not None
            captions.append((f"{number}. {heading}", self._caption(before, made, topic if moved else None)))
        written = self.tongue.words.contracted
        return [(written(heading), written(caption)) for heading, caption in captions]

    def _heading(self, view: View, action: Atom) -> tuple[str, str | None]:
        """Return an action in words; where none means nothing else, its sentence with the names of things."""
        try:
            return self._clause(view, action, True, None, None)
        except QueryError:
            return sentence(action, self.tongue.domain.settings.language), None

    def _said_by_names(self, view: View, fluent: Atom) -> Iterator[Atom]:
        """Yield what the descriptions of the things that a fluent speaks of say already."""
        for thing in fluent.arguments:
            relation = view.describe(thing).relation if thing in self.tongue.looks.nouns else None
            if relation is not None:
                yield relation.about(thing)

    def _caption(self, view: View, facts: State, topic: str | None) -> str:
        told = [text for fluent, value in facts.items() for text in self._told(view, fluent, value, topic, None)]
        return ", ".join(told)

    def read(self, start: Start | Task, text: str) -> Reading:
        """Return what an instruction asks for that is given at the start of a task, or in any other state.

        Raises:
            QueryError: it is none, or it could mean several plans.
        """
        return self.reader.read(start_of(start) if isinstance(start, Task) else start, text)

    def goal(self, task: Task) -> Mapping[Atom, bool]:
        """Return what the vague instruction of a task says: what the task changes for good, if it is worth telling.

        Of a task that leaves all as it was, it is what the last action is for.
        """
        made: dict[Atom, bool] = {}
        for subgoal in task.subgoals:
            made.update(subgoal)
        last = task.states[-1] if task.states else task.initial
        changed = {
            fluent: value for fluent, value in made.items() if last.get(fluent) == value != task.initial.get(fluent)
        }
        told = worth_telling(changed, self.tongue)
        return told or worth_telling(task.subgoals[-1] if task.subgoals else {}, self.tongue)

    def _aim(self, subgoal: State) -> State:
        """Return what is told of what an action makes so: tasks of one space share what their actions do."""
        frozen = subgoal if isinstance(subgoal, FrozenDict) else FrozenDict(subgoal)
        if frozen not in self._aims:
            if len(self._aims) > KEPT:
                self._aims.clear()
            self._aims[frozen] = worth_telling(frozen, self.tongue)
        return self._aims[frozen]

    def _note(self, view: View, atoms: Sequence[Atom], named: dict[str, None]) -> None:
        """Note the entities that have to be called by their names."""
        certain = view.crowd.certain
        for atom in atoms:
            if not certain.issuperset(atom.arguments):
                for argument in atom.arguments:
                    if argument in self.tongue.looks.nouns and view.describe(argument).name:
                        named[argument] = None

    def _frame(self, level: str) -> str:
        return str(self.tongue.words.frames[level])

    def _vague(self, view: View, goal: Mapping[Atom, bool], dice: Dice) -> str:
        """Return what is to be so at the end."""
        clauses = [clause for fluent, value in goal.items() for clause in self._told(view, fluent, value, None, dice)]
        if not clauses:
            return ""
        frame = dice.pick(self.phrasings.of(self.tongue.words.frames["vague"]))
        return capital(frame.format(facts=self._joined(clauses, "facts", dice)))

    def _default(self, view: View, actions: Sequence[Atom], dice: Dice) -> str:
        """Return what is to be done: what the sentence before is about is "it" in the next one."""
        clauses, topic = [], None
        for action in actions:
            clause, topic = self._clause(view, action, True, topic, dice)
            clauses.append(clause)
        if not clauses:
            return ""
        frame = dice.pick(self.phrasings.of(self.tongue.words.frames["default"]))
        return capital(frame.format(actions=self._joined(clauses, "sentences", dice)))

    def _exact(self, view: View, actions: Sequence[Atom], aims: Sequence[State], dice: Dice) -> str:
        """Return what is to be done and what each action is for."""
        words, steps = self.tongue.words, []
        alone, aimed = words.frames["exact"]
        for number, (action, aim) in enumerate(zip(actions, aims, strict=True), 1):
            clause, topic = self._clause(view, action, True, None, dice)
            facts = [told for fluent, value in aim.items() for told in self._told(view, fluent, value, topic, dice)]
            frame = aimed if facts else alone
            told = frame.format(
                number=words.number(number), action=clause, facts=self._joined(facts, "facts", dice) if facts else ""
            )
            steps.append(capital(told))
        return str(words.table["joints"]["steps"]).join(steps)

    def _joined(self, clauses: Sequence[str], kind: str, dice: Dice) -> str:
        """Return sentences as one text."""
        text, joints, joint = clauses[0], self.phrasings.of(self.tongue.words.joints(kind)), ""
        for clause in clauses[1:]:
            joint = dice.pick([each for each in joints if each != joint] or joints)
            text += joint + clause
        return text

    def _told(self, view: View, fluent: Atom, value: bool, topic: str | None, dice: Dice | None) -> list[str]:
        """Return a fact in words, nothing where the language has no words for it that mean nothing else."""
        try:
            return [self._clause(view, fluent, value, topic, dice, of_actions=False)[0]]
        except QueryError:
            return []

    def _clause(
        self, view: View, atom: Atom, value: bool, topic: str | None, dice: Dice | None, *, of_actions: bool = True
    ) -> Clear:
        """Return a sentence that means an action, or a fluent and its value, and nothing else; and what it is about.

        Raises:
            QueryError: there is none.
        """
        sentences = self._sentences_of(atom, value, of_actions)
        first = dice.number(len(sentences.given)) if sentences.given and dice else 0
        key = (view.crowd, topic, first, view.related(sentences.things))
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
            raise QueryError(f"{atom} is no {kind} of {self.tongue.domain.name}; tell tasks of that domain")
        raise QueryError(
            f"no sentence for {atom} that means nothing else; write one that names all that it speaks of "
            f"under [language.{self.tongue.language}.{where}]"
        )

    def _keep(self, sentences: _Sentences, key: object, found: Clear | None) -> None:
        """Keep which sentence means something alone; forget the others where there are too many."""
        if self._kept > KEPT:
            for each in self._sentences.values():
                each.clear.clear()
            self._kept = 0
        sentences.clear[key] = found
        self._kept += 1

    def _search(
        self, view: View, ways: Iterator[tuple[Clause, int]], what: tuple[Atom, bool, bool], topic: str | None
    ) -> tuple[Clear | None, bool]:
        """Return the first of some sentences that means one thing alone, and whether that depends on the state.

        It does not if what the things are described by is all that it depends on.
        """
        (atom, value, of_actions), of_state = what, False
        for clause, variant in ways:
            text = self._written(view, clause, atom, topic, variant)
            heard, unsure = self.reader.heard(view, text, topic, of_actions=of_actions)
            of_state |= unsure
            if len(heard) == 1:
                (said,) = heard
                if (said.atom, said.value) == (atom, value):
                    return (text, said.topic), of_state
        return None, of_state

    def _sentences_of(self, atom: Atom, value: bool, of_actions: bool) -> _Sentences:
        """Return the sentences that tell an action, or a fluent and its value."""
        key = (atom, value, of_actions)
        found = self._sentences.get(key)
        if found is None:
            found = self._sentences[key] = self._found_sentences(atom, value, of_actions)
        return found

    def _found_sentences(self, atom: Atom, value: bool, of_actions: bool) -> _Sentences:
        """Find them: where only some phrasings are said, no other sentence tells an action."""
        clauses = self.tongue.clauses.actions if of_actions else self.tongue.clauses.facts
        known = [each for each in clauses.get((atom.name, len(atom.arguments)), ()) if each.value == value]
        gender = self._gender
        usable = [each for each in known if not each.template.genders or gender(each, atom) in each.template.genders]
        given = [each for each in usable if not each.spare and each.tells(atom, self.tongue.looks.robots)]
        if not of_actions:  # with one robot nobody says which
            fewest = min((len(each.template.slots) for each in given), default=0)
            given = [each for each in given if len(each.template.slots) == fewest]
        chosen = [each for each in given if self.phrasings.has(each.template.phrasing)]
        if chosen or of_actions:
            given = chosen
        spare = [] if of_actions and self.phrasings.all > 1 else [each for each in usable if each.spare]
        things = tuple(each for each in atom.arguments if each in self.tongue.looks.nouns)
        return _Sentences(tuple(given), tuple(spare), things, any(atom in clause.atoms for clause in known))

    def _gender(self, clause: Clause, atom: Atom) -> str:
        """Return the gender of what a sentence names first."""
        return self.tongue.phrases.gender(atom.arguments[clause.template.arguments[0]]) if clause.template.slots else ""

    def _written(self, view: View, clause: Clause, atom: Atom, topic: str | None, variant: int) -> str:
        """Return a sentence with words for what it speaks of."""
        phrases, words = self.tongue.phrases, []
        for slot in clause.template.slots:
            value = atom.arguments[slot.argument]
            if value == topic:
                words.append(phrases.pronoun(value, slot.case))
            else:
                words.append(phrases.write(view, value, slot.case, variant))
        return clause.template.fill(words)


def teller_of(
    domain: Domain, language: str = "en", colors: Mapping[str, str] | None = None, phrasings: str = ""
) -> Teller:
    """Return what tells tasks of a domain in a language.

    Where pictures show entities in other colours than the scene's, `colors` has those (``#rrggbb``), by their names.
    With `phrasings`, such as ``1 of 2``, only some of the ways to say the same are said: every second one from the
    first on. An action that ``1 of 2`` tells is told by other sentences in ``2 of 2``.

    Raises:
        QueryError: the domain does not speak the language, or has no such phrasings, or a colour is none.
        SceneError: something is wrong with the scene.
    """
    for entity, color in (colors or {}).items():
        if entity not in domain.facts.entity_names or not COLOR.fullmatch(color):
            raise QueryError(f"{entity} = {color!r} is no colour of an entity; write one of {domain.name} and #rrggbb")
    return Teller(domain, language, colors, phrasings)


def worth_telling(facts: State, tongue: Tongue) -> Mapping[Atom, bool]:
    """Return those of some facts that are told: what is so, or what is not where that is all."""
    forms = tongue.grammar.facts
    known = {fluent: forms.get((fluent.name, len(fluent.arguments))) for fluent in facts}
    loud = {fluent: value for fluent, value in facts.items() if (form := known[fluent]) is not None and not form.silent}
    true = {fluent: value for fluent, value in loud.items() if value}
    return dict(sorted((true or loud).items()))
