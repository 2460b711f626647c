"""Write moving bodies as one binary glTF 2.0 file (.glb, ISO/IEC 12113), which 3D programs and viewers open.

glTF's y axis points up; the node ``world`` turns the scene, whose z axis points up. Colours in glTF are linear.
"""

from __future__ import annotations

import json
import struct
from collections.abc import Iterable, Mapping, Sequence
from io import BytesIO
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from prag_asp.physics.pictures.camera import pillow
from prag_asp.physics.playback.mesh_pieces import MeshPiece
from prag_asp.physics.playback.tracks import BodyTrack
from prag_asp.scene.geometry import Pose

MAGIC, VERSION, JSON_CHUNK, BINARY_CHUNK = 0x46546C67, 2, 0x4E4F534A, 0x004E4942
FLOAT, SHORT, INTEGER = 5126, 5123, 5125
"""The numbers by which glTF identifies component types: float32, uint16 and uint32."""

VERTICES, INDICES = 34962, 34963
"""The numbers by which glTF identifies the uses of buffers."""

UPRIGHT = (-(0.5**0.5), 0.0, 0.0, 0.5**0.5)
"""The rotation that turns the z axis into the y axis."""

ROUGHNESS = 0.7
"""The roughness of all materials, from 0 to 1: about that of plastic, lacquer and wood."""

LARGEST_SIDE, QUALITY = 1024, 85
"""The largest side of a texture in texels, and the quality of textures that are converted to JPEG."""

SIGNATURES: Mapping[bytes, str] = {b"\x89PNG": "image/png", b"\xff\xd8\xff": "image/jpeg"}
"""The first bytes of images in the formats that glTF allows."""


class GltfCamera(NamedTuple):
    """A camera: its pose, with x to the right, y up and z backwards; its target in metres; and its vertical angle."""

    pose: Pose
    target: tuple[float, float, float]
    angle: float


def gltf_file(
    tracks: Iterable[BodyTrack], times: NDArray[np.float32], camera: GltfCamera, extras: Mapping[str, Any]
) -> bytes:
    """Return a .glb file with one animation; `times` are the T times, in seconds, of the poses of moving bodies.

    `extras` are JSON values that are stored with the animation.

    Raises:
        PicturesMissingError: a texture has to be converted, and Pillow is not installed.
    """
    writer = _GltfWriter()
    for track in tracks:
        writer.add(track, times)
    return writer.finish(camera, extras)


class _GltfWriter:
    """A collector of the JSON and the binary part of a file."""

    def __init__(self) -> None:
        self.binary = bytearray()
        self.views: list[dict[str, Any]] = []
        self.accessors: list[dict[str, Any]] = []
        self.nodes: list[dict[str, Any]] = []
        self.meshes: list[dict[str, Any]] = []
        self.materials: list[dict[str, Any]] = []
        self.images: list[dict[str, Any]] = []
        self.samplers: list[dict[str, Any]] = []
        self.channels: list[dict[str, Any]] = []
        self._numbers: dict[Any, int] = {}
        self._times: int | None = None

    def add(self, track: BodyTrack, times: NDArray[np.float32]) -> None:
        """Add a body, and its motion if it moves."""
        node = len(self.nodes)
        self.meshes.append({"primitives": [self._primitive(piece) for piece in track.pieces]})
        first = track.poses[0].tolist()
        self.nodes.append(
            {"name": track.name, "mesh": len(self.meshes) - 1, "translation": first[:3], "rotation": first[3:]}
        )
        if len(track.poses) == 1:
            return
        if self._times is None:
            self._times = self._accessor(times, "SCALAR", bounds=True)
        for path, kind, columns in (("translation", "VEC3", slice(0, 3)), ("rotation", "VEC4", slice(3, 7))):
            values = self._accessor(np.ascontiguousarray(track.poses[:, columns]), kind)
            self.samplers.append({"input": self._times, "output": values, "interpolation": "LINEAR"})
            self.channels.append({"sampler": len(self.samplers) - 1, "target": {"node": node, "path": path}})

    def finish(self, camera: GltfCamera, extras: Mapping[str, Any]) -> bytes:
        """Return the file."""
        bodies = list(range(len(self.nodes)))
        eye = {"name": "camera", "camera": 0, "translation": camera.pose.position, "rotation": camera.pose.quaternion}
        self.nodes.append({**eye, "extras": {"target": camera.target}})
        self.nodes.append({"name": "world", "rotation": UPRIGHT, "children": [*bodies, len(bodies)]})
        lens = {"yfov": camera.angle, "znear": 0.05, "zfar": 20.0}
        content: dict[str, Any] = {
            "asset": {"version": "2.0", "generator": "prag_asp"},
            "scene": 0,
            "scenes": [{"nodes": [len(self.nodes) - 1]}],
            "nodes": self.nodes,
            "cameras": [{"type": "perspective", "perspective": lens}],
            "meshes": self.meshes,
            "materials": self.materials,
            "accessors": self.accessors,
            "bufferViews": self.views,
            "buffers": [{"byteLength": len(self.binary)}],
        }
        if self.images:
            content["images"], content["samplers"] = self.images, [{}]
            content["textures"] = [{"source": i, "sampler": 0} for i in range(len(self.images))]
        if self.channels:
            content["animations"] = [{"name": "episode", "samplers": self.samplers, "channels": self.channels}]
        content["scenes"][0]["extras"] = dict(extras)
        text = json.dumps(content, separators=(",", ":"), allow_nan=False).encode("ascii")
        text += b" " * (-len(text) % 4)
        chunks = struct.pack("<II", len(text), JSON_CHUNK) + text
        chunks += struct.pack("<II", len(self.binary), BINARY_CHUNK) + bytes(self.binary)
        return struct.pack("<III", MAGIC, VERSION, 12 + len(chunks)) + chunks

    def _primitive(self, piece: MeshPiece) -> dict[str, Any]:
        """Add the triangles of a piece; equal corners are stored once."""
        rows, indices = piece.indexed()
        columns = {"POSITION": rows[:, :3], "NORMAL": rows[:, 3:6]}
        if piece.places is not None:
            # The texture coordinates of glTF begin at the upper left.
            columns["TEXCOORD_0"] = np.column_stack([rows[:, 6], 1 - rows[:, 7]])
        attributes = {
            name: self._accessor(values, f"VEC{values.shape[1]}", use=VERTICES, bounds=name == "POSITION")
            for name, values in columns.items()
        }
        small = np.uint16 if len(rows) < 1 << 16 else np.uint32
        triangles = self._accessor(indices.ravel().astype(small), "SCALAR", use=INDICES)
        return {"attributes": attributes, "indices": triangles, "material": self._material(piece)}

    def _material(self, piece: MeshPiece) -> int:
        """Return the number of the material of a piece."""
        key = (piece.rgba, piece.texture)
        if key not in self._numbers:
            surface: dict[str, Any] = {
                "baseColorFactor": [*(linear(part) for part in piece.rgba[:3]), piece.rgba[3]],
                "metallicFactor": 0.0,
                "roughnessFactor": ROUGHNESS,
            }
            if piece.texture:
                surface["baseColorTexture"] = {"index": self._image(piece.texture)}
            self.materials.append({"pbrMetallicRoughness": surface, "doubleSided": True})
            self._numbers[key] = len(self.materials) - 1
        return self._numbers[key]

    def _image(self, texture: bytes) -> int:
        """Return the number of an image."""
        if texture not in self._numbers:
            content, kind = fitting_image(texture)
            self.images.append({"bufferView": self._view(content), "mimeType": kind})
            self._numbers[texture] = len(self.images) - 1
        return self._numbers[texture]

    def _accessor(self, values: NDArray[Any], kind: str, *, use: int | None = None, bounds: bool = False) -> int:
        """Add an array whose rows are vectors; with `bounds`, add its minimum and maximum as well."""
        types = {np.dtype(np.float32): FLOAT, np.dtype(np.uint16): SHORT, np.dtype(np.uint32): INTEGER}
        accessor: dict[str, Any] = {"bufferView": self._view(values.tobytes(), use)}
        accessor |= {"componentType": types[values.dtype], "count": len(values), "type": kind}
        if bounds:
            rows = values.reshape(len(values), -1)
            accessor |= {"min": rows.min(axis=0).tolist(), "max": rows.max(axis=0).tolist()}
        self.accessors.append(accessor)
        return len(self.accessors) - 1

    def _view(self, content: bytes, use: int | None = None) -> int:
        """Add bytes to the binary part, aligned to a multiple of four."""
        view = {"buffer": 0, "byteOffset": len(self.binary), "byteLength": len(content)}
        self.views.append(view if use is None else {**view, "target": use})
        self.binary += content + bytes(-len(content) % 4)
        return len(self.views) - 1


def linear(part: float) -> float:
    """Return the linear intensity of a component of an sRGB colour; both are from 0 to 1 (IEC 61966-2-1)."""
    return part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4


def fitting_image(content: bytes) -> tuple[bytes, str]:
    """Return an image as PNG or JPEG with at most `LARGEST_SIDE` texels on a side, and its media type.

    Raises:
        PicturesMissingError: the image has to be converted, and Pillow is not installed.
    """
    image = pillow().open(BytesIO(content))
    kind = next((kind for begin, kind in SIGNATURES.items() if content.startswith(begin)), "")
    if kind and max(image.size) <= LARGEST_SIDE:
        return content, kind
    clear = image.mode in ("RGBA", "LA", "PA")
    image = image.convert("RGBA" if clear else "RGB")
    image.thumbnail((LARGEST_SIDE, LARGEST_SIDE))
    buffer = BytesIO()
    image.save(buffer, "PNG" if clear else "JPEG", quality=QUALITY)
    return buffer.getvalue(), "image/png" if clear else "image/jpeg"


def time_marks(names: Sequence[str], ends: Sequence[float]) -> list[dict[str, Any]]:
    """Return actions as JSON values: their names, and the times in seconds at which they begin and end."""
    return [
        {"name": name, "begin": begin, "end": end} for name, begin, end in zip(names, ends[:-1], ends[1:], strict=True)
    ]
