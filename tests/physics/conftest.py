from __future__ import annotations

from collections.abc import Iterator

import pytest

from prag_asp.physics import Validator, open_validator
from prag_asp.physics.world.simulator import Simulator, open_simulator
from prag_asp.scene.scene import Scene
from tests.physics.random_tasks import shipped_scene
from tests.sharing import shared_logic  # noqa: F401 - a fixture


@pytest.fixture(scope="session")
def tabletop() -> Scene:
    return shipped_scene("tabletop")


@pytest.fixture(scope="session")
def prag() -> Scene:
    return shipped_scene("prag")


@pytest.fixture(scope="session")
def tabletop_validator(tabletop: Scene) -> Iterator[Validator]:
    with open_validator(tabletop) as validator:
        yield validator


@pytest.fixture(scope="session")
def prag_validator(prag: Scene) -> Iterator[Validator]:
    with open_validator(prag) as validator:
        yield validator


@pytest.fixture
def simulator(tabletop: Scene) -> Iterator[Simulator]:
    with open_simulator(tabletop) as opened:
        yield opened
