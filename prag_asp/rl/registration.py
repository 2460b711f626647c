"""The names of environments, which importing `prag_asp.rl` registers."""

from __future__ import annotations

from prag_asp.missing import require_gymnasium
from prag_asp.program.paths import shipped_domains

TASK_ENV = "prag_asp.rl.environment:TaskEnv"

LENGTH = "2..4"
"""The default number of actions of tasks."""


def register_environments() -> None:
    """Register ``prag_asp/Task-v0``, ``prag_asp/Dataset-v0``, and one environment for each shipped domain with a scene.

    Raises:
        LearningMissingError: Gymnasium is not installed.
    """
    gymnasium = require_gymnasium()
    options: dict[str, dict[str, str]] = {"Task": {}, "Dataset": {}}
    for name, folder in shipped_domains().items():
        if "[scene]" in (folder / "domain.toml").read_text(encoding="utf-8").splitlines():
            options["".join(word.capitalize() for word in name.split("_"))] = {"domain": name, "length": LENGTH}
    for name, given in options.items():
        gymnasium.register(id=f"prag_asp/{name}-v0", entry_point=TASK_ENV, kwargs=given)
