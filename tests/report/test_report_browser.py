"""In a real browser: figures are drawn, filters count what Python counts, and nothing is reported on the console."""

from __future__ import annotations

import csv
from collections.abc import Iterator
from pathlib import Path
from shutil import which
from typing import Any

import pytest

from prag_asp.report import ReportSource, write_report

playwright = pytest.importorskip("playwright.sync_api")
CHROMIUM = which("chromium")
pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="needs chromium")


@pytest.fixture(scope="module")
def page(folder: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Any]:
    file = tmp_path_factory.mktemp("page") / "report.html"
    write_report(folder, output=file, sample=20)
    with playwright.sync_playwright() as started:
        browser = started.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        size = {"width": 360, "height": 740}
        opened = browser.new_context(offline=True, accept_downloads=True, viewport=size, bypass_csp=True).new_page()
        opened.faults = []
        opened.on("console", lambda message: opened.faults.append(message.text) if message.type == "error" else None)
        opened.on("pageerror", lambda error: opened.faults.append(str(error)))
        opened.goto(file.as_uri())
        opened.wait_for_function("document.documentElement.dataset.ready === 'yes'")
        yield opened
        assert opened.faults == []
        browser.close()


def test_every_figure_is_drawn_and_no_table_widens_a_phones_page(page: Any) -> None:
    figures = page.locator("figure[data-plot]").count()
    assert figures > 8 and page.locator("figure[data-plot] .plot > svg").count() == figures
    assert page.evaluate("document.documentElement.scrollWidth") == 360


RECOUNT = """async () => {
  const text = `${document.querySelector("script[type=module]").textContent}; export { data, filteredPlots };`;
  const { data, filteredPlots } = await import(URL.createObjectURL(new Blob([text], { type: "text/javascript" })));
  const places = data.tasks.number.map((_, at) => at);
  const heights = (plot) => plot.series.flatMap((each) => each.heights.map((value) => value.toFixed(6))).join();
  return data.plots
    .filter((plot) => plot.filtered && plot.name !== "map")
    .map((plot) => [plot.name, heights(plot) === heights(filteredPlots[plot.name](plot, places, {}))]);
}"""


def test_without_filters_recounted_figures_equal_those_of_python(page: Any) -> None:
    names = ["frequencies_names", "frequencies_classes", "frequencies_actions", "lengths", "entities"]
    assert page.evaluate(RECOUNT) == [[name, True] for name in names]


def test_filters_count_what_python_counts_and_reset(page: Any, source: ReportSource) -> None:
    wanted = sum(len(task.plan) == 3 and "apple_1" in task.entities for task in source.tasks)
    page.select_option("select[name=length]", "3")
    page.select_option("select[name=entity]", "apple_1")
    assert page.inner_text("#shown") == f"{wanted} of 40 tasks"
    assert page.evaluate("location.hash") == "#length=3&entity=apple_1"
    assert page.locator("[data-list=tasks] tbody tr").count() == wanted
    assert page.locator("#figure-map [data-task]").count() <= wanted
    page.click("button[type=reset]")
    page.wait_for_function("document.getElementById('shown').textContent === '40 of 40 tasks'")


def test_a_link_that_is_opened_in_the_same_window_sets_the_filters(page: Any, source: ReportSource) -> None:
    for link, length in (("length=3", "3"), ("length=2&entity=nothing", "2"), ("length=99", "")):
        page.evaluate(f"location.hash = {link!r}")
        wanted = sum(length in ("", str(len(task.plan))) for task in source.tasks)
        playwright.expect(page.locator("#shown")).to_have_text(f"{wanted} of 40 tasks")
        assert page.input_value("select[name=length]") == length
    page.select_option("select[name=length]", "3")
    page.evaluate("location.hash = 'map'")
    page.wait_for_timeout(100)
    assert page.input_value("select[name=length]") == "3"
    page.click("button[type=reset]")
    page.wait_for_function("document.getElementById('shown').textContent === '40 of 40 tasks'")


def test_a_table_is_saved_as_csv(page: Any, tmp_path: Path, source: ReportSource) -> None:
    with page.expect_download() as saved:
        page.click("button[data-csv=tasks]")
    saved.value.save_as(tmp_path / "tasks.csv")
    with (tmp_path / "tasks.csv").open(newline="", encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    assert [row["plan"] for row in rows] == [" ".join(task.plan) for task in source.tasks]
