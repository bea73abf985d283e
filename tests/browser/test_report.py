"""The report in a real browser: it opens fast; the scene plays, turns and shows its layers, by mouse and keyboard."""

import time
from collections.abc import Callable
from pathlib import Path

import pytest
from playwright.sync_api import Locator, Page, expect
from small_scenes import CROSSING

import unocclude

OPENS_S = 3.0
HEADINGS = ["Summary", "Failures first", "The scene in 3D", "Each hole", "Error against hole length"]


@pytest.fixture(scope="module")
def report(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The report of two people who pass behind a box, made by the command line."""
    folder = tmp_path_factory.mktemp("report")
    (folder / "small.toml").write_text(CROSSING, encoding="utf-8")
    for command in (
        ["simulate", folder / "small.toml", "-o", folder, "--backend", "scalar"],
        ["solve", folder / "small", "--set", "eps4=3"],
        ["report", folder / "small", "-o", folder / "small.html"],
    ):
        with pytest.raises(SystemExit, match="0"):
            unocclude.main([*map(str, command), "--quiet"])
    return folder / "small.html"


@pytest.fixture
def scene(page: Page, report: Path) -> Page:
    """The opened report at its 3D view."""
    requests: list[str] = []
    page.on("request", lambda request: requests.append(request.url))
    page.goto(report.as_uri())
    expect(page.locator("#view")).to_have_attribute("data-state", "ready")
    page.locator("#scene").scroll_into_view_if_needed()
    assert [one for one in requests if not one.startswith(("data:", "blob:"))] == [report.as_uri()]
    return page


def part(page: Page, name: str) -> Locator:
    return page.locator(f'#view [data-part="{name}"]')


def shown(page: Page) -> bytes:
    """What the canvas shows, once it is drawn."""
    page.evaluate("() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
    return part(page, "canvas").screenshot()


def frame(page: Page) -> int:
    return int(part(page, "slider").input_value())


def test_the_report_opens_fast_and_shows_its_parts(page: Page, report: Path, keep: Callable[[str], Path]) -> None:
    taken = []
    for _ in range(3):  # A busy machine is slow at times, which says nothing of the page.
        begun = time.perf_counter()
        page.goto(report.as_uri())
        expect(page.locator("#view")).to_have_attribute("data-state", "ready")
        taken.append(time.perf_counter() - begun)
    assert min(taken) < OPENS_S
    headings = page.locator("h2").all_inner_texts()
    assert headings[: len(HEADINGS)] == HEADINGS
    keep("report-top")
    for picture in page.locator("img").all():
        assert picture.evaluate("(image) => image.naturalWidth") > 0
    assert page.evaluate("document.documentElement.scrollWidth") <= 1366


def test_scrubbing_shows_another_time(scene: Page, keep: Callable[[str], Path]) -> None:
    before = shown(scene)
    part(scene, "slider").fill("8")
    expect(part(scene, "clock")).to_have_text("frame 8, 0.53 s")
    assert shown(scene) != before
    keep("report-scene")


def test_each_layer_can_be_hidden(scene: Page) -> None:
    names = [box.get_attribute("data-layer") for box in scene.locator("[data-layer]").all()]
    assert names == ["observed", "completed", "truth", "still", "curves"]
    for name in names:
        before = shown(scene)
        scene.locator(f'[data-layer="{name}"]').click()
        assert shown(scene) != before, name


def test_colours_can_be_chosen(scene: Page) -> None:
    pictures = []
    for value in ("0", "1", "2"):
        part(scene, "colouring").select_option(value)
        pictures.append(shown(scene))
    assert len(set(pictures)) == 3


def test_it_plays_to_the_end_and_pauses(scene: Page) -> None:
    part(scene, "slider").fill("0")
    part(scene, "play").click()
    expect(part(scene, "play")).to_have_text("Pause")
    scene.wait_for_function("Number(document.querySelector('[data-part=slider]').value) >= 4")
    part(scene, "play").click()
    stopped = frame(scene)
    scene.wait_for_timeout(300)
    assert frame(scene) == stopped
    part(scene, "slider").fill("36")
    part(scene, "speed").select_option("2")
    part(scene, "play").click()
    expect(part(scene, "play")).to_have_text("Play")
    assert frame(scene) == 39


def test_the_keyboard_alone_is_enough(scene: Page) -> None:
    part(scene, "canvas").focus()
    begun = frame(scene)
    for key, expected in (("ArrowRight", begun + 1), ("ArrowLeft", begun), ("Home", 0), ("End", 39)):
        scene.keyboard.press(key)
        assert frame(scene) == expected
    for key in ("Shift+ArrowLeft", "ArrowUp", "+", "-"):
        before = shown(scene)
        scene.keyboard.press(key)
        assert shown(scene) != before, key
    scene.keyboard.press("Home")
    scene.keyboard.press("Space")
    expect(part(scene, "play")).to_have_text("Pause")
    scene.keyboard.press("Space")
    expect(part(scene, "play")).to_have_text("Play")
    scene.keyboard.press("Tab")
    assert scene.evaluate("document.activeElement.dataset.part") == "back"
    outline = scene.evaluate("getComputedStyle(document.activeElement).outlineStyle")
    assert outline == "solid"


def test_the_mouse_turns_moves_and_zooms(scene: Page) -> None:
    box = part(scene, "canvas").bounding_box()
    assert box is not None
    pictures = [shown(scene)]
    for held in (None, "Shift"):
        scene.mouse.move(box["x"] + 200, box["y"] + 150)
        if held:
            scene.keyboard.down(held)
        scene.mouse.down()
        scene.mouse.move(box["x"] + 320, box["y"] + 190, steps=4)
        scene.mouse.up()
        if held:
            scene.keyboard.up(held)
        pictures.append(shown(scene))
    scene.mouse.wheel(0, -200)
    scene.wait_for_timeout(100)
    pictures.append(shown(scene))
    part(scene, "above").click()
    pictures.append(shown(scene))
    part(scene, "home").click()
    assert len(set(pictures)) == len(pictures)
    scene.mouse.move(0, 0)


def test_a_hole_is_shown_in_3d_at_its_time(scene: Page, keep: Callable[[str], Path]) -> None:
    button = scene.locator("#holes button[data-frame]").first
    button.click()
    assert frame(scene) == int(button.get_attribute("data-frame") or -1)
    assert scene.evaluate("document.activeElement.dataset.part") == "canvas"
    scene.locator("#holes").scroll_into_view_if_needed()
    keep("report-holes")


def test_it_is_readable_on_a_projector_and_on_a_telephone(scene: Page, keep: Callable[[str], Path]) -> None:
    for width, height in ((1920, 1080), (1200, 800), (800, 600), (400, 800)):
        scene.set_viewport_size({"width": width, "height": height})
        scene.locator("#scene").scroll_into_view_if_needed()
        assert scene.evaluate("document.documentElement.scrollWidth") <= width
        ends = [link.bounding_box() for link in scene.locator("nav a").all()]
        assert all(end is not None and end["x"] + end["width"] <= width for end in ends)
        keep(f"report-{width}")


def test_a_link_of_the_menu_leads_to_a_heading_that_the_menu_does_not_hide(scene: Page) -> None:
    for width in (1400, 1200, 800, 400):
        scene.set_viewport_size({"width": width, "height": 700})
        scene.locator("nav a", has_text="Each hole").click()
        heading, menu = (scene.locator(one).bounding_box() for one in ("#holes-title", "nav"))
        assert heading is not None
        assert menu is not None
        assert heading["y"] >= menu["y"] + menu["height"] or menu["y"] + menu["height"] < 0


def test_without_webgl_the_page_says_so(page: Page, report: Path) -> None:
    page.add_init_script("HTMLCanvasElement.prototype.getContext = () => null")
    page.goto(report.as_uri())
    expect(part(page, "failure")).to_contain_text("WebGL 2 is not available")
    assert page.locator("#view").get_attribute("data-state") == "failed"
