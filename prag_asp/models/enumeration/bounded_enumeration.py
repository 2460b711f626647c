"""Enumeration by clingo up to a deterministic limit of work, and an estimate of the required work.

Models and conflicts are limited, so that the result does not depend on the machine.
"""

from __future__ import annotations

from dataclasses import dataclass
from statistics import median
from typing import Any

from prag_asp.models.enumeration.enumeration import POLL, project_on_shown
from prag_asp.models.ground_program import GroundModels
from prag_asp.processes.progress_events import stage

DIVES = 8
"""The number of random searches for a model; the median of their depths varies by about two bits between seeds."""

DIVE_CONFLICTS = 200
"""The number of conflicts after which a random search is abandoned: some milliseconds."""

UNLIMITED = "umax"
"""clasp's word for no limit."""


@dataclass(frozen=True)
class Effort:
    """A limit of an enumeration: the numbers of models and of conflicts."""

    models: int
    conflicts: int


class BoundedEnumeration:
    """The enumeration of a program on its grounding control, which keeps the clauses learned in earlier calls."""

    def __init__(self, ground: GroundModels, *, project: bool) -> None:
        self._control = ground.grounder.control
        configuration: Any = self._control.configuration  # attributes are created at run time
        self._solve, self._solver = configuration.solve, configuration.solver[0]
        if project:
            if ground.projected is None:
                project_on_shown(self._control, ground.shown)
            self._solve.project = "auto"

    def count(self, effort: Effort) -> int | None:
        """Return the number of answer sets, or None if counting exceeds the effort."""
        stage("enumerating answer sets")
        self._solve.models, self._solve.solve_limit = str(effort.models + 1), f"{effort.conflicts},{UNLIMITED}"
        exhausted = self._search()
        # clasp counts in doubles, which are exact up to 2**53
        return int(self._control.statistics["summary"]["models"]["enumerated"]) if exhausted else None

    def depth(self) -> float:
        """Return the median number of decisions of random searches for a model, minus those that conflicts undid.

        A tree of binary decisions of this depth has about ``2 ** depth`` leaves (Knuth 1975).
        """
        before = self._solver.rand_freq, self._solver.sign_def, self._solver.seed
        self._solve.models, self._solve.solve_limit = "1", f"{DIVE_CONFLICTS},{UNLIMITED}"
        self._solver.rand_freq, self._solver.sign_def = "1", "rnd"
        depths: list[float] = []
        for seed in range(1, DIVES + 1):
            self._solver.seed = str(seed)
            self._search()
            work = self._control.statistics["solving"]["solvers"]
            depths.append(work["choices"] - work["conflicts"])
        self._solver.rand_freq, self._solver.sign_def, self._solver.seed = before
        return median(depths)

    def _search(self) -> bool:
        """Search up to a limit; return whether all models were found. Ctrl-C is handled between two polls."""
        with self._control.solve(async_=True) as handle:
            try:
                while not handle.wait(POLL):
                    pass
                return bool(handle.get().exhausted)
            finally:
                handle.cancel()
