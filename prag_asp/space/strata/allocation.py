"""The allocation of a sample to strata: proportional, equal, or based on given standard deviations (Neyman)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import floor
from typing import Literal, Protocol

from prag_asp.errors import QueryError
from prag_asp.exact_numbers import Number, parse_number
from prag_asp.wording import plural, unknown

StratifiedBy = Literal["length", "skeleton", "goal"]
STRATIFIED_BY: tuple[StratifiedBy, ...] = ("length", "skeleton", "goal")

FEWEST = 2
"""The minimum number of tasks from a stratum, unless it has fewer: the variance in a stratum needs two."""

PROPORTIONAL, EQUAL = "proportional", "equal"


class NamedSize(Protocol):
    """The data about a stratum that an allocation needs: its name and its size."""

    @property
    def name(self) -> str:
        """The name of the stratum."""
        ...

    @property
    def size(self) -> int:
        """The number of tasks in the stratum."""
        ...


@dataclass(frozen=True)
class Stratification:
    """The criterion that divides tasks into strata, and how a sample is allocated to them.

    `allocation` is ``proportional`` or ``equal``, or maps names of strata to the standard deviation of a result in
    each; a stratum without a standard deviation gets the largest one.
    """

    by: StratifiedBy
    allocation: str | Mapping[str, Fraction] = PROPORTIONAL

    @classmethod
    def parse(cls, by: StratifiedBy, allocation: str | Mapping[str, Number] = PROPORTIONAL) -> Stratification:
        """Return the stratification for an allocation, which may be a text such as ``length_2=0.3,length_3=0.5``.

        Raises:
            QueryError: the allocation is neither proportional, equal, nor standard deviations of at least 0.
        """
        if isinstance(allocation, str):
            if allocation in (PROPORTIONAL, EQUAL):
                return cls(by, allocation)
            pairs = [each.partition("=") for each in allocation.split(",")]
            if not all(name and equals for name, equals, _ in pairs):
                raise QueryError(
                    f"allocation {allocation}: choose {PROPORTIONAL} or {EQUAL}, or give standard deviations of "
                    "strata, such as length_2=0.3,length_3=0.5"
                )
            allocation = {name.strip(): number.strip() for name, _, number in pairs}
        deviations = {name: parse_number(f"deviation of {name}", number) for name, number in allocation.items()}
        if min(deviations.values(), default=0) < 0 or not any(deviations.values()):
            raise QueryError("standard deviations of strata are at least 0, and one is above 0")
        return cls(by, deviations)

    def __str__(self) -> str:
        if isinstance(self.allocation, str):
            return self.allocation
        return ",".join(f"{name}={number}" for name, number in sorted(self.allocation.items()))

    def counts(self, strata: Sequence[NamedSize], count: int) -> list[int]:
        """Return the number of tasks from each stratum in a sample of `count` tasks.

        Each stratum contributes at least two tasks, or all of its tasks if it has fewer. Apart from that, the numbers
        are proportional to the sizes of the strata, equal, or proportional to the products of sizes and standard
        deviations, which minimises the variance (Neyman 1934; Cochran, Sampling Techniques, 1977, section 5.5). They
        are rounded by the method of largest remainders.

        Raises:
            QueryError: no allocation has this number of tasks, or there is no stratum with a given name.
        """
        sizes, allocation = [stratum.size for stratum in strata], self.allocation
        if isinstance(allocation, str):
            return allocate(sizes, count, [Fraction(size if allocation == PROPORTIONAL else 1) for size in sizes])
        names = [stratum.name for stratum in strata]
        for name in allocation:
            if name not in names:
                raise QueryError(unknown(name, names, "stratum"))
        largest = max(allocation.values())
        return allocate(
            sizes, count, [size * allocation.get(name, largest) for name, size in zip(names, sizes, strict=True)]
        )


def allocate(sizes: Sequence[int], count: int, shares: Sequence[Fraction]) -> list[int]:
    """Return numbers of tasks that sum to `count`, in proportion to `shares` as far as the `sizes` of the strata allow.

    Each number is between two and the size of its stratum, or equal to the size if that is smaller.

    Raises:
        QueryError: there is no such allocation.
    """
    fewest = [min(FEWEST, size) for size in sizes]
    if not sum(fewest) <= count <= sum(sizes):
        what = "task" if len(sizes) == 1 else "tasks"
        raise QueryError(
            f"{plural(count, 'task')} in {plural(len(sizes), 'stratum', 'strata')}: request {sum(fewest)} to "
            f"{sum(sizes)} {what}"
        )
    quotas = _quotas(fewest, sizes, count, shares)
    if quotas is None:
        able = sum(size if share else least for least, size, share in zip(fewest, sizes, shares, strict=True))
        raise QueryError(f"{plural(count, 'task')}: the strata with positive deviations allow at most {able}")
    numbers = [floor(quota) for quota in quotas]
    order = sorted(range(len(sizes)), key=lambda place: (numbers[place] - quotas[place], -sizes[place], place))
    for place in order[: count - sum(numbers)]:
        numbers[place] += 1
    return numbers


def _quotas(
    fewest: Sequence[int], sizes: Sequence[int], count: int, shares: Sequence[Fraction]
) -> list[Fraction] | None:
    """Return a multiple of `shares`, clipped to the bounds of each share, that sums to `count`, or None.

    The sum grows with the factor, and is linear between the factors at which a share reaches a bound.
    """
    bounds = list(zip(fewest, shares, sizes, strict=True))

    def quotas(multiple: Fraction) -> list[Fraction]:
        return [max(Fraction(least), min(multiple * share, Fraction(most))) for least, share, most in bounds]

    ends = sorted({Fraction(bound) / share for least, share, most in bounds if share for bound in (least, most)})
    below = Fraction(0)
    for end in ends:
        at_end, at_begin = (sum(quotas(each), start=Fraction(0)) for each in (end, below))
        if at_end >= count:
            part = (count - at_begin) / (at_end - at_begin) if at_end > at_begin else Fraction(0)
            return quotas(below + part * (end - below))
        below = end
    return None if sum(fewest) != count else list(map(Fraction, fewest))
