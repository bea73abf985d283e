"""How smoothly the viewer plays: frames a second of one layer of points, by two ways of changing the frame.

`shown by turns` sends every frame once, and then two small messages for each change; this is what the viewer does.
`sent anew` sends a frame's points and colours at each change. `server` are the changes a second that the server can
post. `drawn` are those that headless Chromium draws of 30 a second: without a graphics card the processor draws, which
is the slower the larger the window. `page ms` is the time of the page's own thread for each of them, in milliseconds of
processor, drawing left out: 33 are allowed. Takes about a minute; `--no-browser` a few seconds.
"""

import sys
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from shutil import which

sys.path[0] = str(Path(__file__).parents[1])

import numpy as np
from cyclopts import App
from playwright.sync_api import CDPSession, sync_playwright
from viser import GuiSliderHandle

from benchmarks.tables import Row, run, show
from recording.palette import rgb_of
from viewer.clouds import Cloud
from viewer.server import ClosedServer, opened_server
from viewer.space import Space
from viewer.stage import CloudLayer, Stage

app = App(help=__doc__)
Change = Callable[[int], None]
POSTED_PER_SECOND = 30.0
_CHANGES = 300
_FLAGS = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-dev-shm-usage"]
_COUNT = """() => {
  window.drawn = 0; window.last = null;
  const look = () => {
    const now = document.querySelector('[role=slider]').getAttribute('aria-valuenow');
    if (now !== window.last) { window.last = now; window.drawn += 1; }
    requestAnimationFrame(look);
  };
  look();
}"""


@dataclass(frozen=True, kw_only=True)
class Look:
    """How the browser looks at it."""

    window: tuple[int, int]
    """Width and height, pixels."""
    seconds: float


@app.default
def viewing(
    *,
    points: int = 20_000,
    frames: int = 100,
    window: tuple[int, int] = (1366, 768),
    seconds: float = 8.0,
    browser: bool = True,
    json: bool = False,
) -> None:
    """Print a row for each way.

    Args:
        points: Of a frame.
        frames: Of the recording.
        window: Width and height of the browser's, pixels.
        seconds: That the browser plays.
        browser: Measure in the browser too; it wants Chromium and Playwright.
        json: One JSON object in place of the table.
    """
    look = Look(window=window, seconds=seconds) if browser else None
    rows = [_row(way, _cloud(points, frames), look) for way in ("shown by turns", "sent anew")]
    show(f"{frames} frames of {points} points: frames a second", rows, as_json=json)


def _row(way: str, cloud: Cloud, look: Look | None) -> Row:
    server = opened_server(host="127.0.0.1", port=0, label="viewing")
    slider = server.gui.add_slider("Frame", 0, len(cloud.begin) - 2, 1, 0)
    begun = time.perf_counter()
    change = (_by_turns if way == "shown by turns" else _anew)(server, cloud)
    prepared_s = time.perf_counter() - begun
    row: Row = {"way": way, "prepared s": prepared_s, "server": _posted(change, len(cloud.begin) - 1)}
    if look is not None:
        row |= _drawn(server, change, slider, look)
    server.stop()
    return row


def _cloud(points: int, frames: int) -> Cloud:
    """A block of points that moves to the side."""
    block = np.random.default_rng(0).uniform(-2, 2, (points, 3))
    way = np.linspace(-1, 1, frames)[:, None, None] * [1.0, 0.0, 0.0]
    return Cloud(
        points=(block + way).reshape(-1, 3).astype(np.float16),
        begin=np.arange(frames + 1) * points,
        depth_m=np.zeros(frames * points, np.float32),
    )


def _colours(cloud: Cloud) -> np.ndarray:
    return rgb_of(np.arange(len(cloud.points)) % 8)


def _stage(server: ClosedServer, cloud: Cloud) -> Stage:
    x, _, z = np.eye(3)
    space = Space(middle=np.zeros(3), camera=-5 * x, size_m=5.0, up=z, forward=x)
    return Stage(server, space, len(cloud.begin) - 1)


def _by_turns(server: ClosedServer, cloud: Cloud) -> Change:
    stage = _stage(server, cloud)
    layer = CloudLayer(stage=stage, name="points", size_m=0.02, shown=True)
    layer.put(cloud, _colours(cloud), 0)
    return stage.show


def _anew(server: ClosedServer, cloud: Cloud) -> Change:
    colours, first = _colours(cloud), cloud.of(0)
    node = server.scene.add_point_cloud("/points", cloud.points[first], colours[first], point_size=0.02)

    def change(frame: int) -> None:
        with server.atomic():
            node.points, node.colors = cloud.points[cloud.of(frame)], colours[cloud.of(frame)]

    return change


def _posted(change: Change, frames: int) -> float:
    """Changes a second that the server posts when nobody looks."""
    begun = time.perf_counter()
    for number in range(_CHANGES):
        change((number + 1) % frames)
    return _CHANGES / (time.perf_counter() - begun)


def _drawn(server: ClosedServer, change: Change, slider: GuiSliderHandle[int], look: Look) -> Row:
    """What the browser draws of 30 changes a second, and how long it takes to open the page."""
    with sync_playwright() as playwright:
        chromium = playwright.chromium.launch(executable_path=which("chromium"), args=_FLAGS)
        page = chromium.new_page(viewport={"width": look.window[0], "height": look.window[1]})
        begun = time.perf_counter()
        page.goto(f"http://127.0.0.1:{server.get_port()}")
        page.wait_for_selector("[role=slider]")
        opened_s = time.perf_counter() - begun
        page.wait_for_timeout(3000)
        ended = threading.Event()
        player = threading.Thread(target=_play, args=(change, slider, ended))
        player.start()
        page.wait_for_timeout(3000)  # Whatever is drawn for the first time has been.
        page.evaluate(_COUNT)
        session = page.context.new_cdp_session(page)
        session.send("Performance.enable", {"timeDomain": "threadTicks"})
        before, begun = _page_seconds(session), time.perf_counter()
        page.wait_for_timeout(1000 * look.seconds)
        drawn, passed = page.evaluate("() => window.drawn"), time.perf_counter() - begun
        page_ms = 1000 * (_page_seconds(session) - before) / max(drawn, 1)
        ended.set()
        player.join()
        chromium.close()
    return {"drawn": drawn / passed, "page ms": page_ms, "opened s": opened_s}


def _page_seconds(session: CDPSession) -> float:
    """The processor time that the page's thread has spent so far."""
    metrics = session.send("Performance.getMetrics")["metrics"]
    return float(next(each["value"] for each in metrics if each["name"] == "TaskDuration"))


def _play(change: Change, slider: GuiSliderHandle[int], ended: threading.Event) -> None:
    begun, posted = time.perf_counter(), 0
    while not ended.wait(max(begun + posted / POSTED_PER_SECOND - time.perf_counter(), 0.0)):
        change(posted % (slider.max + 1))
        slider.value = posted % (slider.max + 1)  # type: ignore[misc]  # As in `viewer.panels.desk`.
        posted += 1


if __name__ == "__main__":
    run(app)
