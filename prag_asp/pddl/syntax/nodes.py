"""A syntax tree without parentheses, whose words have lines."""

from __future__ import annotations

from dataclasses import dataclass


class LocatedWord(str):
    """A word of a file, with its line."""

    line: int

    def __new__(cls, text: str, line: int) -> LocatedWord:
        """Return a word."""
        word = super().__new__(cls, text)
        word.line = line
        return word


@dataclass(frozen=True)
class Node:
    """A node of a file: its grammar rule, and its words and inner nodes in order."""

    kind: str
    children: tuple[Node | LocatedWord, ...]

    @property
    def nodes(self) -> tuple[Node, ...]:
        """The inner nodes."""
        return tuple(each for each in self.children if isinstance(each, Node))

    @property
    def words(self) -> tuple[LocatedWord, ...]:
        """The words directly in this node."""
        return tuple(each for each in self.children if isinstance(each, LocatedWord))

    @property
    def all_words(self) -> list[LocatedWord]:
        """All words, with those of inner nodes."""
        found: list[LocatedWord] = []
        for each in self.children:
            found += [each] if isinstance(each, LocatedWord) else each.all_words
        return found
