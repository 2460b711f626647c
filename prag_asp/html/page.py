"""The skeleton of a self-contained page, its style sheet, and tables that scroll inside their boxes."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from functools import cache
from pathlib import Path

from prag_asp.html.markup import Markup, element, joined

POLICY = "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data:"
"""What a page may load: only its own styles, scripts and pictures, so it works offline and sends nothing."""


NUMBER = re.compile(r"[-+]?[\d,]*\.?\d*(e[-+]?\d+)?( ?%)?|-|\d+ digits")
"""The pattern of a cell in a column of numbers; a cell may be empty."""


def html_page(title: str, *parts: str, styles: Iterable[str] = (), scripts: Iterable[str] = ()) -> str:
    """Return a page that needs no other file: its title, its style sheets, its parts in order, and its scripts.

    `scripts` are the sources of ES modules, which run after the parts have been parsed.
    """
    head = joined(
        [
            element("meta", charset="utf-8"),
            element("meta", name="viewport", content="width=device-width, initial-scale=1"),
            element("meta", http_equiv="Content-Security-Policy", content=POLICY),
            element("title", title),
            *(element("style", Markup(each)) for each in (style_sheet(), *styles)),
        ]
    )
    run = joined(element("script", Markup(each), type="module") for each in scripts)
    body = element("body", element("main", *parts), run, class_="prag")
    return f"<!doctype html>\n{element('html', element('head', head), body, lang='en')}\n"


def fragment(*parts: str) -> Markup:
    """Return parts with the style sheet, for use in another page, such as a notebook, without changing the rest."""
    return element("div", element("style", Markup(style_sheet())), *parts, class_="prag")


def scroll_table(heads: Sequence[str], rows: Iterable[Sequence[str]], *, label: str, most: int | None = None) -> Markup:
    """Return a table in a box that scrolls if the table is wider than the page; columns of numbers are right-aligned.

    `label` names the table for screen readers. If there are more than `most` rows, the rest are left out, and a last
    row says how many.
    """
    listed = list(rows)
    shown = listed if most is None else listed[:most]
    columns = zip(*shown, strict=True) if shown else ((),) * len(heads)
    sides = [None if shown and all(map(NUMBER.fullmatch, column)) else "left" for column in columns]
    head = element(
        "tr", *(element("th", text, class_=side, scope="col") for text, side in zip(heads, sides, strict=True))
    )
    body = [
        element("tr", *(element("td", text, class_=side) for text, side in zip(row, sides, strict=True)))
        for row in shown
    ]
    if len(shown) < len(listed):
        more = f"and {len(listed) - len(shown):,} more"
        body.append(element("tr", element("td", more, class_="left", colspan=len(heads))))
    table = element("table", element("thead", head), element("tbody", *body))
    return element("div", table, class_="scroll", role="region", tabindex=0, aria_label=label)


@cache
def style_sheet() -> str:
    """Return the style sheet for all pages: colours as CSS variables, light and dark, down to a phone's width."""
    return Path(__file__).with_name("style.css").read_text(encoding="utf-8")
