"""The pages in Chromium: every control, wrong conditions, two windows, and a server that stops."""

from __future__ import annotations

import shutil
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from threading import Thread
from typing import Any

import pytest

from prag_asp import TaskSpace, load_domain
from prag_asp.explore.explored_domain import ExploredDomain
from prag_asp.explore.page_server import PageServer, View
from prag_asp.explore.programs.program_pages import MODELS_PAGE, program_views
from prag_asp.explore.space_pages import PAGE, space_views
from prag_asp.explore.turns import Turns
from prag_asp.space.limits import Limits
from tests.explore.test_models_views import explored

playwright = pytest.importorskip("playwright.sync_api")
CHROMIUM = shutil.which("chromium")

pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="needs Chromium")

PATIENCE = 60_000
"""Milliseconds to wait for a change of the page."""


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with playwright.sync_playwright() as started:
        browser = started.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        yield browser
        browser.close()


@contextmanager
def serving(views: Mapping[str, View], turns: Turns) -> Iterator[PageServer]:
    with PageServer(PAGE, views, turns) as server:
        thread = Thread(target=server.serve_forever, args=(0.01,))
        thread.start()
        try:
            yield server
        finally:
            server.shutdown()
            thread.join()


@pytest.fixture
def server() -> Iterator[PageServer]:
    turns = Turns()
    limits = Limits(stop=turns.stop)
    explored = ExploredDomain(load_domain("kitchen"), ("kitchen",), "load_domain('kitchen')", limits=limits)
    with serving(space_views(explored), turns) as server:
        yield server


@pytest.fixture
def messages() -> list[str]:
    return []


def opened(browser: Any, link: str, messages: list[str]) -> Any:
    page = browser.new_page(viewport={"width": 1440, "height": 900})
    page.set_default_timeout(PATIENCE)
    page.on("console", lambda message: messages.append(message.text))
    page.on("pageerror", lambda error: messages.append(str(error)))
    page.goto(link)
    page.wait_for_selector("#facets li")
    return page


def test_every_control_of_the_page_works(  # noqa: PLR0915
    browser: Any, server: PageServer, messages: list[str]
) -> None:
    space = TaskSpace(load_domain("kitchen"), 7)
    page = opened(browser, f"{server.link}?length=7", messages)
    playwright.expect.set_options(timeout=PATIENCE)
    number, plan = page.locator("#number"), page.locator("#plan > li")

    def shows(count: int, steps: int = 0) -> None:
        playwright.expect(plan).to_have_count(steps + 1)
        playwright.expect(number).to_contain_text(f"{count:,} ")

    shows(space.count())
    first = str(space[0].actions[0])
    page.focus("#actions button >> nth=0")
    page.keyboard.press("ArrowDown")
    page.keyboard.press("ArrowUp")
    page.keyboard.press("Enter")
    shows(space.count(prefix=[first]), 1)
    page.keyboard.press("Backspace")
    shows(space.count())
    page.go_back()
    shows(space.count(prefix=[first]), 1)
    page.click("#undo")
    page.fill("#condition", "usess cup_1")
    playwright.expect(page.locator("#typed")).to_contain_text("did you mean uses")
    page.fill("#condition", "uses cup_1")
    playwright.expect(page.locator("#typed")).to_have_text(f"leaves {space.where('uses cup_1').count():,}")
    page.click("text=Add")
    shows(space.where("uses cup_1").count())
    page.fill("#condition", "nontrivial")
    page.click("#beside")
    both = space.where("uses cup_1", "nontrivial").count("plan")
    playwright.expect(page.locator("#comparison")).to_contain_text(f"{both:,}")
    page.click("text=End the comparison")
    playwright.expect(page.locator("#comparison")).to_be_hidden()
    page.click("[aria-label='Remove uses cup_1']")
    shows(space.count())
    page.select_option("#keyword", "has at least")
    page.select_option("#name", "grasp")
    playwright.expect(page.locator("#condition")).to_have_value("has at least 1 grasp")
    page.fill("#rank", "5")
    page.click("text=Go to rank")
    shows(1, 7)
    assert page.locator("#plan code").all_inner_texts() == list(map(str, space[5].actions))
    playwright.expect(page.locator("#tree")).to_contain_text("reading")
    page.click("#validate")
    playwright.expect(page.locator("#verdict")).to_contain_text("; seed 0")
    page.click("text=Start over")
    playwright.expect(page.locator("#physics")).to_be_hidden()
    page.uncheck("#weighted")
    page.click("text=Sample from what is left")
    shows(1, 7)
    page.click("text=Back to here >> nth=0")
    page.check("#apart")
    shows(space.count("plan"))
    page.uncheck("#apart")
    page.click("#facets button >> nth=1")
    playwright.expect(page.locator("#conditions li")).to_have_count(1)
    page.click("#conditions button")
    page.fill("#length", "2")
    page.press("#length", "Enter")
    shows(space.at(2).count())
    page.goto(f"{server.link}?length=7&where=has+at+least+9+grasp")
    playwright.expect(page.locator("#empty")).to_contain_text("exclude every task")
    page.goto(f"{server.link}?length=7&do=fly(panda)")
    playwright.expect(page.locator("#problem")).to_contain_text("no action 'fly(panda)'")
    playwright.expect(page.locator("#title")).to_have_text("kitchen")
    theme = page.get_attribute("html", "data-theme")
    page.click("#theme")
    assert page.get_attribute("html", "data-theme") != theme
    assert messages == []


def test_two_windows_do_not_disturb_each_other_and_a_server_that_does_not_answer_is_told(
    browser: Any, server: PageServer, messages: list[str]
) -> None:
    one, other = (opened(browser, f"{server.link}?length={length}", messages) for length in (5, 7))
    space = TaskSpace(load_domain("kitchen"), 5)
    for page in (one, other):
        page.click("#actions button >> nth=0")
    for page, length in ((one, 5), (other, 7)):
        first = str(space.at(length)[0].actions[0])
        left = f"{space.at(length).count(prefix=[first]):,} "
        playwright.expect(page.locator("#plan > li")).to_have_count(2, timeout=PATIENCE)
        playwright.expect(page.locator("#number")).to_contain_text(left, timeout=PATIENCE)
    assert messages == []
    other.context.set_offline(True)
    other.click("#undo")
    playwright.expect(other.locator("#problem")).to_contain_text("does not answer", timeout=PATIENCE)


def test_every_control_of_the_page_of_a_program_works(browser: Any, messages: list[str]) -> None:
    with serving(program_views(explored()), Turns()) as server:
        page = opened(browser, f"{server.link}{MODELS_PAGE}", messages)
        number, facets = page.locator("#number"), page.locator("#facets li")

        playwright.expect.set_options(timeout=PATIENCE)

        def shows(count: str, listed: int) -> None:
            playwright.expect(number).to_have_text(count)
            playwright.expect(facets).to_have_count(listed)

        shows("16 answer sets", 7)
        page.click("#facets button:has-text('main(beef)')")
        shows("6 answer sets of 16 (37.5 %)", 2)
        playwright.expect(page.locator("#impossible")).to_contain_text("main(fish)")
        page.go_back()
        shows("16 answer sets", 7)
        page.fill("#find", "main")
        shows("16 answer sets", 3)
        page.fill("#find", "")
        page.select_option("#sort", "share")
        page.click("#facets li:has-text('starter(soup)') >> button:has-text('not')")
        shows("12 answer sets of 16 (75.0 %)", 6)
        page.fill("#seed", "4")
        page.click("text=Sample from what is left")
        playwright.expect(page.locator("#sample")).to_contain_text("main(")
        page.click("#undo")
        shows("16 answer sets", 7)
        page.goto(f"{server.link}{MODELS_PAGE}?where=starter(soup)&where=main(pasta)")
        playwright.expect(number).to_have_text("0 answer sets of 16")
        playwright.expect(page.locator("#empty")).to_contain_text(":- starter(soup), main(pasta).")
        page.goto(f"{server.link}{MODELS_PAGE}?where=main(beef")
        playwright.expect(page.locator("#problem")).to_contain_text("is not a literal")
        page.click("#theme")
    assert messages == []


def test_a_number_of_many_digits_is_short_in_a_facet_and_whole_in_the_heading(
    browser: Any, messages: list[str]
) -> None:
    with serving(program_views(explored("{ a(1..200) }.")), Turns()) as server:
        page = opened(browser, f"{server.link}{MODELS_PAGE}", messages)
        playwright.expect(page.locator("#number")).to_have_text(f"{2**200:,} answer sets")
        digits = str(2**199)
        short = f"about {digits[0]}.{digits[1:4]} x 10^{len(digits) - 1} ·"
        playwright.expect(page.locator("#facets li >> nth=0")).to_contain_text(short)
    assert messages == []


def test_the_filter_of_actions_hides_the_others_also_from_the_arrow_keys(browser: Any, messages: list[str]) -> None:
    turns = Turns()
    explored = ExploredDomain(load_domain("tabletop"), ("tabletop",), "", limits=Limits(stop=turns.stop))
    with serving(space_views(explored), turns) as server:
        page = opened(browser, f"{server.link}?length=1", messages)
        shown = page.locator("#actions li:visible code, #actions li:visible .term")
        assert shown.count() > 2
        page.fill("#filter", "can_1")
        texts = shown.all_inner_texts()
        assert len(texts) >= 2 and all("can_1" in text for text in texts)
        page.focus("#actions li:visible button >> nth=0")
        for text in texts[1:]:
            page.keyboard.press("ArrowDown")
            assert page.evaluate("document.activeElement.textContent").startswith(text)
        page.fill("#filter", "no such action")
        assert shown.count() == 0
    assert messages == []


def test_a_phones_page_is_not_wider_than_the_screen_and_nothing_is_not_little(
    browser: Any, server: PageServer, messages: list[str]
) -> None:
    page = opened(browser, f"{server.link}?length=7&where=uses+cup_1&beside=has+at+least+2+grasp", messages)
    playwright.expect.set_options(timeout=PATIENCE)
    playwright.expect(page.locator("#comparison tr >> nth=0 >> td >> nth=1")).to_have_text("0 % of it in both")
    page.set_viewport_size({"width": 360, "height": 740})
    page.fill("#rank", "5")
    page.click("text=Go to rank")
    playwright.expect(page.locator("#tree")).to_contain_text("pick_and_place")
    assert page.evaluate("document.documentElement.scrollWidth") == 360
    assert messages == []
