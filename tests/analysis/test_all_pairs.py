"""Distances of all pairs in blocks are those of each pair."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from prag_asp import QueryError
from prag_asp.analysis.all_pairs import pair_distances
from prag_asp.similarity import METRICS, compare
from prag_asp.similarity.edit_arrays import unit_edit_distances, weighted_edit_distances
from prag_asp.task import Task
from tests.chance import Chance
from tests.similarity.random_tasks import BACKGROUND, random_task


class Known:
    """What knows the background of the made-up world."""

    background = BACKGROUND


def random_tasks(name: str, chance: Chance, count: int = 9) -> list[Task]:
    generator = chance.generator(11)
    lengths = [3 if name.startswith("hamming") else generator.randint(0, 4) for _ in range(count)]
    tasks = [random_task(generator, length) for length in lengths]
    return [*tasks, *tasks[:2]]


@pytest.mark.parametrize("name", METRICS)
def test_the_distances_of_all_pairs_are_those_of_each(
    name: str, chance: Chance, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("prag_asp.analysis.all_pairs.STRIPE", 25)
    tasks = random_tasks(name, chance)
    pairs = pair_distances(tasks, name, Known)
    object.__setattr__(pairs.table, "shape", (2, 5))
    square = pairs.square()[np.ix_(pairs.place, pairs.place)] / (pairs.table.denominator or 1)
    stripes = np.concatenate([values for _, values in pairs.stripes()]) / (pairs.table.denominator or 1)
    for (i, one), (j, other) in itertools.product(enumerate(tasks), repeat=2):
        expected = float(compare(one, other, name, BACKGROUND).distance)
        assert square[i, j] == stripes[i, j] == pytest.approx(expected, abs=1e-6)
    assert pairs.features <= len(tasks) - 2


@pytest.mark.parametrize("length", [1, 7, 8, 9, 16, 17, 33, 64, 65])
def test_bit_vectors_give_the_distances_of_the_table(length: int, chance: Chance) -> None:
    generator = np.random.default_rng(chance.seed(length))
    for width in (0, 1, 5, 64, 70):
        rows, columns = (generator.integers(0, 3, (4, size)) for size in (length, width))
        found = unit_edit_distances(rows, columns, 3)
        assert (found == weighted_edit_distances(rows, columns, 1 - np.eye(4, dtype=np.int64))).all()
        assert found.shape == (4, 4)


def test_too_many_renamings_are_refused(chance: Chance, monkeypatch: pytest.MonkeyPatch) -> None:
    tasks = random_tasks("levenshtein", chance)
    monkeypatch.setattr("prag_asp.analysis.all_pairs.MOST_IMAGES", 10)
    with pytest.raises(QueryError, match="more than 10 renamings that matter; compare fewer tasks"):
        pair_distances(tasks, "levenshtein", Known)
