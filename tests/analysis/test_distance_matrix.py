"""Matrices, neighbours, near-duplicates, clusters and maps agree with their definitions."""

from __future__ import annotations

import itertools
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from prag_asp import QueryError
from prag_asp.analysis import (
    SimilarityMatrix,
    dendrogram_of,
    near_duplicates,
    nearest_neighbours,
    pair_distances,
    similarity_matrix,
    task_map,
    without_duplicates,
)
from prag_asp.analysis.plots.dendrogram import dendrogram_figure
from prag_asp.analysis.plots.picture import saved
from prag_asp.analysis.plots.task_scaling import map_figure
from prag_asp.similarity import compare
from tests.analysis.test_all_pairs import Known, random_tasks
from tests.chance import Chance
from tests.similarity.random_tasks import BACKGROUND


@pytest.fixture(scope="module")
def matrix(chance: Chance) -> SimilarityMatrix:
    return similarity_matrix(random_tasks("levenshtein", chance), "levenshtein", within=Known)


def test_similarities_are_those_of_each_pair(chance: Chance) -> None:
    tasks = random_tasks("combined", chance)
    for metric in ("combined", "levenshtein-classes", "goal"):
        found = similarity_matrix(tasks, metric, within=Known).similarities
        for (i, one), (j, other) in itertools.product(enumerate(tasks), repeat=2):
            assert found[i, j] == pytest.approx(compare(one, other, metric, BACKGROUND).similarity, abs=1e-6)


def test_files_hold_the_matrix_and_the_neighbours(matrix: SimilarityMatrix, tmp_path: Path) -> None:
    from pyarrow.parquet import read_table

    matrix.save(tmp_path / "m.npz")
    with np.load(tmp_path / "m.npz") as arrays:
        assert (arrays["units"] / arrays["denominator"] == matrix.distances).all()
    matrix.save(tmp_path / "m.parquet")
    rows = read_table(tmp_path / "m.parquet").to_pylist()
    assert len(rows) == 11 * 10 // 2
    assert all(row["distance"] == matrix.distances[row["task"], row["other"]] for row in rows)
    near = nearest_neighbours(matrix, 3)
    near.save(tmp_path / "n.parquet")
    assert read_table(tmp_path / "n.parquet")["other"].to_pylist() == near.tasks.ravel().tolist()
    with pytest.raises(QueryError, match=r"ends in \.npz or \.parquet"):
        matrix.save(tmp_path / "m.csv")


def test_neighbours_and_duplicates_are_those_of_a_search_with_and_without_a_matrix(
    matrix: SimilarityMatrix, chance: Chance
) -> None:
    distances = matrix.distances
    pairs = pair_distances(random_tasks("levenshtein", chance), "levenshtein", Known)
    for given in (matrix, pairs):
        near = nearest_neighbours(given, 3)
        for task, row in enumerate(distances):
            others = sorted((distance, other) for other, distance in enumerate(row) if other != task)[:3]
            assert [*zip(near.distances[task], near.tasks[task], strict=True)] == others
        expected = [(i, j, distances[i, j]) for i, j in itertools.combinations(range(11), 2) if distances[i, j] <= 2]
        assert list(near_duplicates(given, 2)) == expected
        kept = without_duplicates(given, 2)
        assert all(distances[i, j] > 2 for i, j in itertools.combinations(kept, 2))
        assert all(any(distances[i, j] <= 2 for j in kept) for i in range(11))


def test_clusters_merge_at_the_least_mean_distance(chance: Chance) -> None:
    generator = np.random.default_rng(chance.seed(2))
    points = generator.random((12, 3))
    distances = np.linalg.norm(points[:, None] - points, axis=-1)
    found = dendrogram_of(distances)
    clusters = {frozenset([task]) for task in range(12)}
    for number, (_, _, height, size) in enumerate(found.merges):
        means = {
            (distances[np.ix_(sorted(a), sorted(b))].mean(), a | b) for a, b in itertools.combinations(clusters, 2)
        }
        least, union = min(means, key=lambda each: each[0])
        assert height == pytest.approx(least) and size == len(union)
        clusters = {each for each in clusters if not each <= union} | {union}
        after = (height + found.merges[number + 1][2]) / 2 if number < 10 else height
        assert {frozenset(each) for each in found.clusters(after)} == clusters
    assert sorted(found.leaves) == list(range(12))


def test_a_map_of_points_in_the_plane_keeps_their_distances(chance: Chance) -> None:
    points = np.random.default_rng(chance.seed(4)).random((15, 2))
    distances = np.linalg.norm(points[:, None] - points, axis=-1)
    placed = task_map(distances)
    again = np.linalg.norm(placed.points[:, None] - placed.points, axis=-1)
    assert np.allclose(again, distances) and placed.share == pytest.approx(1)
    assert (placed.points.max(axis=0) >= -placed.points.min(axis=0)).all()


def test_pictures_show_the_clusters_and_the_map(matrix: SimilarityMatrix) -> None:
    labels = [f"task_{number}" for number in range(11)]
    drawn = dendrogram_figure(dendrogram_of(matrix.distances), labels, "t")
    assert sorted(text.get_text() for text in drawn.axes[0].get_yticklabels()) == sorted(labels)
    assert len(drawn.axes[0].collections[0].get_segments()) == 10
    placed = map_figure(task_map(matrix.distances), ["a"] * 5 + ["b"] * 6, "t")
    assert [len(each.get_offsets()) for each in placed.axes[0].collections] == [5, 6]
    with Image.open(BytesIO(saved(placed, ".png"))) as image:
        assert image.size == (1400, 1400)


def test_no_task_and_one_task_have_a_matrix_a_tree_and_a_map(chance: Chance) -> None:
    tasks = random_tasks("levenshtein", chance)
    for count in (0, 1):
        few = similarity_matrix(tasks[:count], "levenshtein", within=Known)
        assert few.units.shape == (count, count) and nearest_neighbours(few).tasks.shape == (count, 0)
        assert dendrogram_of(few.distances).leaves == tuple(range(count))
        assert task_map(few.distances).points.shape == (count, 2)
