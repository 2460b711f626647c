"""How often the scripted oracle ends well: by skill, each begun in the state of a witness, and in whole tasks.

    python benchmarks/learning/oracle.py --count 100

No witness here was looked at while the oracle was written. Intervals are Wilson's, of 95 %.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence

from rich.console import Console
from rich.table import Table
from starts import DOMAINS, HELD_OUT, Start, starts, witnessed

from prag_asp.rl import OraclePolicy, Rate, Rollouts, TaskEnv, run

AIMS = {"approach": 95, "grasp": 95, "pick": 85, "place": 85, "tabletop, 4 actions": 60, "prag, 4 actions": 60}
"""What it should reach, in percent."""

PATIENCE = 300
"""For how many steps it may pursue a subgoal."""


def main() -> None:
    """Let the oracle pursue held-out subgoals and tasks, and print two tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=100, help="how many of each kind")
    parser.add_argument("--tries", type=int, default=1, help="how often each subgoal may be tried")
    parser.add_argument("--seed", type=int, default=HELD_OUT + 1, help="the seed of the tasks and their witnesses")
    options = parser.parse_args()
    table = Table("kind", "ended well", "aim")
    for skill in DOMAINS:
        given = starts(skill, options.count, seed=options.seed, length=4)
        rate = subgoals(given, tries=options.tries)
        table.add_row(skill, str(rate), f"{AIMS[skill]} %")
    parts = Table("of whole tasks", "reached, where it was come to")
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
    """Return how often the oracle reaches subgoals that begin in the states of witnesses."""
    ended = []
    for start in given:
        env = TaskEnv(task=start.task, witness=start.witness, stage=start.stage, until="subgoal", reward="sparse")
        runs = run(env, OraclePolicy(env), 1, tries=tries, patience=PATIENCE)
        env.close()
        ended.append(runs.whole().successes)
    return Rate(sum(ended), len(ended))


def whole(domain: str, count: int, *, seed: int, tries: int) -> Rollouts:
    """Return what became of whole tasks of four actions."""
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
