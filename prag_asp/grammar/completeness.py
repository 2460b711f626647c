"""Whether the words of a language are whole: kinds of values, braces, forms by gender and case."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from string import Formatter
from typing import Any

from prag_asp.grammar.word_table import Words, shipped_table
from prag_asp.wording import did_you_mean, listed

PARTS = ("the", "place", "size", "color", "noun")
"""What a phrase is made of."""

BRACES: Mapping[str, Mapping[str, tuple[str, ...]]] = {
    "frames": {
        "vague": ("facts",),
        "default": ("actions",),
        "exact": ("number", "action"),
        "subgoal": ("action",),
        "digits": ("number",),
        "start": (),
    },
    "joints": {"sentences": (), "facts": (), "steps": ()},
}
"""What stands in braces in texts of a language; the second of the exact ones has the facts, too."""

Wrong = tuple[str, str]
"""The key of what is wrong, and what to do."""


def kind_problems(own: Mapping[str, Any]) -> Iterator[Wrong]:
    """Yield words that no language has, and those of another kind than in English."""
    known = {**shipped_table("en"), "numbers": [], "contractions": {}}
    for name, value in own.items():
        if name not in known:
            yield name, f"no language has words called {name}; {did_you_mean(name, known)}"
        elif not _is_like(value, known[name]):
            like = known[name]
            kind = "a table" if isinstance(like, Mapping) else "a list of texts" if isinstance(like, list) else "a text"
            yield name, f"{name} needs {kind}; write it as in the table of English"


def _is_like(value: object, known: object) -> bool:
    """Tell whether a value of a table of words has the kind of the same one in English."""
    if isinstance(known, Mapping):
        return isinstance(value, Mapping) and bool(value)
    if isinstance(known, list):
        return isinstance(value, list) and bool(value) and all(isinstance(each, str) and each for each in value)
    return isinstance(value, str)


def form_problems(words: Words) -> Iterator[Wrong]:
    """Yield what a language lacks that has all its tables."""
    table = words.table
    unknown = next((part for part in table["phrase"] if part not in PARTS), None)
    if unknown is not None or "noun" not in table["phrase"]:
        yield "phrase", f"a phrase is made of {listed(PARTS)}, and has a noun; got {unknown or 'none'}"
    for key, names, needed in (
        ("named", ("the", "noun", "name"), "name"),
        ("modified", ("phrase", "where", "is"), "where"),
    ):
        for text in [table[key]] if isinstance(table[key], str) else table[key]:
            found = _braces(text)
            if found is None or not set(found) <= set(names) or needed not in found:
                yield key, f"{key} has {{{needed}}}, and no other braces than {listed(names)}; got {text!r}"
    if any(_braces(text) and (_braces(text) or ())[:1] != ("phrase",) for text in table["modified"]):
        yield "modified", "modified says where before the {phrase}; begin with it"
    yield from _contraction_problems(table.get("contractions", {}))
    yield from _text_problems(table)
    yield from _agreement_problems(words)


def _contraction_problems(table: Mapping[str, Any]) -> Iterator[Wrong]:
    """Yield contractions that are no words, or that could be read in two ways."""
    for long, short in table.items():
        if not isinstance(short, str) or not short.strip() or not long.strip():
            yield "contractions", f'what {long!r} becomes is no word; write "zu dem" = "zum"'
        elif list(table.values()).count(short) > 1 or short in table:
            yield "contractions", f"{short} stands for several; nobody could read it back: leave one out"


def _text_problems(table: Mapping[str, Any]) -> Iterator[Wrong]:
    """Yield frames and joints that are missing, or have other braces than they need."""
    for part, keys in BRACES.items():
        for key, names in keys.items():
            given, like = table[part].get(key), shipped_table("en")[part][key]
            if not _is_like(given, like) or (key == "exact" and len(given) != 2):
                yield part, f"{part} needs {key} of the same kind as in the table of English; mend it"
                continue
            texts = given if isinstance(given, list) else [given]
            for number, text in enumerate(texts):
                needed = (*names, "facts") if key == "exact" and number else names
                if _braces(text) != needed:
                    braces = ", ".join(f"{{{name}}}" for name in needed) or "no braces"
                    yield part, f"{key} has {braces}, in this order; got {text!r}"


def _agreement_problems(words: Words) -> Iterator[Wrong]:
    """Yield the forms by gender and case that are missing."""
    for word in ("the", "it", "is", "is_not"):
        for gender in words.genders:
            lacking = [case for case in words.cases if not words.agreeing(word, gender, case)]
            if lacking and not (word == "the" and "the" not in words.table["phrase"]):
                yield word, f"the word {word} has no form for {gender} {lacking[0]}; add it"
    kinds = {kind: words.table.get(kind, {}) for kind in ("colors", "sizes", "places")}
    forms = words.table.get("forms", {})
    inflected = any(not isinstance(each, str) for names in kinds.values() for each in names.values())
    for gender in words.genders if inflected else ():
        own = forms.get(gender)
        if not isinstance(own, Mapping) or any(not isinstance(own.get(case), str) for case in words.cases):
            yield "forms", f"adjectives have no form for {gender}; add it to forms"
            return
    for kind, names in kinds.items():
        unknown = next((name for name in names if name not in shipped_table("en")[kind]), None)
        if unknown is not None:
            yield kind, f"no {kind} are called {unknown}; {did_you_mean(unknown, shipped_table('en')[kind])}"
        for name, form in names.items():
            wanted = {forms[gender][case] for gender in words.genders for case in words.cases} if inflected else set()
            whole = isinstance(form, str) or (isinstance(form, Mapping) and all(_has(form, each) for each in wanted))
            if not whole or not form:
                yield kind, f"{name} lacks a form; it needs a text, or one for each of {listed(wanted) or 'the forms'}"


def _has(forms: Mapping[str, Any], name: str) -> bool:
    return isinstance(forms.get(name), str) and bool(forms[name])


def _braces(text: str) -> tuple[str, ...] | None:
    """Return the names in braces in their order, None where they do not match."""
    try:
        return tuple(name for _, name, _, _ in Formatter().parse(text) if name is not None)
    except ValueError:
        return None
