"""An environment for LeRobot's EnvHub: the root of a repository on the Hub needs only this file."""

import os
from functools import partial

import gymnasium

import prag_asp.rl  # noqa: F401  registers the environments
from prag_asp.evaluation.lerobot_view import LeRobotView

STEPS = 100
OPTIONS = {"domain": "tabletop", "length": 1, "steps": STEPS, "control": "joint_position", "reward": "sparse"}
OPTIONS["render_mode"] = "rgb_array"  # for the videos of an evaluation


def make_task(cameras):
    """Make one environment, with observations and actions as in `prag-asp export lerobot`."""
    env = gymnasium.make("prag_asp/Task-v0", cameras=cameras, size=128 if cameras else None, **OPTIONS)
    return LeRobotView(env, STEPS)


def make_env(n_envs=1, use_async_envs=False, cfg=None):
    """Return the environments as LeRobot expects them: {suite: {number of the task: vector environment}}."""
    cameras = tuple(filter(None, os.environ.get("PRAG_ASP_CAMERAS", "").split(",")))
    kind = gymnasium.vector.AsyncVectorEnv if use_async_envs else gymnasium.vector.SyncVectorEnv
    made = kind([partial(make_task, cameras)] * n_envs, autoreset_mode=gymnasium.vector.AutoresetMode.SAME_STEP)
    return {"prag_asp": {0: made}}
