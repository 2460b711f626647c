"""The languages of the package are whole: each has every form, every colour, every predicate."""

from __future__ import annotations

from itertools import product

import pytest

from prag_asp import QueryError
from prag_asp.grammar.words import shipped_languages, shipped_table, words_of
from prag_asp.scene.vocabulary import VOCABULARY


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
