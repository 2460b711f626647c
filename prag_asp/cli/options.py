"""Options that several commands share, gathered into one value."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import wraps
from typing import TYPE_CHECKING, Any

import click

from prag_asp.cli import exit_control, shell_completion
from prag_asp.cli.arguments import one_length, one_or_more_lengths
from prag_asp.cli.domain_options import Asked
from prag_asp.errors import QueryError
from prag_asp.processes.machine import SHARE

if TYPE_CHECKING:
    from prag_asp.domain.load import Domain
    from prag_asp.physics import Budget

Function = Callable[..., Any]


def _limit_time(context: click.Context, parameter: click.Parameter, given: str | None) -> None:
    """Limit the time of the command."""
    if given and not context.resilient_parsing:
        from prag_asp.space.limits import parse_time

        exit_control.set_limits(seconds=parse_time(given))


def _limit_memory(context: click.Context, parameter: click.Parameter, given: str | None) -> None:
    """Limit the memory of the command."""
    if given and not context.resilient_parsing:
        from prag_asp.space.limits import parse_memory

        memory = parse_memory(given)
        if memory < LEAST_MEMORY:
            raise QueryError(f"--memory {given}: no command does with {memory:,} bytes; write 500MB or 4GB")
        exit_control.set_limits(memory=memory)


LEAST_MEMORY = 10**7
"""Less memory, in bytes, than Python takes for itself."""


MOST = 10**15
"""What a command is asked for at most: more than any disk holds, and few enough to be multiplied within 64 bits."""


def whole(least: int, most: int = MOST) -> click.IntRange:
    """Return the kind of an option that is a whole number."""
    return click.IntRange(min=least, max=most)


PROGRAM = (
    click.option(
        "-c", "--const", "constants", metavar="NAME=VALUE", multiple=True,
        help="Value for a #const of the domain, such as discs=4.",
    ),
    click.option(
        "--settings", metavar="FILE", shell_complete=shell_completion.files,
        help="File to read as domain.toml, in place of the folder's; a domain of files has none otherwise.",
    ),
    click.option(
        "--rule", "rules", metavar="RULE", multiple=True, shell_complete=shell_completion.rules,
        help="Rule to add, such as no_undo or 'at_most(grasp,2)'.",
    ),
    click.option(
        "--encodings", metavar="DIR", shell_complete=shell_completion.files,
        help="Folder of encodings to use in place of the shipped ones.",
    ),
    click.option("--flat", is_flag=True, help="Ignore the composites: any sequence of actions may be a plan."),
    click.option(
        "--learned/--no-learned", default=True, help="Read learned.lp if the domain has one.  [default: learned]"
    ),
    click.option("--strict", is_flag=True, help="Take what `prag-asp check` warns of for errors."),
)  # fmt: skip
OF_FILE = (
    click.option(
        "--domain", "names", metavar="DOMAIN", multiple=True, shell_complete=shell_completion.domains,
        help="Their domain; several times for several files.  [default: what they name]",
    ),
    *PROGRAM,
)  # fmt: skip
DOMAIN_ARGUMENT = click.argument(
    "names", metavar="DOMAIN...", nargs=-1, required=True, shell_complete=shell_completion.domains
)
DOMAIN = (DOMAIN_ARGUMENT, *PROGRAM)
TRUST = click.option("--trust", is_flag=True, help="Run the Python files that domain.toml names for physics.")
WHERE = click.option(
    "--where", metavar="CONDITION", multiple=True, shell_complete=shell_completion.conditions,
    help="Such as 'uses apple', 'has at least 2 grasp', 'loop-free'.",
)  # fmt: skip
LENGTH = click.option(
    "-n", "--length", type=one_length, required=True, metavar="N", help="Number of actions of a task."
)
LENGTHS = click.option(
    "-n", "--length", type=one_or_more_lengths, required=True, metavar="N|A..B",
    help="Number of actions of a task, or all numbers from A to B.",
)  # fmt: skip
ANSWERED = (
    WHERE,
    click.option(
        "--engine", default="auto", show_default=True, metavar="ENGINE", shell_complete=shell_completion.engines,
        help="auto, automaton, clingo, sat, sharp or symbolic.",
    ),
    click.option(
        "--cache/--no-cache", "cached", default=True, help="Keep what took long for the next run.  [default: cache]"
    ),
)  # fmt: skip
LIMITS = (
    click.option(
        "--time", metavar="TIME", expose_value=False, is_eager=True, callback=_limit_time,
        help="Stop after this long, such as 60s or 5m, with what is known by then.  [default: no limit]",
    ),
    click.option(
        "--memory", metavar="SIZE", expose_value=False, is_eager=True, callback=_limit_memory,
        help=f"Stop at this much memory of all processes, such as 4GB.  [default: {SHARE} % of the machine's]",
    ),
)  # fmt: skip
"""Every command has these, which the list of commands gives it."""


def add_limits(command: click.Command) -> None:
    """Add the options of limits to a command, or to each command of a group, once."""
    if isinstance(command, click.Group):
        for each in command.commands.values():
            add_limits(each)
    elif not any(each.name == "memory" for each in command.params):
        for option in LIMITS:
            option(command)


SPACE = (*DOMAIN, LENGTH, *ANSWERED)
SPACES = (*DOMAIN, LENGTHS, *ANSWERED)

APPROXIMATION = (
    click.option("--approximate", is_flag=True, help="Print about how many, by ApproxMC: no exact number."),
    click.option(
        "--epsilon", type=float, metavar="E",
        help="With --approximate: off by a factor of 1+E at most ...  [default: 0.8]",
    ),
    click.option(
        "--delta", type=float, metavar="D", help="... with a probability of at least 1-D.  [default: 0.2]",
    ),
    click.option("--seed", type=click.IntRange(min=0), help="With --approximate: same seed, same line.  [default: 0]"),
)  # fmt: skip


@dataclass(frozen=True)
class Approximation:
    """The estimate that a command line asks for, in place of an exact number."""

    approximate: bool
    epsilon: float | None
    delta: float | None
    seed: int | None

    def asked(self, engine: str) -> dict[str, Any] | None:
        """Return the arguments of an estimate, or None where an exact number is asked for.

        Raises:
            QueryError: what is given belongs to an estimate and none is asked for, or an engine is chosen for one.
        """
        given = {"epsilon": self.epsilon, "delta": self.delta, "seed": self.seed}
        given = {name: value for name, value in given.items() if value is not None}
        if given and not self.approximate:
            raise QueryError(f"--{next(iter(given))}: it belongs to an estimate; give --approximate as well")
        if self.approximate and engine != "auto":
            raise QueryError(f"--approximate: ApproxMC counts, not the engine {engine}; leave out --engine")
        return given if self.approximate else None


def approximation(function: Function) -> Function:
    """Give a command the options of an estimate, as one value `approximation`."""
    return bundled(function, "approximation", Approximation, APPROXIMATION)


by_level = click.option(
    "--by",
    type=click.Choice(["plan", "task", "skeleton"]),
    default="task",
    show_default=True,
    help="Plans; tasks, which are plans up to renaming of interchangeable entities; or sequences of action names.",
)
prefix = click.option(
    "--prefix",
    metavar="A,B,...",
    shell_complete=shell_completion.prefix,
    help="Begin with these actions, or names of actions.",
)
output = click.option(
    "-o", "--output", metavar="FILE", shell_complete=shell_completion.files,
    help="Write to FILE in place of stdout, whole or not at all.",
)  # fmt: skip
seed = click.option("--seed", type=click.IntRange(min=0), default=0, show_default=True, help="Same seed, same bytes.")
BUDGET, TIER = "10x10", "kinematics"
CHECKS = (
    click.option("--workers", type=whole(1, 4096), default=1, show_default=True, help="Processes for physics."),
    click.option(
        "--budget", metavar="RxS", default=BUDGET, show_default=True,
        help="How hard physics looks: first states tried for a task x attempts at each action.",
    ),
    click.option(
        "--tier", type=click.Choice(["kinematics", "settling", "transit", "demonstration"]), default=TIER,
        show_default=True,
        help="Dearest tier of checks: arrangements and arm, also that objects stay in a simulation, also that "
        "the arm has a free way from each waypoint to the next, also that the robot performs the task in simulation.",
    ),
    click.option(
        "--demonstrate", metavar="DIR", shell_complete=shell_completion.files,
        help="Let the robot perform each task, and write recordings (.npz) into DIR, each whole.",
    ),
)  # fmt: skip


@dataclass(frozen=True)
class Checking:
    """How a command line wants tasks checked by physics."""

    workers: int
    budget: str
    tier: str
    demonstrate: str | None = None

    def refuse_without_physics(self, others: Mapping[str, bool]) -> None:
        """Refuse options of physics where it is not asked; `others` of a command say whether they are given.

        Raises:
            QueryError: one is given.
        """
        given = {
            "--demonstrate": self.demonstrate is not None,
            "--tier": self.tier != TIER,
            "--budget": self.budget != BUDGET,
            **others,
        }
        for option, is_given in given.items():
            if is_given:
                raise QueryError(f"{option} needs physics; leave it out, or use a domain with a [scene]")

    def limits(self) -> Budget:
        """Return the budget; whoever asks for recordings asks for demonstrations.

        Raises:
            QueryError: --budget is not of the form RxS with positive numbers.
        """
        from prag_asp.physics import TIERS, Budget

        dearest = "demonstration" if self.demonstrate is not None else self.tier
        try:
            return Budget.parse(self.budget, TIERS[TIERS.index(dearest)])
        except QueryError as error:
            raise QueryError(f"--{error}") from None

    def arguments(self) -> dict[str, Any]:
        """Return them as arguments for what looks at tasks."""
        return {"workers": self.workers, "budget": self.limits(), "demonstrate": self.demonstrate}


ON = click.option(
    "--on", type=click.Choice(["ray"]),
    help="Look at tasks on the nodes of a Ray cluster: that of RAY_ADDRESS, or this machine as one.",
)  # fmt: skip
MAX_DRAWS = click.option("--max-draws", type=whole(1), metavar="K", help="Give a part up after K draws.  [1000 a task]")


def checks(function: Function) -> Function:
    """Give a command the options of physics, as one value `checking`."""
    return bundled(function, "checking", Checking, CHECKS)


def looks(function: Function) -> Function:
    """Give a command the options of physics, but for the folder of recordings, as one value `checking`."""
    return bundled(function, "checking", Checking, CHECKS[:-1])


def asks(options: Sequence[Callable[[Function], Function]]) -> Callable[[Function], Function]:
    """Give a command these options, as one value `asked`."""
    return lambda function: bundled(function, "asked", Asked, options)


def bundled(function: Function, name: str, kind: Any, options: Sequence[Callable[[Function], Function]]) -> Function:
    """Return a command with options whose values it gets as one value of a dataclass."""

    @wraps(function)
    def command(**values: Any) -> Any:
        own = {key: values.pop(key) for key in kind.__dataclass_fields__ if key in values}
        return function(**{name: kind(**own)}, **values)

    decorated: Function = command
    for option in reversed(options):
        decorated = option(decorated)
    return decorated


WEIGHING = (
    click.option(
        "--weight", "given", metavar="KEY=W", multiple=True, shell_complete=shell_completion.names,
        help="Such as grasp=2, 'grasp>move=0.5', apple=1/3.",
    ),
    click.option("--uniform", is_flag=True, help="Leave out the weights of domain.toml."),
    click.option(
        "--temperature", default="1", show_default=True, metavar="T",
        help="Each weight w becomes w^(1/T): below 1 sharpens, inf makes all alike.",
    ),
)  # fmt: skip


@dataclass(frozen=True)
class Weighing:
    """The weights that a command line asks for."""

    given: tuple[str, ...] = ()
    uniform: bool = False
    temperature: str = "1"

    def arguments(self, domain: Domain) -> dict[str, Any]:
        """Return them as arguments for the methods of a task space.

        Raises:
            QueryError: an option is not of the form KEY=W.
        """
        own = {} if self.uniform else dict(domain.settings.weights)
        return {"weights": {**own, **parse_weight_options(self.given)}, "temperature": self.temperature.strip()}


def weighs(function: Function) -> Function:
    """Give a command the options of weights, as one value `weighing`."""
    return bundled(function, "weighing", Weighing, WEIGHING)


def parse_weight_options(options: Sequence[str]) -> dict[str, str]:
    """Return the weights that options of the form KEY=WEIGHT state.

    Raises:
        QueryError: an option is of another form.
    """
    found = {}
    for option in options:
        key, equals, weight = option.rpartition("=")
        if not equals or not key:
            raise QueryError(f"--weight {option}: write KEY=WEIGHT, such as grasp=2 or 'grasp>move=0.5'")
        found[key.strip()] = weight.strip()
    return found
