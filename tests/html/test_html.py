"""Markup escapes every text, and a page needs nothing but itself."""

from __future__ import annotations

import json
import re
from html.parser import HTMLParser

from hypothesis import given
from hypothesis import strategies as st

from prag_asp.html import Markup, element, fragment, html_page, joined, json_block, scroll_table, style_sheet


class Reader(HTMLParser):
    """Collects the texts, the tags and the attributes of a page."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.texts, self.tags, self.values = [], [], {}
        self.feed(text)
        self.close()

    def handle_data(self, data: str) -> None:
        self.texts.append(data)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        self.values.update(attrs)


TEXTS = st.text(st.sampled_from("<>&\"'/ab ]-!"), max_size=12)


@given(TEXTS, TEXTS)
def test_any_text_reads_back_as_itself_in_content_and_attributes(text: str, value: str) -> None:
    read = Reader(element("p", text, title=value))
    assert ("".join(read.texts), read.values, read.tags) == (text, {"title": value}, ["p"])


def test_markup_is_not_escaped_again_and_attributes_follow_the_names_of_html() -> None:
    inner = element("b", "a & b")
    assert element("p", inner, "<", class_="x", aria_label="y", hidden=True, id=None) == Markup(
        '<p class="x" aria-label="y" hidden><b>a &amp; b</b>&lt;</p>'
    )
    assert joined(["<", element("br")]) == "&lt;<br>"


@given(st.recursive(TEXTS | st.integers() | st.none(), lambda inner: st.lists(inner) | st.dictionaries(TEXTS, inner)))
def test_json_in_a_page_never_ends_its_element(values: object) -> None:
    read = Reader(json_block("data", values))
    assert read.tags == ["script"] and json.loads("".join(read.texts)) == values


def test_columns_of_numbers_are_right_aligned_and_left_out_rows_are_counted() -> None:
    rows = [("a", "1,000", "12.5 %", "x"), ("b", "", "-", "1"), ("c", "3", "1e-09", "2")]
    table = scroll_table(("name", "n", "share", "kind"), rows, label="some")
    assert '<td class="left">a</td><td>1,000</td><td>12.5 %</td><td class="left">x</td>' in table
    assert table.startswith('<div class="scroll" role="region" tabindex="0" aria-label="some"><table>')
    assert "and 2 more" in scroll_table(("name", "n", "share", "kind"), rows, label="some", most=1)
    assert Reader(scroll_table(("a", "b"), [], label="none")).texts == ["a", "b"]


def test_a_page_loads_nothing_and_has_its_parts_in_order() -> None:
    page = html_page("a < b", element("h1", "title"), styles=["p{color:red}"], scripts=["document.title = '1 < 2'"])
    assert "<title>a &lt; b</title>" in page and "default-src &#x27;none&#x27;" in page
    assert "document.title = '1 < 2'" in page and page.index("p{color:red}") < page.index("<h1>")
    assert not re.search(r"<(link|img|iframe)|@import|url\(|://", page)


def test_every_rule_of_the_style_sheet_stands_under_its_class() -> None:
    rules = re.sub(r"/\*.*?\*/|@media[^{]*\{|\{[^{}]*\}", "|", style_sheet(), flags=re.DOTALL)
    selectors = [each.strip() for each in re.split(r"[|,}]", rules) if each.strip()]
    assert len(selectors) > 20 and all(re.match(r"(body)?\.prag\b", each) for each in selectors)
    assert fragment("x").startswith('<div class="prag"><style>')
