"""A plugin of pytest that runs one case of each test: all cases of a test import the same packages.

The bad domains are the exception, for each of them has a check of its own.
"""

from __future__ import annotations

import pytest

ALL = ("test_bad_domains.py",)
"""Files with tests that run in all cases."""


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    first = {item.nodeid.partition("[")[0]: item for item in reversed(items)}
    chosen = [item for item in items if item.path.name in ALL or first[item.nodeid.partition("[")[0]] is item]
    config.hook.pytest_deselected(items=[item for item in items if item not in chosen])
    items[:] = chosen
