"""PyBullet, imported in silence: it announces when it was built."""

from __future__ import annotations

from prag_asp.physics.world.silence import STDERR, STDOUT, silenced

with silenced(STDOUT, STDERR):
    import pybullet
    import pybullet_data

__all__ = ["pybullet", "pybullet_data"]
