"""Draw the picture of the README: five subgoals of one task, drawn and validated from one seed.

Run:  .venv/bin/python examples/film_strip.py [FILE.png]        (needs the extra `pictures` or `test`)
"""

from __future__ import annotations

import sys
from pathlib import Path

from PIL import Image, ImageOps

from prag_asp import TaskSpace, load_domain, load_scene
from prag_asp.dataset.language import sentence
from prag_asp.physics import film_strip, validate_task

SEED = 34526
PICTURE = Path(__file__).parent / "pictures" / "five_subgoals.png"
FRAME = (260, 250)
MARGIN = 14


def draw() -> Image.Image:
    """Return the picture."""
    domain = load_domain("tabletop")
    scene = load_scene(domain)
    task = TaskSpace(domain, 5).sample(1, seed=SEED, weights={"stack": 8, "insert": 8})[0]
    verdict = validate_task(task, scene, seed=SEED)
    if verdict.witness is None:
        raise SystemExit(f"{task}: {verdict.status}: {verdict.reason}; choose another seed")
    headings = [sentence(action, domain.settings.language) for action in task.actions]
    strip = film_strip(task, verdict.witness, scene, size=FRAME, headings=headings)
    subgoals = strip.crop((strip.width // 6, 0, strip.width, strip.height))  # the first frame is the initial state
    bottom = ImageOps.invert(subgoals.convert("L")).getbbox()[3]
    return subgoals.crop((0, 0, subgoals.width, bottom + MARGIN))


if __name__ == "__main__":
    target = Path(sys.argv[1]) if len(sys.argv) > 1 else PICTURE
    target.parent.mkdir(parents=True, exist_ok=True)
    draw().save(target, optimize=True)
