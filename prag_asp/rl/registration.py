"""The names of environments, registered by the entry point ``gymnasium.envs`` of the package.

This module imports no simulator or logic solver, because ``import gymnasium`` runs it.
"""

from __future__ import annotations

from prag_asp.program.paths import shipped_domains

TASK_ENV = "prag_asp.rl.environment:TaskEnv"

LENGTH = "2..4"
"""The default number of actions of tasks."""


def register_environments() -> None:
    """Register ``prag_asp/Task-v0``, ``prag_asp/Dataset-v0``, and one environment for each shipped domain with a scene.

    An environment that is already registered is unchanged.
    """
    from gymnasium.envs.registration import register, registry  # noqa: PLC0415 - Gymnasium may call this function

    options: dict[str, dict[str, str]] = {"Task": {}, "Dataset": {}}
    for name, folder in shipped_domains().items():
        if "[scene]" in (folder / "domain.toml").read_text(encoding="utf-8").splitlines():
            options["".join(word.capitalize() for word in name.split("_"))] = {"domain": name, "length": LENGTH}
    for name, given in options.items():
        if f"prag_asp/{name}-v0" not in registry:
            register(id=f"prag_asp/{name}-v0", entry_point=TASK_ENV, kwargs=given)
