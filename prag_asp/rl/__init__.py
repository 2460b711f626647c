"""Reinforcement learning: a Gymnasium environment over task spaces, rewards, curricula, and chains of skills.

>>> import gymnasium
>>> env = gymnasium.make("prag_asp.rl:prag_asp/Tabletop-v0", length=2)
>>> observation, info = env.reset(seed=0)
>>> info["task"]
'pick(panda,brick_1,table_1) place(panda,brick_1,behind,can_1)'
>>> env.close()

The names of environments are in `prag_asp.rl.registration`. Importing this package raises `LearningMissingError` if
Gymnasium is not installed.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from prag_asp.lazy import names_from
from prag_asp.rl.registration import register_environments

if TYPE_CHECKING:
    from prag_asp.dataset.pass_rates import Rate
    from prag_asp.rl.curriculum.bandit import BanditCurriculum
    from prag_asp.rl.curriculum.growing_length import LengthCurriculum
    from prag_asp.rl.curriculum.learning_progress import AdaptiveCurriculum
    from prag_asp.rl.curriculum.novelty import NoveltyCurriculum
    from prag_asp.rl.curriculum.reverse_curriculum import ReverseCurriculum
    from prag_asp.rl.environment import TaskEnv
    from prag_asp.rl.episode_replay import Replay, replay
    from prag_asp.rl.observations import Layout
    from prag_asp.rl.scripted_agent import OraclePolicy, oracle
    from prag_asp.rl.skill_chains import Rollout, Rollouts, run

__all__ = [
    "AdaptiveCurriculum",
    "BanditCurriculum",
    "Layout",
    "LengthCurriculum",
    "NoveltyCurriculum",
    "OraclePolicy",
    "Rate",
    "Replay",
    "ReverseCurriculum",
    "Rollout",
    "Rollouts",
    "TaskEnv",
    "oracle",
    "replay",
    "run",
]  # fmt: skip

register_environments()

_HOMES = {
    "prag_asp.rl.curriculum.learning_progress": ("AdaptiveCurriculum",),
    "prag_asp.rl.curriculum.reverse_curriculum": ("ReverseCurriculum",),
    "prag_asp.rl.curriculum.bandit": ("BanditCurriculum",),
    "prag_asp.rl.curriculum.growing_length": ("LengthCurriculum",),
    "prag_asp.rl.curriculum.novelty": ("NoveltyCurriculum",),
    "prag_asp.rl.environment": ("TaskEnv",),
    "prag_asp.rl.observations": ("Layout",),
    "prag_asp.rl.episode_replay": ("Replay", "replay"),
    "prag_asp.rl.skill_chains": ("Rollout", "Rollouts", "run"),
    "prag_asp.dataset.pass_rates": ("Rate",),
    "prag_asp.rl.scripted_agent": ("OraclePolicy", "oracle"),
}

__getattr__ = names_from(__name__, _HOMES)


def __dir__() -> list[str]:
    return __all__
