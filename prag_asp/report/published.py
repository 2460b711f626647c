"""Counts for shipped domains that have been published in papers, to be shown beside the exact ones."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True)
class PublishedCount:
    """A published number of skeletons with a given length that begin with a name, and its source."""

    length: int
    prefix: str
    count: int
    source: str


PUBLISHED: Mapping[str, PublishedCount] = {
    "prag": PublishedCount(
        15, "approach", 190_000_000, "PRAG (Škoviera, Vavrečka, Šejnová and Štěpánová): about 1.9 x 10^8 sequences"
    )
}
"""The published count for each domain, by the name of the domain."""
