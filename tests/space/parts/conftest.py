"""What logic says of a domain is computed once for the tests of this room: how it is parted is their matter."""

from __future__ import annotations

from tests.sharing import shared_logic  # noqa: F401 - a fixture
