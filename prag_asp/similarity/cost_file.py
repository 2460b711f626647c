"""Edit distances with costs that an author gives in a TOML file."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any

from prag_asp.atom import Atom
from prag_asp.errors import PragError, QueryError
from prag_asp.exact_numbers import parse_number
from prag_asp.safe_reading import read_bytes
from prag_asp.similarity.background import Background, Trace
from prag_asp.similarity.metrics import Metric
from prag_asp.similarity.own_costs import metric_with_costs
from prag_asp.tables.toml_text import key_line, parse_toml
from prag_asp.wording import unknown

NUMBERS, PAIRS = ("insert", "replace"), ("actions", "arguments")
"""The keys in a file: costs, and tables of costs for pairs."""

Pairs = Mapping[tuple[str, str], Fraction]


@dataclass(frozen=True)
class AuthorCosts:
    """Costs of edits of actions.

    Inserting or deleting an action costs `insert`. Replacing an action costs the sum of the costs of the pair of names
    and of all pairs of different arguments, but at most `replace`, which is also the cost of an unlisted pair. A pair
    of arguments is looked up by the arguments first, then by their classes.
    """

    insert: Fraction
    replace: Fraction
    actions: Pairs
    arguments: Pairs
    classes: Mapping[str, str]

    def __call__(self, one: Atom | None, other: Atom | None) -> Fraction:
        """Return the cost of replacing an action by another one; None stands for no action."""
        if one == other:
            return Fraction(0)
        if one is None or other is None:
            return self.insert
        cost = Fraction(0) if one.name == other.name else self._pair(self.actions, one.name, other.name)
        if len(one.arguments) != len(other.arguments):
            return self.replace
        for first, second in zip(one.arguments, other.arguments, strict=True):
            cost += Fraction(0) if first == second else self._argument(first, second)
        return min(cost, self.replace)

    def _argument(self, one: str, other: str) -> Fraction:
        if (one, other) in self.arguments or (other, one) in self.arguments:
            return self._pair(self.arguments, one, other)
        return self._pair(self.arguments, self.classes.get(one, one), self.classes.get(other, other))

    def _pair(self, pairs: Pairs, one: str, other: str) -> Fraction:
        return pairs.get((one, other), pairs.get((other, one), self.replace))


def read_costs(path: str | Path, tasks: Iterable[Trace], background: Background) -> Metric:
    """Return the edit distance with the costs that a file gives for the actions of the given tasks.

    If the costs are not a metric, `axioms` is False, and `summary` names actions that violate an axiom.

    Raises:
        QueryError: the file cannot be read, has keys or values that are not costs, names something that the tasks lack,
            or distinguishes interchangeable entities.
    """
    path, given = Path(path), tuple(tasks)
    try:
        text = read_bytes(path).decode()
        table = parse_toml(path, text)
    except (OSError, UnicodeDecodeError) as error:
        raise QueryError(f"{path}: cannot be read: {getattr(error, 'strerror', None) or error}") from None
    except PragError as error:
        raise QueryError(str(error)) from None
    actions = list(dict.fromkeys(action for task in given for action in task.actions))
    others = background.preconditions or ()
    names = {action.name for action in (*actions, *others)}
    terms = {term for action in (*actions, *others) for term in action.arguments}
    terms |= {*background.classes.values(), *background.parents}
    reader = _CostReader(path, text)
    for key in table:
        if key not in (*NUMBERS, *PAIRS):
            reader.refuse([key], unknown(key, (*NUMBERS, *PAIRS), "key"))
    insert, replace = (reader.number(table.get(key, 1), [key]) for key in NUMBERS)
    by_name = reader.pairs(table.get("actions", {}), "actions", names)
    by_argument = reader.pairs(table.get("arguments", {}), "arguments", terms)
    costs = AuthorCosts(insert, replace, by_name, by_argument, background.classes)
    return metric_with_costs(costs, actions, background)


@dataclass(frozen=True)
class _CostReader:
    """A checker of the values in a file; errors name the file and the line."""

    path: Path
    text: str

    def refuse(self, keys: list[str], why: str) -> None:
        """Raise an error about the value at the given keys."""
        raise QueryError(f"{self.path}:{key_line(self.text, keys)}: {why}")

    def number(self, value: Any, keys: list[str]) -> Fraction:
        """Return a cost."""
        try:
            cost = parse_number(".".join(keys), value)
        except QueryError as error:
            self.refuse(keys, str(error))
        if cost < 0:
            self.refuse(keys, f"{'.'.join(keys)}: {value} is negative; give a cost of at least 0")
        return cost

    def pairs(self, table: Any, key: str, known: Collection[str]) -> dict[tuple[str, str], Fraction]:
        """Return the costs of pairs, as a table for each first name, keyed by the second names."""
        example = f"write it like [{key}.NAME] with OTHER = 0.5"
        if not isinstance(table, dict):
            self.refuse([key], f"{key}: is not a table; {example}")
        costs: dict[tuple[str, str], Fraction] = {}
        for one, row in table.items():
            if not isinstance(row, dict):
                self.refuse([key, one], f"{key}.{one}: is not a table; {example}")
            for name, keys in ((one, [key, one]), *((other, [key, one, other]) for other in row)):
                if name not in known:
                    self.refuse(
                        keys, unknown(name, sorted(known), "action" if key == "actions" else "class or argument")
                    )
            costs.update({(one, other): self.number(cost, [key, one, other]) for other, cost in row.items()})
        return costs
