"""The final test of trained policies on witnesses and tasks that were not used for choosing settings.

    python benchmarks/learning/fresh.py MODELS

MODELS is the folder of policies trained by curves.py (`--models MODELS`). Each is tested on new witnesses of tasks of
two actions, the length of its training tasks, and on tasks of three actions, which are all new. Writes fresh.parquet
into the folder --output. Requires the extra `learning`.
"""

from __future__ import annotations

import argparse
import itertools
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq
import torch
from curves import begun, reaches
from rich.console import Console
from rich.table import Table
from stable_baselines3 import SAC
from starts import FRESH, TRAINING, FromStarts, require_apart, starts

from prag_asp.rl import Rate
from prag_asp.rl.rewards import REWARDS

SKILLS, LENGTHS = ("approach", "grasp"), (2, 3)


def main() -> None:
    """Test all policies, write the results, and print a table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("models", type=Path, help="the folder of the policies")
    parser.add_argument("--count", type=int, default=30, help="test subgoals of each kind")
    parser.add_argument("--training", type=int, default=100, help="training witnesses of the policies")
    parser.add_argument("--seed", type=int, default=FRESH, help="the seed of the tasks and their witnesses")
    parser.add_argument("--unseen", help="test policies that were trained without this object on it")
    parser.add_argument("--output", type=Path, default=Path("learned"), help="the folder of the table")
    options = parser.parse_args()
    unseen = options.unseen
    added = "" if unseen is None else f"_unseen_{unseen}"
    if not any(_seeds(options.models, skill + added, reward) for skill, reward in itertools.product(SKILLS, REWARDS)):
        parser.error(f"{options.models} has no policies; train some: curves.py approach --models {options.models}")
    torch.set_num_threads(1)
    rows = []
    table = Table("skill", "reward", "actions of the tasks", "seeds", "all")
    for skill, length in itertools.product(SKILLS, LENGTHS):
        learned = [(reward, paths) for reward in REWARDS if (paths := _seeds(options.models, skill + added, reward))]
        if not learned:
            continue
        given = starts(skill, options.count, seed=options.seed, length=length, only=unseen)
        others = starts(skill, options.training, seed=TRAINING, without=unseen)
        require_apart(others, given, tasks=unseen is not None or length != LENGTHS[0])
        test = begun(given, "sparse")
        for reward, policies in learned:
            rates = [_rate(SAC.load(path, device="cpu"), test, len(given)) for path in policies]
            rows += [
                {"skill": skill, "reward": reward, "policy": path.stem, "length": length, **rate._asdict()}
                for path, rate in zip(policies, rates, strict=True)
            ]
            together = Rate(sum(rate.successes for rate in rates), sum(rate.trials for rate in rates))
            each = ", ".join(f"{float(rate.share):.2f}" for rate in rates)
            table.add_row(skill, reward, str(length), each, str(together))
        test.close()
    options.output.mkdir(parents=True, exist_ok=True)
    pq.write_table(pa.Table.from_pylist(rows), options.output / f"fresh{added}.parquet")
    Console().print(table)


def _rate(model: SAC, test: FromStarts, count: int) -> Rate:
    """Return the rate at which a policy reaches `count` subgoals."""
    return Rate(sum([reaches(model, test) for _ in range(count)]), count)


def _seeds(models: Path, name: str, reward: str) -> list[Path]:
    """Return the files of the policies of a skill, one for each seed."""
    return sorted(models.glob(f"{name}_{reward}_[0-9]*.zip"))


if __name__ == "__main__":
    main()
