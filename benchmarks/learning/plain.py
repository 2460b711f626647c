"""Success of agents with their default settings: python benchmarks/learning/plain.py.

Each agent of Stable-Baselines3 is trained in an environment by its name, without own settings and, except with
`--reach`, without wrappers, with one seed for the agent and the tasks. It is then tested in 30 episodes whose tasks and
initial states have another seed; settings of the package were chosen with a third one.

Appends to plain.parquet in the folder --output; results in the file are not computed again. Requires the extra
`learning`; 10,000 steps take two to three minutes of processor time.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import click
import gymnasium
import pyarrow as pa
import pyarrow.parquet as pq
import torch
from rich.console import Console
from rich.table import Table
from sb3_contrib import TQC
from stable_baselines3 import SAC
from stable_baselines3.common.base_class import BaseAlgorithm

from prag_asp.rl import Rate
from prag_asp.rl.wrappers import ScriptedReach

AGENTS = {"SAC": SAC, "TQC": TQC}

SKILLS = ("PragApproach", "PragGrasp")

KIND = ("skill", "agent", "reach", "steps")
"""The columns that distinguish the rows of a table."""

FRESH = 20_000
"""The seed of the first test; that of an agent is added."""


@click.command()
@click.option("--agent", "agents", type=click.Choice([*AGENTS]), multiple=True, default=[*AGENTS], show_default=True)
@click.option("--skill", "skills", multiple=True, default=SKILLS, show_default=True, help="Names of environments.")
@click.option("--reach", is_flag=True, help="Add the actions to a scripted reach.")
@click.option("--steps", type=int, default=10_000, show_default=True, help="Training steps.")
@click.option("--seeds", type=int, default=3, show_default=True, help="Agents of each kind.")
@click.option("--tests", type=int, default=30, show_default=True, help="Test episodes of each agent.")
@click.option("--output", type=Path, default=Path("learned"), help="The folder of the results.")
@click.option("--models", type=Path, help="A folder for the trained agents.")
def main(
    agents: Sequence[str],
    skills: Sequence[str],
    reach: bool,
    steps: int,
    seeds: int,
    tests: int,
    output: Path,
    models: Path | None,
) -> None:
    """Train the missing agents, test them, and print the table."""
    torch.set_num_threads(1)
    output.mkdir(parents=True, exist_ok=True)
    path = output / "plain.parquet"
    rows: list[dict[str, Any]] = pq.read_table(path).to_pylist() if path.exists() else []
    for seed in range(seeds):
        for agent, skill in ((agent, skill) for agent in agents for skill in skills):
            key = {"agent": agent, "skill": skill, "reach": reach, "steps": steps, "seed": seed}
            if any(key.items() <= row.items() for row in rows):
                continue
            before = time.process_time()
            env = gymnasium.make(f"prag_asp.rl:prag_asp/{skill}-v0")
            env = ScriptedReach(env) if reach else env
            model = AGENTS[agent]("MlpPolicy", env, seed=seed, device="cpu").learn(steps)
            seconds = time.process_time() - before
            rate = tested(model, env, tests, seed=FRESH + seed)
            Console(stderr=True).print(f"{agent}, {skill}, seed {seed}, {seconds:.0f} s: {rate}")
            rows.append({**key, **rate._asdict(), "processor_seconds": round(seconds, 1)})
            pq.write_table(pa.Table.from_pylist(rows), path)
            if models is not None:
                model.save(models / f"{agent}_{skill}_{seed}")
            env.close()
    Console().print(table(rows))


def tested(model: BaseAlgorithm, env: gymnasium.Env[Any, Any], tests: int, *, seed: int) -> Rate:
    """Return the success rate of an agent in episodes sampled with a seed."""
    successes = 0
    for number in range(tests):
        seen, _ = env.reset(seed=seed if number == 0 else None)
        reached = late = False
        while not reached and not late:
            seen, _, reached, late, _ = env.step(model.predict(seen, deterministic=True)[0])
        successes += reached
    return Rate(successes, tests)


def table(rows: Sequence[dict[str, Any]]) -> Table:
    """Return the table of the rates, of each agent and of all seeds together."""
    result = Table("environment", "agent", "steps", "seeds", "all", "processor seconds of a seed")
    for kind in dict.fromkeys(tuple(row[name] for name in KIND) for row in rows):
        own = [row for row in rows if tuple(row[name] for name in KIND) == kind]
        each = ", ".join(f"{row['successes'] / row['trials']:.2f}" for row in own)
        together = Rate(sum(row["successes"] for row in own), sum(row["trials"] for row in own))
        seconds = sum(row["processor_seconds"] for row in own) / len(own)
        skill, agent, reach, steps = kind
        result.add_row(skill, agent + ", reach" * reach, f"{steps:,}", each, str(together), f"{seconds:.0f}")
    return result


if __name__ == "__main__":
    main()
