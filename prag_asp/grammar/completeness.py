"""The check that the word table of a language is complete: types, braces, and a form for each gender and case."""

from __future__ import annotations

from collections.abc import Mapping
from string import Formatter
from typing import Any

from prag_asp.grammar.word_table import Words, shipped_table
from prag_asp.tables.report import TableEntry
from prag_asp.wording import did_you_mean, listed

PARTS = ("the", "place", "size", "color", "noun")
"""The parts of a noun phrase."""

BRACES: Mapping[str, Mapping[str, tuple[str, ...]]] = {
    "frames": {
        "vague": ("facts",),
        "default": ("actions",),
        "exact": ("number", "action"),
        "subgoal": ("action",),
        "digits": ("number",),
        "start": (),
    },
    "joints": {"sentences": (), "facts": (), "many": (), "goal": (), "steps": ()},
}
"""The names in braces in the texts of a language; the second frame of an exact instruction also has the facts."""

NUMBERS: Mapping[str, int] = {"exact": 2, "many": 2, "goal": 3}
"""The numbers of texts in lists of a fixed length."""

OPTIONAL_JOINTS = frozenset(["many", "goal"])
"""The texts between clauses that a language may lack."""


def check_kinds(words: TableEntry) -> None:
    """Report unknown words, and words whose value does not have the same type as in the English table."""
    english = {**shipped_table("en"), "numbers": [], "contractions": {}}
    words.require_known(english)
    for name, entry in words.entries():
        if name in english and not _is_like(entry.value, english[name]):
            like = english[name]
            kind = "a table" if isinstance(like, Mapping) else "a list of texts" if isinstance(like, list) else "a text"
            entry.add(f"needs {kind}; write it as in the table of English")


def _is_like(value: object, model: object) -> bool:
    """Return whether a value in a word table has the same type as its English `model`."""
    if isinstance(model, Mapping):
        return isinstance(value, Mapping) and bool(value)
    if isinstance(model, list):
        return isinstance(value, list) and bool(value) and all(isinstance(each, str) and each for each in value)
    return isinstance(value, str)


def check_forms(entry: TableEntry, words: Words) -> None:
    """Report missing and superfluous forms and braces in a language, whose tables must be complete."""
    table = words.table
    unknown = next((part for part in table["phrase"] if part not in PARTS), None)
    if unknown is not None or "noun" not in table["phrase"]:
        entry.at("phrase").add(f"a phrase is made of {listed(PARTS)}, and has a noun; got {unknown or 'none'}")
    for key, names, needed in (
        ("named", ("the", "noun", "name"), "name"),
        ("modified", ("phrase", "where", "is"), "where"),
        ("formerly", ("phrase", "where", "was"), "where"),
        ("repeated", ("action",), ""),
        ("varied", ("action", "manner"), "manner"),
    ):
        if key not in table:
            continue
        for text in [table[key]] if isinstance(table[key], str) else table[key]:
            braces = _braces(text)
            if braces is None or not set(braces) <= set(names) or needed not in (*braces, ""):
                needs = f"{{{needed}}}, and " if needed else ""
                entry.at(key).add(f"has {needs}no other braces than {listed(names)}; got {text!r}")
    if any(_braces(text) and (_braces(text) or ())[:1] != ("phrase",) for text in table["modified"]):
        entry.at("modified").add("does not begin with {phrase}; write the place after it")
    contractions = table.get("contractions", {})
    for long, short in contractions.items():
        if not isinstance(short, str) or not short.strip() or not long.strip():
            entry.at("contractions").add(f'the contraction of {long!r} is not a word; write "zu dem" = "zum"')
        elif list(contractions.values()).count(short) > 1 or short in contractions:
            entry.at("contractions").add(f"{short} stands for several texts, so it is ambiguous; leave one out")
    _check_texts(entry, table)
    _check_agreement(entry, words)


def _check_texts(words: TableEntry, table: Mapping[str, Any]) -> None:
    """Report frames and joints that are missing or have wrong braces."""
    for part, keys in BRACES.items():
        for key, names in keys.items():
            entry, value, like = words.at(part).at(key), table[part].get(key), shipped_table("en")[part][key]
            if key in OPTIONAL_JOINTS and value is None:
                continue
            if not _is_like(value, like) or len(value) != NUMBERS.get(key, len(value)):
                entry.add("has to be of the same kind as in the table of English; fix it")
                continue
            for number, text in enumerate(value if isinstance(value, list) else [value]):
                needed = (*names, "facts") if key == "exact" and number else names
                if _braces(text) != needed:
                    braces = ", ".join(f"{{{name}}}" for name in needed) or "no braces"
                    entry.add(f"has {braces}, in this order; got {text!r}")


def _check_agreement(entry: TableEntry, words: Words) -> None:
    """Report missing forms for genders and cases."""
    for word in ("the", "it", "is", "is_not", *(["was"] if "{was}" in words.table.get("formerly", "") else [])):
        for gender in words.genders:
            lacking = [case for case in words.cases if not words.agreeing(word, gender, case)]
            if lacking and not (word == "the" and "the" not in words.table["phrase"]):
                entry.at(word).add(f"has no form for {gender} {lacking[0]}; add it")
    kinds = {kind: words.table.get(kind, {}) for kind in ("colors", "sizes", "places")}
    forms = words.table.get("forms", {})
    inflected = any(not isinstance(each, str) for names in kinds.values() for each in names.values())
    for gender in words.genders if inflected else ():
        own = forms.get(gender)
        if not isinstance(own, Mapping) or any(not isinstance(own.get(case), str) for case in words.cases):
            entry.at("forms").add(f"adjectives have no form for {gender}; add it to forms")
            return
    for kind, names in kinds.items():
        english = shipped_table("en")[kind]
        needed = {forms[gender][case] for gender in words.genders for case in words.cases} if inflected else set()
        for name, form in names.items():
            forms_of_name = [form.get(each) for each in needed] if isinstance(form, Mapping) else [form]
            place = entry.at(kind).at(name)
            if name not in english:
                place.add(f"no {kind} have that name; {did_you_mean(name, english)}")
            if not form or not all(isinstance(each, str) and each for each in forms_of_name):
                place.add(f"lacks a form; write a text, or one for each of {listed(needed) or 'the forms'}")


def _braces(text: str) -> tuple[str, ...] | None:
    """Return the names in braces, in order and in lower case, or None if the braces do not match."""
    try:
        return tuple(name.lower() for _, name, _, _ in Formatter().parse(text) if name is not None)
    except ValueError:
        return None
