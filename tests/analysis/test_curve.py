"""The curve of counts: right numbers, and files that need nothing else."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from prag_asp import OutputError, QueryError, TaskSpace, load_domain
from prag_asp.analysis.chart import dashes, nice_step
from prag_asp.analysis.curve import counts_by_length, draw_curve, figure, logarithms

CURVE = counts_by_length(TaskSpace(load_domain("prag"), 6))


def test_its_lines_are_the_counts_of_each_level_and_all_sequences_of_names() -> None:
    lines = {series.name: series.counts for series in CURVE.series}
    assert lines["skeletons"] == (8, 30, 124, 524, 2224, 9448)
    assert lines["tasks"][:3] == (36, 265, 2092) and lines["plans"][2] == 2800
    assert lines["8^n, all sequences of names"] == tuple(8**n for n in range(1, 7))


def test_logarithms_are_taken_of_counts_that_no_float_holds() -> None:
    assert logarithms((10**5000, 1, 0, 1000)) == [5000.0, 0.0, None, 3.0]


def test_the_figure_shows_heights_as_powers_of_ten_with_exact_counts() -> None:
    plans, _, skeletons, _ = figure(CURVE).data
    assert skeletons.y[2] == pytest.approx(2.0934, abs=1e-4) and skeletons.text[2] == "124"
    assert plans.text[-1] == f"{CURVE.series[0].counts[-1]:,}"


def test_a_page_holds_all_that_it_needs(tmp_path: Path) -> None:
    page = tmp_path / "curve.html"
    draw_curve(CURVE, str(page))
    text = page.read_text(encoding="utf-8")
    assert not re.search(r"<(?:script|link)[^>]+(?:src|href)=", text)
    assert "Plotly.newPlot" in text and "skeletons" in text


def test_a_picture_shows_every_line(tmp_path: Path) -> None:
    draw_curve(CURVE, str(tmp_path / "curve.png"))
    with Image.open(tmp_path / "curve.png") as image:
        assert image.size == (1600, 1100)
        colors = image.getcolors(1 << 24)
    for wanted in ((0, 114, 178), (213, 94, 0), (0, 158, 115), (119, 119, 119)):
        near = (count for count, color in colors if max(map(abs, np.subtract(color, wanted))) < 40)
        assert sum(near) > 1000


def test_a_file_that_is_no_picture_or_cannot_be_written_is_named(tmp_path: Path) -> None:
    with pytest.raises(QueryError, match=r"curve.pdf: .*\.html or \.png"):
        draw_curve(CURVE, "curve.pdf")
    for kind in ("html", "png"):
        with pytest.raises(OutputError, match="cannot be written"):
            draw_curve(CURVE, str(tmp_path / "missing" / f"curve.{kind}"))
    with pytest.raises(QueryError, match="larger length"):
        counts_by_length(TaskSpace(load_domain("prag"), 0))


@pytest.mark.parametrize(("largest", "step"), [(1, 1), (8, 1), (9, 2), (15, 2), (41, 10), (700, 100), (905, 200)])
def test_steps_of_axes_are_round(largest: int, step: int) -> None:
    assert nice_step(largest) == step


def test_dashes_go_on_around_corners() -> None:
    assert dashes([(0.0, 0.0), (3.0, 0.0), (3.0, 7.0)], 4.0) == [
        [(0.0, 0.0), (3.0, 0.0), (3.0, 1.0)],
        [(3.0, 5.0), (3.0, 7.0)],
    ]
