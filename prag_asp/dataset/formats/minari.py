"""Minari: a local dataset for `minari.load_dataset`, in the layout of https://minari.farama.org.

The environment that the metadata names has the same actions but different observations, so the metadata includes the
spaces.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from prag_asp.dataset.formats.body_values import POSE
from prag_asp.dataset.formats.episode_source import EpisodeSource, ExportEpisode
from prag_asp.dataset.formats.export_format import Progress
from prag_asp.dataset.formats.hdf5 import group_in, note, numbers_of, origin, pictures_of, put, require_steps, written
from prag_asp.dataset.formats.provenance import write_provenance
from prag_asp.dataset.store.domain_snapshot import snapshot_of
from prag_asp.domain.load import load_domain
from prag_asp.output import make_folder, new_folder, replace_file
from prag_asp.program.paths import shipped_domains
from prag_asp.wording import plural

LAYOUT = "0.5.0"
"""The first version of Minari that had this layout."""

MAIN = "main_data.hdf5"
SMALLEST = 32
"""The minimum side length in pixels with which Minari treats an array of colours as an image and stores it as JPEG."""

QUALITY = 95
"""The JPEG quality of images, as in Minari."""


@dataclass(frozen=True)
class Minari:
    """The format of a folder for ``MINARI_DATASETS_PATH``, with one dataset, ``prag_asp/DOMAIN-v0``."""

    def write(self, source: EpisodeSource, target: Path, progress: Progress) -> None:
        """Write the folder.

        Raises:
            QueryError: there are no recordings.
            OutputError: the folder cannot be written.
        """
        name, control = dataset_name(source), source.control
        with new_folder(target) as folder:
            inner = make_folder(folder / name / "data")
            steps = count = 0
            with written(inner / MAIN, target) as (file, check):
                for count, episode in enumerate(source.episodes(), 1):
                    steps += _write(group_in(file, f"episode_{count - 1}"), source, episode, count - 1)
                    check()
                    progress(plural(count, "episode"), count, source.count)
            content = {
                "dataset_id": name,
                "total_episodes": count,
                "total_steps": steps,
                "data_format": "hdf5",
                "jpeg_encoding": True,
                "observation_space": json.dumps({"type": "Dict", "subspaces": dict(_observation_spaces(source))}),
                "action_space": json.dumps(_box((control.low, control.high), len(control.names), "float32")),
                "env_spec": json.dumps(environment_of(source)),
                "minari_version": LAYOUT,
                "dataset_size": round((inner / MAIN).stat().st_size / 1e6, 1),
                "description": f"Demonstrations of {source.data.domain.name} by prag_asp.",
                "joints": source.joints,
                "objects": source.objects,
                "furniture": source.furniture,
                "legend": source.legend,
                "rate": source.rate,
                "control": control.name,
                "action_names": control.names,
                "action_units": control.units,
                "action_lower": control.lower.tolist(),
                "action_upper": control.upper.tolist(),
            }
            replace_file(inner / "metadata.json", json.dumps(content, ensure_ascii=False).encode())
            write_provenance(folder, source, "minari")


def dataset_name(source: EpisodeSource) -> str:
    """Return the name of a dataset in Minari; characters that it does not allow become ``_``."""
    return f"prag_asp/{re.sub(r'[^-a-zA-Z0-9_]', '_', source.data.domain.name)}-v0"


def environment_of(source: EpisodeSource) -> dict[str, Any]:
    """Return the specification of the environment of a dataset, as Gymnasium writes it.

    The environment samples tasks from the space of the dataset. A domain that is not shipped cannot be loaded by name,
    so ``recover_environment`` needs the dataset as the argument ``dataset=``.
    """
    manifest, kwargs = source.data.manifest, dict[str, Any]()
    name = manifest.domain.name
    if name in shipped_domains() and manifest.domain == snapshot_of(load_domain(name))[0]:
        kwargs = {"domain": name, "length": manifest.lengths, "where": manifest.where}
    return {
        "id": "prag_asp/Task-v0",
        "entry_point": "prag_asp.rl.environment:TaskEnv",
        "reward_threshold": None,
        "nondeterministic": False,
        "max_episode_steps": None,
        "order_enforce": True,
        "disable_env_checker": False,
        "kwargs": kwargs | {"control": source.control.name, "rate": source.rate},
        "additional_wrappers": [],
        "vector_entry_point": None,
    }


def _write(group: h5py.Group, source: EpisodeSource, episode: ExportEpisode, number: int) -> int:
    """Write an episode, and return the number of its steps."""
    steps = require_steps(source, episode)
    attributes = {
        name: json.dumps(each, ensure_ascii=False) if isinstance(each, list) else each
        for name, each in origin(episode).items()
    }
    note(group, {"id": number, "total_steps": steps, **attributes})
    last = np.arange(steps) == steps - 1
    done = episode.rewards[1:] == 1
    put(group, "actions", source.actions_of(episode)[:-1])
    put(group, "rewards", episode.rewards[1:].astype(np.float64))
    put(group, "terminations", last & done)
    put(group, "truncations", last & ~done)
    put(group, "infos/subgoal", episode.subgoal)
    for name, values in numbers_of(source, episode).items():
        put(group, f"observations/{name}", values)
    for camera, kind, pictures in pictures_of(source, episode):
        name = f"observations/{camera}_{kind}"
        if kind == "rgb" and min(pictures.shape[1:3]) >= SMALLEST:
            put(group, name, _as_jpeg(pictures))
        else:
            put(group, name, pictures)
    return steps


def _as_jpeg(pictures: Iterable[NDArray[np.uint8]]) -> NDArray[np.uint8]:
    """Return images as JPEG, shape (N, bytes), padded with zeros, which JPEG readers ignore."""
    from PIL import Image

    images = []
    for picture in pictures:
        buffer = BytesIO()
        Image.fromarray(picture).save(buffer, format="JPEG", quality=QUALITY, subsampling=0)
        images.append(np.frombuffer(buffer.getvalue(), dtype=np.uint8))
    rows = np.zeros((len(images), max(map(len, images))), dtype=np.uint8)
    for row, content in zip(rows, images, strict=True):
        row[: len(content)] = content
    return rows


def _observation_spaces(source: EpisodeSource) -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield the space of each observation; measurements have no bounds."""
    yield "state", _free(len(source.joints))
    yield "objects", _free(len(source.objects), 1 + len(POSE))
    if source.furniture:
        yield "openings", _free(len(source.furniture))
    yield "tools", _free(len(source.robots), len(POSE))
    for camera, (width, height) in source.cameras.items():
        entities = len(source.legend)
        yield f"{camera}_rgb", _between(0, 255, (height, width, 3), "uint8")
        yield f"{camera}_depth", _between(0.0, np.inf, (height, width), "float16")
        yield f"{camera}_segmentation", _between(0, entities - 1, (height, width), source.segmentation_type.name)


def _free(*shape: int) -> dict[str, Any]:
    return _between(-np.inf, np.inf, shape, "float32")


def _between(low: float, high: float, shape: tuple[int, ...], kind: str) -> dict[str, Any]:
    """Return a box with the same bounds for all elements."""
    return _box((np.full(shape, low), np.full(shape, high)), *shape, kind)


def _box(bounds: tuple[NDArray[Any], NDArray[Any]], *rest: Any) -> dict[str, Any]:
    """Return a box as Minari encodes it, given its bounds, the dimensions of its shape, and the element type."""
    *shape, kind = rest
    low, high = (each.astype(kind).tolist() for each in bounds)
    return {"type": "Box", "dtype": kind, "shape": shape, "low": low, "high": high}
