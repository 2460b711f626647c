"""The player of 3D scenes in Chromium: the page of a small scene, and `prag-asp explore` with its physics replaced."""

from __future__ import annotations

import math
import shutil
from collections.abc import Callable, Iterator
from io import BytesIO
from pathlib import Path
from threading import Thread
from time import monotonic
from typing import Any

import numpy as np
import pytest

from prag_asp import load_domain
from prag_asp.explore.explored_domain import ExploredDomain
from prag_asp.explore.page_server import PageServer
from prag_asp.explore.space_pages import PAGE, space_views
from prag_asp.explore.turns import Turns
from prag_asp.html.player import MODULES, PLAYER, player_page
from prag_asp.physics.playback.gltf import GltfCamera, gltf_file, time_marks
from prag_asp.physics.playback.mesh_pieces import body_pieces
from prag_asp.physics.playback.tracks import BodyTrack
from prag_asp.physics.verdict import Budget, Verdict
from prag_asp.physics.witness import Witness
from prag_asp.scene.geometry import Pose
from prag_asp.scene.scene import Solid

playwright = pytest.importorskip("playwright.sync_api")
image = pytest.importorskip("PIL.Image")
CHROMIUM = shutil.which("chromium")

pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="needs Chromium")

PATIENCE = 90_000
"""Milliseconds to wait for a change of the page; WebGL without a graphics card is slow."""

DURATION = 2.0
"""Seconds of the small scene."""


@pytest.fixture(scope="module")
def scene_file() -> bytes:
    """A red cube that moves from left to right in two actions, on a grey plate."""
    still, moving = np.zeros((1, 7), np.float32), np.zeros((3, 7), np.float32)
    still[:, 6] = moving[:, 6] = 1.0
    moving[:, 1], moving[:, 2] = (-0.3, 0.0, 0.3), 0.1
    tracks = [
        BodyTrack("plate", body_pieces([Solid("box", (1.0, 1.0, 0.02))], (), "#808080"), still),
        BodyTrack("cube", body_pieces([Solid("box", (0.2, 0.2, 0.2))], (), "#ff0000"), moving),
    ]
    times = np.array((0.0, DURATION / 2, DURATION), np.float32)
    half = math.sqrt(0.5)
    camera = GltfCamera(Pose((1.8, 0.0, 1.0), (half, 0.0, 0.0, half)), (0.0, 0.0, 0.0), 0.7)
    extras = {"actions": time_marks(["1. begin", "2. go on"], times.tolist()), "light": (-0.3, 0.8, 1.8)}
    return gltf_file(tracks, times, camera, extras)


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    options = ["--no-sandbox", "--enable-unsafe-swiftshader", "--disable-gpu-watchdog"]
    with playwright.sync_playwright() as started:
        browser = started.chromium.launch(executable_path=CHROMIUM, args=options)
        yield browser
        browser.close()


@pytest.fixture
def open_page(browser: Any) -> Iterator[Callable[..., Any]]:
    """Open a page without motion, and check after the test that it has reported no mistake."""
    messages: list[str] = []
    contexts = []

    def opened(link: str, script: str = "", width: int = 360) -> Any:
        contexts.append(
            browser.new_context(viewport={"width": width, "height": 640}, reduced_motion="reduce", has_touch=True)
        )
        page = contexts[-1].new_page()
        page.set_default_timeout(PATIENCE)
        page.on("console", lambda message: messages.append(message.text))
        page.on("pageerror", lambda error: messages.append(str(error)))
        page.add_init_script(script)
        page.goto(link)
        return page

    yield opened
    for each in contexts:
        each.close()
    assert [text for text in messages if "GL Driver Message" not in text and "CONTEXT_LOST" not in text] == []


NO_WEBGL = "HTMLCanvasElement.prototype.getContext = () => null;"


def view(page: Any) -> np.ndarray:
    """Return the colours of the view, shape (height, width, 3), once it has been drawn."""
    page.evaluate("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
    with image.open(BytesIO(page.locator("canvas").screenshot())) as shown:
        return np.asarray(shown.convert("RGB")).astype(int)


def wait_for(page: Any, condition: Callable[[np.ndarray], bool], what: str) -> np.ndarray:
    """Return the colours of the view as soon as they meet a condition; a lost WebGL context is restored meanwhile."""
    deadline = monotonic() + PATIENCE / 1000
    while not condition(pixels := view(page)):
        assert monotonic() < deadline, what
    return pixels


def is_red(pixels: np.ndarray) -> np.ndarray:
    return (pixels[..., 0] > 100) & (pixels[..., 1] < 60)


def red_column(page: Any) -> float:
    """Return the mean column of the red pixels of the view, from 0 to 1."""
    red = is_red(wait_for(page, lambda pixels: is_red(pixels).sum() > 100, "the cube is seen"))
    return float(np.nonzero(red)[1].mean() / red.shape[1])


def test_the_page_plays_the_scene_and_every_control_works(
    scene_file: bytes, open_page: Callable[..., Any], tmp_path: Path
) -> None:
    (tmp_path / "scene.html").write_text(player_page("A scene", scene_file))
    page = open_page(f"file://{tmp_path}/scene.html")
    expect = playwright.expect
    expect.set_options(timeout=PATIENCE)
    now, clock, slider = page.locator(".player-now"), page.locator(".player-clock"), page.get_by_label("Time")
    expect(clock).to_have_text("0.0 of 2.0 s")
    expect(now).to_have_text("1. begin")
    begin = red_column(page)
    slider.focus()
    page.keyboard.press("End")
    expect(now).to_have_text("The task is done.")
    end = red_column(page)
    assert begin < 0.45 and end > 0.55, "y points to the right of this view"
    page.get_by_role("button", name="2. go on").click()
    expect(clock).to_have_text("1.0 of 2.0 s")
    assert "2. go on" in slider.get_attribute("aria-valuetext")
    expect(page.get_by_role("button", name="2. go on")).to_have_attribute("aria-current", "step")
    page.get_by_role("button", name="One action back").click()
    expect(clock).to_have_text("0.0 of 2.0 s")
    page.get_by_role("button", name="One action on").click()
    page.get_by_role("button", name="One action on").click()
    expect(now).to_have_text("The task is done.")
    page.get_by_label("Speed").select_option("4")
    page.locator("canvas").focus()
    page.keyboard.press("Space")
    expect(page.get_by_role("button", name="Pause")).to_have_count(1)
    expect(now).to_have_text("The task is done.")
    expect(page.get_by_role("button", name="Play", exact=True)).to_have_count(1)
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth"), "nothing is wider than a phone"


def test_the_view_turns_moves_and_zooms_by_keys_mouse_and_touch(
    scene_file: bytes, open_page: Callable[..., Any], tmp_path: Path
) -> None:
    (tmp_path / "scene.html").write_text(player_page("A scene", scene_file))
    page = open_page(f"file://{tmp_path}/scene.html")
    page.wait_for_selector(".player-clock:not(:empty)")
    canvas = page.locator("canvas")
    canvas.focus()
    first = wait_for(page, lambda pixels: is_red(pixels).sum() > 100, "the cube is seen")
    left, top = canvas.bounding_box()["x"] + 100, canvas.bounding_box()["y"] + 100
    touch = page.context.new_cdp_session(page)

    def key(name: str) -> None:
        canvas.focus()
        page.keyboard.press(name)

    def drag(button: str) -> None:
        page.mouse.move(left, top)
        page.mouse.down(button=button)
        page.mouse.move(left + 40, top + 20, steps=2)
        page.mouse.up(button=button)

    def pinch() -> None:
        for kind, gap in (("touchStart", 20), ("touchMove", 60), ("touchEnd", 0)):
            points = [{"x": left - gap, "y": top, "id": 0}, {"x": left + gap, "y": top, "id": 1}]
            touch.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points if gap else []})

    moves = [lambda name=name: key(name) for name in ("ArrowLeft", "ArrowUp", "Shift+ArrowRight", "+", "-")]
    moves += [lambda: drag("left"), lambda: drag("right"), lambda: page.mouse.wheel(0, 200), pinch]
    for number, move in enumerate(moves):
        move()
        wait_for(page, lambda pixels: np.abs(pixels - first).mean() > 1, f"move {number} changes the view")
        key("Home")
        wait_for(page, lambda pixels: (pixels == first).all(), f"the view is the first one again after move {number}")


def test_without_webgl_the_page_says_so(scene_file: bytes, open_page: Callable[..., Any], tmp_path: Path) -> None:
    (tmp_path / "scene.html").write_text(player_page("A scene", scene_file))
    page = open_page(f"file://{tmp_path}/scene.html", NO_WEBGL)
    playwright.expect(page.get_by_role("alert")).to_contain_text("WebGL 2 is missing")


@pytest.fixture
def link(scene_file: bytes) -> Iterator[str]:
    """The link to a whole task in `prag-asp explore`, which finds every task feasible and shows the small scene."""
    results = {
        "judge": Verdict("feasible", Budget(), 0, 0, witness=Witness({}, (), ())),
        "execute": None,
        "make_scene_file": scene_file,
        "draw_film": ("image/webp", b""),
    }
    explored = ExploredDomain(load_domain("tabletop"), ("tabletop",), "")
    views = space_views(explored, lambda work, *arguments: results[work.__name__])
    with PageServer(PAGE, views, Turns()) as server:
        thread = Thread(target=server.serve_forever, args=(0.01,))
        thread.start()
        yield f"{server.link}?length=1&do=pick(panda,brick_1,bin_1)"
        server.shutdown()
        thread.join()


def test_demonstrate_plays_in_3d_and_makes_a_video_on_request(link: str, open_page: Callable[..., Any]) -> None:
    page = open_page(link)
    page.click("#demonstrate")
    playwright.expect(page.locator(".player-now")).to_have_text("1. begin", timeout=PATIENCE)
    red_column(page)
    with page.expect_download() as download:
        page.click("text=Download the 3D scene")
    assert download.value.suggested_filename == "task.glb"
    page.click("text=Make a video")
    playwright.expect(page.locator("#film a")).to_have_attribute("download", "task.webp", timeout=PATIENCE)
    playwright.expect(page.locator("canvas")).to_have_count(1)


def test_without_webgl_demonstrate_makes_a_video(link: str, open_page: Callable[..., Any]) -> None:
    page = open_page(link, NO_WEBGL)
    page.click("#demonstrate")
    playwright.expect(page.locator("#film a")).to_have_attribute("download", "task.webp", timeout=PATIENCE)
    playwright.expect(page.locator("#scene *")).to_have_count(0)


def test_the_modules_name_no_host_and_every_file_is_among_them() -> None:
    assert {path.name for path in PLAYER.iterdir()} == {*MODULES, "player.css"}
    for path in PLAYER.iterdir():
        text = path.read_text()
        assert "http" not in text and "innerHTML" not in text and "eval(" not in text
