"""Lift a body with a free hand of Franka's sizes in MuJoCo: an antipodal search without an arm, for what is true.

Two pads close with 12 N, the hand rises by 100 mm and holds still for a second. Nothing of prag_asp is used.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

Floats = NDArray[np.float64]

STEP = 0.002
FORCE, OPENING = 12.0, 0.08
"""Newtons of a finger, and metres between open pads."""

FRICTION = 0.98
"""Rubber on wood: 1.4 times 0.7, as prag_asp has it by default."""

TIP, PALM = 0.009, 0.0454
"""Metres from the tool to the fingertips and back to the palm."""

RISE, RISING, HELD = 0.10, 1.0, 1.0
"""Metres, and seconds of rising and of holding still."""

SETTLING, CLOSING = 1.5, 0.4
"""Seconds in which the body comes to rest, and the pads close."""

ROOM = 0.004
"""Metres between pads and body before they close."""

TRIES, PAIRS = 40, 4000
"""Grasps that are simulated, and lines through the body that are drawn."""

STEEPEST = 0.15
"""The least cosine between the direction of the hand and straight down."""


@dataclass(frozen=True)
class Lift:
    """What a search found: whether the hand lifts the body, how wide it is there, how many grasps it tried."""

    lifted: bool
    tried: int
    width: float = 0.0
    slope: float = 0.0


def lift(parts: Sequence[Floats], mass: float, centre: Sequence[float] | None, seed: int = 0) -> Lift:
    """Search for a grasp with which the hand lifts a body; its parts are corners (n, 3) of convex ones, in metres."""
    rng = np.random.default_rng(seed)
    low = min(float(part[:, 2].min()) for part in parts)
    model = mujoco.MjModel.from_xml_string(_xml(parts, mass, centre))
    data = mujoco.MjData(model)
    data.qpos[:7] = (0.0, 0.0, -low + 0.001, 1.0, 0.0, 0.0, 0.0)
    _park(data)
    for _ in range(round(SETTLING / STEP)):
        mujoco.mj_step(model, data)
    rest = data.qpos[:7].copy()
    turn = Rotation.from_quat(rest[3:], scalar_first=True).as_matrix()
    placed = [part @ turn.T + rest[:3] for part in parts]
    tried = 0
    for middle, frame, width in _grasps(placed, rng):
        if not _enter(model, data, rest, middle, frame, min(OPENING, width + 2 * ROOM)):
            continue
        tried += 1
        if _lifts(model, data, rest, middle):
            return Lift(True, tried, width, float(-frame[2, 2]))
        if tried == TRIES:
            break
    return Lift(False, tried)


def _grasps(parts: Sequence[Floats], rng: np.random.Generator) -> Iterator[tuple[Floats, Floats, float]]:
    """Yield tools between two opposite places of a surface: the middle, the axes as columns, how far these are apart.

    Of the lines drawn those from above come first; z is the direction of the hand, y that of the pads.
    """
    hulls = [ConvexHull(part) for part in parts]
    triangles = np.concatenate([part[hull.simplices] for part, hull in zip(parts, hulls, strict=True)])
    normals = np.concatenate([hull.equations[:, :3] for hull in hulls])
    areas = np.linalg.norm(np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]), axis=1)
    chosen = rng.choice(len(triangles), PAIRS, p=areas / areas.sum())
    shares = rng.dirichlet((1.0, 1.0, 1.0), PAIRS)
    points = np.einsum("ij,ijk->ik", shares, triangles[chosen])
    found = []
    for point, normal in zip(points, normals[chosen], strict=True):
        axis = normal + 0.25 * rng.normal(size=3) * (rng.random() < 0.5)
        axis /= np.linalg.norm(axis)
        if any((hull.equations[:, :3] @ point + hull.equations[:, 3]).max() < -1e-6 for hull in hulls):
            continue
        # Where the line leaves a part within the opening; what is further in is between the pads as well.
        ends = []
        for hull in hulls:
            down, off = hull.equations[:, :3] @ -axis, hull.equations[:, :3] @ point + hull.equations[:, 3]
            with np.errstate(divide="ignore", invalid="ignore"):
                way = -off / down
            enters, leaves = way[down < -1e-9].max(initial=0.0), way[down > 1e-9].min(initial=np.inf)
            if (off[np.abs(down) <= 1e-9] <= 0).all() and enters <= leaves and 1e-3 < leaves < OPENING - 2 * ROOM:
                k = int(np.flatnonzero(down > 1e-9)[way[down > 1e-9].argmin()])
                if hull.equations[k, :3] @ -axis > 0.8:
                    ends.append(leaves)
        for end in ends:
            side = np.cross(axis, rng.normal(size=3) * 0.5 + np.array([0.0, 0.0, 1.0]) * (rng.random() < 0.6))
            side /= np.linalg.norm(side)
            ahead = np.cross(side, axis)
            ahead *= -np.sign(ahead[2]) or 1.0
            if -ahead[2] >= STEEPEST:
                found.append((float(ahead[2]) + 0.3 * rng.random(), point - end / 2 * axis, axis, ahead, float(end)))
    top = max(float(part[:, 2].max()) for part in parts)
    for _, middle, axis, ahead, width in sorted(found, key=lambda each: each[0]):
        # The tips stay over the ground, and the palm over the body if it comes from above.
        lowest = middle[2] + TIP * ahead[2] - 0.5 * width * abs(axis[2]) - 0.009 * np.sqrt(max(0.0, 1 - ahead[2] ** 2))
        back = max(0.0, 0.001 - lowest) / -ahead[2]
        if ahead[2] < -0.95:
            back = max(back, top - middle[2] - PALM + 0.001)
        if back < 2 * TIP - 0.003:
            yield middle - back * ahead, np.stack([np.cross(axis, ahead), axis, ahead], 1), width


def _enter(
    model: mujoco.MjModel, data: mujoco.MjData, rest: Floats, middle: Floats, frame: Floats, width: float
) -> bool:
    """Put the open hand around a body at rest; return whether it touches neither that nor the ground."""
    mujoco.mj_resetData(model, data)
    quaternion = Rotation.from_matrix(frame).as_quat(scalar_first=True)
    data.qpos[:7] = rest
    data.qpos[7:10], data.qpos[10:14] = middle, quaternion
    data.qpos[14:16] = width / 2
    data.mocap_pos[0], data.mocap_quat[0] = middle, quaternion
    mujoco.mj_forward(model, data)
    hand = set(range(2, model.nbody))
    for i in range(data.ncon):
        bodies = {int(model.geom_bodyid[geom]) for geom in data.contact[i].geom}
        if bodies & hand and data.contact[i].dist < 0.0:
            return False
    return True


def _lifts(model: mujoco.MjModel, data: mujoco.MjData, rest: Floats, middle: Floats) -> bool:
    """Close the pads, rise, hold still; return whether the body has come along, between both pads."""
    data.ctrl[:] = FORCE
    for _ in range(round(CLOSING / STEP)):
        mujoco.mj_step(model, data)
    steps = round(RISING / STEP)
    for k in range(steps):
        data.mocap_pos[0, 2] = middle[2] + RISE * (k + 1) / steps
        mujoco.mj_step(model, data)
        if k == steps // 2 and data.qpos[2] < rest[2] + 0.3 * RISE:
            return False
    for _ in range(round(HELD / STEP)):
        mujoco.mj_step(model, data)
    touched = {
        int(model.geom_bodyid[geom])
        for i in range(data.ncon)
        for geom in data.contact[i].geom
        if 1 in model.geom_bodyid[data.contact[i].geom]
    }
    return bool(data.qpos[2] > rest[2] + 0.85 * RISE and {3, 4} <= touched)


def _park(data: mujoco.MjData) -> None:
    """Put the hand far above."""
    data.qpos[7:14] = (0.0, 0.0, 2.0, 0.0, 1.0, 0.0, 0.0)
    data.mocap_pos[0], data.mocap_quat[0] = (0.0, 0.0, 2.0), (0.0, 1.0, 0.0, 0.0)


def _xml(parts: Sequence[Floats], mass: float, centre: Sequence[float] | None) -> str:
    """Return the model: the ground, the body as body 1, the hand as body 2 and its fingers as 3 and 4."""
    volumes = [ConvexHull(part).volume for part in parts]
    meshes = "".join(
        f'<mesh name="m{i}" inertia="convex" vertex="{" ".join(f"{x:.7g}" for x in part.ravel())}"/>'
        for i, part in enumerate(parts)
    )
    geoms = "".join(
        f'<geom type="mesh" mesh="m{i}" mass="{mass * volume / sum(volumes):.9g}"/>' for i, volume in enumerate(volumes)
    )
    inertial = ""
    if centre is not None:
        points = np.concatenate(parts)
        x, y, z = np.ptp(points, axis=0)
        moments = " ".join(f"{mass / 12 * (a * a + b * b):.9g}" for a, b in ((y, z), (x, z), (x, y)))
        inertial = f'<inertial pos="{" ".join(map(str, centre))}" mass="{mass}" diaginertia="{moments}"/>'
    # The pad of 17.6 x 14.2 x 17.6 mm, the shank behind it, and the hand of 63 x 204 x 66 mm.
    fingers = "".join(
        f'<body name="f{side}"><inertial pos="0 0 0" mass="0.1" diaginertia="1e-4 1e-4 1e-4"/>'
        f'<joint name="j{side}" type="slide" axis="0 {side} 0" range="0 0.04" limited="true" damping="5"/>'
        f'<geom type="box" size="0.0088 0.0071 0.0088" pos="0 {side * 0.0071} 0.0002" condim="4"/>'
        f'<geom type="box" size="0.0104 0.0083 0.018" pos="0 {side * 0.0172} -0.0268"/></body>'
        for side in (1, -1)
    )
    return f"""
<mujoco>
  <option timestep="{STEP}" cone="elliptic" impratio="10" integrator="implicitfast"/>
  <default><geom friction="{FRICTION} 0.005 0.0001" solref="0.01 1" solimp="0.95 0.99 0.001"/></default>
  <asset>{meshes}</asset>
  <worldbody>
    <geom type="plane" size="2 2 0.1"/>
    <body name="thing"><freejoint/>{inertial}{geoms}</body>
    <body name="hand" gravcomp="1"><freejoint/>
      <inertial pos="0 0 -0.08" mass="1" diaginertia="0.01 0.01 0.01"/>
      <geom type="box" size="0.0315 0.102 0.033" pos="0 0 {-PALM - 0.033}"/>{fingers}
    </body>
    <body name="target" mocap="true"/>
  </worldbody>
  <contact><exclude body1="hand" body2="f1"/><exclude body1="hand" body2="f-1"/></contact>
  <equality>
    <weld body1="target" body2="hand" solref="0.004 1" solimp="0.99 0.999 0.001"/>
    <joint joint1="j1" joint2="j-1" solref="0.01 1"/>
  </equality>
  <actuator><motor joint="j1" gear="-1"/><motor joint="j-1" gear="-1"/></actuator>
</mujoco>"""
