"""Mass properties (mass, centre of mass and inertia) of rigid bodies that consist of solids of uniform density.

The integrals over a polyhedron are sums over the tetrahedra between its triangles and the origin (Mirtich, "Fast and
accurate computation of polyhedral mass properties", 1996).
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from prag_asp.scene.forms import FORMS
from prag_asp.scene.scene import Size, Solid

Floats = NDArray[np.float64]

PLAUSIBLE = 1e-6
"""The relative tolerance for the conditions on an inertia, because decimals in files are rounded."""


class MassProperties(NamedTuple):
    """A mass in kilograms, its centre (3,) in metres, and its inertia (3, 3) about the centre in kg m²."""

    mass: float
    centre: Floats
    inertia: Floats

    def scaled(self, mass: float) -> MassProperties:
        """Return the properties of a body with the same mass distribution and a different mass."""
        return MassProperties(mass, self.centre, self.inertia * (mass / self.mass))

    def moved(self, rows: Floats, at: Floats) -> MassProperties:
        """Return the properties after a rotation, shape (3, 3), and a translation."""
        return MassProperties(self.mass, rows @ self.centre + at, rows @ self.inertia @ rows.T)

    def fits(self, low: Floats, high: Floats) -> bool:
        """Return whether some distribution of mass in a box, given by two corners, can have this inertia."""
        if not np.all(np.isfinite(self.inertia)):
            return False
        # For any distribution, the second moments about the centre of mass are positive in each direction, and at most
        # the mass times the square of the longest distance along an axis.
        moments = np.trace(self.inertia) / 2 * np.eye(3) - self.inertia
        room = self.mass * np.maximum(high - self.centre, self.centre - low) ** 2
        slack = PLAUSIBLE * float(np.trace(self.inertia))
        within = bool(np.all(np.diag(moments) <= room + slack))
        return within and float(np.linalg.eigvalsh(moments)[0]) >= -slack and float(np.trace(self.inertia)) > 0.0


def point_mass(mass: float, centre: Floats) -> MassProperties:
    """Return the properties of a point mass."""
    return MassProperties(mass, centre, np.zeros((3, 3)))


def combined(bodies: Iterable[MassProperties]) -> MassProperties:
    """Combine the properties of several bodies, using the parallel axis theorem."""
    parts = list(bodies)
    total = sum(part.mass for part in parts)
    centre = sum((part.mass * part.centre for part in parts), np.zeros(3)) / total
    inertia = np.zeros((3, 3))
    for part in parts:
        offset = part.centre - centre
        inertia += part.inertia + part.mass * (offset @ offset * np.eye(3) - np.outer(offset, offset))
    return MassProperties(total, centre, inertia)


def primitive_mass(solid: Solid) -> MassProperties:
    """Return the properties of a box, cylinder or ball with density 1, in its own frame."""
    x, y, z = (side / 2 for side in solid.size)
    volume = FORMS[solid.kind].volume((x, y, z))
    if solid.kind == "box":
        second = np.array([x * x, y * y, z * z]) / 3
    elif solid.kind == "cylinder":
        second = np.array([x * x / 4, x * x / 4, z * z / 3])
    else:
        second = np.full(3, x * x / 5)
    return MassProperties(volume, np.zeros(3), volume * np.diag(second.sum() - second))


def polyhedron_mass(triangles: Floats) -> MassProperties:
    """Return the properties of a closed polyhedron with density 1, given by outward-facing triangles (n, 3, 3)."""
    around = triangles.mean((0, 1))
    corners = triangles - around
    volumes = np.linalg.det(corners) / 6
    volume, sums = float(volumes.sum()), corners.sum(1)
    first = (volumes[:, None] * sums).sum(0) / 4
    second = np.einsum("n,nki,nkj->ij", volumes, corners, corners) + np.einsum("n,ni,nj->ij", volumes, sums, sums)
    second /= 20
    centre = first / volume
    about = second - volume * np.outer(centre, centre)
    return MassProperties(volume, centre + around, np.trace(about) * np.eye(3) - about)


def principal(inertia: Floats) -> tuple[Size, Floats]:
    """Return the principal moments of an inertia in kg m², and the rotation (3, 3) that has their axes as columns.

    If the inertia is diagonal, the axes are those of the frame.
    """
    diagonal = np.diag(inertia)
    if np.all(np.abs(inertia - np.diag(diagonal)) <= PLAUSIBLE * diagonal.max()):
        return (float(diagonal[0]), float(diagonal[1]), float(diagonal[2])), np.eye(3)
    moments, axes = np.linalg.eigh(inertia)
    if np.linalg.det(axes) < 0.0:
        axes[:, 0] = -axes[:, 0]
    return (float(moments[0]), float(moments[1]), float(moments[2])), axes
