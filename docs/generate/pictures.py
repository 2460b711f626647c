"""Generate the pictures of the documentation: tasks, each sampled and validated from one seed, and a curve.

Run:  .venv/bin/python docs/generate/pictures.py [NAME...]        (requires the extras `pictures` and `formats`)
"""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import islice
from pathlib import Path
from tempfile import TemporaryDirectory
from textwrap import wrap

import av
import numpy as np
from PIL import Image, ImageDraw, ImageFont
from pyarrow.parquet import read_table

from prag_asp import TaskSpace, load_domain, load_scene
from prag_asp.dataset import feasible, instruction_writer_of
from prag_asp.physics import CameraImage, Demonstration, Staging, animate, demonstrate, film_strip, validate_task
from prag_asp.scene.colours import more_colours

ROOT = Path(__file__).parent.parent.parent
PICTURES = ROOT / "docs" / "pictures"
COLOURS = 256
"""The number of colours of a picture, which halves the size of its file."""

MARGIN = 14


@dataclass(frozen=True)
class Strip:
    """A film strip of the first feasible task sampled from a domain with a seed, and the layout of its frames."""

    domain: str
    length: int
    seed: int
    weights: Mapping[str, int] = field(default_factory=dict)
    where: tuple[str, ...] = ()
    frame: tuple[int, int] = (264, 244)
    columns: int = 3


STRIPS = {
    "five_subgoals": Strip("tabletop", 5, 34526, {"stack": 8, "insert": 8}),
    "strip": Strip("tabletop", 3, 7),
    "prag": Strip("prag", 5, 3, where=("begins approach", "uses can_1")),
    "tabletop": Strip("tabletop", 5, 11, {"stack": 8, "insert": 8}),
    "kitchen": Strip("kitchen", 7, 4, where=("matches open approach grasp move drop withdraw close",), columns=4),
    "two_arms": Strip("two_arms", 7, 1, where=("begins pick", "has give"), columns=4),
    "household": Strip("household", 5, 1, where=("has wipe(panda,sponge_1,mug_1)", "has put(panda,mug_1,rack_1)")),
    "dishes": Strip(
        "examples/dishes", 6, 2, where=("matches pick put wash charge pick put", "ends inside(cup_1,rack_1)"), columns=4
    ),
    "desk": Strip("examples/desk", 4, 4, where=("starts on_top(cup_1,desk_1), on_top(cup_2,desk_1)",)),
    "warehouse": Strip(
        "examples/warehouse", 4, 5, where=("avoids crate", "avoids rod", "uses shelf_1", "avoids shelf_2")
    ),
    "own_predicates": Strip("examples/own_predicates", 4, 6, where=("has tuck", "has aim")),
}


def draw(strip: Strip) -> Image.Image:
    """Return a film strip with a reduced palette."""
    path = ROOT / strip.domain
    domain = load_domain(path if path.is_dir() else strip.domain, trust=True)
    scene = load_scene(domain)
    space = TaskSpace(domain, strip.length).where(*strip.where)
    tasks = space.stream(seed=strip.seed, weights=strip.weights)
    checked = ((task, validate_task(task, scene, seed=strip.seed).witness) for task in tasks)
    task, witness = next((task, witness) for task, witness in checked if witness is not None)
    captions = instruction_writer_of(domain).captions(task)
    return reduced(film_strip(task, witness, scene, size=strip.frame, columns=strip.columns, captions=captions))


FILMED = Staging(("front", "wrist"), (160, 160), rate=5)
"""The cameras for the page on cameras, which shows the first task of length 2 of `tabletop` with seed 8."""

GAP = 6


def draw_films() -> Image.Image:
    """Return four frames of a demonstration from two cameras: colour, depth and segmentation."""
    space = TaskSpace(load_domain("tabletop"), 2)
    with TemporaryDirectory() as folder:
        next(feasible(space, seed=8, demonstrate=folder, staging=FILMED))
        footage = Demonstration.load(Path(folder) / "000001.npz").footage
    count = len(footage.frames)
    moments = [round(share * (count - 1)) for share in (0.1, 0.4, 0.65, 1.0)]
    width, height = FILMED.size
    page = Image.new("RGB", (4 * (width + GAP) - GAP, 6 * (height + GAP) - GAP), "white")
    for row, name in zip((0, 3), FILMED.cameras, strict=True):
        pictures = [image for k, image in enumerate(footage.videos[name].images()) if k in moments]
        for column, picture in enumerate(pictures):
            for k, pixels in enumerate((picture.rgb, in_grey(picture), in_palette(picture, len(footage.legend)))):
                page.paste(Image.fromarray(pixels), (column * (width + GAP), (row + k) * (height + GAP)))
    return reduced(page)


SHOWN, SHOWN_SEED = ("has wipe(panda,sponge_1,mug_1)", "has put(panda,mug_1,rack_1)"), 4
"""The conditions on the task of the animation, and the seed with which its witness can be executed."""


def write_demonstration(path: Path) -> None:
    """Write the animation of the README: 640 pixels wide, 5 s long."""
    domain = load_domain("household")
    scene = load_scene(domain)
    (task,) = TaskSpace(domain, 5).where(*SHOWN).sample(1, seed=1)
    witness = validate_task(task, scene, seed=SHOWN_SEED).witness
    assert witness is not None
    headings = [heading.partition(". ")[2] for heading, _ in instruction_writer_of(domain).captions(task)[1:]]
    options = {"size": (612, 400), "speed": 3.0, "rate": 15, "fine": True, "headings": headings}
    animate(task, demonstrate(task, witness, scene), scene, path, **options)


FIRST = "tabletop --length 2 --tasks 4 --seed 0 --split train=0.75,test=0.25 --demonstrate --cameras front,wrist"
"""The arguments of the page on the first dataset."""

ENLARGED, LINE = 2, 40


def draw_first() -> Image.Image:
    """Return four frames of the first episode of a LeRobotDataset, from its videos, with their instructions."""
    with TemporaryDirectory() as temporary:
        folder = Path(temporary)
        quiet = {"stdout": subprocess.DEVNULL, "cwd": folder}
        subprocess.run(["prag-asp", "generate", *FIRST.split(), "-o", "first"], check=True, **quiet)
        subprocess.run(["prag-asp", "export", "lerobot", "first", "-o", "lerobot"], check=True, **quiet)
        episode = read_table(folder / "lerobot/data/chunk-000/file-000.parquet").to_pylist()
        subtasks = read_table(folder / "lerobot/meta/subtasks.parquet").to_pylist()
        (instruction,) = (each["task"] for each in read_table(folder / "lerobot/meta/tasks.parquet").to_pylist()[:1])
        rows = [row for row in episode if row["episode_index"] == 0]
        moments = [rows[round(share * (len(rows) - 1))] for share in (0.1, 0.4, 0.65, 1.0)]
        films = {}
        for name in ("front", "wrist"):
            with av.open(str(folder / f"lerobot/videos/observation.images.{name}/chunk-000/file-000.mp4")) as video:
                films[name] = [frame.to_image() for frame in islice(video.decode(video=0), len(rows))]
    side = ENLARGED * films["front"][0].width
    page = Image.new("RGB", (4 * (side + GAP) - GAP, 2 * (side + GAP) + 2 * LINE), "white")
    pen, font = ImageDraw.Draw(page), ImageFont.load_default(size=15)
    pen.text((MARGIN, LINE / 2), instruction, fill="black", font=font, anchor="lm")
    for column, row in enumerate(moments):
        left = column * (side + GAP)
        for line, pictures in enumerate(films.values()):
            enlarged = pictures[row["frame_index"]].resize((side, side), Image.Resampling.LANCZOS)
            page.paste(enlarged, (left, LINE + line * (side + GAP)))
        subtask = "\n".join(wrap(subtasks[row["subtask_index"]]["subtask"], 32))
        pen.multiline_text((left + 4, page.height - LINE + 2), subtask, fill="black", font=font)
    return reduced(page)


def in_grey(picture: CameraImage) -> np.ndarray:
    """Return the depth of a picture in grey: near is dark, the background is white."""
    depth = picture.depth.astype(float)
    visible = depth > 0
    low, high = depth[visible].min(), depth[visible].max()
    grey = np.where(visible, 30 + 190 * (depth - low) / (high - low), 255)
    return np.repeat(grey.astype(np.uint8)[..., None], 3, axis=-1)


def in_palette(picture: CameraImage, count: int) -> np.ndarray:
    """Return the segmentation of a picture with one colour for each entity."""
    colours = ["#ffffff", "#d9cfc0", *more_colours(("#ffffff", "#d9cfc0"), count)]
    palette = np.array([[int(colour[i : i + 2], 16) for i in (1, 3, 5)] for colour in colours], dtype=np.uint8)
    return palette[picture.segmentation]


def reduced(picture: Image.Image) -> Image.Image:
    """Return a picture with a reduced palette."""
    return picture.convert("RGB").quantize(COLOURS, kmeans=2, dither=Image.Dither.NONE)


def main(names: list[str]) -> None:
    """Generate the named pictures, by default all."""
    for name in names or [*STRIPS, "curve", "cameras", "first_dataset", "demonstration"]:
        target = PICTURES / f"{name}.png"
        if name == "curve":
            curve = ["stats", "prag", "--length", "15", "--by", "skeleton", "--plot", str(target)]
            subprocess.run(["prag-asp", *curve], check=True, stdout=subprocess.DEVNULL)
            with Image.open(target) as drawn:
                few = reduced(drawn)
            few.save(target, optimize=True)
        elif name == "demonstration":
            write_demonstration(target.with_suffix(".webp"))
        elif name == "cameras":
            draw_films().save(target, optimize=True)
        elif name == "first_dataset":
            draw_first().save(target, optimize=True)
        else:
            draw(STRIPS[name]).save(target, optimize=True)


if __name__ == "__main__":
    main(sys.argv[1:])
