"""Replay a recording open loop in MuJoCo, with other friction and mass, and judge the states that it reaches.

The world is built from the independent check (tests/independent), not from the package: arms by their makers' numbers,
bodies by their convex parts. Motors follow the recorded commands; nothing corrects them.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import mujoco
import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

from prag_asp.scene.scene import BodyModel, Scene
from tests.independent.check import terms
from tests.independent.convex import Part, volume
from tests.independent.frames import Frame
from tests.independent.relations import MEANINGS, Seen
from tests.independent.world import Layout, World, world_of

Floats = NDArray[np.float64]

STEP, FRAME = 0.002, 0.05
"""Seconds of a step of the simulation, and of a frame of a recording."""

RUBBER, WOOD = 1.4, 0.5
"""Friction of pads and of the table, which is multiplied by that of a body."""

FORCE = 12.0
"""Newtons of a finger."""

MISSED = 0.006
"""Metres and radians by which a fact may be missed: other friction moves bodies by some millimetres."""

DRAG = {True: 2.0, False: 0.3}
"""Friction in the joint of furniture that slides or turns, in newtons or newton metres."""

PAD, SHANK = ("0.0088 0.0071 0.0088", (0.0071, 0.045)), ("0.0104 0.0083 0.018", (0.0172, 0.018))
"""Half the sides of the boxes of a finger, and their places along y and z of it, in metres."""


class Change(NamedTuple):
    """Factors of the friction and of the masses of all bodies that move."""

    friction: float = 1.0
    mass: float = 1.0


def replay(states: Sequence[Mapping[str, bool]], shown: Any, scene: Scene, change: Change) -> list[str]:
    """Return the facts that do not hold at the ends of states where the commands of a recording are followed.

    `states` are those of the task, the initial one first, each by the texts of its fluents.
    """
    world = world_of(scene)
    model = mujoco.MjModel.from_xml_string(_xml(world, scene, shown, change))
    data = mujoco.MjData(model)
    _begin(model, data, shown)
    found, ends = list[str](), shown.ends.tolist()
    commands = shown.commands.astype(float)
    steps = round(FRAME / STEP)
    for at in range(len(shown.times)):
        for k in range(steps if at else 0):
            share = (k + 1) / steps
            data.ctrl[:] = _controls(commands[at - 1] + share * (commands[at] - commands[at - 1]))
            mujoco.mj_step(model, data)
        for k, end in enumerate(ends):
            if end == at:
                found += [f"state {k}: {text}" for text in _broken(states[k], model, data, shown, world)]
        if found:
            break
    return found


def _begin(model: mujoco.MjModel, data: mujoco.MjData, shown: Any) -> None:
    """Set the first frame."""
    for i, robot in enumerate(shown.robots):
        for j in range(7):
            data.joint(f"{robot}:{j}").qpos[0] = shown.joints[0, i, j]
        for side in ("left", "right"):
            data.joint(f"{robot}:{side}").qpos[0] = shown.widths[0, i] / 2
    for k, name in enumerate(shown.objects):
        if mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_JOINT, f"free:{name}") >= 0:
            x, y, z, *quaternion = shown.poses[0, k].astype(float).tolist()
            data.joint(f"free:{name}").qpos[:] = (x, y, z, quaternion[3], *quaternion[:3])
    for k, name in enumerate(shown.furniture):
        data.joint(f"part:{name}").qpos[0] = shown.openings[0, k]
    data.ctrl[:] = _controls(shown.commands[0].astype(float))
    mujoco.mj_forward(model, data)


def _controls(command: Floats) -> Floats:
    """Return the targets of all motors: seven joints and two fingers of each arm."""
    return np.concatenate([[*row[:7], max(row[7], 0.0) / 2, max(row[7], 0.0) / 2] for row in command])


def _broken(
    state: Mapping[str, bool], model: mujoco.MjModel, data: mujoco.MjData, shown: Any, world: World
) -> Iterator[str]:
    """Yield the facts of a state that are missed by more than `MISSED`."""
    poses = {name: _frame(data, name) for name in shown.objects}
    openings = {name: float(data.joint(f"part:{name}").qpos[0]) for name in shown.furniture}
    joints = {robot: tuple(float(data.joint(f"{robot}:{j}").qpos[0]) for j in range(7)) for robot in shown.robots}
    widths = {
        robot: float(sum(data.joint(f"{robot}:{side}").qpos[0] for side in ("left", "right"))) for robot in joints
    }
    tools = {robot: world.robots[robot].tool(joints[robot]) for robot in joints}
    seen = Seen(Layout(world, poses, openings), tools, widths)
    touching = set(_touching(model, data))
    for fluent, value in state.items():
        name, *arguments = terms(fluent)
        meaning = world.meaning(name)
        if meaning is None or not {*arguments} <= {*poses, *world.kinds, *world.rotations}:
            continue
        if meaning == "holding":
            robot, body = arguments
            held = {(f"{robot}:left", body), (f"{robot}:right", body)} <= touching
            missed = 0.0 if held == value else 1.0
        else:
            missed = max(MEANINGS[meaning](seen, arguments))
            missed = missed if value else -missed
        if missed > MISSED:
            yield f"{fluent} is not {str(value).lower()} by {1000 * missed:.1f} mm"


def _frame(data: mujoco.MjData, name: str) -> Frame:
    body = data.body(name)
    return Frame(np.array(body.xmat).reshape(3, 3), np.array(body.xpos))


def _touching(model: mujoco.MjModel, data: mujoco.MjData) -> Iterator[tuple[str, str]]:
    """Yield the names of bodies that touch, either way round."""
    for i in range(data.ncon):
        one, two = (model.body(model.geom_bodyid[geom]).name for geom in data.contact[i].geom)
        yield one, two
        yield two, one


def _xml(world: World, scene: Scene, shown: Any, change: Change) -> str:
    """Return the model of a scene with the objects of a recording."""
    meshes, bodies, pairs, geoms = list[str](), list[str](), list[str](), dict[str, list[str]]()
    for name in shown.objects:
        bodies.append(_body(world, scene, name, meshes, geoms, change))
    arms = [_arm(world, robot, meshes) for robot in shown.robots]
    for robot in shown.robots:
        for name, own in geoms.items():
            friction = RUBBER * world.frictions[name] * change.friction
            numbers = f"{friction} {friction} 0.005 0.0001 0.0001"
            pairs += [
                f'<pair geom1="{robot}:{side}:pad" geom2="{geom}" condim="4" friction="{numbers}" solref="0.01 1"/>'
                for side in ("left", "right")
                for geom in own
            ]
    (x, y), (half_x, half_y) = world.table
    rough = WOOD * change.friction
    motors = "".join(
        f'<position joint="{robot}:{j}" kp="20000" kv="400"/>' if isinstance(j, int)
        else f'<position joint="{robot}:{j}" kp="10000" kv="200" forcerange="-{FORCE} {FORCE}"/>'
        for robot in shown.robots
        for j in (*range(7), "left", "right")
    )  # fmt: skip
    links = "".join(f'<joint joint1="{robot}:left" joint2="{robot}:right"/>' for robot in shown.robots)
    return f"""
<mujoco>
  <compiler angle="radian" balanceinertia="true" autolimits="true" boundmass="1e-4" boundinertia="1e-9"/>
  <option timestep="{STEP}" cone="elliptic" impratio="10" integrator="implicitfast"/>
  <default><geom solref="0.01 1" solimp="0.95 0.99 0.001" contype="2" conaffinity="3"/></default>
  <asset>{"".join(meshes)}</asset>
  <worldbody>
    <geom type="box" size="{half_x} {half_y} 0.02" pos="{x} {y} -0.02" friction="{0.7 * rough} 0.005 0.0001"/>
    {"".join(bodies)}{"".join(arms)}
  </worldbody>
  <contact>{"".join(pairs)}</contact>
  <equality>{links}</equality>
  <actuator>{motors}</actuator>
</mujoco>"""


def _body(world: World, scene: Scene, name: str, meshes: list[str], geoms: dict[str, list[str]], change: Change) -> str:
    """Return the body of an object; its geoms are noted by its name."""
    index = len(geoms)
    still = name in world.places or name in world.furniture
    parts, rolling = world.parts[name], scene.material(name).rolling
    surface = f'friction="{world.frictions[name] * WOOD * change.friction} 0.005 {rolling}"'
    sizes = [_volume(part) for part in parts]
    mass = world.masses[name] * change.mass
    own, text = geoms.setdefault(name, []), ""
    for number, (part, size) in enumerate(zip(parts, sizes, strict=True)):
        own.append(f"g{index}_{number}")
        roll = ' condim="6"' if part.kind == "sphere" else ""
        heavy = f'mass="{mass * size / sum(sizes):.9g}"'
        text += f'<geom name="{own[-1]}" {_form(part, own[-1], meshes)} {surface}{roll} {heavy}/>'
    model = scene.shapes[name].model
    if model is not None:
        text += _inertial(model, change.mass)
    if name in world.furniture:
        text += _moving(world, name, own, surface, scene.material(name).density)
    free = "" if still else f'<freejoint name="free:{name}"/>'
    at = ""
    if still:
        place = world.places[name]
        at = f' pos="{_text(place.at)}" quat="{_quaternion(place)}"'
    return f'<body name="{name}"{at}>{free}{text}</body>'


def _moving(world: World, name: str, own: list[str], surface: str, density: float) -> str:
    """Return the moving part of furniture."""
    furniture, text = world.furniture[name], ""
    for number, ends in enumerate(furniture.moving):
        low, high = np.array(ends).T
        own.append(f"{own[0]}_part{number}")
        text += (
            f'<geom name="{own[-1]}" type="box" size="{_text((high - low) / 2)}" pos="{_text((high + low) / 2)}" '
            f'{surface} density="{density}"/>'
        )
    kind, axis = ("slide", "-1 0 0") if furniture.slides else ("hinge", "0 0 -1")
    joint = (
        f'<joint name="part:{name}" type="{kind}" axis="{axis}" range="0 {furniture.limit}" '
        f'frictionloss="{DRAG[furniture.slides]}" damping="0.5"/>'
    )
    return f'<body name="{name}:part" pos="{_text(furniture.joint)}">{joint}{text}</body>'


def _inertial(model: BodyModel, factor: float) -> str:
    x, y, z, w = model.axes
    moments = [max(moment, 1e-7) * factor for moment in model.moments]
    return (
        f'<inertial pos="{_text(model.centre)}" quat="{w} {x} {y} {z}" mass="{model.mass * factor}" '
        f'diaginertia="{_text(moments)}"/>'
    )


def _form(part: Part, name: str, meshes: list[str]) -> str:
    """Return the attributes of a geom."""
    place = f'pos="{_text(part.at)}"'
    if part.hull is not None:
        corners = part.hull.corners
        meshes.append(f'<mesh name="{name}" inertia="convex" vertex="{_text(corners.ravel())}"/>')
        # A mesh is moved to its own centre of mass when it is compiled, and so is its geom.
        return f'type="mesh" mesh="{name}" {place}'
    sizes = {"box": part.half, "sphere": part.half[:1], "cylinder": part.half[[0, 2]]}
    return f'type="{part.kind}" size="{_text(sizes[part.kind])}" {place}'


def _volume(part: Part) -> float:
    return float(ConvexHull(part.hull.corners).volume) if part.hull is not None else volume(part)


def _arm(world: World, name: str, meshes: list[str]) -> str:
    """Return an arm with its hand and fingers; its links do not meet each other."""
    mounted = world.robots[name]
    robot, hulls = mounted.robot, mounted.robot.links
    text = _hand(name, robot, _hulls(name, 8, hulls[8], meshes))
    for j in reversed(range(7)):
        inertial = '<inertial pos="0 0 0" mass="1" diaginertia="0.02 0.02 0.02"/>'
        joint = f'<joint name="{name}:{j}" axis="0 0 1" armature="0.5"/>'
        step = robot.steps[j]
        text = (
            f'<body gravcomp="1" pos="{_text(step.at)}" quat="{_quaternion(step)}">{inertial}{joint}'
            f"{_hulls(name, j + 1, hulls[j + 1], meshes)}{text}</body>"
        )
    base = mounted.base
    return f'<body pos="{_text(base.at)}" quat="{_quaternion(base)}">{text}</body>'


def _hand(name: str, robot: Any, hulls: str) -> str:
    """Return the hand of an arm, and its fingers."""
    fingers = ""
    for side, sign in (("left", 1), ("right", -1)):
        boxes = "".join(
            f'<geom name="{name}:{side}:{kind}" type="box" size="{size}" pos="0 {sign * y} {z}" contype="1" '
            f'conaffinity="2" friction="1 0.005 0.0001"/>'
            for kind, (size, (y, z)) in (("pad", PAD), ("shank", SHANK))
        )
        fingers += (
            f'<body name="{name}:{side}" gravcomp="1" pos="0 0 {robot.fingers}">'
            f'<inertial pos="0 0 0" mass="0.1" diaginertia="1e-4 1e-4 1e-4"/>'
            f'<joint name="{name}:{side}" type="slide" axis="0 {sign} 0" range="0 {robot.opening / 2}" damping="5"/>'
            f"{boxes}</body>"
        )
    inertial = '<inertial pos="0 0 0" mass="0.5" diaginertia="0.005 0.005 0.005"/>'
    place = f'pos="{_text(robot.hand.at)}" quat="{_quaternion(robot.hand)}"'
    return f'<body name="{name}:hand" gravcomp="1" {place}>{inertial}{hulls}{fingers}</body>'


def _hulls(name: str, link: int, hulls: Sequence[Any], meshes: list[str]) -> str:
    text = ""
    for number, hull in enumerate(hulls):
        mesh = f"{name}_{link}_{number}"
        meshes.append(f'<mesh name="{mesh}" inertia="convex" vertex="{_text(hull.corners.ravel())}"/>')
        text += f'<geom type="mesh" mesh="{mesh}" contype="1" conaffinity="2"/>'
    return text


def _quaternion(place: Frame) -> str:
    return _text(Rotation.from_matrix(place.turn).as_quat(scalar_first=True))


def _text(values: Any) -> str:
    return " ".join(f"{float(value):.8g}" for value in values)
