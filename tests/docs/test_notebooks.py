"""The notebooks show what their cells print and draw."""

from __future__ import annotations

import base64
import io
import json
from pathlib import Path

import pytest
from PIL import Image, ImageChops, ImageStat

from tests.docs.notebooks import NOTEBOOKS, Output, outputs


def picture(output: Output) -> Image.Image | None:
    data = output.get("data", {}).get("image/png")
    return None if data is None else Image.open(io.BytesIO(base64.b64decode(data))).convert("RGB")


def alike(kept: Output, shown: Output) -> bool:
    """Tell whether two outputs are the same; a newer Pillow may draw letters a little differently."""
    before, after = picture(kept), picture(shown)
    if before is None or after is None:
        return {**kept, "execution_count": None} == {**shown, "execution_count": None}
    return before.size == after.size and max(ImageStat.Stat(ImageChops.difference(before, after)).mean) < 1.0


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_shows_what_its_cells_do(path: Path) -> None:
    notebook = json.loads(path.read_text(encoding="utf-8"))
    kept = [cell["outputs"] for cell in notebook["cells"] if cell["cell_type"] == "code"]
    for before, after in zip(kept, outputs(notebook), strict=True):
        assert len(before) == len(after)
        assert all(map(alike, before, after)), f"write them anew: python -m tests.docs.notebooks\n{after}"


def test_there_are_two_and_they_are_small() -> None:
    assert len(NOTEBOOKS) == 2
    assert all(path.stat().st_size < 250_000 for path in NOTEBOOKS)
