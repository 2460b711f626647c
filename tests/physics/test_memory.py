from __future__ import annotations

import gc
import os
from itertools import islice
from pathlib import Path

import pytest

from tests.physics.random_tasks import random_tasks

STATM = Path("/proc/self/statm")


@pytest.mark.skipif(not STATM.exists(), reason="the system does not tell how much memory a process has")
@pytest.mark.parametrize("name", ["tabletop", "prag"])
def test_the_memory_of_a_validator_is_flat_once_it_is_warm(name, request):
    validator = request.getfixturevalue(f"{name}_validator")
    tasks = [*islice(random_tasks(name, 3, 1), 40), *islice(random_tasks(name, 5, 2), 40)]
    sizes = []
    for seed in range(4):
        for index, task in enumerate(tasks):
            validator.validate(task, seed=seed, index=index)
        gc.collect()
        sizes.append(int(STATM.read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 2**20)
    assert sizes[-1] - sizes[0] < 5.0
