"""Refuse to publish pages that need anything from another host: they are read without a network, from a folder."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING

from mkdocs.exceptions import PluginError

if TYPE_CHECKING:
    from mkdocs.config.defaults import MkDocsConfig

LOADED = re.compile(r"<(?:script|img|iframe|source|video)\b[^>]*\bsrc=\"?(https?:)?//[^\">\s]*")
STYLED = re.compile(r"<link\b[^>]*\brel=\"?(?:stylesheet|preconnect|icon)[^>]*href=\"?(?:https?:)?//[^\">\s]*")
IMPORTED = re.compile(r"(?:@import|url\()\s*[\"']?(?:https?:)?//[^\"')\s]*")


def on_post_build(config: MkDocsConfig) -> None:
    """Look through all pages and styles that were built.

    Raises:
        PluginError: one loads something from another host.
    """
    site = Path(config.site_dir)
    for path in sorted([*site.rglob("*.html"), *site.rglob("*.css")]):
        text = path.read_text(encoding="utf-8")
        for pattern in (LOADED, STYLED, IMPORTED):
            found = pattern.search(text)
            if found:
                raise PluginError(f"{path.relative_to(site)}: loads {found[0]}; pages are read without a network")
