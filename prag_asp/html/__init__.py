"""Self-contained HTML pages: markup that escapes its texts, tables in scrolling boxes, and one style sheet.

>>> from prag_asp.html import element, scroll_table
>>> element("p", "a < b", class_="note")
'<p class="note">a &lt; b</p>'
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from prag_asp.lazy import names_from

if TYPE_CHECKING:
    from prag_asp.html.markup import Markup, element, joined, json_block
    from prag_asp.html.page import fragment, html_page, scroll_table, style_sheet

__all__ = ["Markup", "element", "fragment", "html_page", "joined", "json_block", "scroll_table", "style_sheet"]

_HOMES = {
    "prag_asp.html.markup": ("Markup", "element", "joined", "json_block"),
    "prag_asp.html.page": ("fragment", "html_page", "scroll_table", "style_sheet"),
}

__getattr__ = names_from(__name__, _HOMES)
