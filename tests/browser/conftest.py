"""A real browser for the tests of pages: headless Chromium, driven by Playwright."""

import shutil
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, ConsoleMessage, Page, sync_playwright

PICTURES = Path(__file__).parent.parent.parent / "pictures"
"""Where screenshots are kept to be looked at; nothing of it is committed."""
NAMES = ("chromium", "chromium-browser", "google-chrome")
FLAGS = (
    "--no-sandbox",  # Its sandbox wants a user of its own, which containers often lack.
    "--use-angle=swiftshader",  # WebGL without a graphics card.
    "--enable-unsafe-swiftshader",
    "--disable-dev-shm-usage",
)


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    """The system's Chromium without a window.

    For a module, not for all tests: Playwright holds the thread's event loop, which other tests may want.
    """
    program = next(filter(None, map(shutil.which, NAMES)), None)
    assert program is not None, "expected a browser, found none: 'apt-get install chromium'"
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=program, args=list(FLAGS))
        yield browser
        browser.close()


@pytest.fixture
def page(browser: Browser) -> Iterator[Page]:
    """A page of 1366x768, a small laptop's; the test fails in the end if the console held an error."""
    page = browser.new_page(viewport={"width": 1366, "height": 768})
    errors: list[str] = []

    def heard(message: ConsoleMessage) -> None:
        if message.type == "error":
            errors.append(message.text)

    page.on("console", heard)
    page.on("pageerror", lambda error: errors.append(str(error)))
    yield page
    page.close()
    assert errors == []


@pytest.fixture
def keep(page: Page) -> Callable[[str], Path]:
    """A function that keeps a screenshot of what the page shows now, under a name."""

    def kept(name: str) -> Path:
        PICTURES.mkdir(exist_ok=True)
        path = PICTURES / f"{name}.png"
        page.screenshot(path=path)
        return path

    return kept
