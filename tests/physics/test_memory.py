"""The memory of validating, in a process of its own: what other tests leave in one says nothing about a validator."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
STATM = Path("/proc/self/statm")
VALIDATED_IN_ROUNDS = """
import gc, resource, sys
from itertools import islice
from pathlib import Path
from prag_asp.physics import open_validator
from tests.physics.random_tasks import random_tasks, shipped_scene

name = sys.argv[1]
tasks = [*islice(random_tasks(name, 3, 1), 20), *islice(random_tasks(name, 5, 2), 20)]
with open_validator(shipped_scene(name)) as validator:
    for seed in range(12):
        for index, task in enumerate(tasks):
            validator.validate(task, seed=seed, index=index)
        gc.collect()
        print(int(Path("/proc/self/statm").read_text().split()[1]) * resource.getpagesize())
"""


@pytest.mark.skipif(not STATM.exists(), reason="the system does not report the memory of a process")
@pytest.mark.parametrize("name", ["tabletop", "prag"])
def test_the_memory_of_a_validator_is_flat_once_it_is_warm(name: str) -> None:
    command = [sys.executable, "-c", VALIDATED_IN_ROUNDS, name]
    output = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout
    sizes = [int(line) / 2**20 for line in output.split()]
    assert len(sizes) == 12 and sizes[-1] - sizes[8] < 1.0
