"""``prag-asp evaluate`` and ``prag-asp compare``: the success rates of a policy, and the difference of two policies."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import click

from prag_asp.cli import options, shell_completion
from prag_asp.cli.arguments import parse_lengths
from prag_asp.cli.domain_options import PROGRAM, WHERE, DomainOptions, domain_options
from prag_asp.cli.options import StrataOptions, whole
from prag_asp.cli.physics_options import BUDGET, parse_pixels
from prag_asp.cli.terminal import progress, say, tell_line
from prag_asp.errors import QueryError
from prag_asp.tables.json_fields import decoded

if TYPE_CHECKING:
    from prag_asp.evaluation.sources import ScenarioSource
    from prag_asp.space.strata.allocation import Stratification

COUNT = 100
"""The default number of fresh scenarios."""


@click.command()
@click.argument("policy", metavar="POLICY")
@click.argument("names", metavar="[DOMAIN]...", nargs=-1, shell_complete=shell_completion.domains)
@domain_options(*PROGRAM, WHERE, options.trust)
@click.option(
    "-n", "--length", "lengths", type=parse_lengths, metavar="N|A..B|N,M",
    help="With DOMAIN: sample distinct feasible tasks with N actions, with A to B actions, or with N or M.",
)  # fmt: skip
@click.option(
    "--data", metavar="DIR", shell_complete=shell_completion.files,
    help="Use the tasks and initial states of a dataset or a suite.",
)  # fmt: skip
@click.option("--part", "parts", metavar="NAME", multiple=True, help="With --data: only this part; may be repeated.")
@click.option(
    "--scenarios", "ids", metavar="FILE", shell_complete=shell_completion.files,
    help="Use the scenarios whose ids this file lists, one per line.",
)  # fmt: skip
@click.option(
    "--count", type=whole(1), metavar="K",
    help="Number of scenarios to sample, or of tasks per part of --data.  [default: 100, or all of --data]",
)  # fmt: skip
@options.seed
@options.strata_options
@click.option(
    "--budget", metavar="RxS", help="With DOMAIN: search effort for initial states, as in sample.  [default: 10x10]"
)
@click.option("--workers", type=whole(1, 4096), default=1, show_default=True, help="Number of processes.")
@click.option(
    "--control", metavar="NAME", help="Control convention of the environment.  [default: that of the environment]"
)
@click.option(
    "--steps", type=whole(1), metavar="K", help="Step limit for each subgoal.  [default: that of the environment]"
)
@click.option("--everything", is_flag=True, help="Observe all bodies, not only those of the current action.")
@click.option("--cameras", metavar="A,B,...", shell_complete=shell_completion.cameras, help="Cameras to observe.")
@click.option("--size", metavar="WxH", help="With --cameras: size of the images in pixels.")
@click.option("--language", metavar="LANGUAGE", help="Language of the instructions.  [default: en]")
@click.option(
    "--env", "others", metavar="NAME=VALUE", multiple=True,
    help="Any other environment option, as in training, such as goals=true or action_scale=0.5.",
)  # fmt: skip
@click.option("--wrapper", metavar="MODULE:CALLABLE", help="Wrap the environment, as in training.")
@click.option(
    "--videos", type=whole(0), default=0, show_default=True, metavar="K", help="Write videos of the first K failures."
)
@click.option(
    "-o",
    "--output",
    metavar="DIR",
    required=True,
    shell_complete=shell_completion.files,
    help="Folder for the results.",
)
def evaluate(
    *,
    policy: str,
    request: DomainOptions,
    lengths: Any,
    data: str | None,
    parts: tuple[str, ...],
    ids: str | None,
    count: int | None,
    seed: int,
    stratifying: StrataOptions,
    budget: str | None,
    workers: int,
    control: str | None,
    steps: int | None,
    everything: bool,
    cameras: str | None,
    size: str | None,
    language: str | None,
    others: tuple[str, ...],
    wrapper: str | None,
    videos: int,
    output: str,
) -> None:
    """Evaluate a policy: its success by part, length, action and class.

    POLICY is `oracle`, `random` or `zeros`; MODULE:CALLABLE, a Python function that maps an observation to an action,
    or a class whose instances are such functions; a zip file from Stable-Baselines3; a pretrained_model folder from
    LeRobot, which also determines the control convention and the cameras; or ws://HOST:PORT, a policy server that uses
    the protocol of openpi. Modules, zip files and checkpoints run code. The output folder contains a Parquet table with
    a row for each episode. If the command is interrupted, run it again: it continues.
    """
    from prag_asp.evaluation import evaluate as evaluated
    from prag_asp.physics import require_physics

    require_physics()
    given = {
        "control": control, "steps": steps, "everything": everything or None, "language": language,
        "cameras": tuple(cameras.split(",")) if cameras else None, "size": parse_pixels(size) if size else None,
    }  # fmt: skip
    environment = {name: value for name, value in given.items() if value is not None} | _options(others)
    with progress() as tell:
        request = replace(request, length=lengths if lengths is not None else 0)
        stratification = stratifying.stratification({"--data": data is not None, "--scenarios": ids is not None})
        source = _source(
            request, data, parts, ids, count, seed, budget, stratification, with_length=lengths is not None
        )
        results = evaluated(
            policy, source, output, workers=workers, seed=seed, wrapper=_imported(wrapper), videos=videos,
            progress=tell, **environment,
        )  # fmt: skip
    causes = ", ".join(f"{number} {cause}" for cause, number in results.causes().items())
    tell_line(f"{results.record.policy} on {results.record.source}: {causes}")
    say(results.table())


@click.command()
@click.argument("first", metavar="DIR", shell_complete=shell_completion.files)
@click.argument("second", metavar="DIR", shell_complete=shell_completion.files)
@click.option("--across", is_flag=True, help="Compare even if the domains, controls or step limits differ.")
def compare(*, first: str, second: str, across: bool) -> None:
    """Compare two evaluations on their shared scenarios.

    Prints both success rates, their difference (first minus second) with a 95 % interval (Newcombe's for pairs),
    and the p-value of McNemar's exact test.
    """
    from prag_asp.evaluation import Results
    from prag_asp.evaluation import compare as compared

    comparison = compared(Results.open(first), Results.open(second), across=across)
    say(comparison.table())
    if comparison.unpaired():
        tell_line(comparison.unpaired())


def _source(
    request: DomainOptions, data: str | None, parts: tuple[str, ...], ids: str | None, count: int | None, seed: int,
    budget: str | None, stratification: Stratification | None, *, with_length: bool,
) -> ScenarioSource:  # fmt: skip
    """Return the scenarios that a command line names.

    Raises:
        QueryError: the command line names no scenarios, or has contradictory options.
    """
    from prag_asp.dataset.scenarios import read_scenarios
    from prag_asp.evaluation.sources import FreshScenarios, NamedScenarios, StoredScenarios
    from prag_asp.physics import Budget

    kinds = {"--length": with_length, "--data": data is not None, "--scenarios": ids is not None}
    named = [name for name, is_given in kinds.items() if is_given]
    if len(named) != 1:
        what = " and ".join(named) or "nothing"
        raise QueryError(
            f"{what}: scenarios have one source; give one of DOMAIN --length N, --data DIR and --scenarios FILE"
        )
    if parts and data is None:
        raise QueryError(f"--part {parts[0]}: only a dataset has parts; give --data DIR")
    if data is not None:
        if request.names or request.where:
            raise QueryError("a dataset has its own domain and conditions; leave DOMAIN and --where out")
        return StoredScenarios.open(data, parts, count, trust=request.trust)
    if ids is not None:
        if request.where or count is not None:
            raise QueryError("a file of ids determines its scenarios; leave --where and --count out")
        scenarios = tuple(read_scenarios(ids))
        if not scenarios:
            raise QueryError(f"{ids}:1: it has no scenario ids; prag-asp sample --format scenario prints some")
        return NamedScenarios(request.of_scenario(scenarios[0]).domain(), scenarios)
    if not request.names:
        raise QueryError("--length needs a domain; give DOMAIN, such as tabletop")
    budgeted = Budget.parse(budget or BUDGET)
    return FreshScenarios(request.spaces(), count or COUNT, seed, budgeted, stratification=stratification)


def _options(texts: tuple[str, ...]) -> dict[str, Any]:
    """Parse the environment options in texts of the form NAME=VALUE; a value that is not JSON is a string.

    Raises:
        QueryError: a text is not of the form NAME=VALUE.
    """
    options = {}
    for text in texts:
        name, equals, value = text.partition("=")
        if not name or not equals:
            raise QueryError(f"--env {text}: write NAME=VALUE, such as goals=true")
        try:
            options[name] = decoded(value)
        except QueryError:
            options[name] = value
    return options


def _imported(wrapper: str | None) -> Any:
    """Return the callable MODULE:CALLABLE, or None if no name is given."""
    if wrapper is None:
        return None
    from prag_asp.evaluation.policies.python_callable import imported

    return imported(wrapper, "wrapper")
