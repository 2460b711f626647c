"""HDF5 in the layout of robomimic (https://robomimic.github.io/docs/datasets/overview.html).

N time steps result in N - 1 samples: an observation, the action, and the next observation.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from prag_asp.dataset.formats.episode_source import EpisodeSource, ExportEpisode
from prag_asp.dataset.formats.export_format import Progress
from prag_asp.dataset.formats.hdf5 import group_in, note, numbers_of, origin, pictures_of, put, require_steps, written
from prag_asp.dataset.formats.provenance import provenance_of
from prag_asp.output import whole_file
from prag_asp.wording import plural

GYM = 2
"""The type of environment in the file: Gym, because robomimic has no type for a dataset without an environment."""

IMAGES = {"rgb": "image", "depth": "depth", "segmentation": "segmentation"}
"""The suffix of each kind of camera image in robomimic."""


@dataclass(frozen=True)
class Robomimic:
    """The format of one file for robomimic."""

    def write(self, source: EpisodeSource, target: Path, progress: Progress) -> None:
        """Write a file with ``data`` and ``mask``.

        Raises:
            QueryError: there are no recordings.
            OutputError: the file cannot be written.
        """
        with whole_file(target) as path, written(path, target) as (file, check):
            data, mask, total = group_in(file, "data"), dict[str, list[str]](), 0
            for number, episode in enumerate(source.episodes()):
                name = f"demo_{number}"
                total += _write(group_in(data, name), source, episode)
                check()
                mask.setdefault(episode.entry.part, []).append(name)
                progress(plural(number + 1, "episode"), number + 1, source.count)
            note(data, {"total": total, "env_args": json.dumps(_environment(source), ensure_ascii=False)})
            for part, names in mask.items():
                put(file, f"mask/{part}", np.array(names, dtype="S"))


def _write(demo: h5py.Group, source: EpisodeSource, episode: ExportEpisode) -> int:
    """Write an episode, and return the number of its samples."""
    steps = require_steps(source, episode)
    control = source.control
    action = source.actions_of(episode)[:-1]
    values = control.values(action.astype(float))
    put(demo, "actions", np.clip(control.to_unit(values), -1, 1).astype(np.float32))
    put(demo, "action_dict/targets", values.astype(np.float32))
    put(demo, "rewards", episode.rewards[1:])
    put(demo, "dones", (np.arange(steps) == steps - 1).astype(np.int64))
    put(demo, "subgoals", episode.subgoal[:-1])
    numbers = numbers_of(source, episode)
    states = [numbers[name] for name in ("state", "objects", "openings") if name in numbers]
    put(demo, "states", np.concatenate([each.reshape(episode.length, -1) for each in states], 1)[:-1])
    for name, values in _observed(source, episode):
        put(demo, f"obs/{name}", values[:-1])
        put(demo, f"next_obs/{name}", values[1:])
    origins = json.dumps({"lang": episode.instruction, **origin(episode)}, ensure_ascii=False)
    note(demo, {"num_samples": steps, "ep_meta": origins})
    return steps


def _observed(source: EpisodeSource, episode: ExportEpisode) -> Iterator[tuple[str, NDArray[Any]]]:
    """Yield the keys of observations, each with its values at every time step."""
    numbers = numbers_of(source, episode)
    for at, robot in enumerate(source.robots):
        own = numbers["state"].reshape(episode.length, len(source.robots), -1)[:, at]
        yield f"{robot}_joint_pos", own[:, :-1]
        yield f"{robot}_gripper_width", own[:, -1:]
        yield f"{robot}_eef_pos", numbers["tools"][:, at, :3]
        yield f"{robot}_eef_quat", numbers["tools"][:, at, 3:]
    yield "object", numbers["objects"].reshape(episode.length, -1)
    if "openings" in numbers:
        yield "openings", numbers["openings"]
    for camera, kind, pictures in pictures_of(source, episode):
        shaped = pictures if kind == "rgb" else pictures[..., None]
        yield f"{camera}_{IMAGES[kind]}", shaped.astype(np.float32) if kind == "depth" else shaped


def _environment(source: EpisodeSource) -> dict[str, Any]:
    """Return a description of the environment, which robomimic cannot create; its arguments hold the metadata."""
    control = source.control
    values = {
        **provenance_of(source, "robomimic"),
        "rate": source.rate,
        "joints": source.joints,
        "control": control.name,
        "names": list(control.names),
        "units": list(control.units),
        "lower": control.lower.tolist(),
        "upper": control.upper.tolist(),
        "objects": source.objects,
        "furniture": source.furniture,
        "legend": source.legend,
    }
    return {"env_name": f"prag_asp/{source.data.domain.name}", "type": GYM, "env_kwargs": values}
