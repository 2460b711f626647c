"""A player of 3D scenes that are .glb files: plain ES modules on WebGL 2, for any page.

The package has its own player to keep pages small: its modules take 26 KB, whereas meshcat 0.3.2 takes 853 KB, and
viser 1.1.1 takes 819 KB and needs a server with WebSockets. It reads only files that `gltf_file` writes.
"""

from __future__ import annotations

import re
from base64 import b64encode
from pathlib import Path

from prag_asp.html.markup import Markup, element
from prag_asp.html.page import html_page

PLAYER = Path(__file__).parent / "player"
"""The folder that contains the player's modules and style sheet."""

MODULES = ("matrices.js", "episode.js", "renderer.js", "orbit.js", "player.js")
"""The modules, ordered so that each one uses only names from earlier ones."""

START = """
const packed = atob(document.getElementById("episode").textContent);
showEpisode(document.getElementById("player"), Uint8Array.from(packed, (each) => each.charCodeAt(0)).buffer);
"""

IMPORT, EXPORT = re.compile(r"^import .*\n", re.MULTILINE), re.compile(r"^export ", re.MULTILINE)


def player_script() -> str:
    """Return all modules of the player as one module; its names are unique, so they need no imports."""
    texts = [(PLAYER / name).read_text(encoding="utf-8") for name in MODULES]
    return "".join(EXPORT.sub("", IMPORT.sub("", text)) for text in texts)


def player_page(title: str, content: bytes) -> str:
    """Return a self-contained page that plays the .glb file with this content."""
    return html_page(
        title,
        element("h1", title),
        element("div", id="player"),
        element("script", Markup(b64encode(content).decode("ascii")), type="application/octet-stream", id="episode"),
        styles=[(PLAYER / "player.css").read_text(encoding="utf-8")],
        scripts=[player_script() + START],
    )
