"""Sentences are filled in and found again, in every way that there is; wrong braces are message."""

from __future__ import annotations

import pytest

from prag_asp import QueryError
from prag_asp.grammar.template import parse_template


def test_a_sentence_that_is_filled_in_is_found_again_in_the_text() -> None:
    template = parse_template("put {1} on {2:dat}, please", ("acc", "dat"), 3)
    assert template.arguments == (1, 2) and [slot.case for slot in template.slots] == ["", "dat"]
    text = template.fill(["the cup", "the tray"])
    assert text == "put the cup on the tray, please"
    assert list(template.find(text)) == [("the cup", "the tray")]


def test_all_ways_to_split_a_text_are_found() -> None:
    template = parse_template("put {0} on {1}", ("plain",), 2)
    text = "put the cup on the box on the tray"
    assert set(template.find(text)) == {("the cup", "the box on the tray"), ("the cup on the box", "the tray")}
    assert list(template.find(text, {"the cup", "the box on the tray"}.__contains__)) == [
        ("the cup", "the box on the tray")
    ]


def test_what_is_missing_in_a_text_is_not_found() -> None:
    template = parse_template("put {0} on {1}", ("plain",), 2)
    for text in ("", "put", "put  on ", "put the cup", "put the cup on ", "lift the cup on the tray"):
        assert not list(template.find(text)), text
    assert list(parse_template("wait", ("plain",), 0).find("wait")) == [()]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("put {2}", r"has braces that name no argument; use \{0\}, \{1\}"),
        ("put {what}", "has braces that name no argument"),
        ("put {0", "has braces that do not match"),
        ("put {0!r}", "has braces that do not match"),
        ("put {0:{1}}", "has braces that do not match"),
        ("put {0:abl}", r"has \{0:abl\}, which is not a case; cases are acc, dat"),
        ("put {0}{1}", "two pairs of braces side by side"),
        (" ", "is empty"),
    ],
)
def test_wrong_braces_are_reported(text: str, message: str) -> None:
    with pytest.raises(QueryError, match=message):
        parse_template(text, ("acc", "dat"), 2)
