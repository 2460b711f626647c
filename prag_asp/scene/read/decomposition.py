"""Divide a concave mesh into convex parts with CoACD (Wei et al., "Approximate convex decomposition", 2022).

The parts depend only on the mesh and the parameters. They are cached, because a decomposition takes seconds.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from functools import cache
from hashlib import sha256
from importlib.util import find_spec

import numpy as np
from numpy.typing import NDArray

from prag_asp.output.cache_files import cache_folder, read_cached, write_cached
from prag_asp.processes.bounded_call import bounded

Floats = NDArray[np.float64]

PARAMETERS = {
    "threshold": 0.05,
    "max_convex_hull": -1,
    "preprocess_mode": "auto",
    "preprocess_resolution": 50,
    "resolution": 2000,
    "mcts_nodes": 20,
    "mcts_iterations": 100,
    "mcts_max_depth": 3,
    "seed": 0,
}
"""The defaults of CoACD, stated here because results depend on them; the threshold is a share of the mesh's size."""

LONGEST = 300.0
"""The time limit of a decomposition in seconds; CoACD itself has none. A closed mesh of about 2,000 triangles takes 9
s. A mug whose solids share edges takes 115 s, because it is not a manifold: it is preprocessed first, and has 28
parts."""

LARGEST = 64_000_000
"""The largest size of a cached decomposition in bytes."""

FORMAT = 1
"""The version of the cache format; it increases when the content of cache files changes."""


@cache
def can_decompose() -> bool:
    """Return whether CoACD is installed."""
    return find_spec("coacd") is not None


def decomposed(triangles: Floats) -> tuple[Floats, ...]:
    """Return the triangles (n, 3, 3) of the convex parts of a concave mesh, given by its triangles.

    Raises:
        LimitReached: the decomposition takes more than `LONGEST` seconds, or more than the available memory.
    """
    key = sha256(json.dumps([FORMAT, PARAMETERS], sort_keys=True).encode() + np.round(triangles, 9).tobytes())
    folder = cache_folder()
    path = None if folder is None else folder / f"mesh-{key.hexdigest()}.json"
    content = None if path is None else read_cached(path, LARGEST)
    if content is None:
        parts = bounded(decompose, triangles, seconds=LONGEST)
        if path is not None:
            write_cached(path, json.dumps([part.tolist() for part in parts]).encode())
        return parts
    return tuple(np.array(part) for part in json.loads(content))


def decompose(triangles: Floats) -> tuple[Floats, ...]:
    """Return the convex parts of a mesh; called in a separate process, because CoACD cannot be interrupted."""
    import coacd  # type: ignore[import-untyped]  # noqa: PLC0415 - an extra, and heavy

    coacd.set_log_level("off")
    corners, numbers = np.unique(triangles.reshape(-1, 3), axis=0, return_inverse=True)
    found: Sequence[tuple[Floats, NDArray[np.int64]]] = coacd.run_coacd(
        coacd.Mesh(corners, numbers.reshape(-1, 3)), **PARAMETERS
    )
    return tuple(np.asarray(vertices, dtype=float)[np.asarray(faces)] for vertices, faces in found)
