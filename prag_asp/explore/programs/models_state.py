"""The state of a page of answer sets, which is the query of its link."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal, get_args
from urllib.parse import urlencode

from prag_asp.errors import QueryError
from prag_asp.explore.page_state import fields_of_query
from prag_asp.wording import unknown

Sorting = Literal["name", "significance", "share"]
"""The orders of facets: clingo's order of symbols, or the largest numbers first."""

LARGEST_SEED = 2**63 - 1

FIELDS = ("where", "find", "sort", "seed")


@dataclass(frozen=True)
class ModelsState:
    """What a page shows of a program: the answer sets that agree with the literals `where`, in the order of choice.

    The facets whose text contains `find` are listed. With a `seed`, a sample is shown.
    """

    where: tuple[str, ...] = ()
    find: str = ""
    sort: Sorting = "name"
    seed: int | None = None

    @property
    def query(self) -> str:
        """The query of the link."""
        fields = [("where", text) for text in self.where]
        fields += [("find", self.find)] if self.find else []
        fields += [("sort", self.sort)] if self.sort != "name" else []
        return urlencode([*fields, *([] if self.seed is None else [("seed", str(self.seed))])])

    def choosing(self, *literals: str) -> ModelsState:
        """Return the state with further choices, and without the sample."""
        return replace(self, where=(*self.where, *literals), seed=None)


def parse_models_query(query: str) -> ModelsState:
    """Return the state that a query describes.

    Raises:
        QueryError: a field is unknown, repeated or wrong.
    """
    values = fields_of_query(query, FIELDS)
    for name in FIELDS[1:]:
        if len(values[name]) > 1:
            raise QueryError(f"a link has {name} at most once; leave one out")
    sorts: dict[str, Sorting] = {name: name for name in get_args(Sorting)}
    sort, seed = (values["sort"] or ["name"])[0], (values["seed"] or [""])[0].strip()
    if sort not in sorts:
        raise QueryError(unknown(sort, sorts, "order of facets"))
    if seed and not (seed.isascii() and seed.isdigit() and len(seed) < 20 and int(seed) <= LARGEST_SEED):
        raise QueryError(f"seed {seed[:30]!r}: write a whole number from 0 to {LARGEST_SEED}")
    find = (values["find"] or [""])[0].strip()
    return ModelsState(tuple(dict.fromkeys(values["where"])), find, sorts[sort], int(seed) if seed else None)
