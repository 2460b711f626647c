"""Behaviour cloning from an exported LeRobot dataset: its frames, networks with three kinds of inputs, and a policy.

A network predicts a chunk of target poses of the tool, relative to its current pose, as in Zhao and others, "Learning
fine-grained bimanual manipulation with low-cost hardware" (2023).
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pyarrow.parquet as pq
import torch
from numpy.typing import NDArray
from torch import nn

from prag_asp.atom import atom_of, parse_atom
from prag_asp.dataset.formats.body_values import objects_in
from prag_asp.rl.observations import named_bodies, skill
from prag_asp.scene.scene import Scene

Floats = NDArray[np.float32]
Kind = Literal["objects", "names", "sentence"]
KINDS: tuple[Kind, ...] = ("objects", "names", "sentence")
"""What a network is told: the current skill and the poses of the objects that its action names; the names in that
action and the poses of all objects; or the instruction of the whole task and the poses of all objects."""

CHUNK, EXECUTED = 10, 5
"""The predicted actions, and how many of them are executed before the next prediction."""

GRACE = 15
"""The steps for which a policy continues with a subgoal that has been reached: its arm still has to move away."""

NOISE, TURNED = 0.01, 0.05
"""The noise on the position and the turn of the tool in training, in metres and radians. Targets are absolute, so the
network learns to return to the recorded path."""

WIDTH, BATCH = 192, 256
UNITS = np.array([0.1, 0.1, 0.1, 0.3, 0.3, 0.3, 0.04], dtype=np.float32)
"""The scales of the predicted numbers: metres, radians, and the opening of the gripper in metres."""


@dataclass(frozen=True)
class Vocabulary:
    """The skills, the objects with their half-extents, and the words of the instructions."""

    scene: Scene
    skills: tuple[str, ...]
    words: tuple[str, ...] = ()

    @property
    def objects(self) -> list[str]:
        """The objects of the scene, in the order of exported poses."""
        return objects_in(self.scene)

    def action(self, text: str) -> tuple[int, int, int]:
        """Return the numbers of the skill and of the two bodies that an action names; -1 for what is no object."""
        atom = parse_atom(text)
        bodies = [*named_bodies(atom, self.scene), "", ""][:2]
        first, second = (self.objects.index(body) if body in self.objects else -1 for body in bodies)
        return self.skills.index(skill(atom, self.scene)), first, second

    def sentence(self, text: str, length: int = 60) -> list[int]:
        """Return the numbers of the words of an instruction, padded with 0; 1 is a word that is not known."""
        numbers = [self.words.index(word) + 2 if word in self.words else 1 for word in words_of(text)]
        return [*numbers, *[0] * length][:length]


def words_of(text: str) -> list[str]:
    """Return the words of a sentence and its punctuation, in lower case."""
    return re.findall(r"\w+|[.,]", text.lower())


@dataclass(frozen=True)
class Frames:
    """The N frames of an exported dataset.

    `state` (N, 7) is the pose of the tool and its opening, `commanded` (N,) the opening commanded before, `bodies` (N,
    objects, 8) the poses of the objects, `goals` (N, 3) the current action, `texts` (N,) the number of the instruction
    in `sentences`, and `actions` (N, 7) the targets. `subgoal_end` and `end` (N,) are the last frames of the action and
    of the episode.
    """

    state: Floats
    commanded: Floats
    bodies: Floats
    goals: NDArray[np.int64]
    texts: NDArray[np.int64]
    actions: Floats
    subgoal_end: NDArray[np.int64]
    end: NDArray[np.int64]
    sentences: NDArray[np.int64]
    vocabulary: Vocabulary

    @classmethod
    def read(cls, folder: Path, scene: Scene, actions: Sequence[str]) -> Frames:
        """Read a dataset that was exported with ``--action ee_position --state ee_position --objects``."""
        skills = tuple(sorted({skill(atom_of(each), scene) for each in actions}))
        rows = pq.read_table(sorted((folder / "data").rglob("*.parquet")))
        column = {name: np.stack(rows[name].to_numpy(zero_copy_only=False)) for name in COLUMNS}
        episodes = pq.read_table(sorted((folder / "meta/episodes").rglob("*.parquet")), columns=EPISODE).to_pylist()
        words = sorted({word for each in episodes for word in words_of(each["tasks"][0])})
        vocabulary = Vocabulary(scene, skills, tuple(words))
        goals, ends, subgoal_ends, commanded = [], [], [], []
        for each in episodes:
            begin, end = each["dataset_from_index"], each["dataset_to_index"]
            subgoals = column["subgoal_index"][begin:end]
            plan = np.array([vocabulary.action(action) for action in each["prag_asp/plan"]])
            goals.append(plan[subgoals])
            ends.append(np.full(end - begin, end - 1))
            subgoal_ends.append(begin + np.searchsorted(subgoals, subgoals, side="right") - 1)
            commanded.append([column["observation.state"][begin, 6], *column["action"][begin : end - 1, 6]])
        return cls(
            column["observation.state"], np.concatenate(commanded).astype(np.float32),
            column["observation.environment_state"].reshape(len(rows), -1, 8), np.concatenate(goals),
            column["episode_index"], column["action"], np.concatenate(subgoal_ends), np.concatenate(ends),
            np.array([vocabulary.sentence(each["tasks"][0]) for each in episodes]), vocabulary,
        )  # fmt: skip

    def targets(self, frames: NDArray[np.int64], state: Floats, kind: Kind) -> Floats:
        """Return the chunks of actions that follow on frames, relative to states, shape (N, CHUNK * 7)."""
        last = (self.end if kind == "sentence" else self.subgoal_end)[frames, None]
        chunk = self.actions[np.minimum(frames[:, None] + np.arange(CHUNK), last)].copy()
        chunk[..., :6] -= state[:, None, :6]
        chunk[..., 5] = wrapped(chunk[..., 5])
        scaled: Floats = (chunk / UNITS).reshape(len(frames), -1)
        return scaled


COLUMNS = (
    "observation.state", "observation.environment_state", "action", "subgoal_index", "episode_index",
)  # fmt: skip
EPISODE = ["tasks", "dataset_from_index", "dataset_to_index", "prag_asp/plan"]


def wrapped(angle: Any) -> Any:
    """Return angles between -pi and pi."""
    return (angle + np.pi) % (2 * np.pi) - np.pi


def features(
    kind: Kind, vocabulary: Vocabulary, state: Floats, commanded: Floats, bodies: Floats, goals: NDArray[np.int64]
) -> Floats:
    """Return the inputs of a network, shape (N, size); a sentence is not among them."""
    seen = relative(state, bodies)
    arm = np.column_stack([state[:, 2:6], state[:, 6] / 0.04, commanded / 0.04])
    chosen = np.eye(len(vocabulary.skills))[goals[:, 0]]
    if kind == "objects":
        half = np.array([vocabulary.scene.shapes[each].half for each in vocabulary.objects])
        named = []
        for column in (1, 2):
            number, there = goals[:, column], goals[:, column, None] >= 0
            named += [seen[np.arange(len(seen)), number] * there, half[number] * there / 0.05]
        return np.column_stack([arm, *named, chosen]).astype(np.float32)
    everything = [arm, state[:, :2], seen.reshape(len(seen), -1), bodies[..., 1:4].reshape(len(seen), -1)]
    if kind == "names":
        one_hot = np.vstack([np.eye(bodies.shape[1]), np.zeros(bodies.shape[1])])
        everything += [chosen, one_hot[goals[:, 1]], one_hot[goals[:, 2]]]
    return np.column_stack(everything).astype(np.float32)


def relative(state: Floats, bodies: Floats) -> Floats:
    """Return, for each object, whether it is there, its offset from the tool, and its turn; shape (N, objects, 8).

    The turn is given for bodies that look the same after half a turn and after a quarter of a turn.
    """
    there, (x, y, z, w) = bodies[..., :1], np.moveaxis(bodies[..., 4:], -1, 0)
    turn = np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)) - state[:, None, 5]
    turns = [function(times * turn) for times in (2, 4) for function in (np.cos, np.sin)]
    offset = (bodies[..., 1:4] - state[:, None, :3]) / 0.1
    result: Floats = np.concatenate([there, offset * there, np.stack(turns, axis=-1) * there], axis=-1)
    return result


class Network(nn.Module):
    """Two hidden layers; for the kind `sentence`, a recurrent network reads the instruction."""

    def __init__(self, kind: Kind, example: Floats, words: int):
        super().__init__()
        self.kind, self.words = kind, words
        size = example.shape[1]
        self.register_buffer("mean", torch.from_numpy(example.mean(axis=0)))
        self.register_buffer("deviation", torch.from_numpy(example.std(axis=0).clip(0.05)))
        if kind == "sentence":
            self.embedding = nn.Embedding(words + 2, 32, padding_idx=0)
            self.reader = nn.GRU(32, 64, batch_first=True)
            size += 64
        self.layers = nn.Sequential(
            nn.Linear(size, WIDTH), nn.ReLU(), nn.Linear(WIDTH, WIDTH), nn.ReLU(), nn.Linear(WIDTH, WIDTH), nn.ReLU(),
            nn.Linear(WIDTH, CHUNK * len(UNITS)),
        )  # fmt: skip

    def forward(self, inputs: torch.Tensor, sentences: torch.Tensor) -> torch.Tensor:
        """Return the scaled chunks of actions."""
        inputs = ((inputs - self.mean) / self.deviation).clamp(-10.0, 10.0)
        if self.kind == "sentence":
            inputs = torch.cat([inputs, self.read(sentences)], dim=1)
        return self.layers(inputs)

    def read(self, sentences: torch.Tensor) -> torch.Tensor:
        """Return the states of the recurrent network after the last words of sentences."""
        found, inverse = torch.unique(sentences, dim=0, return_inverse=True)
        found = found[:, : int((found > 0).sum(dim=1).max())]
        outputs, _ = self.reader(self.embedding(found))
        return outputs[torch.arange(len(found)), (found > 0).sum(dim=1) - 1][inverse]


def imitated(frames: Frames, kind: Kind, *, steps: int, seed: int) -> Network:
    """Return a network that imitates the recordings, trained for a number of batches on the mean absolute error."""
    torch.manual_seed(seed)
    rng, vocabulary = np.random.default_rng(seed), frames.vocabulary
    every = rng.integers(len(frames.state), size=4096)
    example = features(kind, vocabulary, *(getattr(frames, name)[every] for name in INPUTS))
    network = Network(kind, example, len(vocabulary.words))
    optimizer = torch.optim.AdamW(network.parameters(), lr=1e-3, weight_decay=1e-4)
    rate = torch.optim.lr_scheduler.OneCycleLR(optimizer, 2e-3, total_steps=steps, pct_start=0.1)
    for _ in range(steps):
        chosen = rng.integers(len(frames.state), size=BATCH)
        state = frames.state[chosen].copy()
        state[:, :3] += rng.normal(0.0, NOISE, (BATCH, 3))
        state[:, 5] += rng.normal(0.0, TURNED, BATCH)
        rest = (getattr(frames, name)[chosen] for name in INPUTS[1:])
        inputs = torch.from_numpy(features(kind, vocabulary, state, *rest))
        sentences = torch.from_numpy(frames.sentences[frames.texts[chosen]])
        targets = torch.from_numpy(frames.targets(chosen, state, kind))
        optimizer.zero_grad()
        nn.functional.l1_loss(network(inputs, sentences), targets).backward()
        optimizer.step()
        rate.step()
    return network.eval()


INPUTS = ("state", "commanded", "bodies", "goals")


class Imitator:
    """A policy of the observations of `LeRobotView` that executes the chunks of a network."""

    def __init__(self, network: Network, vocabulary: Vocabulary):
        self._network, self._vocabulary = network, vocabulary
        self.begin()

    def begin(self) -> None:
        """Begin an episode."""
        self._chunk: list[Floats] = []
        self._commanded: float | None = None
        self._action, self._old = "", 0

    def __call__(self, observation: Mapping[str, Floats], info: Mapping[str, Any]) -> Floats:
        """Return the next action."""
        self._old = self._old + 1 if self._action != info["action"] else 0
        if not self._action or self._old > GRACE:
            self._action, self._old, self._chunk = info["action"], 0, []
        if not self._chunk:
            self._chunk = list(self._predicted(observation, info["instruction"])[:EXECUTED])
        action = self._chunk.pop(0)
        self._commanded = float(action[6])
        return action

    def _predicted(self, observation: Mapping[str, Floats], instruction: str) -> Floats:
        """Return the next actions, shape (CHUNK, 7)."""
        state = observation["agent_pos"][None]
        bodies = observation["environment_state"].reshape(1, -1, 8)
        commanded = np.array([state[0, 6] if self._commanded is None else self._commanded], dtype=np.float32)
        goals = np.array([self._vocabulary.action(self._action)])
        inputs = features(self._network.kind, self._vocabulary, state, commanded, bodies, goals)
        with torch.no_grad():
            sentence = torch.tensor([self._vocabulary.sentence(instruction)])
            scaled = self._network(torch.from_numpy(inputs), sentence).numpy()
        chunk = scaled.reshape(CHUNK, -1) * UNITS
        chunk[:, :6] += state[:, :6]
        length = np.linalg.norm(chunk[:, 3:6], axis=1, keepdims=True)
        chunk[:, 3:6] *= np.where(length > np.pi, 1 - 2 * np.pi / length.clip(1e-9), 1.0)
        result: Floats = chunk.astype(np.float32)
        return result
