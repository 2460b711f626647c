"""Success rate of the scripted oracle: by skill, beginning in the state of a witness, and on whole tasks.

    python benchmarks/learning/oracle.py --count 100

These witnesses were not used in the development of the oracle. Intervals are Wilson's 95 % intervals.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence

from rich.console import Console
from rich.table import Table
from starts import DOMAINS, HELD_OUT, Start, starts, witnessed

from prag_asp.rl import OraclePolicy, Rate, Rollouts, TaskEnv, run

AIMS = {"approach": 95, "grasp": 95, "pick": 85, "place": 85, "tabletop, 4 actions": 60, "prag, 4 actions": 60}
"""The required success rates, in percent."""

PATIENCE = 300
"""The time limit of a subgoal, in steps."""


def main() -> None:
    """Run the oracle on held-out subgoals and tasks, and print two tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=100, help="number of each kind")
    parser.add_argument("--tries", type=int, default=1, help="tries for each subgoal")
    parser.add_argument("--seed", type=int, default=HELD_OUT + 1, help="the seed of the tasks and their witnesses")
    options = parser.parse_args()
    table = Table("kind", "success", "required")
    for skill in DOMAINS:
        given = starts(skill, options.count, seed=options.seed, length=4)
        rate = subgoals(given, tries=options.tries)
        table.add_row(skill, str(rate), f"{AIMS[skill]} %")
    parts = Table("stage or action of whole tasks", "reached, of those that began it")
    for domain in sorted(set(DOMAINS.values())):
        runs = whole(domain, options.count, seed=options.seed + 1, tries=options.tries)
        kind = f"{domain}, 4 actions"
        table.add_row(kind, str(runs.whole()), f"{AIMS[kind]} %")
        for number, rate in enumerate(runs.by_stage(), 1):
            parts.add_row(f"{domain}, stage {number}", str(rate))
        for action, rate in runs.by_action().items():
            parts.add_row(f"{domain}, {action}", str(rate))
    Console().print(table, parts)


def subgoals(given: Sequence[Start], *, tries: int) -> Rate:
    """Return the success rate of the oracle on subgoals that begin in states of witnesses."""
    successes = []
    for start in given:
        env = TaskEnv(task=start.task, witness=start.witness, stage=start.stage, until="subgoal", reward="sparse")
        runs = run(env, OraclePolicy(env), 1, tries=tries, patience=PATIENCE)
        env.close()
        successes.append(runs.whole().successes)
    return Rate(sum(successes), len(successes))


def whole(domain: str, count: int, *, seed: int, tries: int) -> Rollouts:
    """Return the rollouts of whole tasks of four actions."""
    drawn = witnessed(domain, 4, seed=seed)
    given = [next(drawn) for _ in range(count)]
    drawn.close()
    env = TaskEnv(task=given[0][0], witness=given[0][1], reward="sparse")
    try:
        return run(env, OraclePolicy(env), given, tries=tries, patience=PATIENCE)
    finally:
        env.close()


if __name__ == "__main__":
    main()
