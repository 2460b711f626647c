"""The actions and entities that a condition refers to."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import clingo

from prag_asp.atom import atom_of, parse_atom
from prag_asp.errors import QueryError
from prag_asp.program.entity_names import action_name, no_action, refuse_ambiguous
from prag_asp.program.facts import Facts
from prag_asp.wording import unknown

ANY = "_"


@dataclass(frozen=True)
class Pattern:
    """An action, an action name, or an action with ``_`` as a wildcard; `arguments` is None for a name alone."""

    name: str
    arguments: tuple[str, ...] | None = None

    @classmethod
    def parse(cls, text: str) -> Pattern:
        """Return the pattern of a text such as ``grasp`` or ``grasp(_,apple_1)``.

        Raises:
            QueryError: the text is not a term.
        """
        atom = parse_atom(text)
        return cls(atom.name, atom.arguments or None)

    def matches(self, facts: Facts) -> tuple[clingo.Symbol, ...]:
        """Return the matching actions.

        Raises:
            QueryError: no action matches.
        """

        def fits(action: clingo.Symbol) -> bool:
            if action_name(action) != self.name or self.arguments is None:
                return action_name(action) == self.name
            arguments = atom_of(action).arguments
            return len(arguments) == len(self.arguments) and all(
                pattern in (ANY, argument) for pattern, argument in zip(self.arguments, arguments, strict=True)
            )

        actions = tuple(filter(fits, facts.actions))
        if not actions:
            spelled = self.name if self.arguments is None else f"{self.name}({','.join(self.arguments)})"
            names = {*map(action_name, facts.actions), *map(str, facts.actions)}
            raise QueryError(no_action(spelled, names, facts))
        return actions


def alternatives(text: str) -> list[str]:
    """Return the patterns in a text such as ``grasp | move(_,apple_1,_)``; bars in parentheses do not count."""
    pieces, depth = [""], 0
    for character in text:
        depth += (character == "(") - (character == ")")
        if character == "|" and not depth:
            pieces.append("")
        else:
            pieces[-1] += character
    return [piece.strip() for piece in pieces]


def class_members(kind: str, facts: Facts) -> Iterator[clingo.Symbol]:
    """Return the entities whose name or class is `kind`, in clingo's order of terms.

    Raises:
        QueryError: there is no such entity or class, or the name is ambiguous.
    """
    refuse_ambiguous(kind, facts)
    entities = {str(entity): entity for entity in facts.entities}
    if kind in entities:
        return iter([entities[kind]])
    classes = {str(name): name for name in facts.classes}
    if kind not in classes:
        raise QueryError(unknown(kind, [*entities, *classes], "entity or class"))
    return iter(sorted(entity for entity in facts.entities if (entity, classes[kind]) in facts.memberships))
