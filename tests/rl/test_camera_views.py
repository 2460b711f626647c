"""What cameras see of an environment."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Mapping
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

from prag_asp.errors import QueryError
from prag_asp.physics import Situation
from prag_asp.rl import TaskEnv
from prag_asp.rl.camera_views import Viewer
from prag_asp.scene.scene import Scene
from tests.rl.conftest import Given


@pytest.mark.filterwarnings("ignore:.*infinity.*", "ignore:.*not within the observation space.*")
def test_gymnasium_finds_nothing_wrong_with_pictures(given: Mapping[str, list[Given]]) -> None:
    task, witness = given["tabletop"][0]
    asked: dict[str, Any] = {"task": task, "witness": witness, "cameras": ("front", "wrist"), "size": (40, 32)}
    checked = gymnasium.make("prag_asp/Task-v0", render_mode="rgb_array", **asked)
    check_env(checked.unwrapped)
    checked.close()
    env = TaskEnv(**asked, render_mode="rgb_array")
    observation, _ = env.reset()
    seen = observation["camera_front"]
    assert seen.shape == (32, 40, 3) and seen.dtype == np.uint8 and env.observation_space.contains(observation)
    assert np.array_equal(env.render(), seen), "the first camera is what is rendered"
    for _ in range(4):
        after, *_ = env.step(np.array([0.0, 1.0, 0.0, 0.0, 0.0]))
    assert (after["camera_front"] != seen).mean() > 0.01, "the arm has moved"
    env.close()


def test_other_bodies_are_seen_in_the_next_episode(given: Mapping[str, list[Given]]) -> None:
    (task, witness), (other, another) = given["tabletop"][:2]
    env = TaskEnv(task=task, witness=witness, render_mode="rgb_array", size=48)
    with pytest.raises(QueryError, match="no episode"):
        env.render()
    env.reset()
    first = env.render()
    env.reset(options={"task": other, "witness": another})
    second = env.render()
    env.reset()
    assert first is not None and second is not None and first.shape == (48, 48, 3)
    assert not np.array_equal(first, second) and np.array_equal(env.render(), first)
    env.close()
    plain = TaskEnv(task=task, witness=witness)
    plain.reset()
    assert plain.render() is None
    plain.close()


def test_a_camera_sees_how_far_furniture_is_open(scenes: Mapping[str, Scene], given: Mapping[str, list[Given]]) -> None:
    scene, (_, witness) = scenes["kitchen"], given["kitchen"][0]
    moment = witness.moments[0]
    situation = Situation(scene, moment.poses, moment.arms, moment.openings)
    with ExitStack() as resources:
        viewer = Viewer(scene, ("front",), 64, resources)
        for name in moment.openings:
            seen = [viewer.image(situation.with_opening(name, opening)) for opening in (0.0, 0.2, 0.0)]
            assert np.array_equal(seen[0], seen[2]) and (seen[0] != seen[1]).any()


def test_cameras_and_curricula_leave_nothing_behind_and_print_nothing(tmp_path: Path) -> None:
    code = (
        "import gymnasium, prag_asp.rl as rl; from prag_asp import TaskSpace, load_domain\n"
        "if __name__ == '__main__':\n"
        "    asked = {'space': TaskSpace(load_domain('tabletop'), length=1), 'cameras': ('front',), 'size': 32,\n"
        "        'curriculum': (rl.NoveltyCurriculum('tasks'), rl.ReverseCurriculum()), 'steps': 1,\n"
        "        'render_mode': 'rgb_array'}\n"
        "    env = gymnasium.make('prag_asp/Task-v0', **asked)\n"
        "    for seed in range(3): env.reset(seed=seed); env.step(env.action_space.sample()); env.render()\n"
        "    env.close(); env.close(); env.reset(); env.close()\n"
        "    envs = gymnasium.make_vec('prag_asp/Task-v0', 1, vectorization_mode='async', **asked)\n"
        "    envs.reset(seed=0); envs.close()\n"
    )
    script, left = tmp_path / "script.py", tmp_path / "left"
    script.write_text(code)
    left.mkdir()
    environment = {**os.environ, "TMPDIR": str(left)}
    run = subprocess.run([sys.executable, script], capture_output=True, text=True, check=False, env=environment)
    assert (run.returncode, run.stdout, run.stderr) == (0, "", "")
    assert not list(left.iterdir())
