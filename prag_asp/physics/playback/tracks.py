"""The bodies of an episode with their pieces and their pose in each frame."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from prag_asp.physics.bullet import STDOUT, mute_output, pybullet
from prag_asp.physics.demonstration.demonstration import Demonstration, pose_of
from prag_asp.physics.filming.appearance_meshes import COARSE, Fineness, low_files
from prag_asp.physics.playback.mesh_pieces import CLOSE, MeshPiece, body_pieces, robot_pieces
from prag_asp.physics.world.furniture_bodies import lighter
from prag_asp.physics.world.simulated_arm import load_robot_files, set_joints
from prag_asp.physics.world.simulator import open_client
from prag_asp.scene.furniture import mechanism, part_pose
from prag_asp.scene.geometry import Pose
from prag_asp.scene.robots import robot_of
from prag_asp.scene.scene import Scene
from prag_asp.scene.solids import boxes, solids

Poses = NDArray[np.float32]
NOBODY: Mapping[str, Pose] = {}


class BodyTrack(NamedTuple):
    """A rigid body of an episode: its visible pieces, and its poses, shape (T, 7), or (1, 7) if it never moves.

    A pose is x, y, z in metres and a unit quaternion x, y, z, w.
    """

    name: str
    pieces: Sequence[MeshPiece]
    poses: Poses


def body_tracks(
    demonstration: Demonstration, scene: Scene, bystanders: Mapping[str, Pose] = NOBODY, fineness: Fineness = CLOSE
) -> Iterator[BodyTrack]:
    """Yield the links of the robots (``robot/link``), the objects, and the moving parts of furniture (``name/part``).

    `bystanders` are poses of further objects, which never move; `fineness` is that of the robots.

    Raises:
        SceneError: the scene does not allow the size of an object, or a file cannot be read.
    """
    sized = demonstration.sized_scene(scene)
    yield from _robot_tracks(demonstration, sized, fineness)
    for entity, pose in bystanders.items():
        yield _track(entity, _object_pieces(sized, entity), _rows([pose]))
    for i, entity in enumerate(demonstration.objects):
        shape, color, poses = sized.shapes[entity], sized.color(entity), demonstration.poses[:, i]
        if not shape.traits.furniture:
            yield _track(entity, _object_pieces(sized, entity), poses)
            continue
        parts, openings = mechanism(shape), demonstration.openings[:, demonstration.furniture.index(entity)]
        yield _track(entity, body_pieces(boxes(parts.body), (), color), poses)
        moved = [
            part_pose(shape, pose_of(row), opening)
            for row, opening in zip(poses.tolist(), openings.tolist(), strict=True)
        ]
        yield _track(f"{entity}/part", body_pieces(boxes(parts.part), (), lighter(color)), _rows(moved))


def _robot_tracks(demonstration: Demonstration, scene: Scene, fineness: Fineness) -> Iterator[BodyTrack]:
    """Yield the links of the robots, whose poses PyBullet computes from the joint angles."""
    with open_client() as client, mute_output(STDOUT):
        for number, name in enumerate(demonstration.robots):
            robot, kind = robot_of(scene, name), scene.robots[name].kind
            body = load_robot_files(client, low_files(kind, COARSE), robot.base)
            joints = range(pybullet.getNumJoints(body, physicsClientId=client))
            links = [pybullet.getJointInfo(body, joint, physicsClientId=client)[12].decode() for joint in joints]
            frames = np.empty((len(demonstration.times), len(links), 7), dtype=np.float32)
            rows = zip(demonstration.joints[:, number].tolist(), demonstration.widths[:, number].tolist(), strict=True)
            for frame, (angles, width) in enumerate(rows):
                set_joints(client, body, robot, tuple(angles), width)
                states = pybullet.getLinkStates(
                    body, list(joints), computeForwardKinematics=True, physicsClientId=client
                )
                frames[frame] = [(*state[4], *state[5]) for state in states]
            pieces = robot_pieces(kind, fineness)
            base = pybullet.getBodyInfo(body, physicsClientId=client)[0].decode()
            yield BodyTrack(f"{name}/{base}", pieces[base], _rows([robot.base]))
            for i, link in enumerate(links):
                if pieces[link]:
                    yield _track(f"{name}/{link}", pieces[link], frames[:, i])


def _object_pieces(scene: Scene, entity: str) -> list[MeshPiece]:
    """Return the pieces of an object, with furniture closed."""
    shape = scene.shapes[entity]
    return body_pieces(solids(shape), () if shape.model is None else shape.model.looks, scene.color(entity))


def _track(name: str, pieces: Sequence[MeshPiece], poses: Poses) -> BodyTrack:
    """Return a track; of a body that never moves, with one pose."""
    return BodyTrack(name, pieces, poses[:1] if (poses == poses[0]).all() else poses)


def _rows(poses: Sequence[Pose]) -> Poses:
    """Return poses as an array."""
    return np.array([(*pose.position, *pose.quaternion) for pose in poses], dtype=np.float32)
