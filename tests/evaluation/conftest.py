from __future__ import annotations

from tests.sharing import pictures_are_small, shared_logic  # noqa: F401 - fixtures
