"""Recordings of Rerun (https://rerun.io/docs): one .rrd file per episode, with the 3D scene for the viewer.

Unlike the exports for training, a file also shows the bodies of the episode, the subgoals, and the contacts with their
forces, on the same timeline as the joints and the camera images. Rerun numbers rows at random, so the bytes of two
exports differ.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import rerun as rr
import rerun.blueprint as rrb
from numpy.typing import NDArray
from PIL import Image

from prag_asp.dataset.formats.episode_source import EpisodeSource, ExportEpisode
from prag_asp.dataset.formats.export_format import Progress
from prag_asp.dataset.formats.provenance import write_provenance
from prag_asp.output import file_in, new_folder, replace_file
from prag_asp.physics.demonstration.demonstration import Demonstration
from prag_asp.physics.demonstration.footage import CameraVideo
from prag_asp.physics.filming.appearance_meshes import MIDDLE
from prag_asp.physics.playback.mesh_pieces import MeshPiece
from prag_asp.physics.playback.surroundings import FLOOR_NAME, surroundings
from prag_asp.physics.playback.tracks import BodyTrack, body_tracks
from prag_asp.wording import plural

APPLICATION = "prag_asp"
TIME = "time"
"""The timeline, in seconds since the start of the episode."""

WORLD, CAMERAS, ROBOTS, FURNITURE, CONTACTS, SUBGOAL = "world", "cameras", "robots", "furniture", "contacts", "subgoal"
"""The first parts of the paths of entities in Rerun."""

FRUSTUM = 0.08
"""The distance in metres at which the viewer draws the image plane of a camera."""


@dataclass(frozen=True)
class Rerun:
    """The format of a folder with one file per episode, ``PART-NUMBER-START.rrd``."""

    def write(self, source: EpisodeSource, target: Path, progress: Progress) -> None:
        """Write the folder.

        Raises:
            QueryError: there are no recordings.
            OutputError: the folder cannot be written.
        """
        with new_folder(target) as folder:
            for number, episode in enumerate(source.episodes(), 1):
                name = f"{episode.entry.part}-{episode.entry.number:06d}-{episode.start}"
                replace_file(file_in(folder, f"{name}.rrd"), recording_of(source, episode, name))
                progress(plural(number, "episode"), number, source.count)
            write_provenance(folder, source, "rerun")


def recording_of(source: EpisodeSource, episode: ExportEpisode, name: str) -> bytes:
    """Return the content of the .rrd file of an episode; `name` is the name of the recording."""
    recording = rr.RecordingStream(APPLICATION, recording_id=f"{source.data.manifest.identity}-{name}")
    recording.set_log_time_enabled(False)
    memory = recording.memory_recording()
    recording.send_recording_name(name)
    shown = episode.demonstration
    recording.log("instruction", rr.TextDocument(episode.instruction), static=True)
    recording.log(WORLD, rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
    scene = shown.sized_scene(source.scene)
    for track in (*surroundings(scene), *body_tracks(shown, source.scene, fineness=MIDDLE)):
        if track.name != FLOOR_NAME:
            _send_body(recording, track, shown.times)
    _send_joints(recording, source, shown)
    _send_contacts(recording, shown)
    _send_subgoals(recording, episode)
    for camera, video in episode.videos.items():
        _send_video(recording, camera, video, source.segmentation_of(episode, camera), shown.times[episode.frames])
    if episode.videos:
        classes = [rr.AnnotationInfo(number, entity) for number, entity in enumerate(source.legend)]
        recording.log(f"{WORLD}/{CAMERAS}", rr.AnnotationContext(classes), static=True)
    recording.send_blueprint(_layout(tuple(episode.videos)))
    recording.flush()
    content: bytes = memory.drain_as_bytes()
    return content


def _seconds(times: NDArray[Any]) -> rr.TimeColumn:
    return rr.TimeColumn(TIME, duration=np.asarray(times, dtype=float))


def _send_body(recording: rr.RecordingStream, track: BodyTrack, times: NDArray[np.float32]) -> None:
    """Send the meshes of a body, and its pose in each frame."""
    path = f"{WORLD}/{track.name}"
    for number, piece in enumerate(track.pieces):
        recording.log(f"{path}/mesh_{number}", _mesh(piece), static=True)
    if len(track.poses) == 1:
        pose = rr.Transform3D(translation=track.poses[0, :3], quaternion=rr.Quaternion(xyzw=track.poses[0, 3:]))
        recording.log(path, pose, static=True)
        return
    columns = rr.Transform3D.columns(translation=track.poses[:, :3], quaternion=track.poses[:, 3:])
    recording.send_columns(path, [_seconds(times)], columns)


def _mesh(piece: MeshPiece) -> rr.Mesh3D:
    """Return a mesh of triangles in one colour or with a texture."""
    rows, triangles = piece.indexed()
    texture: dict[str, Any] = {}
    if piece.texture and piece.places is not None:
        with Image.open(BytesIO(piece.texture)) as image:
            # Rerun's texture coordinates begin at the upper left.
            texture = {
                "albedo_texture": np.asarray(image.convert("RGB")),
                "vertex_texcoords": rows[:, 6:] * (1.0, -1.0) + (0.0, 1.0),
            }
    return rr.Mesh3D(
        vertex_positions=rows[:, :3],
        triangle_indices=triangles,
        vertex_normals=rows[:, 3:6],
        albedo_factor=[round(255 * part) for part in piece.rgba],
        **texture,
    )


def _send_joints(recording: rr.RecordingStream, source: EpisodeSource, shown: Demonstration) -> None:
    """Send the joint angles in radians, the openings of grippers in metres, and those of furniture."""
    values = np.concatenate([shown.joints, shown.widths[..., None]], axis=2).reshape(len(shown.times), -1)
    for name, column in zip(source.joints, values.T, strict=True):
        recording.send_columns(f"{ROBOTS}/{name}", [_seconds(shown.times)], rr.Scalars.columns(scalars=column))
    for name, column in zip(shown.furniture, shown.openings.T, strict=True):
        path = f"{FURNITURE}/{name}/opening"
        recording.send_columns(path, [_seconds(shown.times)], rr.Scalars.columns(scalars=column))


def contact_forces(shown: Demonstration) -> Mapping[tuple[str, str], NDArray[np.float32]]:
    """Return the contact force in newtons in each frame, shape (T,), for all pairs of bodies that touch at all."""
    forces: dict[tuple[str, str], NDArray[np.float32]] = {}
    for touch in shown.touches(0, len(shown.times) - 1):
        first, second = sorted((touch.one, touch.two))
        series = forces.setdefault((first, second), np.zeros(len(shown.times), dtype=np.float32))
        series[touch.frame] = max(series[touch.frame], touch.force)
    return forces


def _send_contacts(recording: rr.RecordingStream, shown: Demonstration) -> None:
    for (one, two), forces in contact_forces(shown).items():
        path = f"{CONTACTS}/{rr.escape_entity_path_part(one)}/{rr.escape_entity_path_part(two)}"
        recording.send_columns(path, [_seconds(shown.times)], rr.Scalars.columns(scalars=forces))


def subgoal_marks(episode: ExportEpisode) -> Iterator[tuple[float, str]]:
    """Yield the start time in seconds of each action, with its text, and then the end time with the result."""
    times, ends = episode.demonstration.times, episode.demonstration.ends.tolist()
    for number, (action, sentence) in enumerate(zip(episode.plan, episode.subgoals, strict=False)):
        yield float(times[ends[number]]), f"{number + 1}. {sentence} [{action}]"
    yield float(times[ends[-1]]), "The task is done." if episode.demonstration.success else episode.demonstration.detail


def _send_subgoals(recording: rr.RecordingStream, episode: ExportEpisode) -> None:
    marks = list(subgoal_marks(episode))
    times = _seconds(np.array([time for time, _ in marks]))
    recording.send_columns(SUBGOAL, [times], rr.TextLog.columns(text=[text for _, text in marks]))
    steps = _seconds(episode.demonstration.times[episode.frames])
    recording.send_columns(f"{SUBGOAL}/index", [steps], rr.Scalars.columns(scalars=episode.subgoal))


def _send_video(
    recording: rr.RecordingStream,
    camera: str,
    video: CameraVideo,
    segmentation: NDArray[np.unsignedinteger],
    times: NDArray[np.float32],
) -> None:
    """Send the images of a camera, losslessly compressed, and the pose of the camera at each image."""
    path, (width, height) = f"{WORLD}/{CAMERAS}/{camera}", video.size
    lens = rr.Pinhole(
        image_from_camera=video.intrinsics,
        resolution=[width, height],
        camera_xyz=rr.ViewCoordinates.RDF,
        image_plane_distance=FRUSTUM,
    )
    recording.log(path, lens, static=True)
    poses = rr.Transform3D.columns(translation=video.extrinsics[:, :3, 3], mat3x3=video.extrinsics[:, :3, :3])
    recording.send_columns(path, [_seconds(times)], poses)
    for time, image, entities in zip(times.tolist(), video.images(), segmentation, strict=True):
        recording.set_time(TIME, duration=time)
        buffer = BytesIO()
        Image.fromarray(image.rgb).save(buffer, "PNG")
        recording.log(f"{path}/rgb", rr.EncodedImage(contents=buffer.getvalue(), media_type="image/png"))
        recording.log(f"{path}/depth", rr.DepthImage(image.depth, meter=1.0))
        recording.log(f"{path}/segmentation", rr.SegmentationImage(entities))


def _layout(cameras: tuple[str, ...]) -> rrb.Blueprint:
    """Return the layout of the viewer: the scene and the images on the left, the plots on the right."""
    images = [rrb.Spatial2DView(origin=f"{WORLD}/{CAMERAS}/{name}", name=name) for name in cameras]
    scene = rrb.Spatial3DView(origin=WORLD, name="scene")
    left = rrb.Vertical(scene, rrb.Horizontal(*images), row_shares=[2, 1]) if images else scene
    return rrb.Blueprint(
        rrb.Horizontal(
            left,
            rrb.Vertical(
                rrb.TextDocumentView(origin="instruction", name="instruction"),
                rrb.TextLogView(origin=SUBGOAL, name="subgoals"),
                rrb.TimeSeriesView(origin=CONTACTS, name="contact forces in N"),
                rrb.TimeSeriesView(origin=ROBOTS, name="joints in rad, openings in m"),
                row_shares=[1, 2, 3, 3],
            ),
            column_shares=[3, 2],
        ),
        rrb.TimePanel(timeline=TIME, state="collapsed"),
        auto_views=False,
    )
