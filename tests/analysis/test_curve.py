"""The curve of counts: right numbers, and files that need nothing else."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from prag_asp import OutputError, QueryError, TaskSpace, load_domain
from prag_asp.analysis.plots.curve import KINDS, Curve, Series, counts_by_length, draw_curve, figure, logarithms, shown
from prag_asp.errors import PicturesMissingError

CURVE = counts_by_length(TaskSpace(load_domain("prag"), 6))


def test_its_lines_are_the_counts_of_each_level_and_all_sequences_of_names() -> None:
    lines = {series.name: series.counts for series in CURVE.series}
    assert lines["skeletons"] == (8, 30, 124, 524, 2224, 9448)
    assert lines["tasks"][:3] == (36, 265, 2092) and lines["plans"][2] == 2800
    assert lines["8^n, all sequences of names"] == tuple(8**n for n in range(1, 7))


def test_logarithms_are_taken_of_counts_that_no_float_holds() -> None:
    assert logarithms((10**5000, 1, 0, 1000)) == [5000.0, 0.0, None, 3.0]


def test_the_figure_has_heights_as_powers_of_ten_over_whole_lengths() -> None:
    drawn = figure(CURVE)
    (axes,) = drawn.axes
    assert [line.get_label() for line in axes.lines] == [series.name for series in CURVE.series]
    heights = dict(axes.lines[2].get_xydata().tolist())
    assert heights[3] == pytest.approx(2.0934, abs=1e-4) and list(heights) == [1, 2, 3, 4, 5, 6]
    drawn.canvas.draw()
    labels = [text.get_text() for text in axes.get_yticklabels()]
    assert labels[:3] == ["$10^{0}$", "$10^{1}$", "$10^{2}$"] and len(set(labels)) == len(labels)


def test_lengths_without_plans_have_no_point() -> None:
    nothing = Curve("few", tuple(Series(str(n), (n, 0, 10**400)) for n in range(1, 5)))
    assert [list(line.get_xdata()) for line in figure(nothing).axes[0].lines] == [[1, 3]] * 4


def test_a_page_holds_the_picture_and_every_count_and_needs_nothing_else(tmp_path: Path) -> None:
    page = tmp_path / "curve.html"
    draw_curve(CURVE, str(page))
    text = page.read_text(encoding="utf-8")
    assert not re.search(r"<(?:script|link|img)|@import", text) and text.count("<svg") == 1
    for series in CURVE.series:
        assert all(f"<td>{count:,}<" in text for count in series.counts)
    assert re.search("<th[^>]*>skeletons<", text)


def test_a_name_is_never_taken_for_markup(tmp_path: Path) -> None:
    named = Curve("<b>$x^2$ & co", CURVE.series)
    draw_curve(named, str(tmp_path / "curve.html"))
    text = (tmp_path / "curve.html").read_text(encoding="utf-8")
    assert "<b>" not in text and "<title>&lt;b&gt;$x^2$ &amp; co</title>" in text


def test_a_count_that_is_long_is_told_by_its_digits() -> None:
    assert [shown(count) for count in (0, 1234, 10**30)] == ["0", "1,234", "31 digits"]


def test_a_picture_shows_every_line(tmp_path: Path) -> None:
    draw_curve(CURVE, str(tmp_path / "curve.png"))
    with Image.open(tmp_path / "curve.png") as image:
        assert image.size == (1600, 1100)
        colors = image.convert("RGB").getcolors(1 << 24)
    for wanted in ((0, 114, 178), (213, 94, 0), (0, 158, 115), (119, 119, 119)):
        near = (count for count, color in colors if max(map(abs, np.subtract(color, wanted))) < 40)
        assert sum(near) > 1000


@pytest.mark.parametrize(("kind", "beginning"), [("svg", b"<?xml"), ("pdf", b"%PDF"), ("png", b"\x89PNG")])
def test_the_same_curve_is_the_same_bytes(tmp_path: Path, kind: str, beginning: bytes) -> None:
    for name in ("one", "two"):
        draw_curve(CURVE, str(tmp_path / f"{name}.{kind}"))
    content = (tmp_path / f"one.{kind}").read_bytes()
    assert content.startswith(beginning) and content == (tmp_path / f"two.{kind}").read_bytes()
    assert not re.search(rb"<dc:date>|/CreationDate|tIME", content)


def test_a_file_that_is_no_picture_or_cannot_be_written_is_named(tmp_path: Path) -> None:
    with pytest.raises(QueryError, match=r"curve.txt: .*\.html, \.png, \.svg or \.pdf"):
        draw_curve(CURVE, "curve.txt")
    for kind in KINDS:
        with pytest.raises(OutputError, match="cannot be written"):
            draw_curve(CURVE, str(tmp_path / "missing" / f"curve{kind}"))
    with pytest.raises(QueryError, match="larger length"):
        counts_by_length(TaskSpace(load_domain("prag"), 0))


def test_without_matplotlib_one_line_says_how_to_install_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("prag_asp.analysis.plots.curve.find_spec", lambda name: None)
    with pytest.raises(PicturesMissingError, match=r"pip install 'prag_asp\[pictures\]'"):
        draw_curve(CURVE, "curve.png")
