"""Reinforcement learning: a Gymnasium environment over task spaces, its rewards, curricula, and chains of skills.

>>> import gymnasium, prag_asp.rl
>>> from prag_asp import TaskSpace, load_domain
>>> env = gymnasium.make("prag_asp/Task-v0", space=TaskSpace(load_domain("tabletop"), length=2))
>>> observation, info = env.reset(seed=0)
>>> info["task"]
'pick(panda,brick_1,table_1) place(panda,brick_1,behind,can_1)'
>>> env.close()

Importing it registers ``prag_asp/Task-v0``; it raises `LearningMissingError` where Gymnasium is not installed.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from prag_asp.lazy import names_from
from prag_asp.missing import require_gymnasium

if TYPE_CHECKING:
    from prag_asp.rl.curriculum.bandit import BanditCurriculum
    from prag_asp.rl.curriculum.growing_length import LengthCurriculum
    from prag_asp.rl.curriculum.learning_progress import AdaptiveCurriculum
    from prag_asp.rl.curriculum.novelty import NoveltyCurriculum
    from prag_asp.rl.curriculum.reverse_curriculum import ReverseCurriculum
    from prag_asp.rl.environment import TaskEnv
    from prag_asp.rl.observations import Layout
    from prag_asp.rl.scripted_agent import OraclePolicy, oracle
    from prag_asp.rl.skill_chains import Rate, Rollout, Rollouts, run

__all__ = [
    "AdaptiveCurriculum",
    "BanditCurriculum",
    "Layout",
    "LengthCurriculum",
    "NoveltyCurriculum",
    "OraclePolicy",
    "Rate",
    "ReverseCurriculum",
    "Rollout",
    "Rollouts",
    "TaskEnv",
    "oracle",
    "run",
]  # fmt: skip

require_gymnasium().register(id="prag_asp/Task-v0", entry_point="prag_asp.rl.environment:TaskEnv")

_HOMES = {
    "prag_asp.rl.curriculum.learning_progress": ("AdaptiveCurriculum",),
    "prag_asp.rl.curriculum.reverse_curriculum": ("ReverseCurriculum",),
    "prag_asp.rl.curriculum.bandit": ("BanditCurriculum",),
    "prag_asp.rl.curriculum.growing_length": ("LengthCurriculum",),
    "prag_asp.rl.curriculum.novelty": ("NoveltyCurriculum",),
    "prag_asp.rl.environment": ("TaskEnv",),
    "prag_asp.rl.observations": ("Layout",),
    "prag_asp.rl.skill_chains": ("Rate", "Rollout", "Rollouts", "run"),
    "prag_asp.rl.scripted_agent": ("OraclePolicy", "oracle"),
}

__getattr__ = names_from(__name__, _HOMES)


def __dir__() -> list[str]:
    return __all__
