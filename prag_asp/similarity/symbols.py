"""Symbols that metrics compare (actions, facts, states and links): rename the entities in them, and collect them."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping
from typing import Any

from prag_asp.atom import Atom, split_terms

Symbol = Any
"""An atom, or a tuple or frozen set of symbols; strings, truth values, numbers and None in them are not renamed."""


def renamer(names: Mapping[str, str]) -> Callable[[Symbol], Symbol]:
    """Return a function that renames the entities in symbols; it caches atoms and frozen sets."""
    if not names:
        return lambda symbol: symbol
    cache: dict[Symbol, Symbol] = {}

    def rename(symbol: Symbol) -> Symbol:
        if isinstance(symbol, Atom):
            renamed = cache.get(symbol)
            if renamed is None:
                renamed = cache[symbol] = Atom(
                    symbol.name, tuple(renamed_term(each, names) for each in symbol.arguments)
                )
            return renamed
        if isinstance(symbol, frozenset):
            renamed = cache.get(symbol)
            if renamed is None:
                renamed = cache[symbol] = frozenset(map(rename, symbol))
            return renamed
        return tuple(map(rename, symbol)) if isinstance(symbol, tuple) else symbol

    return rename


def renamed_term(term: str, names: Mapping[str, str]) -> str:
    """Return the text of a term with its entities renamed, including those within other terms."""
    if term in names:
        return names[term]
    name, parenthesis, rest = term.partition("(")
    if not parenthesis or '"' in term:
        return term
    return f"{name}({','.join(renamed_term(each, names) for each in split_terms(rest[:-1]))})"


def entities_in(symbol: Symbol, entities: Collection[str]) -> Iterator[str]:
    """Yield the entities in a symbol, which may repeat; the elements of sets are ordered by their texts."""
    if isinstance(symbol, Atom):
        for term in symbol.arguments:
            yield from _entities_of_term(term, entities)
    elif isinstance(symbol, frozenset):
        for each in sorted(symbol, key=str):
            yield from entities_in(each, entities)
    elif isinstance(symbol, tuple):
        for each in symbol:
            yield from entities_in(each, entities)


def _entities_of_term(term: str, entities: Collection[str]) -> Iterator[str]:
    if term in entities:
        yield term
    elif "(" in term and '"' not in term:
        for each in split_terms(term.partition("(")[2][:-1]):
            yield from _entities_of_term(each, entities)


def symbol_text(symbol: Symbol) -> str:
    """Return an action, a fact with its value, an action with its effects, a link or a state as text."""
    if isinstance(symbol, frozenset):
        return "{" + ", ".join(sorted(f"{'' if value else 'not '}{fact}" for fact, value in symbol)) + "}"
    if not isinstance(symbol, tuple) or isinstance(symbol, Atom):
        return str(symbol)
    if len(symbol) == 2:
        first, second = symbol
        if isinstance(second, frozenset):
            return str(first)
        return f"{first} becomes unknown" if second is None else f"{'' if second else 'not '}{first}"
    producer, fact, value, consumer, _ = symbol
    return f"{producer or 'the initial state'} makes {'' if value else 'not '}{fact} for {consumer}"
