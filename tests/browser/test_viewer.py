"""The viewer in a real browser: it opens, plays, shows layers, picks a motion, solves anew and shows the change."""

import shlex
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
from passing_by import SETTINGS, passing_by
from PIL import Image, ImageChops
from playwright.sync_api import Locator, Page, expect
from viser.transforms import SO3

import unocclude
from algorithm.staged import solve
from recording.cache import Cache
from recording.motions import Motions
from recording.parquet import load_motions
from recording.store import save_recording
from viewer.keeping import CorrectionsFile
from viewer.viewer import Viewer
from viewer.wish import command

Keep = Callable[[str], Path]
PATIENCE_MS = 60_000.0
"""On a busy machine without a graphics card."""
SETTLING_MS = 400.0
"""In which the browser draws what it was sent."""
BESIDE = 120.0, 740.0
"""A place of the page where the scene is empty."""


@pytest.fixture(scope="module")
def viewer(tmp_path_factory: pytest.TempPathFactory, own_cache: Path) -> Iterator[Viewer]:
    """A viewer of one person who passes behind a wall; its motions are judged."""
    scene, cache = passing_by(tmp_path_factory.mktemp("scene")), Cache(folder=own_cache)
    file = CorrectionsFile(tmp_path_factory.mktemp("kept") / "corrections.toml")
    viewer = Viewer(scene, solve(scene, SETTINGS, cache=cache), port=0, cache=cache, file=file)
    thread = threading.Thread(target=viewer.run)
    thread.start()
    until(lambda: viewer.session.answer is not None and viewer.session.answer.judgement is not None)
    yield viewer
    viewer.stop()
    thread.join()


@pytest.fixture
def opened(viewer: Viewer, page: Page) -> Page:
    """The viewer's page, as it is at first."""
    page.goto(viewer.address, timeout=PATIENCE_MS)
    expect(page.get_by_role("button", name="Play")).to_be_visible(timeout=PATIENCE_MS)
    until(lambda: len(viewer.server.get_clients()) > 0)
    page.locator(".mantine-Notification-closeButton").first.click(timeout=PATIENCE_MS)  # There is no graphics card.
    page.wait_for_timeout(SETTLING_MS)
    return page


def solved_with(viewer: Viewer, setting: str) -> object:
    """The value of a setting that the answer which is shown was made with; None without an answer."""
    answer = viewer.session.answer
    return None if answer is None else answer.motions.making.settings[setting]


def until(done: Callable[[], bool]) -> None:
    """Wait until something has come true in the viewer."""
    end = time.monotonic() + PATIENCE_MS / 1000
    while not done():
        assert time.monotonic() < end, "expected it by now"
        time.sleep(0.02)


def differing_pixels(one: Path, other: Path) -> int:
    """How many pixels of two screenshots differ, to the left of the panels."""
    pictures = [Image.open(path).convert("RGB").crop((0, 200, 950, 768)) for path in (one, other)]
    return int((np.asarray(ImageChops.difference(*pictures)).max(axis=2) > 30).sum())


def slider(page: Page, label: str) -> Locator:
    """The slider beside a label."""
    return page.locator(f"xpath=//*[text()='{label}']/following::*[@role='slider'][1]")


def test_scrubbing_stepping_and_playing_move_the_time(viewer: Viewer, opened: Page, keep: Keep) -> None:
    before = keep("viewer")
    slider(opened, "Frame").press("End")
    until(lambda: viewer.session.frame == 29)
    opened.wait_for_timeout(SETTLING_MS)
    assert differing_pixels(before, keep("viewer_last_frame")) > 500
    opened.mouse.click(*BESIDE)  # The keys are the scene's now.
    opened.keyboard.press("Home")
    until(lambda: viewer.session.frame == 0)
    opened.keyboard.press("l")
    until(lambda: viewer.session.frame == 1)
    opened.keyboard.press("j")
    until(lambda: viewer.session.frame == 0)
    opened.keyboard.press("Space")
    until(lambda: viewer.session.frame > 3)
    opened.get_by_role("button", name="Pause").click()
    until(lambda: not viewer.session.playback.playing)
    viewer.session.post(lambda: viewer.session.playback.go_to(15))  # In the middle of the hole.


def test_layers_come_and_go(viewer: Viewer, opened: Page, keep: Keep) -> None:
    for layer, label in {"truth": "Truth", "holes": "Holes", "segments": "Segments"}.items():
        without = keep(f"viewer_without_{layer}")
        box = opened.locator(f"xpath=//*[text()='{label}']/following::input[@type='checkbox'][1]")
        box.check()
        until(lambda layer=layer: viewer.scene.shown[layer])
        opened.wait_for_timeout(SETTLING_MS)
        assert differing_pixels(without, keep(f"viewer_with_{layer}")) > 10, f"{label} cannot be seen"
        box.uncheck()
        until(lambda layer=layer: not viewer.scene.shown[layer])
        opened.wait_for_timeout(SETTLING_MS)


def test_colours_follow_the_key_and_the_list(viewer: Viewer, opened: Page, keep: Keep) -> None:
    opened.mouse.click(*BESIDE)
    for colouring in ("segment", "error", "depth", "motion"):
        opened.keyboard.press("c")
        until(lambda wanted=colouring: viewer.session.colouring == wanted)
        opened.wait_for_timeout(SETTLING_MS)
        keep(f"viewer_by_{colouring}")


def test_a_click_on_a_point_picks_its_motion_and_shows_its_numbers(viewer: Viewer, opened: Page, keep: Keep) -> None:
    viewer.session.post(lambda: viewer.session.playback.go_to(0))
    until(lambda: viewer.session.frame == 0)
    opened.wait_for_timeout(SETTLING_MS)
    opened.mouse.click(*on_screen(viewer, first_point(viewer)))
    until(lambda: viewer.session.picked == 0)
    opened.get_by_role("tab", name="Motion").click()
    expect(opened.get_by_text("points observed")).to_be_visible()
    expect(opened.get_by_text("person 1 (F")).to_be_visible()
    expect(opened.get_by_role("cell", name="made", exact=True)).to_be_visible()
    keep("viewer_picked")
    opened.mouse.click(*BESIDE)
    until(lambda: viewer.session.picked is None)


def test_a_slider_solves_anew_and_shows_the_change_of_the_scores(viewer: Viewer, opened: Page, keep: Keep) -> None:
    opened.get_by_role("tab", name="Settings").click()
    expect(opened.get_by_text("coverage")).to_be_visible()
    thumb = slider(opened, "eps2 [m]")
    for _ in range(8):
        thumb.press("ArrowRight")
    until(lambda: solved_with(viewer, "eps2") == pytest.approx(0.18))  # On the way there others may be solved.
    expect(opened.get_by_text("solved in")).to_be_visible(timeout=PATIENCE_MS)
    expect(opened.locator("td strong").first).to_be_visible(timeout=PATIENCE_MS)
    keep("viewer_solved_anew")
    opened.get_by_role("button", name="As opened").click()
    until(lambda: viewer.session.answer is viewer.session.opened)
    expect(opened.locator("td strong")).to_have_count(0)


def test_a_pair_is_marked_solved_apart_saved_and_replayed(
    viewer: Viewer, opened: Page, keep: Keep, tmp_path: Path
) -> None:
    session = viewer.session
    assert session.file is not None
    session.post(lambda: session.playback.go_to(0))
    opened.get_by_role("tab", name="Corrections").click()
    opened.mouse.click(*BESIDE)
    opened.keyboard.press("m")
    until(lambda: session.clicks == "mark")
    opened.wait_for_timeout(SETTLING_MS)
    opened.mouse.click(*on_screen(viewer, first_point(viewer)))
    until(lambda: len(session.marks.known) == 1)
    opened.get_by_label("Second").click()
    opened.get_by_role("option").last.click()
    until(lambda: len(session.marks.known) == 2)
    opened.wait_for_timeout(SETTLING_MS)
    keep("viewer_marked")
    opened.get_by_role("button", name="different").click()
    expect(opened.get_by_role("button", name="1. different")).to_be_visible(timeout=PATIENCE_MS)
    expect(opened.locator("td strong").first).to_be_visible(timeout=PATIENCE_MS)
    expect(opened.get_by_text("solved in")).to_be_visible(timeout=PATIENCE_MS)
    keep("viewer_corrected")
    opened.get_by_role("button", name="Save").click()
    expect(opened.get_by_text("saved to")).to_be_visible()
    assert session.answer is not None
    assert len(session.answer.motions.motion_ids) == 2
    shown = session.answer.motions
    replayed = replay(viewer, tmp_path)
    for column in ("frame", "trajectory", "segment", "motion", "position"):
        np.testing.assert_array_equal(getattr(replayed, column), getattr(shown, column))
    opened.get_by_role("button", name="last change").click()
    until(lambda: session.answer is session.opened)
    expect(opened.locator("td strong")).to_have_count(0)


def replay(viewer: Viewer, folder: Path) -> Motions:
    """The motions that the command line makes of the viewer's settings and its saved corrections."""
    session = viewer.session
    assert session.file is not None
    save_recording(session.recording, folder / "recording")
    line = command(session.wish, session.recording, session.file.path)
    words = [str(folder / "recording") if word == "RECORDING" else word for word in shlex.split(line)[1:]]
    with pytest.raises(SystemExit, match="0"):
        unocclude.main([*words, "--quiet"])
    return load_motions(folder / "recording" / "motions.parquet")


def first_point(viewer: Viewer) -> np.ndarray:
    """A point of motion 0 in frame 0, the one nearest to their mean."""
    answer = viewer.session.answer
    assert answer is not None
    rows = (answer.motions.motion == 0) & (answer.motions.frame == 0) & answer.motions.observed
    points = answer.motions.position[rows].astype(float)
    return points[np.linalg.norm(points - points.mean(axis=0), axis=1).argmin()]


def on_screen(viewer: Viewer, place: np.ndarray) -> tuple[float, float]:
    """Where the browser shows a place of the world."""
    camera = next(iter(viewer.server.get_clients().values())).camera
    x, y, z = SO3(camera.wxyz).as_matrix().T @ (place - camera.position)
    half = np.tan(camera.fov / 2) * z
    width, height = camera.image_width, camera.image_height
    return width / 2 * (1 + x / (half * width / height)), height / 2 * (1 + y / half)
