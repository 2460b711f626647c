"""The sentences of a language, with the actions or fluents that each one can mean."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
from dataclasses import replace
from functools import cached_property

from prag_asp.atom import Atom, atom_of
from prag_asp.dataset.language.descriptions import Relation
from prag_asp.grammar.reader import FactForms, Grammar, Where, listed
from prag_asp.grammar.template import Template, admits
from prag_asp.grammar.ways import Signature, Way
from prag_asp.program.facts import Facts

Words = tuple[str, ...]


class Sentence:
    """A sentence for all actions or fluents with one name; `value` is false if it states that a fluent does not hold.

    A sentence with a source omits the place from which an object is moved, because the phrase for the object already
    names it: "take the cup in the rack". In that case, `moved` is the slot of the object, and `sources` holds, for each
    action, the relation that the phrase has to state.
    """

    def __init__(
        self,
        template: Template,
        atoms: tuple[Atom, ...],
        value: bool = True,
        *,
        spare: bool = False,
        moved: int = -1,
        sources: Mapping[Atom, Atom] | None = None,
    ) -> None:
        self.template, self.atoms, self.value, self.spare = template, atoms, value, spare
        self.moved, self.sources = moved, sources or {}

    @cached_property
    def _meant(self) -> Mapping[Words, tuple[Atom, ...]]:
        found: dict[Words, list[Atom]] = {}
        for atom in self.atoms:
            found.setdefault(self.arguments(atom), []).append(atom)
        return {arguments: tuple(atoms) for arguments, atoms in found.items()}

    def arguments(self, atom: Atom) -> Words:
        """Return the arguments of an atom that occur in the sentence, in the order of its slots."""
        return tuple(atom.arguments[index] for index in self.template.arguments)

    def meant(self, arguments: Words) -> tuple[Atom, ...]:
        """Return the actions or fluents that the sentence means with these arguments in its slots."""
        return self._meant.get(arguments, ())

    def meant_from(self, arguments: Words, relations: Set[Relation]) -> tuple[Atom, ...]:
        """Return the actions that a sentence with a source means if the phrase for the object states `relations`."""
        stated = {relation.about(arguments[self.moved]) for relation in relations}
        return tuple(atom for atom in self.meant(arguments) if self.sources.get(atom) in stated)

    def identifies(self, atom: Atom, robots: frozenset[str]) -> bool:
        """Return whether the sentence means only this action or fluent.

        A sentence without the robot identifies an action only if the scene has one robot.
        """
        named = self.template.arguments
        unnamed = (argument for index, argument in enumerate(atom.arguments) if index not in named)
        if len(robots) > 1 and not robots.isdisjoint(unnamed):
            return False
        return self.meant(self.arguments(atom)) == (atom,)


class Modifier:
    """A phrase that modifies a noun with a fluent, such as ``on the tray``, and the relations that it can mean."""

    def __init__(self, where: Where, fluents: tuple[Atom, ...]) -> None:
        self.template, self.subject = where.template, where.subject
        self.fluents = fluents

    @cached_property
    def _meant(self) -> Mapping[Words, frozenset[Relation]]:
        found: dict[Words, set[Relation]] = {}
        for fluent in self.fluents:
            others = (*fluent.arguments[: self.subject], *fluent.arguments[self.subject + 1 :])
            arguments = tuple(fluent.arguments[index] for index in self.template.arguments)
            found.setdefault(arguments, set()).add(Relation(fluent.name, self.subject, others))
        return {arguments: frozenset(relations) for arguments, relations in found.items()}

    def meant(self, arguments: Words) -> frozenset[Relation]:
        """Return the relations that the modifier means with these arguments in its slots."""
        return self._meant.get(arguments, frozenset())

    def arguments(self, relation: Relation) -> Words:
        """Return the arguments of a relation that occur in the modifier, in the order of its slots."""
        whole = relation.about("").arguments
        return tuple(whole[index] for index in self.template.arguments)


class SentenceTable:
    """All sentences for a domain in one language."""

    def __init__(self, grammar: Grammar, facts: Facts) -> None:
        actions, fluents = _by_signature(facts.actions), _by_signature(facts.fluents)
        self.fluents = fluents
        kinds = {(str(entity), str(name)) for entity, name in facts.memberships}
        self.actions: dict[Signature, tuple[Sentence, ...]] = {}
        for signature, atoms in actions.items():
            templates = grammar.actions.get(signature, ())
            given = [Sentence(template, _admitted(template, templates, atoms, kinds)) for template in templates]
            plain = [
                Sentence(template, tuple(atom for atom in atoms if not own or str(atom) in own), spare=True)
                for template, own in grammar.plain.get(signature, ())
            ]
            sources = grammar.sources.get(signature, {})
            particles = listed(grammar.words.table.get("defaults", {}).get("particles", ()))
            shorter = [each for sentence in (*given, *plain) for each in _from_phrase(sentence, sources, particles)]
            shorter.sort(key=lambda each: len(each.template.texts[each.moved + 1]))
            self.actions[signature] = (*given, *plain, *shorter)
        self.facts: dict[Signature, tuple[Sentence, ...]] = {}
        self.modifiers: dict[Signature, tuple[Modifier, ...]] = {}
        for signature, atoms in fluents.items():
            forms = grammar.facts.get(signature, FactForms())
            self.facts[signature] = tuple(_of_fluents(forms, atoms, kinds))
            spare = grammar.spare.get(signature, FactForms())
            self.facts[signature] += tuple(_of_fluents(spare, atoms, kinds, {*forms.true, *forms.false}))
            modifiers = [where.template for where in forms.where]
            self.modifiers[signature] = tuple(
                Modifier(where, _admitted(where.template, modifiers, atoms, kinds)) for where in forms.where
            )


def _from_phrase(
    sentence: Sentence, sources: Mapping[str, tuple[int, Way]], particles: Sequence[str]
) -> Iterator[Sentence]:
    """Yield a sentence without the place from which an object is moved, if this place directly follows the object.

    A particle before the place remains; without known `particles`, these are all words except the last one.
    """
    template = sentence.template
    for place, moved in {(place, way.moved) for place, way in sources.values()}:
        slot = template.arguments.index(moved) if moved in template.arguments else -1
        if slot < 0 or template.arguments[slot + 1 : slot + 2] != (place,) or template.arguments.count(place) > 1:
            continue
        words = template.texts[slot + 1].split()[:-1]
        particle = "".join(f" {word}" for word in words if word in particles or not particles)
        texts = (*template.texts[: slot + 1], particle + template.texts[slot + 2], *template.texts[slot + 3 :])
        slots = (*template.slots[: slot + 1], *template.slots[slot + 2 :])
        fluents = {atom: sources[str(atom)][1].fluent for atom in sentence.atoms if str(atom) in sources}
        shorter = replace(template, texts=texts, slots=slots)
        yield Sentence(shorter, sentence.atoms, spare=sentence.spare, moved=slot, sources=fluents)


def _admitted(
    template: Template, templates: Sequence[Template], atoms: tuple[Atom, ...], kinds: Set[tuple[str, str]]
) -> tuple[Atom, ...]:
    """Return the atoms for which a template is used: of several templates that admit an atom, the last one counts."""
    special = list(dict.fromkeys(each.only for each in templates if each.only))
    if not special:
        return atoms

    def fitting(atom: Atom) -> tuple[str, ...]:
        return next((only for only in reversed(special) if admits(only, atom.arguments, kinds)), ())

    return tuple(atom for atom in atoms if fitting(atom) == template.only)


def _of_fluents(
    forms: FactForms, atoms: tuple[Atom, ...], kinds: Set[tuple[str, str]], given: Set[Template] | None = None
) -> Iterator[Sentence]:
    """Yield the sentences for a fluent; with `given` templates, yield those of other templates, as spare ones."""
    for value, templates in ((True, forms.true), (False, forms.false)):
        for template in templates:
            if given is None or template not in given:
                yield Sentence(template, _admitted(template, templates, atoms, kinds), value, spare=given is not None)


def _by_signature(terms: Iterable[object]) -> dict[Signature, tuple[Atom, ...]]:
    found: dict[Signature, list[Atom]] = {}
    for term in terms:
        atom = atom_of(term)  # type: ignore[arg-type]
        found.setdefault((atom.name, len(atom.arguments)), []).append(atom)
    return {signature: tuple(atoms) for signature, atoms in found.items()}
