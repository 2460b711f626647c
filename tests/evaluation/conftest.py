from __future__ import annotations

from tests.sharing import automata_are_cached, pictures_are_small, shared_logic  # noqa: F401 - fixtures
