from __future__ import annotations

from collections.abc import Mapping

import gymnasium
import numpy as np
import pytest

from prag_asp.errors import QueryError
from prag_asp.rl import TaskEnv
from prag_asp.rl.wrappers import ScriptedReach
from tests.rl.conftest import Given


def test_a_scripted_reach_brings_the_tool_to_the_body_and_an_action_adds_to_it(
    given: Mapping[str, list[Given]],
) -> None:
    still = np.zeros(5, dtype=np.float32)
    for task, witness in given["tabletop"][:3]:
        env = TaskEnv(task=task, witness=witness)
        reach = ScriptedReach(env, share=0.5)
        reach.reset()
        entity, nearest = task.actions[0].arguments[1], 1.0
        for _ in range(25):
            move = reach.action(still)
            assert np.abs(move[:3]).max() <= 1.0 and move[4] == 0.0
            added = reach.action(np.array([0.2, 0.0, 0.0, 0.0, 1.0], dtype=np.float32)) - move
            assert added[4] == 1.0 and (added[0] == pytest.approx(0.1, abs=1e-6) or move[0] > 0.9)
            reach.step(still)
            x, y, _ = np.subtract(env.situation.body(entity).centre, env.situation.tool("panda").position)
            nearest = min(nearest, float(np.hypot(x, y)))
        assert nearest < 0.02
        reach.reset(options={"stage": 1})
        assert reach.action(still).tolist() == [0.0, 0.0, 1.0, 0.0, 0.0], "what is held is lifted"
        env.close()


def test_what_cannot_be_reached_with_is_refused(given: Mapping[str, list[Given]]) -> None:
    task, witness = given["tabletop"][0]
    joints = TaskEnv(task=task, witness=witness, control="joint_delta")
    for env, share in ((joints, 0.5), (gymnasium.Env(), 0.5), (TaskEnv(task=task, witness=witness), 0.0)):
        with pytest.raises(QueryError):
            ScriptedReach(env, share)
        env.close()
