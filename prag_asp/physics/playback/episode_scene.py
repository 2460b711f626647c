"""An episode as one file that can be played in 3D: a .glb for 3D programs, or a page with a player."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import chain

from prag_asp.html.player import player_page
from prag_asp.physics.demonstration.demonstration import Demonstration
from prag_asp.physics.filming.appearance_meshes import MIDDLE
from prag_asp.physics.filming.studio import FLIPPED
from prag_asp.physics.pictures.camera import view_camera
from prag_asp.physics.pictures.picture_world import open_picture_world
from prag_asp.physics.pictures.rendering import caption, check_headings, moments_of
from prag_asp.physics.playback.gltf import GltfCamera, gltf_file, time_marks
from prag_asp.physics.playback.surroundings import surroundings
from prag_asp.physics.playback.tracks import body_tracks
from prag_asp.physics.robot.kinematics import quaternion_of
from prag_asp.scene.geometry import Pose
from prag_asp.scene.scene import Scene
from prag_asp.scene.variation import USUAL_LIGHT
from prag_asp.task import Task

FRAME = (800, 600)
"""The size of a picture in pixels for which the first view is chosen."""


def episode_glb(
    task: Task,
    demonstration: Demonstration,
    scene: Scene,
    *,
    headings: Sequence[str | None] | None = None,
    bystanders: bool = True,
) -> bytes:
    """Return a .glb file (binary glTF 2.0) of an episode: its bodies, and an animation at 20 poses per second.

    The extras of its scene hold the `actions` with their names and times in seconds, and the direction to the `light`.
    `headings` that are not None replace the words for the actions. `bystanders` also shows objects that the task does
    not name, where they touch nothing.

    Raises:
        PicturesMissingError: Pillow is not installed.
        QueryError: the demonstration does not belong to the task.
        SceneError: the scene does not allow the size of an object, or a file cannot be read.
    """
    moments = moments_of(task, demonstration)
    check_headings(task, headings)
    with open_picture_world(
        task, demonstration, moments, scene, FRAME, fineness=MIDDLE, bystanders=bystanders
    ) as world:
        view, sized, placed = world.choose_view(range(len(moments))), world.scene, world.placed
    camera = view_camera(view, FRAME)
    pose = camera.pose @ FLIPPED
    x, y, z = pose[:3, 3].tolist()
    eye = GltfCamera(Pose((x, y, z), quaternion_of(pose.tolist())), camera.look_at, math.radians(camera.field_of_view))
    names = [caption(task, scene, k, headings)[0] for k in range(1, len(moments))]
    variation = demonstration.variation
    light = USUAL_LIGHT if variation is None or variation.light is None else variation.light
    times = demonstration.times - demonstration.times[0]
    extras = {"actions": time_marks(names, [0.0, *times[demonstration.ends[1:]].tolist()]), "light": light}
    return gltf_file(chain(surroundings(sized), body_tracks(demonstration, scene, placed)), times, eye, extras)


def episode_page(
    task: Task,
    demonstration: Demonstration,
    scene: Scene,
    *,
    title: str = "",
    headings: Sequence[str | None] | None = None,
    bystanders: bool = True,
) -> str:
    """Return a page that plays an episode in 3D; it needs no other file, and works offline.

    The default title is the name of the domain; the other arguments are those of `episode_glb`.

    Raises:
        PicturesMissingError: Pillow is not installed.
        QueryError: the demonstration does not belong to the task.
        SceneError: the scene does not allow the size of an object, or a file cannot be read.
    """
    content = episode_glb(task, demonstration, scene, headings=headings, bystanders=bystanders)
    return player_page(title or task.domain, content)
