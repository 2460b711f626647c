"""A syntax tree without parentheses, whose words carry their line numbers."""

from __future__ import annotations

from dataclasses import dataclass


class LocatedWord(str):
    """A word of a file, with its line number."""

    line: int

    def __new__(cls, text: str, line: int) -> LocatedWord:
        """Return a word."""
        word = super().__new__(cls, text)
        word.line = line
        return word


@dataclass(frozen=True)
class Node:
    """A node of the syntax tree: its grammar rule, and its words and child nodes in order."""

    kind: str
    children: tuple[Node | LocatedWord, ...]

    @property
    def nodes(self) -> tuple[Node, ...]:
        """The child nodes."""
        return tuple(each for each in self.children if isinstance(each, Node))

    @property
    def words(self) -> tuple[LocatedWord, ...]:
        """The words directly in this node."""
        return tuple(each for each in self.children if isinstance(each, LocatedWord))

    @property
    def all_words(self) -> list[LocatedWord]:
        """All words below this node, in order."""
        words: list[LocatedWord] = []
        for each in self.children:
            words += [each] if isinstance(each, LocatedWord) else each.all_words
        return words
