"""A syntax tree without parentheses, whose words know their lines."""

from __future__ import annotations

from dataclasses import dataclass


class LocatedWord(str):
    """A word of a file; `line` is where it stands."""

    line: int

    def __new__(cls, text: str, line: int) -> LocatedWord:
        """Return a word."""
        word = super().__new__(cls, text)
        word.line = line
        return word


@dataclass(frozen=True)
class Node:
    """A piece of a file: the rule of the grammar that it follows, and its words and pieces in order."""

    kind: str
    children: tuple[Node | LocatedWord, ...]

    @property
    def nodes(self) -> tuple[Node, ...]:
        """The pieces of this one."""
        return tuple(each for each in self.children if isinstance(each, Node))

    @property
    def words(self) -> tuple[LocatedWord, ...]:
        """The words right in this piece."""
        return tuple(each for each in self.children if isinstance(each, LocatedWord))

    @property
    def all_words(self) -> list[LocatedWord]:
        """All words, those of the pieces in it among them."""
        found: list[LocatedWord] = []
        for each in self.children:
            found += [each] if isinstance(each, LocatedWord) else each.all_words
        return found
