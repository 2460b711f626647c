"""Options shared by several commands, as decorators, with related options grouped into a single value."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import wraps
from typing import TYPE_CHECKING, Any, cast

import click

from prag_asp.cli import exit_control, shell_completion
from prag_asp.errors import QueryError
from prag_asp.processes.machine import SHARE

if TYPE_CHECKING:
    from prag_asp.domain.load import Domain
    from prag_asp.space.strata.allocation import Stratification, StratifiedBy

Function = Callable[..., Any]
Decorator = Callable[[Function], Function]

MOST = 10**15
"""The largest number that an option accepts: larger than any plausible request, and far below the limit of 64 bits."""

LEAST_MEMORY = 10**7
"""The smallest memory limit in bytes, because Python itself needs more."""


def whole(least: int, most: int = MOST) -> Callable[[Any], int]:
    """Return the type of an option that is a whole number; its bounds appear in errors, not in the help."""
    bounds = click.IntRange(min=least, max=most)

    def integer(value: Any) -> int:
        return int(bounds.convert(value, None, None))

    return integer


def grouped(name: str, kind: Any, options: Sequence[Decorator]) -> Decorator:
    """Return a decorator that adds options to a command, which receives their values as a single dataclass."""

    def decorate(function: Function) -> Function:
        @wraps(function)
        def command(**values: Any) -> Any:
            fields = {key: values.pop(key) for key in kind.__dataclass_fields__ if key in values}
            return function(**{name: kind(**fields)}, **values)

        decorated: Function = command
        for option in reversed(options):
            decorated = option(decorated)
        return decorated

    return decorate


def _set_limit(context: click.Context, parameter: click.Parameter, text: str | None) -> None:
    """Set the limit of the option --time or --memory.

    Raises:
        QueryError: the text is not a time or a size, or no command can run with so little memory.
    """
    if not text or context.resilient_parsing:
        return
    from prag_asp.space.limits import parse_memory, parse_time

    if parameter.name == "time":
        exit_control.set_limits(seconds=parse_time(text))
        return
    memory = parse_memory(text)
    if memory < LEAST_MEMORY:
        raise QueryError(f"--memory {text}: {memory:,} bytes are too few for any command; write 500MB or 4GB")
    exit_control.set_limits(memory=memory)


def add_limits(command: click.Command) -> None:
    """Add the options for limits to a command, or to each command of a group, unless they are already there."""
    if isinstance(command, click.Group):
        for each in command.commands.values():
            add_limits(each)
    elif not any(each.name == "memory" for each in command.params):
        click.option(
            "--time", metavar="TIME", expose_value=False, is_eager=True, callback=_set_limit,
            help="Time limit, such as 60s or 5m; partial results, if any, are printed.  [default: no limit]",
        )(command)  # fmt: skip
        click.option(
            "--memory", metavar="SIZE", expose_value=False, is_eager=True, callback=_set_limit,
            help=f"Memory limit for all processes together, such as 4GB.  [default: {SHARE} % of the machine's memory]",
        )(command)  # fmt: skip


by_level = click.option(
    "--by", type=click.Choice(["plan", "task", "skeleton"]), default="task", show_default=True,
    help="Plans; tasks (plans up to renaming of interchangeable entities); or skeletons (sequences of action names).",
)  # fmt: skip
prefix = click.option(
    "--prefix", metavar="A,B,...", shell_complete=shell_completion.prefix,
    help="Only tasks that begin with these actions, or with actions of these names.",
)  # fmt: skip
output = click.option(
    "-o", "--output", metavar="FILE", shell_complete=shell_completion.files,
    help="Write to FILE instead of stdout; FILE is replaced as a whole.",
)  # fmt: skip
seed = click.option(
    "--seed", type=click.IntRange(min=0), default=0, show_default=True,
    help="Random seed; the same seed produces the same output.",
)  # fmt: skip
trust = click.option("--trust", is_flag=True, help="Run the Python files that domain.toml names for physics.")


@dataclass(frozen=True)
class Approximation:
    """The options for estimates: whether to estimate, the tolerance, the confidence and the seed."""

    approximate: bool
    epsilon: float | None
    delta: float | None
    seed: int | None

    def arguments(self, engine: str) -> dict[str, Any] | None:
        """Return the arguments for an estimate, or None if an exact number is requested.

        Raises:
            QueryError: an option for estimates is given without --approximate, or an engine is given with it.
        """
        options = {"epsilon": self.epsilon, "delta": self.delta, "seed": self.seed}
        options = {name: value for name, value in options.items() if value is not None}
        if options and not self.approximate:
            raise QueryError(f"--{next(iter(options))} is for estimates; add --approximate")
        if self.approximate and engine != "auto":
            raise QueryError(f"--approximate: ApproxMC counts, not the engine {engine}; leave out --engine")
        return options if self.approximate else None


approximation = grouped(
    "approximation", Approximation,
    (
        click.option("--approximate", is_flag=True, help="Estimate the number with ApproxMC; it is not exact."),
        click.option(
            "--epsilon", type=float, metavar="E",
            help="With --approximate: the estimate is off by a factor of at most 1+E.  [default: 0.8]",
        ),
        click.option(
            "--delta", type=float, metavar="D",
            help="With --approximate: probability that the estimate is off by more.  [default: 0.2]",
        ),
        click.option(
            "--seed", type=click.IntRange(min=0), help="With --approximate: random seed of the estimate.  [default: 0]"
        ),
    ),
)  # fmt: skip
"""The decorator that gives a command the options for estimates, as a single value `approximation`."""


@dataclass(frozen=True)
class WeightOptions:
    """The options that set the weights for sampling."""

    weight: tuple[str, ...] = ()
    uniform: bool = False
    temperature: str = "1"

    def arguments(self, domain: Domain) -> dict[str, Any]:
        """Return the options as arguments for the methods of a task space.

        Raises:
            QueryError: an option is not of the form KEY=W.
        """
        defaults = {} if self.uniform else dict(domain.settings.weights)
        return {"weights": {**defaults, **parse_weight_options(self.weight)}, "temperature": self.temperature.strip()}


weight_options = grouped(
    "weighting", WeightOptions,
    (
        click.option(
            "--weight", metavar="KEY=W", multiple=True, shell_complete=shell_completion.names,
            help="Weight of a name, such as grasp=2, 'grasp>move=0.5' or apple=1/3.",
        ),
        click.option("--uniform", is_flag=True, help="Ignore the weights of domain.toml."),
        click.option(
            "--temperature", default="1", show_default=True, metavar="T",
            help="Replace each weight w by w^(1/T): a T below 1 sharpens the weights, inf makes them equal.",
        ),
    ),
)  # fmt: skip
"""The decorator that gives a command the options for weights, as a single value `weighting`."""


@dataclass(frozen=True)
class StrataOptions:
    """The options that divide a sample into strata."""

    strata: str | None = None
    allocation: str | None = None

    def stratification(self, others: Mapping[str, bool]) -> Stratification | None:
        """Return the stratification, or None if there are no strata; `others` maps options to whether they are given.

        Raises:
            QueryError: an allocation is given without strata or is malformed, or strata are given with other options.
        """
        if self.strata is None:
            if self.allocation is not None:
                raise QueryError(f"--allocation {self.allocation} is that of strata; add --strata length")
            return None
        for option, given in others.items():
            if given:
                raise QueryError(f"--strata {self.strata}: strata are sampled uniformly as a whole; leave {option} out")
        from prag_asp.space.strata.allocation import PROPORTIONAL, Stratification

        return Stratification.parse(cast("StratifiedBy", self.strata), self.allocation or PROPORTIONAL)


strata_options = grouped(
    "stratifying", StrataOptions,
    (
        click.option(
            "--strata", type=click.Choice(["length", "skeleton", "goal"]),
            help="Stratified sample by length, skeleton or goal, with exact weights.",
        ),
        click.option(
            "--allocation", metavar="HOW",
            help="With --strata: proportional, equal, or standard deviations such as length_2=0.3,length_3=0.5, which "
            "give the Neyman allocation.  [default: proportional]",
        ),
    ),
)  # fmt: skip
"""The decorator that gives a command the options for strata, as a single value `stratifying`."""

over = click.option(
    "--over", type=click.Choice(["skeletons", "goals"]),
    help="Sample a skeleton (or a goal) uniformly first, then a task that has it.",
)  # fmt: skip


def parse_weight_options(options: Sequence[str]) -> dict[str, str]:
    """Return the weights set by options of the form KEY=WEIGHT.

    Raises:
        QueryError: an option does not have this form.
    """
    weights = {}
    for option in options:
        key, equals, weight = option.rpartition("=")
        if not equals or not key:
            raise QueryError(f"--weight {option}: write KEY=WEIGHT, such as grasp=2 or 'grasp>move=0.5'")
        weights[key.strip()] = weight.strip()
    return weights
