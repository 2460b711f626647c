from __future__ import annotations

import pytest

from prag_asp.errors import QueryError
from prag_asp.physics import Budget, Staging, validate_tasks
from tests.physics.scenarios import stacking

STAGED = Staging(("front", "wrist"), (24, 16), rate=2, vary=("friction", "light", "camera", "colour"))


def test_what_is_filmed_and_what_varies_does_not_depend_on_the_number_of_workers(tabletop, tmp_path):
    how = {"seed": 4, "budget": Budget(tier="demonstration"), "staging": STAGED}
    found = []
    for workers in (1, 2):
        shown = [
            verdict.demonstration for verdict in validate_tasks([stacking()] * 2, tabletop, workers=workers, **how)
        ]
        for i, each in enumerate(shown):
            each.save(tmp_path / f"{workers}_{i}.npz")
        found.append([(tmp_path / f"{workers}_{i}.npz").read_bytes() for i in range(2)])
    assert found[0] == found[1]
    assert shown[0].variation != shown[1].variation
    poses = [each.footage.videos["front"].extrinsics[0] for each in shown]
    assert (poses[0] != poses[1]).any(), "the camera that films is the one that was drawn"


def test_an_unknown_camera_is_refused_before_a_task_is_taken(tabletop):
    with pytest.raises(QueryError, match="no camera side"):
        validate_tasks(iter(int, 1), tabletop, seed=0, staging=Staging(("side",)))
