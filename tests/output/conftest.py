from __future__ import annotations

from collections.abc import Iterator

import pytest

from tests.sharing import logic_shared, small_pictures


@pytest.fixture(scope="package", autouse=True)
def logic() -> Iterator[None]:
    """Compute once what logic says of a domain, and draw small pictures."""
    with logic_shared(), small_pictures():
        yield
