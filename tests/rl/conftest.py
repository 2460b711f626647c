from __future__ import annotations

from collections.abc import Iterator, Mapping

import pytest

from prag_asp import Dataset, Task, TaskSpace, load_domain
from prag_asp.dataset import generate
from prag_asp.dataset.scenes import scene_of
from prag_asp.physics import Witness, open_validator
from prag_asp.scene.scene import Scene
from tests.sharing import automata_are_cached, pictures_are_small, shared_logic  # noqa: F401 - fixtures

Given = tuple[Task, Witness]
DOMAINS = ("tabletop", "prag", "kitchen", "two_arms")


@pytest.fixture(scope="session")
def scenes() -> Mapping[str, Scene]:
    return {name: scene_of(load_domain(name)) for name in DOMAINS}


@pytest.fixture(scope="session")
def given(scenes: Mapping[str, Scene]) -> Mapping[str, list[Given]]:
    """Some tasks of four actions, with witnesses, of each domain, found when a test asks for the domain."""

    class Found(dict[str, list[Given]]):
        def __missing__(self, name: str) -> list[Given]:
            self[name] = list(feasible(name, scenes[name]))
            return self[name]

    return Found()


@pytest.fixture(scope="session")
def dataset(tmp_path_factory: pytest.TempPathFactory) -> Dataset:
    """Four tasks of two actions, each with two witnesses."""
    space = TaskSpace(load_domain("tabletop"), length=2)
    return generate(space, tmp_path_factory.mktemp("rl") / "data", tasks=4, starts=2, seed=1)


def feasible(name: str, scene: Scene, count: int = 6) -> Iterator[Given]:
    found = 0
    with open_validator(scene) as validator:
        for index, task in enumerate(TaskSpace(load_domain(name), length=4).stream(seed=5)):
            witness = validator.validate(task, seed=5, index=index).witness
            if witness is not None:
                yield task, witness
                found += 1
            if found == count:
                return
