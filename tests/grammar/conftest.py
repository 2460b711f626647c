from __future__ import annotations

from tests.sharing import shared_logic  # noqa: F401 - a fixture
