"""The names of environments, which are registered when `prag_asp.rl` is imported."""

from __future__ import annotations

from typing import Any

from prag_asp.missing import require_gymnasium
from prag_asp.program.paths import shipped_domains

TASK_ENV = "prag_asp.rl.environment:TaskEnv"

LENGTH = "2..4"
"""The default number of actions in tasks."""

SKILLS: dict[str, dict[str, Any]] = {
    "PragApproach": {
        "domain": "prag",
        "length": 2,
        "stage": "approach",
        "until": "subgoal",
        "steps": 50,
        "action_scale": 0.5,
    },
    "PragGrasp": {
        "domain": "prag",
        "length": 2,
        "stage": "grasp",
        "until": "subgoal",
        "steps": 25,
        "action_scale": 0.5,
    },
    "TabletopPick": {
        "domain": "tabletop",
        "length": 2,
        "stage": "pick",
        "until": "subgoal",
        "steps": 50,
    },
}
"""The arguments of environments for single skills; an episode consists of one subgoal of the skill.

The step limits are about twice the number of steps that the scripted agent takes.
"""


def register_environments() -> None:
    """Register ``prag_asp/Task-v0``, ``prag_asp/Dataset-v0``, each shipped domain with a scene, and `SKILLS`.

    Raises:
        LearningMissingError: Gymnasium is not installed.
    """
    gymnasium = require_gymnasium()
    options: dict[str, dict[str, Any]] = {"Task": {}, "Dataset": {}, **SKILLS}
    for name, folder in shipped_domains().items():
        if "[scene]" in (folder / "domain.toml").read_text(encoding="utf-8").splitlines():
            options["".join(word.capitalize() for word in name.split("_"))] = {"domain": name, "length": LENGTH}
    for name, given in options.items():
        gymnasium.register(id=f"prag_asp/{name}-v0", entry_point=TASK_ENV, kwargs=given)
