"""Checkpoints of LeRobot: inputs and actions mean what the export of their training says, with a fake LeRobot here.

A test with the real package runs where it is installed.
"""

from __future__ import annotations

import json
import sys
from contextlib import nullcontext
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
import pyarrow.parquet as pq
import pytest

from prag_asp import Dataset, QueryError, TaskSpace, load_domain
from prag_asp.dataset import export, generate
from prag_asp.evaluation import StoredScenarios, evaluate
from prag_asp.evaluation.policies import environment_of

RENAMED = {"observation.state": "observation.arm"}


class Tensor(np.ndarray):
    def cpu(self) -> Tensor:
        return self

    def numpy(self) -> Any:
        return np.asarray(self)


class Replaying:
    """Plays recorded actions, and notes what it gets."""

    def __init__(self, actions: Any, device: str) -> None:
        self.actions, self.config, self.batches = actions, SimpleNamespace(device=device), list[Any]()

    def eval(self) -> None: ...

    def reset(self) -> None:
        self.batches.clear()

    def select_action(self, batch: Any) -> Tensor:
        self.batches.append(batch)
        return self.actions[[min(len(self.batches), len(self.actions)) - 1]].view(Tensor)


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> Dataset:
    folder = tmp_path_factory.mktemp("lerobot") / "data"
    dataset = generate(TaskSpace(load_domain("tabletop"), 1), folder, tasks=1, demonstrate=True)
    for action, state in (("ee_delta", ("ee_position", "joint_position")), ("joint_position", ("joint_position",))):
        export(dataset, "lerobot", folder.parent / action, action=action, state=state, level="vague")
    return dataset


@pytest.fixture
def policy(data: Dataset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Replaying:
    """A policy of a fake LeRobot that plays the recording in the folder `ee_delta`."""
    rows = frames(data, "ee_delta")
    replaying = Replaying(rows["action"].astype(np.float32), "cpu")
    torch: Any = ModuleType("torch")
    torch.from_numpy, torch.inference_mode = (lambda values: values.view(Tensor)), nullcontext
    torch.set_num_threads = torch.manual_seed = lambda number: None
    factory, configs = SimpleNamespace(), SimpleNamespace()
    config = SimpleNamespace(pretrained_backbone_weights="downloads")
    configs.PreTrainedConfig = SimpleNamespace(from_pretrained=lambda path: config)
    factory.get_policy_class = lambda kind: SimpleNamespace(
        from_pretrained=lambda path, config: replaying if config.pretrained_backbone_weights is None else None
    )
    factory.make_pre_post_processors = lambda config, path, preprocessor_overrides: (
        lambda batch: {RENAMED.get(name, name): value for name, value in batch.items()},
        lambda action: action,
    )
    for name, module in {
        "torch": torch,
        "lerobot.policies.factory": factory,
        "lerobot.configs.policies": configs,
    }.items():
        monkeypatch.setitem(sys.modules, name, module)
    return replaying


def frames(data: Dataset, name: str) -> dict[str, Any]:
    table = pq.read_table(next((data.folder.parent / name / "data").rglob("*.parquet")))
    return {
        key: np.array(table[key].to_pylist())
        for key in ("observation.state", "observation.environment_state", "action")
    }


def checkpoint(folder: Path, inputs: dict[str, list[int]], action: int, root: Path | None) -> str:
    """Write the configuration of a checkpoint."""
    folder.mkdir()
    features = {name: {"type": "STATE", "shape": shape} for name, shape in inputs.items()}
    renaming = {"registry_name": "rename_observations_processor", "config": {"rename_map": RENAMED}}
    contents = {
        "config.json": {"type": "act", "input_features": features, "output_features": {"action": {"shape": [action]}}},
        "policy_preprocessor.json": {"steps": [renaming if root else {}, {"registry_name": "device_processor"}]},
        "train_config.json": {"dataset": {"root": None if root is None else str(root)}},
    }
    for name, content in contents.items():
        (folder / name).write_text(json.dumps(content), encoding="utf-8")
    return str(folder)


def test_a_checkpoint_gets_what_the_export_has_and_its_actions_are_those_of_the_export(
    data: Dataset, policy: Replaying, tmp_path: Path
) -> None:
    rows, inputs = frames(data, "ee_delta"), {"observation.arm": [14], "observation.environment_state": [56]}
    path = checkpoint(tmp_path / "act", inputs, 7, data.folder.parent / "ee_delta")
    assert environment_of(path) == {"control": "ee_delta", "rate": 20}
    results = evaluate(path, StoredScenarios.open(data.folder))
    assert results.whole().successes == 1 and results.record.options == {"control": "ee_delta", "rate": "20"}
    assert len(policy.batches) == results.episodes[0].steps
    for step, same in ((0, 14), (len(rows["action"]) // 2, 7)):  # the tool's pose; the elbow may differ later
        batch = policy.batches[step]
        assert batch["observation.arm"].shape == (1, 14) and batch["observation.arm"].dtype == np.float32
        for name, key in (("observation.arm", "observation.state"), ("observation.environment_state",) * 2):
            assert batch[name][0][:same] == pytest.approx(rows[key][step][:same], abs=0.02)
        assert batch["task"] == [data.entry(0).instruction["vague"]]


def test_without_the_dataset_shapes_decide_and_contradictions_are_refused(
    data: Dataset, policy: Replaying, tmp_path: Path
) -> None:
    source, lost = StoredScenarios.open(data.folder), checkpoint(tmp_path / "lost", {"observation.state": [7]}, 7, None)
    assert environment_of(lost) == {}
    assert evaluate(lost, source, control="ee_delta").whole().successes == 1
    assert policy.batches[0]["observation.arm"][0] == pytest.approx(
        frames(data, "ee_delta")["observation.state"][0][:7], abs=0.01
    )
    known = checkpoint(tmp_path / "known", {"observation.arm": [14]}, 7, data.folder.parent / "ee_delta")
    broken = tmp_path / "broken"
    broken.mkdir()
    wrong: list[tuple[str, dict[str, Any], str]] = [
        (lost, {}, "give --control and --env rate"),
        (known, {"control": "joint_delta"}, "trained with control ee_delta, the environment has joint_delta"),
        (known, {"rate": 10}, "trained with rate 20, the environment has 10"),
        (str(broken), {}, "has no config.json"),
    ]
    for number, (name, shape, message) in enumerate(
        [
            ("observation.state", [5], "not a state of panda"), ("observation.environment_state", [9], "other names"),
            ("observation.images.front", [3, 8, 8], "has no camera|shape"), ("observation.sound", [2], "no input"),
        ]
    ):  # fmt: skip
        size = {"size": (32, 32)} if len(shape) == 3 else {}
        path = checkpoint(tmp_path / str(number), {name: shape}, 7, None)
        wrong.append((path, {"control": "ee_delta", **size}, message))
    for path, options, message in wrong:
        with pytest.raises(QueryError, match=message) as error:
            evaluate(path, source, **{"steps": 2, **options})
        assert "\n" not in str(error.value)
    (broken / "config.json").write_text("{}", encoding="utf-8")
    with pytest.raises(QueryError, match="is not a file of LeRobot"):
        environment_of(str(broken))


def test_the_real_lerobot_loads_its_checkpoint(data: Dataset, tmp_path: Path) -> None:
    pytest.importorskip("lerobot", reason="LeRobot needs versions of its own")
    from lerobot.configs.types import FeatureType, PolicyFeature
    from lerobot.policies.act.configuration_act import ACTConfig
    from lerobot.policies.act.modeling_act import ACTPolicy
    from lerobot.policies.factory import make_pre_post_processors

    inputs = {"observation.state": (FeatureType.STATE, 8), "observation.environment_state": (FeatureType.ENV, 56)}
    config = ACTConfig(
        device="cpu", dim_model=16, n_heads=2, dim_feedforward=16, n_encoder_layers=1, chunk_size=4, n_action_steps=2,
        input_features={name: PolicyFeature(kind, (size,)) for name, (kind, size) in inputs.items()},
        output_features={"action": PolicyFeature(FeatureType.ACTION, (8,))},
    )  # fmt: skip
    for each in (ACTPolicy(config), *make_pre_post_processors(config)):
        each.save_pretrained(tmp_path)
    root = {"dataset": {"root": str(data.folder.parent / "joint_position")}}
    (tmp_path / "train_config.json").write_text(json.dumps(root), encoding="utf-8")
    results = [evaluate(str(tmp_path), StoredScenarios.open(data.folder), steps=4) for _ in range(2)]
    assert results[0].episodes == results[1].episodes and results[0].episodes[0].steps == 4
    assert results[0].record.options["control"] == "joint_position"
