"""Check that built pages load nothing from another host, so that they can be read offline."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING

from mkdocs.exceptions import PluginError

if TYPE_CHECKING:
    from mkdocs.config.defaults import MkDocsConfig

SOURCES = re.compile(r"<(?:script|img|iframe|source|video)\b[^>]*\bsrc=\"?(https?:)?//[^\">\s]*")
LINKS = re.compile(r"<link\b[^>]*\brel=\"?(?:stylesheet|preconnect|icon)[^>]*href=\"?(?:https?:)?//[^\">\s]*")
IMPORTS = re.compile(r"(?:@import|url\()\s*[\"']?(?:https?:)?//[^\"')\s]*")


def on_post_build(config: MkDocsConfig) -> None:
    """Check all built pages and style sheets.

    Raises:
        PluginError: one loads a resource from another host.
    """
    site = Path(config.site_dir)
    for path in sorted([*site.rglob("*.html"), *site.rglob("*.css")]):
        text = path.read_text(encoding="utf-8")
        for pattern in (SOURCES, LINKS, IMPORTS):
            match = pattern.search(text)
            if match:
                raise PluginError(f"{path.relative_to(site)}: loads {match[0]}; pages must be readable offline")
