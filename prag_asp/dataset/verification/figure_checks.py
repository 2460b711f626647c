"""The figures of dataset.json: what follows from its shards, from the space, and from what was asked for."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from copy import deepcopy
from itertools import pairwise
from typing import TYPE_CHECKING

import msgspec

from prag_asp.dataset.store.manifest import NAME, Manifest, PartNote, Shard, derive
from prag_asp.dataset.verification.finding import Finding
from prag_asp.integers import grouped, number_of
from prag_asp.output.digests import digest

if TYPE_CHECKING:
    from prag_asp.space.distinct_sampling import TaskOrder
    from prag_asp.space.task_space import TaskSpace

DERIVED = ("draws", "tasks", "covered", "lengths")


def wrong_figures(manifest: Manifest) -> Iterator[Finding]:
    """Yield what does not follow from the shards that dataset.json lists."""
    again = deepcopy(manifest)
    derive(again)
    for part, right in zip(manifest.parts, again.parts, strict=True):
        for name in DERIVED:
            if getattr(part, name) != getattr(right, name):
                yield Finding(NAME, None, f"parts, {part.name}: {name} is not what its shards add up to")
        if part.tail is not None:
            yield Finding(NAME, None, f"parts, {part.name}: a shard of it is not written to its end")
        if part.tasks > part.wanted:
            yield Finding(NAME, None, f"parts, {part.name}: has more tasks than the {part.wanted} that were wanted")
        yield from _wrong_shards(part)
    if manifest.covered != again.covered:
        yield Finding(NAME, None, "covered is not the share of the space that the parts have")
    identity = digest([msgspec.to_builtins(manifest.domain), msgspec.to_builtins(manifest.asked)])
    if manifest.identity != identity:
        yield Finding(NAME, None, "identity is not that of the domain and of what was asked for")


def _wrong_shards(part: PartNote) -> Iterator[Finding]:
    for number, shard in enumerate(part.shards):
        if shard.number != number:
            yield Finding(NAME, None, f"parts, {part.name}: shard {number} has the number {shard.number}")
        yield from _wrong_shard(part, shard)
    for one, other in pairwise(part.shards):
        if one.end != other.first:
            yield Finding(NAME, None, f"parts, {part.name}: shard {other.number} begins at draw {other.first}, not "
                                      f"at {one.end}, where the one before it ends")  # fmt: skip
    if part.shards and part.shards[0].first:
        yield Finding(NAME, None, f"parts, {part.name}: the first shard begins at draw {part.shards[0].first}")


def _wrong_shard(part: PartNote, shard: Shard) -> Iterator[Finding]:
    """Yield what the tally of a shard says otherwise than its files."""
    passed = sum(each.feasible for each in shard.tally)
    refused = sum(each.not_found + each.infeasible for each in shard.tally)
    drawn, witnesses = sum(each.drawn for each in shard.tally), sum(each.witnesses for each in shard.tally)
    said = {"tasks": passed, "refused": refused, "witnesses": witnesses, "draws": drawn}
    counted = {table: shard.rows(table) for table in ("tasks", "refused", "witnesses")}
    for what, number in {**counted, "draws": shard.end - shard.first}.items():
        if said[what] != number:
            told = f"the tally of shard {shard.number} has {said[what]} {what}; there are {number}"
            yield Finding(NAME, None, f"parts, {part.name}: {told}")


def wrong_sizes(
    manifest: Manifest, spaces: Mapping[int, TaskSpace], parts: Mapping[str, TaskOrder]
) -> Iterator[Finding]:
    """Yield which exact numbers of tasks are not those that are counted now."""
    for space in manifest.spaces:
        count = spaces[space.length].count()
        if number_of(space.tasks) != count:
            told = f"there are {grouped(count)} tasks of length {space.length}, not {grouped(number_of(space.tasks))}"
            yield Finding(NAME, None, f"spaces: {told}")
    for part in manifest.parts:
        if number_of(part.size) != parts[part.name].size:
            told = f"has {grouped(parts[part.name].size)} tasks to draw, not {grouped(number_of(part.size))}"
            yield Finding(NAME, None, f"parts, {part.name}: {told}")
