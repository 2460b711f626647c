"""Enumeration by clingo up to a work limit, and a prediction of the processor time for all answer sets."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from statistics import fmean
from time import process_time
from typing import Any

from prag_asp.models.enumeration.enumeration import POLL, project_on_shown
from prag_asp.models.ground_program import GroundModels
from prag_asp.processes.progress_events import stage

DIVES = 16
"""The number of random searches for a model, which take about 20 ms; few predictions are wrong by more than a factor of
four."""

DIVE_CONFLICTS = 200
"""The number of conflicts after which a random search is abandoned, which takes a few milliseconds."""

DIVE_OPTIONS = ("rand_freq", "sign_def", "restarts", "local_restarts", "seed")
"""The options of clasp's solver that are changed for random searches."""

FORGOTTEN = "3"
"""The data that clasp resets after random searches (scores and signs of variables), because they may slow down a search
twentyfold."""

UNLIMITED = "umax"
"""clasp's word for no limit."""


@dataclass(frozen=True)
class Effort:
    """The limits on an enumeration: the numbers of models and of conflicts."""

    models: int
    conflicts: int


class BoundedEnumeration:
    """An enumeration with the control that grounded the program; it keeps the clauses learned in earlier calls."""

    def __init__(self, ground: GroundModels, *, project: bool) -> None:
        self._control = ground.grounder.control
        configuration: Any = self._control.configuration  # attributes are created at run time
        self._solve, self._solver = configuration.solve, configuration.solver[0]
        self._rate = 0.0  # models per second of processor time in the latest search
        if project:
            if ground.projected is None:
                project_on_shown(self._control, ground.shown)
            self._solve.project = "auto"

    def count(self, effort: Effort) -> int | None:
        """Return the number of answer sets, or None if counting exceeds the effort."""
        return self._count(effort, inf)

    def count_within(self, seconds: float) -> int | None:
        """Return the number of answer sets, or None if counting takes more than `seconds` of processor time."""
        return self._count(None, seconds)

    def predicted_seconds(self) -> float | None:
        """Predict the processor time that counting will take; return None if too few models are known.

        A random search for a model that makes d decisions finds it with a probability of ``2 ** -d``, so the mean of
        ``2 ** d`` estimates the number of models (Knuth 1975). A decision that a conflict reverts does not count
        (Gogate and Dechter 2011).
        """
        depths = self._depths()
        if self._rate == 0 or not depths:
            return None
        return fmean(2.0 ** min(depth, 1000) for depth in depths) / self._rate

    def _depths(self) -> list[float]:
        """Return the number of decisions in each random search that finds a model."""
        before = {name: getattr(self._solver, name) for name in DIVE_OPTIONS}
        self._solve.models, self._solve.solve_limit = "1", f"{DIVE_CONFLICTS},{UNLIMITED}"
        self._solver.rand_freq, self._solver.sign_def, self._solver.restarts = "1", "rnd", "no"
        depths: list[float] = []
        for seed in range(1, DIVES + 1):
            self._solver.seed = str(seed)
            self._search(inf)
            found = self._control.statistics["solving"]["solvers"]["extra"]
            if found["models"]:
                depths.append(found["models_level"] - 1)  # there is no decision at the lowest level
        for name, value in before.items():
            setattr(self._solver, name, value)
        self._solver.forget_on_step = FORGOTTEN
        return depths

    def _count(self, effort: Effort | None, seconds: float) -> int | None:
        stage("enumerating answer sets")
        self._solve.models, self._solve.solve_limit = "0", f"{UNLIMITED},{UNLIMITED}"
        if effort is not None:
            self._solve.models, self._solve.solve_limit = str(effort.models + 1), f"{effort.conflicts},{UNLIMITED}"
        begun = process_time()
        exhausted = self._search(seconds)
        # clasp counts in doubles, which are exact up to 2**53
        number = int(self._control.statistics["summary"]["models"]["enumerated"])
        self._rate = number / max(process_time() - begun, 1e-6)
        return number if exhausted else None

    def _search(self, seconds: float) -> bool:
        """Search up to a limit, and return whether all models were found; Ctrl-C is handled between polls."""
        until = process_time() + seconds
        with self._control.solve(async_=True) as handle:
            try:
                while not handle.wait(POLL):
                    if process_time() > until:
                        handle.cancel()
                        return False
                return bool(handle.get().exhausted)
            finally:
                handle.cancel()
