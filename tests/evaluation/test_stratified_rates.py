"""Estimates from stratified samples: unbiased over all samples, with weights that sum to 1, and with an interval."""

from __future__ import annotations

from fractions import Fraction
from itertools import combinations, permutations, product
from math import comb, prod, sqrt
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pyarrow.parquet as pq
import pytest

from prag_asp import Dataset, QueryError, TaskSpace, load_domain
from prag_asp.dataset import generate, read_lines
from prag_asp.dataset.strata.stratified_sampling import stratified_sample
from prag_asp.dataset.strata.stratum_figures import StratumFigures, stratum_weights
from prag_asp.evaluation import FreshScenarios, Results, StoredScenarios, compare, evaluate
from prag_asp.evaluation.stratified_rates import stratified_difference, stratified_rate
from prag_asp.rl.skill_chains import Rate
from prag_asp.space.strata.allocation import Stratification
from tests.commands import ok


def episodes(outcomes: dict[str, list[int]]) -> list[Any]:
    """Return one episode for each outcome of a stratum."""
    return [
        SimpleNamespace(part=name, task=[str(number)], success=bool(value))
        for name, values in outcomes.items()
        for number, value in enumerate(values)
    ]


def test_the_weighted_rate_is_unbiased_over_all_samples_of_a_small_space() -> None:
    space, numbers = {"a": [1, 0, 0, 1], "b": [0, 1, 1], "c": [1, 0]}, {"a": 2, "b": 2, "c": 2}
    true = Fraction(sum(map(sum, space.values())), sum(map(len, space.values())))
    strata = [StratumFigures(name, str(len(space[name])), n, n, n) for name, n in numbers.items()]
    assert sum(stratum_weights(strata).values()) == 1
    total, squares, variances = Fraction(0), Fraction(0), 0.0
    for chosen in product(*(combinations(space[name], n) for name, n in numbers.items())):
        rate = stratified_rate(episodes(dict(zip(space, map(list, chosen), strict=True))), strata)
        total, squares, variances = total + rate.share, squares + (rate.share - true) ** 2, variances + rate.error**2
    samples = prod(comb(len(space[name]), n) for name, n in numbers.items())
    assert total / samples == true
    assert variances / samples == pytest.approx(float(squares / samples))  # the estimated variance is unbiased, too


def test_the_estimated_number_of_feasible_tasks_and_its_variance_are_unbiased_over_all_orders() -> None:
    for feasible in range(2, 6):
        tasks = [1] * feasible + [0] * (6 - feasible)
        shares, variances = [], []
        for order in permutations(tasks):
            draws = next(number for number in range(1, 7) if sum(order[:number]) == 2)
            figures = StratumFigures("a", "6", 2, draws, 2)
            shares.append(figures.share)
            variances.append(figures.variance)
        true = Fraction(feasible, 6)
        assert sum(shares) / len(shares) == true
        if feasible > 2:  # with exactly two, the formula divides by zero when both come first
            assert sum(variances) / len(variances) == sum((each - true) ** 2 for each in shares) / len(shares)


def test_a_single_stratum_has_wilsons_interval_corrected_for_the_finite_population() -> None:
    for successes in (0, 3, 8):
        outcomes = {"a": [1] * successes + [0] * (8 - successes)}
        large = stratified_rate(episodes(outcomes), [StratumFigures("a", "8" + "0" * 30, 8, 8, 8)])
        assert (large.low, large.high) == pytest.approx(Rate(successes, 8).interval())
        half = stratified_rate(episodes(outcomes), [StratumFigures("a", "15", 8, 8, 8)])  # worth 8 * 14 / 7 tasks
        assert (half.low, half.high) == pytest.approx(Rate(2 * successes, 16).interval())
        whole = stratified_rate(episodes(outcomes), [StratumFigures("a", "8", 8, 8, 8)])
        assert whole.low == whole.high == successes / 8 and whole.error == 0


def test_the_difference_of_pairs_has_the_variance_of_paired_tasks() -> None:
    strata = [StratumFigures("a", "1000000", 40, 40, 40), StratumFigures("b", "3000000", 40, 40, 40)]
    first, second = (
        episodes({"a": [1, 0] * 20, "b": [1] * 30 + [0] * 10}),
        episodes({"a": [1, 0] * 20, "b": [1, 0] * 20}),
    )
    same = stratified_difference(list(zip(first, first, strict=True)), strata)
    assert same.difference == 0 and -0.02 < same.low < 0 < same.high < 0.02
    found = stratified_difference(list(zip(first, second, strict=True)), strata)
    assert found.difference == Fraction(3, 4) * Fraction(1, 4)
    differences = [one.success - two.success for one, two in zip(first[40:], second[40:], strict=True)]
    mean = sum(differences) / 40
    error = 0.75 * sqrt(sum((each - mean) ** 2 for each in differences) / 39 / 40)
    assert found.high - found.low == pytest.approx(2 * 1.96 * error, rel=0.1)


def test_a_sample_has_weights_that_sum_to_one_and_survive_a_file() -> None:
    space = TaskSpace(load_domain("hanoi"), "1..3")
    sample = stratified_sample(space, 8, Stratification.parse("length"))
    weights = [record.weight for record in sample.records]
    assert sum(filter(None, weights)) == 1 and weights[0] == Fraction(1, 12)  # the only task of length 1, of 12
    lines = ok("sample", "hanoi", "-n", "1..3", "--count", "8", "--strata", "length", "--format", "jsonl").splitlines()
    assert [(each.stratum, each.weight) for each in read_lines(lines, "lines")] == [
        (record.stratum, record.weight) for record in sample.records
    ]


@pytest.mark.parametrize("others", [["--over", "goals"], ["--weight", "move=2"], ["--by", "plan"]])
def test_strata_are_refused_with_options_that_choose_other_tasks(others: list[str]) -> None:
    with pytest.raises(AssertionError, match="strata are sampled uniformly"):
        ok("sample", "hanoi", "-n", "2", "--strata", "goal", "--no-physics", *others)


@pytest.fixture(scope="module")
def spaces() -> TaskSpace:
    return TaskSpace(load_domain("tabletop"), "1..2")


def test_a_dataset_of_strata_has_weights_and_its_evaluation_the_same(spaces: TaskSpace, tmp_path: Path) -> None:
    by_length = Stratification.parse("length", "equal")
    data = generate(spaces, tmp_path / "data", tasks=4, stratification=by_length)
    weights = [Fraction(int(each.weight.numerator), int(each.weight.denominator)) for each in data.manifest.parts]
    assert sum(2 * weight for weight in weights) == 1
    assert Dataset.open(tmp_path / "data").manifest.strata == data.manifest.strata
    results = evaluate("zeros", StoredScenarios.open(tmp_path / "data"), steps=1)
    assert [Fraction(each.weight) for each in results.episodes] == [weights[0]] * 2 + [weights[1]] * 2
    part = evaluate("zeros", StoredScenarios.open(tmp_path / "data", ["length_1"]), steps=1)
    assert part.whole_space() is None and results.whole_space() is not None
    with pytest.raises(QueryError, match="leave the split out"):
        generate(spaces, tmp_path / "other", tasks=4, stratification=by_length, split={"a": 1})


def test_fresh_scenarios_of_strata_are_weighted_and_do_not_depend_on_workers(spaces: TaskSpace, tmp_path: Path) -> None:
    source = FreshScenarios(spaces, 4, seed=1, stratification=Stratification.parse("length", "equal"))
    one = evaluate("zeros", source, tmp_path / "one", steps=1)
    evaluate("zeros", source, tmp_path / "two", steps=1, workers=2)
    table = pq.read_table(tmp_path / "one" / "episodes.parquet")
    assert table == pq.read_table(tmp_path / "two" / "episodes.parquet")
    assert sum(map(Fraction, table["weight"].to_pylist())) == 1
    assert sum(table["weight_value"].to_pylist()) == pytest.approx(1)
    assert [each.size for each in one.record.strata] == ["15", "360"]
    comparison = compare(Results.open(tmp_path / "one"), Results.open(tmp_path / "two"))
    assert comparison.whole_space() is not None and "whole space" in comparison.table()
