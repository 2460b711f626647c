"""The state of a page, which is stored in the query of its link."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from urllib.parse import parse_qsl, urlencode

from prag_asp.errors import QueryError
from prag_asp.space.engines.engine import Level
from prag_asp.wording import unknown

MOST_FIELDS = 500
"""The maximum number of fields in a query."""

LONGEST_LENGTH = 10_000
"""The maximum number of actions in a task on a page."""


@dataclass(frozen=True)
class PageState:
    """What a page shows: the tasks of a given length that satisfy conditions and begin with the chosen actions.

    `beside` are the conditions to compare with `where`. With the level ``plan``, interchangeable entities are shown
    separately; with ``task``, they are shown as one.
    """

    length: int
    where: tuple[str, ...] = ()
    chosen: tuple[str, ...] = ()
    beside: tuple[str, ...] = ()
    by: Level = "task"

    @property
    def query(self) -> str:
        """The query of the link."""
        fields: list[tuple[str, str]] = [("length", str(self.length))]
        fields += [("where", text) for text in self.where] + [("beside", text) for text in self.beside]
        fields += [("by", "plan")] if self.by == "plan" else []
        return urlencode([*fields, *(("do", action) for action in self.chosen)])

    def choosing(self, *actions: str) -> PageState:
        """Return the state with further actions."""
        return replace(self, chosen=(*self.chosen, *actions))


FIELDS = ("length", "where", "beside", "by", "do")


def fields_of_query(query: str, names: Sequence[str]) -> dict[str, list[str]]:
    """Return the values of each field of a link, in their order.

    Raises:
        QueryError: there are too many fields, or the name of one is not among `names`.
    """
    try:
        fields = parse_qsl(query, keep_blank_values=True, max_num_fields=MOST_FIELDS)
    except ValueError:
        raise QueryError(f"the link has more than {MOST_FIELDS} fields; open a shorter one") from None
    values: dict[str, list[str]] = {name: [] for name in names}
    for name, value in fields:
        if name not in values:
            raise QueryError(unknown(name, names, "field of a link"))
        values[name].append(value)
    return values


def parse_query(query: str) -> PageState:
    """Return the state that a query describes.

    Raises:
        QueryError: a field is unknown, missing or wrong.
    """
    values = fields_of_query(query, FIELDS)
    if len(values["length"]) != 1 or len(values["by"]) > 1:
        raise QueryError("a link has one length and at most one level, such as ?length=15&by=plan")
    text, level = values["length"][0], (values["by"] or ["task"])[0]
    if not (text.isascii() and text.isdigit() and len(text) <= len(str(LONGEST_LENGTH))):
        raise QueryError(f"length {text[:20]!r}: write a number from 0 to {LONGEST_LENGTH:,}")
    if int(text) > LONGEST_LENGTH:
        raise QueryError(f"length {text}: a page shows at most {LONGEST_LENGTH:,} actions; choose a smaller length")
    if level not in ("task", "plan"):
        raise QueryError(f"level {level[:20]!r}: choose task or plan")
    by: Level = "plan" if level == "plan" else "task"
    conditions = (tuple(text for text in values[name] if text.strip()) for name in ("where", "beside"))
    where, beside = conditions
    return PageState(int(text), where, tuple(values["do"]), beside, by)
