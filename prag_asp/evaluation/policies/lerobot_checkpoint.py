"""Read a checkpoint of LeRobot 0.4 or later: the folder ``pretrained_model``, with its processors.

A checkpoint contains the shapes of its inputs and actions, but not their meaning. The meaning is recorded in the
training dataset, which was exported by `prag_asp.dataset.export` and whose folder is named in the checkpoint. The
dataset determines the control convention, the rate and the cameras of the environment. Without the dataset, these are
options of the evaluation, and the convention of the state follows from its shape.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

import msgspec

from prag_asp.dataset.formats.provenance import PROVENANCE
from prag_asp.errors import QueryError
from prag_asp.safe_reading import read_bytes

Content = TypeVar("Content")

IMAGES = "observation.images."
"""The prefix of camera images among the inputs of a policy."""

EMPTY = f"{IMAGES}empty_camera"
"""The prefix of inputs that a policy fills with constant images."""

CHECK = "give the folder pretrained_model of a checkpoint"


class TensorShape(msgspec.Struct):
    """The shape of an input or an output of a policy."""

    shape: list[int]


class PolicyConfig(msgspec.Struct):
    """The part of config.json that is used: the kind of policy, its inputs and its outputs."""

    type: str
    input_features: dict[str, TensorShape]
    output_features: dict[str, TensorShape]


class ProcessorStep(msgspec.Struct):
    """A step of a processor."""

    registry_name: str = ""
    config: dict[str, Any] = {}


class ProcessorConfig(msgspec.Struct):
    """The part of policy_preprocessor.json that is used."""

    steps: list[ProcessorStep]


class TrainingDataset(msgspec.Struct):
    """The folder of a training dataset."""

    root: str | None = None


class TrainingConfig(msgspec.Struct):
    """The part of train_config.json that is used."""

    dataset: TrainingDataset | None = None


class ExportedFeature(msgspec.Struct):
    """A feature of an exported dataset: its shape, the names of its components, and metadata from prag_asp."""

    shape: list[int]
    names: Any = None
    prag_asp: dict[str, Any] = {}


class ExportInfo(msgspec.Struct):
    """The part of an exported dataset's info.json that is used."""

    fps: float
    features: dict[str, ExportedFeature]


class ExportLevel(msgspec.Struct):
    """The level of detail of the instructions in an exported dataset."""

    level: str = "default"


@dataclass(frozen=True)
class LeRobotCheckpoint:
    """A checkpoint: its configuration, the names of its inputs in the dataset, and the dataset, if it is found."""

    path: Path
    config: PolicyConfig
    steps: tuple[ProcessorStep, ...]
    export: ExportInfo | None
    level: str

    @classmethod
    def open(cls, folder: str | Path) -> LeRobotCheckpoint:
        """Read the configuration in a folder.

        Raises:
            QueryError: the folder is not a checkpoint of LeRobot 0.4 or later.
        """
        path = Path(folder)
        config = _read(path / "config.json", PolicyConfig)
        if config is None:
            raise QueryError(f"{path}: has no config.json; {CHECK}")
        processor = _read(path / "policy_preprocessor.json", ProcessorConfig)
        if processor is None:
            remedy = (
                "convert checkpoints of earlier versions than 0.4 with lerobot.processor.migrate_policy_normalization"
            )
            raise QueryError(f"{path}: has no policy_preprocessor.json; {remedy}")
        training = _read(path / "train_config.json", TrainingConfig) or TrainingConfig()
        root = training.dataset.root if training.dataset is not None else None
        export = None if root is None else _read(Path(root) / "meta/info.json", ExportInfo)
        level = None if root is None else _read(Path(root) / PROVENANCE, ExportLevel)
        return cls(path, config, tuple(processor.steps), export, (level or ExportLevel()).level)

    @property
    def inputs(self) -> dict[str, ExportedFeature]:
        """The inputs of the policy by their names in the dataset, with shapes there; images have shape (H, W, 3)."""
        renamed = {
            old: new
            for step in self.steps
            if step.registry_name == "rename_observations_processor"
            for old, new in step.config.get("rename_map", {}).items()
        }
        if self.export is not None:
            features = self.export.features.items()
            return {name: each for name, each in features if renamed.get(name, name) in self.config.input_features}
        original = {new: old for old, new in renamed.items()}
        shapes = {name: each.shape for name, each in self.config.input_features.items() if not name.startswith(EMPTY)}
        return {
            original.get(name, name): ExportedFeature([*shape[1:], shape[0]] if name.startswith(IMAGES) else shape)
            for name, shape in shapes.items()
        }

    def options(self) -> dict[str, Any]:
        """Return the environment options that the checkpoint determines."""
        images = {name.removeprefix(IMAGES): each for name, each in self.inputs.items() if name.startswith(IMAGES)}
        options: dict[str, Any] = {"cameras": tuple(images)} if images else {}
        sizes = {(each.shape[1], each.shape[0]) for each in images.values()}
        if len(sizes) == 1:
            options["size"] = sizes.pop()
        if self.export is not None:
            action = self.export.features.get("action", ExportedFeature([])).prag_asp
            options |= {"control": action["control"], "rate": int(self.export.fps)} if "control" in action else {}
        return options


def _read(path: Path, kind: type[Content]) -> Content | None:
    """Return the content of a JSON file, or None if it does not exist.

    Raises:
        QueryError: the file cannot be read.
    """
    try:
        return msgspec.json.decode(read_bytes(path), type=kind)
    except (FileNotFoundError, NotADirectoryError):
        return None
    except (OSError, msgspec.DecodeError) as error:
        reason = " ".join(str(error).split())
        raise QueryError(f"{path}: is not a file of LeRobot: {reason:.200}; {CHECK}") from None
