"""Chosen tasks are far apart, within the guarantee of the farthest-first choice."""

from __future__ import annotations

import itertools

import pytest

from prag_asp import QueryError
from prag_asp.analysis import diverse_choice, novelty, pair_distances, similarity_matrix
from tests.analysis.test_all_pairs import Known, random_tasks
from tests.chance import Chance


@pytest.mark.parametrize("metric", ["levenshtein", "goal", "jaro"])
def test_a_choice_is_as_far_apart_as_it_says_and_at_least_half_of_the_best(metric: str, chance: Chance) -> None:
    tasks = random_tasks(metric, chance)
    matrix = similarity_matrix(tasks, metric, within=Known)
    distances, numbers = matrix.distances, range(len(tasks))
    for count in (1, 2, 3, 4):
        found = diverse_choice(matrix, count)
        assert found == diverse_choice(pair_distances(tasks, metric, within=Known), count)
        assert len(set(found.tasks)) == count

        def separation(chosen: tuple[int, ...]) -> float:
            return min((distances[pair] for pair in itertools.combinations(chosen, 2)), default=0.0)

        def radius(chosen: tuple[int, ...]) -> float:
            return max(min(distances[one, other] for other in chosen) for one in numbers)

        assert found.separation == separation(found.tasks) and found.radius == radius(found.tasks)
        if metric != "jaro":
            choices = list(itertools.combinations(numbers, count))
            assert 2 * found.separation >= max(map(separation, choices))
            assert found.radius <= 2 * min(map(radius, choices))


def test_equal_tasks_are_chosen_once_each(chance: Chance) -> None:
    tasks = random_tasks("goal", chance)[:1] * 3
    found = diverse_choice(similarity_matrix(tasks, "goal", within=Known), 3)
    assert (found.tasks, found.separation, found.radius) == ((0, 1, 2), 0.0, 0.0)
    with pytest.raises(QueryError, match="cannot choose 4 of 3 tasks; choose at least 1 and at most 3"):
        diverse_choice(similarity_matrix(tasks, "goal", within=Known), 4)


@pytest.mark.parametrize("metric", ["levenshtein-classes", "goal", "jaro"])
def test_the_novelty_of_a_task_is_its_least_distance(metric: str, chance: Chance) -> None:
    tasks = random_tasks(metric, chance)
    new, given = tasks[:4], tasks[3:]
    found = novelty(new, given, metric, within=Known)
    for task, distance, nearest in zip(new, found.distances, found.nearest, strict=True):
        expected = [float(task.distance(other, metric, within=Known)) for other in given]
        assert distance == pytest.approx(min(expected), abs=1e-6)
        assert expected[nearest] == pytest.approx(min(expected), abs=1e-6)
    assert found.distances[3] == 0
    with pytest.raises(QueryError, match="no given task"):
        novelty(new, [], metric, within=Known)
