"""What logic says of a domain is computed once for the tests of this room: what is drawn from it is their matter."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from tests.sharing import logic_shared


@pytest.fixture(scope="package", autouse=True)
def logic() -> Iterator[None]:
    """Compute once what logic says of a domain."""
    with logic_shared():
        yield
