"""What behaviour cloning transfers by composition: python benchmarks/learning/composition.py.

Records 400 training tasks of composition.toml, exports them for LeRobot, trains networks on the export (imitation.py),
and evaluates them on held-out tasks of the same kind (`familiar`) and on each other part of the suite.

Appends the episodes to composition.parquet in the folder --output; evaluations in the file are not run again. Settings
were chosen with the part `validation`, which is not evaluated here. Requires the extra `learning`.
"""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from statistics import mean, stdev
from typing import Any

import click
import pyarrow as pa
import pyarrow.parquet as pq
import torch
from imitation import KINDS, Frames, Imitator, Kind, Network, imitated
from rich.console import Console
from rich.table import Table
from scipy import stats

from prag_asp import Dataset, load_domain
from prag_asp.dataset import export, generate_suite, load_suite
from prag_asp.dataset.scenes import scene_of
from prag_asp.evaluation import Results, StoredScenarios, evaluate
from prag_asp.evaluation.lerobot_view import LeRobotView
from prag_asp.rl import Rate

SUITE = Path(__file__).with_suffix(".toml")
PARTS = ("familiar", "paraphrased", "unseen_pairs", "longer", "other_start", "unseen_objects")
PARAPHRASED, READER = "paraphrased", "sentence"
"""The part that differs only in its instructions, and the kind of networks that read them."""

ACTIONS = ("pick", "place", "insert", "stack")

MOST_STEPS = 1000
"""More steps than any episode has."""


@click.command()
@click.option("--kind", "kinds", type=click.Choice(KINDS), multiple=True, default=KINDS, show_default=True)
@click.option("--part", "parts", type=click.Choice(PARTS), multiple=True, default=PARTS, show_default=True)
@click.option("--seeds", type=int, default=3, show_default=True, help="Networks of each kind.")
@click.option("--steps", type=int, default=3000, show_default=True, help="Batches of a training.")
@click.option("--tests", type=int, default=60, show_default=True, help="Test tasks of each part.")
@click.option("--suite", type=Path, default=SUITE, help="The tasks; by default, those of composition.toml.")
@click.option("--output", type=Path, default=Path("learned"), help="The folder of the results.")
def main(
    kinds: Sequence[Kind], parts: Sequence[str], seeds: int, steps: int, tests: int, suite: Path, output: Path
) -> None:
    """Record, export, train and evaluate what is missing, and print the table."""
    torch.set_num_threads(1)
    recorded(suite, output)
    domain = load_domain("tabletop")
    frames = Frames.read(output / "lerobot", scene_of(domain), domain.facts.actions)
    path = output / "composition.parquet"
    rows: list[dict[str, Any]] = pq.read_table(path).to_pylist() if path.exists() else []
    for seed, kind in ((seed, kind) for seed in range(seeds) for kind in kinds):
        key = {"kind": kind, "seed": seed, "steps": steps}
        network: Network | None = None
        for part in parts:
            if part == PARAPHRASED and kind != READER:
                continue
            if any({**key, "part": part}.items() <= row.items() for row in rows):
                continue
            network = network or trained(frames, output, **key)
            before = time.process_time()
            results = tested(network, frames, output, part, tests)
            rate, seconds = results.whole(), time.process_time() - before
            Console(stderr=True).print(f"{kind}, seed {seed}, {part}, {seconds:.0f} s: {rate}")
            rows += [{**key, "part": part, **row} for row in episodes(results)]
            pq.write_table(pa.Table.from_pylist(rows), path)
    Console().print(table(rows))


def recorded(suite: Path, output: Path) -> None:
    """Generate the suite and export its training part, unless they are there."""
    if not (output / "lerobot").exists():
        generate_suite(load_suite(suite), output / "suite")
        data = Dataset.open(output / "suite" / "train").part("train")
        export(data, "lerobot", output / "lerobot", action="ee_position", state=["ee_position"], objects=True)


def trained(frames: Frames, output: Path, *, kind: Kind, seed: int, steps: int) -> Network:
    """Return a network, which is stored in the folder of the results."""
    path = output / f"{kind}_{steps}_{seed}.pt"
    if not path.exists():
        before = time.process_time()
        torch.save(imitated(frames, kind, steps=steps, seed=seed), path)
        Console(stderr=True).print(f"{kind}, seed {seed}: trained in {time.process_time() - before:.0f} s")
    network: Network = torch.load(path, weights_only=False)
    return network


def tested(network: Network, frames: Frames, output: Path, part: str, tests: int) -> Results:
    """Return the results of a network in scenarios of a part."""
    own = part in ("familiar", "validation")
    source = StoredScenarios.open(output / "suite" / ("train" if own else part), [part] if own else ["train"], tests)
    view = partial(LeRobotView, steps=MOST_STEPS, state=("ee_position",))
    return evaluate(Imitator(network, frames.vocabulary), source, control="ee_position", wrapper=view)


def episodes(results: Results) -> Iterator[dict[str, Any]]:
    """Yield a row for each episode."""
    for each in results.episodes:
        yield {
            "task": " ".join(each.task), "length": each.length, "reached": each.reached, "success": each.success,
            "episode_steps": each.steps,
        }  # fmt: skip


def table(rows: Sequence[dict[str, Any]]) -> Table:
    """Return the success of whole tasks and of the actions that were begun, by kind and part.

    The intervals in the columns of success pool the episodes of all seeds (Wilson); that of the mean over seeds is
    Student's.
    """
    result = Table("network", "part", "seeds", "mean over seeds", "whole tasks", "actions begun", *ACTIONS)
    for kind, part in dict.fromkeys((row["kind"], row["part"]) for row in rows):
        own = [row for row in rows if (row["kind"], row["part"]) == (kind, part)]
        begun = [each for row in own for each in actions_begun(row)]
        rates = Rate(sum(row["success"] for row in own), len(own)), Rate(sum(done for _, done in begun), len(begun))
        ends = [[done for name, done in begun if name == action] for action in ACTIONS]
        counts = (f"{sum(each)} of {len(each)}" for each in ends)
        seeds = sorted({row["seed"] for row in own})
        each = [mean(row["success"] for row in own if row["seed"] == seed) for seed in seeds]
        result.add_row(
            kind,
            part,
            str(len(seeds)),
            with_interval(each),
            *(str(rate).partition(";")[0] + ")" for rate in rates),
            *counts,
        )
    return result


def with_interval(rates: Sequence[float]) -> str:
    """Return the mean of the success rates of seeds in percent, with Student's 95 % interval if there are several."""
    middle = 100 * mean(rates)
    if len(rates) < 2:
        return f"{middle:.0f} %"
    half = 100 * stats.t.ppf(0.975, len(rates) - 1) * stdev(rates) / len(rates) ** 0.5
    return f"{middle:.0f} % ({max(0.0, middle - half):.0f} to {min(100.0, middle + half):.0f})"


def actions_begun(row: Mapping[str, Any]) -> list[tuple[str, bool]]:
    """Return the name of each action that was begun in an episode, and whether it succeeded."""
    names = [action.partition("(")[0] for action in row["task"].split()]
    return [(name, number < row["reached"]) for number, name in enumerate(names[: row["reached"] + 1])]


if __name__ == "__main__":
    main()
