"""The kinds of mutants, each a function from a generator of random numbers to a mutant, a file for each family."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from random import Random

from tests.fuzz.kinds.bodies import body
from tests.fuzz.kinds.caches import cache
from tests.fuzz.kinds.commands import command_line
from tests.fuzz.kinds.datasets import dataset
from tests.fuzz.kinds.domains import logic, settings
from tests.fuzz.kinds.places import place
from tests.fuzz.kinds.tasks import recording, tasks
from tests.fuzz.mutant import Mutant

Make = Callable[[Random, int], Mutant]

KINDS: Mapping[str, tuple[Make, int]] = {
    "logic": (logic, 8),
    "settings": (settings, 4),
    "tasks": (tasks, 3),
    "recording": (recording, 2),
    "command": (command_line, 4),
    "place": (place, 2),
    "body": (body, 1),
    "cache": (cache, 1),
    "dataset": (dataset, 2),
}
"""The kinds, each with how many there are of it in a round."""


def mutant(number: int, seed: int, kinds: tuple[str, ...] = ()) -> Mutant:
    """Return the mutant of a number in the campaign of a seed, of some kinds or of all."""
    wheel = [kind for kind, (_, times) in KINDS.items() if not kinds or kind in kinds for _ in range(times)]
    # The wheel is turned so that few mutants have all kinds among them.
    kind = wheel[number * 7 % len(wheel)] if len(wheel) % 7 else wheel[number % len(wheel)]
    make, _ = KINDS[kind]
    return make(Random(f"{seed} {kind} {number}"), number)
