"""Build HTML from plain strings, which are escaped."""

from __future__ import annotations

import json
from collections.abc import Iterable
from html import escape
from typing import Any

VOID = frozenset(["br", "col", "hr", "img", "input", "link", "meta"])
"""Elements without content, which have no end tag."""


class Markup(str):
    """A string that is already HTML; every other string is escaped."""

    __slots__ = ()


def element(name: str, /, *content: str, **attributes: str | int | float | bool | None) -> Markup:
    """Return an element with its attributes and content; strings that are not `Markup` are escaped.

    A final underscore in an attribute's name is left out (``class_``), and other underscores become hyphens. An
    attribute that is None or False is left out; one that is True has no value.
    """
    given = "".join(
        f" {_attribute_name(key)}" if value is True else f' {_attribute_name(key)}="{escape(str(value))}"'
        for key, value in attributes.items()
        if value is not None and value is not False
    )
    return Markup(f"<{name}{given}>" if name in VOID else f"<{name}{given}>{joined(content)}</{name}>")


def _attribute_name(key: str) -> str:
    return key.removesuffix("_").replace("_", "-")


def joined(parts: Iterable[str]) -> Markup:
    """Return the markup of all parts in order; strings that are not `Markup` are escaped."""
    return Markup("".join(part if isinstance(part, Markup) else escape(part) for part in parts))


def json_block(name: str, values: Any) -> Markup:
    """Return an element that holds JSON values for a script on the page; `name` is its id.

    Characters that could end the element are escaped in a way that JSON allows.
    """
    text = json.dumps(values, ensure_ascii=False, allow_nan=False, separators=(",", ":"))
    safe = text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")
    return element("script", Markup(safe), type="application/json", id=name)
