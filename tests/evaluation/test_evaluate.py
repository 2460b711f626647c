"""Evaluations: the same results however they are run, resumed where they stopped, of all kinds of policies."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import wraps
from pathlib import Path
from threading import Thread
from typing import Any

import msgpack
import numpy as np
import pyarrow.parquet as pq
import pytest

from prag_asp import Dataset, Domain, OutputError, QueryError, TaskSpace, load_domain
from prag_asp.dataset import Scenarios, generate
from prag_asp.evaluation import FreshScenarios, NamedScenarios, Results, StoredScenarios, compare, evaluate
from prag_asp.evaluation.evaluating import JOURNAL
from prag_asp.evaluation.policies import content_of
from prag_asp.rl import TaskEnv
from tests.commands import ok, run
from tests.evaluation import policies_under_test
from tests.evaluation.policies_under_test import Informed

HERE = "tests.evaluation.policies_under_test"


@pytest.fixture(scope="module")
def tabletop() -> Domain:
    return load_domain("tabletop")


@pytest.fixture(scope="module")
def fresh(tabletop: Domain) -> FreshScenarios:
    return FreshScenarios(TaskSpace(tabletop, 1), 3, seed=2)


@pytest.fixture(scope="module")
def dataset(tabletop: Domain, tmp_path_factory: pytest.TempPathFactory) -> Dataset:
    space = TaskSpace(tabletop, 1)
    return generate(
        space, tmp_path_factory.mktemp("evaluation") / "data", tasks=4, split={"train": "1/2", "test": "1/2"}
    )


@pytest.fixture(scope="module")
def oracle(dataset: Dataset, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("evaluation") / "oracle"
    evaluate("oracle", StoredScenarios.open(dataset.folder), folder)
    return folder


def table(folder: Path) -> bytes:
    return (folder / "episodes.parquet").read_bytes()


def test_results_do_not_depend_on_workers_and_resume_without_repeating(
    fresh: FreshScenarios, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    options: dict[str, Any] = {"steps": 6, "seed": 5}
    one = evaluate(f"{HERE}:noise", fresh, tmp_path / "one", **options)
    evaluate(f"{HERE}:noise", fresh, tmp_path / "two", workers=2, **options)
    assert table(tmp_path / "one") == table(tmp_path / "two")

    seen = 0

    def interrupt(words: str, done: int, total: int) -> None:
        if done == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        evaluate(f"{HERE}:noise", fresh, tmp_path / "three", progress=interrupt, **options)
    assert (tmp_path / "three" / JOURNAL).exists() and run(
        "compare", str(tmp_path / "one"), str(tmp_path / "three")
    ).returncode == 2

    noise = policies_under_test.noise

    @wraps(noise)  # so that the policy still comes from the same file
    def count(observation: Any) -> Any:
        nonlocal seen
        seen += 1
        return noise(observation)

    monkeypatch.setattr(policies_under_test, "noise", count)
    evaluate(f"{HERE}:noise", fresh, tmp_path / "three", **options)
    assert seen == one.episodes[2].steps, "only the last episode runs again"
    assert table(tmp_path / "one") == table(tmp_path / "three") and not (tmp_path / "three" / JOURNAL).exists()
    assert evaluate(f"{HERE}:noise", fresh, tmp_path / "one", **options) == one == Results.open(tmp_path / "one")
    with pytest.raises(OutputError, match="another evaluation"):
        evaluate(f"{HERE}:noise", fresh, tmp_path / "one", seed=6, steps=6)


def test_the_ids_of_results_are_scenarios_and_give_the_same_results(fresh: FreshScenarios, tmp_path: Path) -> None:
    results = evaluate("zeros", fresh, steps=4)
    ids = tmp_path / "ids"
    ids.write_text("".join(f"{episode.scenario}\n" for episode in results.episodes), encoding="utf-8")
    ok("evaluate", "zeros", "--scenarios", str(ids), "--steps", "4", "-o", str(tmp_path / "again"))
    again = Results.open(tmp_path / "again")
    assert again.episodes == results.episodes
    assert compare(results, again).whole() == (0, 0, 0, 3)
    task = Scenarios(fresh.domain).ranked((), 1, 3)
    for wrong in ([], [task]):
        with pytest.raises(QueryError):
            NamedScenarios(fresh.domain, wrong)


def test_the_table_has_a_row_for_each_episode_and_rates_by_group(dataset: Dataset, oracle: Path) -> None:
    results, rows = Results.open(oracle), pq.read_table(oracle / "episodes.parquet").to_pylist()
    assert [row["part"] for row in rows] == ["train"] * 2 + ["test"] * 2
    for number, row in enumerate(rows):
        assert row["scenario"] == str(dataset.scenario(number)) and row["task"] == [
            str(a) for a in dataset.task(number).actions
        ]
        assert row["instruction"] and row["steps"] == sum(each["steps"] for each in row["subgoals"])
        assert row["seconds"] == pytest.approx(row["steps"] / 20)
        assert row["success"] == (row["cause"] == "success") == (row["reached"] == row["length"])
    assert results.whole().successes >= 3, "the oracle solves most tasks"
    assert results.by("part")["test"].trials == 2 and results.by("length")["1"] == results.whole()
    assert sum(rate.trials for rate in results.by("action").values()) == 4
    assert results.by("class")["robot"] == results.whole()
    assert results.table().splitlines()[0].startswith("all") and "part test" in results.table()


def test_evaluations_are_paired_by_scenario_unless_they_differ(oracle: Path, dataset: Dataset, tmp_path: Path) -> None:
    first = Results.open(oracle)
    test = StoredScenarios.open(dataset.folder, ["test"])
    second = evaluate("zeros", test, tmp_path / "zeros", steps=100)
    with pytest.raises(QueryError, match="the option steps is"):
        compare(first, second)
    comparison = compare(first, second, across=True)
    assert comparison.whole().total == 2 and comparison.only_first == 2 and not comparison.only_second
    assert comparison.whole().first == first.by("part")["test"].successes
    done = run("compare", str(oracle), str(tmp_path / "zeros"), "--across")
    assert done.returncode == 0 and "2 episodes only in the first" in done.stderr and done.stdout.startswith(" ")
    with pytest.raises(QueryError, match="no scenario in common"):
        compare(
            evaluate("zeros", StoredScenarios.open(dataset.folder, ["train"]), steps=3),
            evaluate("zeros", test, steps=3),
        )


def test_functions_and_classes_are_policies_with_seeds_and_instructions(fresh: FreshScenarios) -> None:
    results = evaluate(Informed, fresh, steps=40)
    for episode in results.episodes:
        assert episode.cause in ("gave up", "success")
        assert episode.success or episode.steps == len(episode.instruction.split())


@pytest.mark.parametrize(
    ("policy", "message"),
    [
        (f"{HERE}:wrong", "an action has the shape"), (f"{HERE}:failing", "ZeroDivisionError: it divides by zero"),
        (f"{HERE}:leaving", "SystemExit: 0"), (f"{HERE}:Unmade", "cannot be created: ZeroDivisionError: it divides by"),
        (f"{HERE}:nothing", "has no callable"), ("no_such_module:act", "cannot be imported"), ("act", "give one of"),
        ("missing.zip", "no such file"), ("ws://127.0.0.1:9", "no policy server answers"),
    ],
)  # fmt: skip
def test_a_policy_that_fails_is_named_in_one_line(fresh: FreshScenarios, policy: str, message: str) -> None:
    with pytest.raises(QueryError, match=message) as error:
        evaluate(policy, fresh, steps=3)
    assert "\n" not in str(error.value)


def test_a_wrapper_that_fails_is_named_in_one_line(fresh: FreshScenarios) -> None:
    with pytest.raises(QueryError, match="the wrapper cannot be created: ZeroDivisionError: it divides by zero"):
        evaluate("zeros", fresh, steps=3, wrapper=policies_under_test.failing)


def test_results_of_a_policy_whose_file_changed_are_not_reused(
    fresh: FreshScenarios, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    module = tmp_path / "policy_that_changes.py"
    module.write_text("def act(observation):\n    return [0.0] * 5\n")
    options: dict[str, Any] = {"steps": 3}
    evaluate("policy_that_changes:act", fresh, tmp_path / "results", **options)
    evaluate("policy_that_changes:act", fresh, tmp_path / "results", **options)
    module.write_text("def act(observation):\n    return None\n")
    with pytest.raises(OutputError, match="before its files changed"):
        evaluate("policy_that_changes:act", fresh, tmp_path / "results", **options)


@pytest.mark.parametrize("name", ["model.zip", "checkpoint"])
def test_the_content_of_a_policy_is_that_of_its_files(tmp_path: Path, name: str) -> None:
    policy = tmp_path / name
    file = policy / "model.safetensors" if name == "checkpoint" else policy
    file.parent.mkdir(exist_ok=True)
    file.write_bytes(b"weights")
    before = content_of(str(policy))
    assert before == content_of(str(policy)) != ""
    file.write_bytes(b"weightS")
    assert content_of(str(policy)) != before
    assert content_of("zeros") == content_of("ws://localhost:1") == content_of("operator:neg") == ""


def test_a_zip_of_stable_baselines_predicts_as_its_model_does(fresh: FreshScenarios, tmp_path: Path) -> None:
    sb3 = pytest.importorskip("stable_baselines3")
    from prag_asp.evaluation.policies.stable_baselines import algorithm_of
    from prag_asp.rl import TaskEnv

    env = TaskEnv(fresh.space)
    for name in ("SAC", "PPO", "A2C"):
        model = getattr(sb3, name)("MlpPolicy", env, policy_kwargs={"net_arch": [4]}, device="cpu", seed=1)
        model.save(tmp_path / f"{name}.zip")
        assert algorithm_of(tmp_path / f"{name}.zip") == ("stable_baselines3", name)
    by_zip = evaluate(str(tmp_path / "A2C.zip"), fresh, steps=5)
    by_model = evaluate(lambda observation: model.predict(observation, deterministic=True)[0], fresh, steps=5)
    assert by_zip.episodes == by_model.episodes
    with pytest.raises(QueryError, match="its observation space is"):
        evaluate(str(tmp_path / "A2C.zip"), fresh, steps=5, everything=True)


@pytest.fixture
def server() -> Iterator[tuple[str, list[Mapping[Any, Any]]]]:
    """A policy server that answers chunks of two zero actions, and an error to the sixth request."""
    from websockets.sync.server import ServerConnection, serve

    requests: list[Mapping[Any, Any]] = []

    def array(values: Any) -> dict[bytes, Any]:
        return {b"__ndarray__": True, b"data": values.tobytes(), b"dtype": values.dtype.str, b"shape": values.shape}

    def answer(connection: ServerConnection) -> None:
        connection.send(msgpack.packb({"name": "zeros"}))
        for message in connection:
            requests.append(msgpack.unpackb(bytes(message), strict_map_key=False))
            if len(requests) == 6:
                connection.send("Traceback:\n  ...\nValueError: too many")
                return
            connection.send(
                msgpack.packb({"actions": array(np.zeros((2, 5), np.float64)), "server_timing": {"ms": 1.5}})
            )

    with serve(answer, "127.0.0.1", 0, compression=None) as listening:
        Thread(target=listening.serve_forever, daemon=True).start()
        yield f"ws://127.0.0.1:{listening.socket.getsockname()[1]}", requests
        listening.shutdown()


def test_a_policy_server_gets_observations_and_answers_chunks(
    server: tuple[str, list[Mapping[Any, Any]]], tabletop: Domain
) -> None:
    address, requests = server
    results = evaluate(address, FreshScenarios(TaskSpace(tabletop, 1), 1), steps=3)
    assert results.episodes[0].steps == 3 and len(requests) == 2
    state = requests[0]["observation/state"]
    assert state[b"dtype"] == "<f4" and len(state[b"data"]) == 4 * state[b"shape"][0]
    assert requests[0]["prompt"] == results.episodes[0].instruction
    with pytest.raises(QueryError, match="the policy server reports an error: ValueError: too many"):
        evaluate(address, FreshScenarios(TaskSpace(tabletop, 1), 1), steps=20)


@pytest.mark.parametrize(
    "arguments",
    [
        ["tabletop"], ["tabletop", "-n", "1", "--data", "x"], ["-n", "1"], ["--part", "test", "tabletop", "-n", "1"],
        ["--data", "no_such"], ["--scenarios", "no_such"], ["tabletop", "-n", "1", "--env", "goal=true"],
        ["tabletop", "-n", "1", "--env", "goals"],
    ],
)  # fmt: skip
def test_contradictory_requests_are_refused(arguments: list[str], tmp_path: Path) -> None:
    done = run("evaluate", "zeros", *arguments, "-o", str(tmp_path / "out"))
    assert done.returncode == 2 and done.stderr.count("\n") == 1 and not (tmp_path / "out").exists()


def test_failures_are_filmed(fresh: FreshScenarios, tmp_path: Path) -> None:
    pytest.importorskip("av")
    evaluate("zeros", fresh, tmp_path, steps=2, videos=1)
    import av

    with av.open(str(tmp_path / "videos" / "000001.mp4")) as video:
        assert video.streams.video[0].frames == 3


def test_instructions_of_a_dataset_are_its_own_in_environments_and_evaluations(
    tabletop: Domain, tmp_path: Path
) -> None:
    data = generate(TaskSpace(tabletop, 1), tmp_path / "data", tasks=3, seed=3, phrasings="2 of 2")
    own = [data.entry(number).instruction["default"] for number in range(3)]
    source = StoredScenarios.open(data.folder)
    assert [each.instruction for each in evaluate("zeros", source, steps=1).episodes] == own
    spoken = evaluate("zeros", source, steps=1, language="de").episodes
    assert not {each.instruction for each in spoken} & set(own)
    env = TaskEnv(dataset=data.folder)
    for number, task in enumerate(data.task(number) for number in range(3)):
        for options in ({"rank": number}, {"task": task, "witness": data.witness(number)}):
            assert env.reset(seed=0, options=options)[1]["instruction"] == own[number]
    with pytest.raises(QueryError, match="TaskTexts"):
        env.reset(options={"texts": "pick it up"})
    env.close()
