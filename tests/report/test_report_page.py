"""The page of a report needs nothing but itself, escapes every text, and has the same bytes for the same input."""

from __future__ import annotations

import json
import re
import shutil
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner

from prag_asp import OutputError, TaskSpace, load_domain
from prag_asp.cli import cli
from prag_asp.dataset import generate
from prag_asp.errors import PicturesMissingError
from prag_asp.report import ReportedTask, ReportSource, read_source, report_plots, report_tables, write_report
from prag_asp.report import report_page as pages
from prag_asp.report.pdf_figures import COLUMN, pdf_figure
from prag_asp.report.report_page import report_page, task_data
from prag_asp.report.strips import film_strips

POINTS_PER_INCH = 72


@pytest.fixture(scope="module")
def written(folder: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("out")
    write_report(folder, output=out / "report.html", tables=out / "tables", sample=20)
    return out


def values_of(page: str) -> dict[str, object]:
    found = re.search(r'<script type="application/json" id="report-data">(.*?)</script>', page, re.DOTALL)
    assert found is not None
    values = json.loads(found[1])
    assert isinstance(values, dict)
    return values


def test_a_page_refers_to_nothing_outside_and_has_all_tables(written: Path) -> None:
    page = (written / "report.html").read_text(encoding="utf-8")
    assert not re.search(r"<link|<iframe|<script src|@import|url\(|https?:", page)
    names = {path.stem for path in (written / "tables").glob("*.csv")}
    assert {"counts", "coverage", "frequencies", "complexity", "distances", "map", "tasks"} <= names
    assert {table["name"] for table in values_of(page)["tables"]} == names - {"tasks"}  # type: ignore[attr-defined]
    assert all(f'data-csv="{name}"' in page for name in names)


def test_the_same_input_gives_the_same_bytes(written: Path, folder: Path, tmp_path: Path) -> None:
    write_report(folder, output=tmp_path / "report.html", tables=tmp_path / "tables", sample=20)
    ours = sorted(path.relative_to(written) for path in written.rglob("*") if path.is_file())
    assert ours == sorted(path.relative_to(tmp_path) for path in tmp_path.rglob("*") if path.is_file())
    assert all((written / name).read_bytes() == (tmp_path / name).read_bytes() for name in ours)


def test_figures_are_vectors_as_wide_as_a_column_and_repeatable(source: ReportSource) -> None:
    plots = {plot.name: plot for plot in report_plots(report_tables(source, sample=10))}
    for name in ("counts", "frequencies_names", "map"):
        content = pdf_figure(plots[name])
        box = re.search(rb"/MediaBox \[ ?0 0 ([\d.]+) ([\d.]+) ?\]", content)
        assert box is not None and float(box[1]) == pytest.approx(COLUMN * POINTS_PER_INCH, abs=1)
        assert b"CreationDate" not in content and not re.search(rb"/Subtype /Image\b", content)
    assert pdf_figure(plots["map"]) == content


def test_hostile_texts_stay_texts() -> None:
    evil = "</script><script>alert(1)</script><img src=x onerror=alert(1)>"
    tasks = (ReportedTask(0, evil, ("go",), (), {}, evil), ReportedTask(1, "b", ("go",), (), {}, ""))
    source = ReportSource(evil, tasks)
    tables = report_tables(source)
    page = report_page(source, tables, report_plots(tables))
    assert "<script>alert" not in page and "<img src=x" not in page
    assert values_of(page)["title"] == evil


def test_counts_beyond_the_floats_of_a_browser_are_texts(written: Path) -> None:
    tables = values_of((written / "report.html").read_text(encoding="utf-8"))["tables"]
    (counts,) = [table for table in tables if table["name"] == "counts"]  # type: ignore[attr-defined]
    column = [row[counts["columns"].index("8^n")] for row in counts["rows"]]
    assert column[-1] == 8**15 and all(isinstance(value, str) == (int(value) >= 2**53) for value in column)


def test_the_tasks_of_a_page_read_back(source: ReportSource) -> None:
    data = task_data(source, source.tasks)
    for place, task in enumerate(source.tasks):
        assert tuple(data["letters"][letter] for letter in data["plans"][place]) == task.plan
        assert tuple(data["entities"][entity] for entity in data["own"][place]) == task.entities
    assert {name.partition("(")[0] for name in data["classes"]} == set(data["names"])


def test_of_many_tasks_a_page_has_a_sample(source: ReportSource, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pages, "MOST_TASKS", 7)
    values = values_of(report_page(source, (), ()))
    assert len(values["tasks"]["number"]) == 7 and values["total"] == 40  # type: ignore[index]


def test_the_command_writes_what_the_function_writes(written: Path, folder: Path, tmp_path: Path) -> None:
    page = tmp_path / "report.html"
    page.write_text("old")
    done = CliRunner().invoke(cli, ["report", str(folder), "-o", str(page), "--sample", "20"], standalone_mode=False)
    assert done.exit_code == 0 and done.stdout.splitlines()[-1] == str(page)
    assert page.read_bytes() == (written / "report.html").read_bytes()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((), "needs -o FILE.html, --tables DIR or --figures DIR"),
        (("-o", "report.txt"), "a file that ends in .html"),
        (("-o", "missing/report.html"), "missing/report.html"),
    ],
)
def test_wrong_outputs_are_one_line(folder: Path, arguments: tuple[str, ...], message: str) -> None:
    done = CliRunner().invoke(cli, ["report", str(folder), *arguments])
    assert message in str(done.exception) + done.output


def test_a_dataset_without_its_domain_and_no_output_are_named(folder: Path, tmp_path: Path) -> None:
    broken = Path(shutil.copytree(folder, tmp_path / "broken"))
    shutil.rmtree(broken / "domain")
    with pytest.raises(Exception, match="domain") as caught:
        write_report(broken, output=tmp_path / "report.html")
    assert len(str(caught.value).splitlines()) == 1 and not (tmp_path / "report.html").exists()
    with pytest.raises(OutputError, match="needs an output"):
        write_report(folder)


def test_without_matplotlib_figures_say_how_to_install_it(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("prag_asp.report.pdf_figures.find_spec", lambda name: None)
    with pytest.raises(PicturesMissingError, match=r"pip install 'prag_asp\[pictures\]'"):
        write_report(folder, figures="figures")


def test_film_strips_name_objects_as_the_instructions_do(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("pybullet")
    image = pytest.importorskip("PIL.Image")
    generate(TaskSpace(load_domain("tabletop"), 1), tmp_path / "data", tasks=1, seed=1)
    drawn: list[list[tuple[str, str]]] = []

    def film_strip(*_: Any, captions: list[tuple[str, str]], **__: Any) -> Any:
        drawn.append(captions)
        return image.new("RGB", (8, 8))

    monkeypatch.setattr("prag_asp.physics.film_strip", film_strip)
    source = read_source(tmp_path / "data")
    assert list(film_strips(source)) == [0]
    ((_, (heading, text)),) = drawn
    assert source.dataset is not None
    (subgoal,) = source.dataset.entry(0).subgoals
    assert heading == f"1. {subgoal}"
    assert not re.search(r"[a-z] [0-9]", text)
