"""The languages of the package are whole: each has every form, every colour, every predicate."""

from __future__ import annotations

from collections.abc import Callable
from itertools import product
from typing import Any

import pytest

from prag_asp import QueryError
from prag_asp.grammar.completeness import check_forms, check_kinds
from prag_asp.grammar.word_table import shipped_languages, shipped_table, words_of
from prag_asp.scene.predicate_names import VOCABULARY
from prag_asp.tables.report import TableEntry, TableReport


@pytest.mark.parametrize("code", shipped_languages())
def test_a_language_has_all_forms_and_all_predicates(code: str) -> None:
    words, english = words_of(code, {}), shipped_table("en")
    for gender, case in product(words.genders, words.cases):
        assert all(words.agreeing(word, gender, case) for word in ("the", "it", "is", "is_not"))
        for kind in ("colors", "sizes", "places"):
            assert words.table[kind].keys() == english[kind].keys()
            assert all(words.adjective(kind, name, gender, case) for name in english[kind])
    assert set(words.table["facts"]) == set(VOCABULARY)
    assert len({words.number(k) for k in range(1, 40)}) == 39


def test_english_numbers_are_words() -> None:
    words = words_of("en", {})
    assert [words.number(k) for k in (1, 2, 12, 21)] == ["first", "second", "twelfth", "twenty-first"]


def test_a_domain_can_lay_words_over_those_of_a_language() -> None:
    words = words_of("en", {"colors": {"red": "crimson"}})
    assert words.adjective("colors", "red", "one", "plain") == "crimson"
    assert words.adjective("colors", "blue", "one", "plain") == "blue"


def test_a_language_without_words_is_refused() -> None:
    with pytest.raises(QueryError, match="the language fr has no words for genders, cases"):
        words_of("fr", {"the": {"m": "le"}})


@pytest.mark.parametrize(
    ("whole", "written"),
    [
        ("Trage die Dose zu der Kiste.", "Trage die Dose zur Kiste."),
        ("Zu dem Tablett, von dem Tisch in das Tablett", "Zum Tablett, vom Tisch ins Tablett"),
        ("von den Tischen zu den Kisten", "von den Tischen zu den Kisten"),
        ("hierzu dem Tisch, in demselben", "hierzu dem Tisch, in demselben"),
        ("", ""),
    ],
)
def test_german_contracts_and_what_is_contracted_is_read_as_it_was(whole: str, written: str) -> None:
    words = words_of("de", {})
    assert words.contracted(whole) == written and words.expanded(written) == words.expanded(whole) == whole
    assert words_of("en", {}).contracted(whole) == words_of("en", {}).expanded(written + whole)[len(written) :]


def reported(check: Callable[[TableEntry], None]) -> list[str]:
    """Return the problems that a check of words reports."""
    entry = TableEntry(TableReport(), ("words",))
    check(entry)
    return list(map(str, entry.report.problems))


@pytest.mark.parametrize(
    ("words", "place"),
    [
        ({"repeated": "{deed} again"}, "repeated: has no other braces than action"),
        ({"varied": "{action} again"}, "varied: has {manner}, and no other braces than action, manner"),
        ({"was": {"one": "was", "several": ""}}, "was: has no form for several"),
        ({"joints": {"goal": [" and "]}}, "joints.goal: has to be of the same kind"),
    ],
)
def test_what_is_said_of_repeated_and_former_things_has_its_braces_and_forms(words: dict[str, Any], place: str) -> None:
    (line,) = reported(lambda entry: check_forms(entry, words_of("en", words)))
    assert line.startswith(f"words.{place}")


def test_contractions_that_could_be_read_in_two_ways_are_refused() -> None:
    own = {"contractions": {"zu dem": "zum", "zu einem": "zum"}}
    assert "words.contractions: zum stands for several texts, so it is ambiguous; leave one out" in reported(
        lambda entry: check_forms(entry, words_of("de", own))
    )
    (line,) = reported(lambda entry: check_forms(entry, words_of("de", {"contractions": {"zu dem": ""}})))
    assert line.startswith("words.contractions: ")
    assert reported(lambda entry: check_forms(entry, words_of("de", {}))) == []
    words = {"contractions": {"a": "b"}}
    assert reported(lambda entry: check_kinds(TableEntry(entry.report, entry.keys, words))) == []
