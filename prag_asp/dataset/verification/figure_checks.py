"""Check the figures of dataset.json against its shards, the space and the request."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from copy import deepcopy
from itertools import pairwise
from typing import TYPE_CHECKING

from prag_asp.dataset.store.manifest import NAME, Manifest, PartManifest, derive, identity_of
from prag_asp.dataset.verification.finding import Finding
from prag_asp.integers import grouped, number_of

if TYPE_CHECKING:
    from prag_asp.space.distinct_sampling import TaskOrder
    from prag_asp.space.task_space import TaskSpace

DERIVED = ("draws", "tasks", "covered", "lengths")


def wrong_figures(manifest: Manifest) -> Iterator[Finding]:
    """Yield findings about figures that do not follow from the shards in dataset.json."""
    expected = deepcopy(manifest)
    derive(expected)
    for part, expected_part in zip(manifest.parts, expected.parts, strict=True):
        for name in DERIVED:
            if getattr(part, name) != getattr(expected_part, name):
                yield Finding(NAME, None, f"parts, {part.name}: {name} is not what the shards add up to")
        if part.tail is not None:
            yield Finding(NAME, None, f"parts, {part.name}: its last shard is incomplete")
        if part.tasks > part.requested:
            yield Finding(NAME, None, f"parts, {part.name}: has more tasks than the {part.requested} requested")
        yield from _wrong_shards(part)
    if manifest.covered != expected.covered:
        yield Finding(NAME, None, "covered is not the share of the space that the parts cover")
    if manifest.identity != identity_of(manifest.domain, manifest.request):
        yield Finding(NAME, None, "identity is not that of the domain and the request")


def _wrong_shards(part: PartManifest) -> Iterator[Finding]:
    for number, shard in enumerate(part.shards):
        if shard.number != number:
            yield Finding(NAME, None, f"parts, {part.name}: shard {number} has the number {shard.number}")
        tallied = {
            "tasks": sum(each.feasible for each in shard.tally),
            "rejected": sum(each.trivial + each.not_found + each.infeasible for each in shard.tally),
            "witnesses": sum(each.witnesses for each in shard.tally),
            "draws": sum(each.drawn for each in shard.tally),
        }
        for what, tally in tallied.items():
            there = shard.end - shard.first if what == "draws" else shard.rows(what)
            if tally != there:
                problem = f"the tally of shard {shard.number} has {tally} {what}; there are {there}"
                yield Finding(NAME, None, f"parts, {part.name}: {problem}")
    for one, other in pairwise(part.shards):
        if one.end != other.first:
            yield Finding(NAME, None, f"parts, {part.name}: shard {other.number} begins at draw {other.first}, not "
                                      f"at {one.end}, where the one before it ends")  # fmt: skip
    if part.shards and part.shards[0].first:
        yield Finding(NAME, None, f"parts, {part.name}: the first shard begins at draw {part.shards[0].first}")


def wrong_sizes(
    manifest: Manifest, spaces: Mapping[int, TaskSpace], parts: Mapping[str, TaskOrder]
) -> Iterator[Finding]:
    """Yield findings about exact numbers of tasks that differ from a new count."""
    for space in manifest.spaces:
        count = spaces[space.length].count()
        if number_of(space.tasks) != count:
            problem = (
                f"there are {grouped(count)} tasks of length {space.length}, not {grouped(number_of(space.tasks))}"
            )
            yield Finding(NAME, None, f"spaces: {problem}")
    for part in manifest.parts:
        if number_of(part.size) != parts[part.name].size:
            problem = f"has {grouped(parts[part.name].size)} tasks to draw, not {grouped(number_of(part.size))}"
            yield Finding(NAME, None, f"parts, {part.name}: {problem}")
