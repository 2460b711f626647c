"""Read a .glb file as the specification of glTF 2.0 describes it, with none of the package's code."""

from __future__ import annotations

import json
import struct
from dataclasses import dataclass
from typing import Any

import numpy as np

TYPES = {5126: np.float32, 5123: np.uint16, 5125: np.uint32}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}


@dataclass(frozen=True)
class GlbFile:
    json: dict[str, Any]
    binary: bytes

    def array(self, number: int) -> np.ndarray:
        accessor = self.json["accessors"][number]
        kind, width = np.dtype(TYPES[accessor["componentType"]]), WIDTHS[accessor["type"]]
        rows = np.frombuffer(self.view(accessor["bufferView"]), kind).reshape(-1, width)
        assert len(rows) == accessor["count"]
        return rows

    def view(self, number: int) -> bytes:
        view = self.json["bufferViews"][number]
        return self.binary[view["byteOffset"] : view["byteOffset"] + view["byteLength"]]

    def node(self, name: str) -> int:
        return next(i for i, node in enumerate(self.json["nodes"]) if node["name"] == name)

    def poses(self, name: str) -> np.ndarray:
        """Return the poses of a node over the animation, one row if it does not move."""
        number = self.node(name)
        node, animation = self.json["nodes"][number], self.json["animations"][0]
        found = {
            channel["target"]["path"]: self.array(animation["samplers"][channel["sampler"]]["output"])
            for channel in animation["channels"]
            if channel["target"]["node"] == number
        }
        still = np.array([node["translation"] + node["rotation"]], np.float32)
        return np.hstack([found["translation"], found["rotation"]]) if found else still

    def triangles(self, name: str) -> np.ndarray:
        """Return the triangles (n, 3, 3) of a node in its own frame."""
        mesh = self.json["meshes"][self.json["nodes"][self.node(name)]["mesh"]]
        return np.concatenate(
            [
                self.array(each["attributes"]["POSITION"])[self.array(each["indices"]).ravel()].reshape(-1, 3, 3)
                for each in mesh["primitives"]
            ]
        )


def read_glb(content: bytes) -> GlbFile:
    magic, version, length = struct.unpack_from("<4sII", content)
    assert (magic, version, length) == (b"glTF", 2, len(content))
    size, kind = struct.unpack_from("<I4s", content, 12)
    assert kind == b"JSON" and size % 4 == 0
    binary_size, kind = struct.unpack_from("<I4s", content, 20 + size)
    assert kind == b"BIN\0" and 28 + size + binary_size == length
    return GlbFile(json.loads(content[20 : 20 + size]), content[28 + size :])
