"""A page: what it consists of, as values, and how it becomes one HTML file that loads nothing."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import ClassVar

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from recording.atomic import whole_file
from recording.palette import COLOURS
from recording.version import VERSION

_ASSETS = Path(__file__).parent / "assets"


@dataclass(frozen=True, kw_only=True)
class Picture:
    """A picture with everything that it needs to be shown."""

    kind: ClassVar = "picture"
    source: str
    """A data URI."""
    alt: str
    """What is to be seen, for those who cannot."""
    caption: str = ""


@dataclass(frozen=True, kw_only=True)
class Text:
    """A paragraph."""

    kind: ClassVar = "text"
    words: str


@dataclass(frozen=True, kw_only=True)
class Tile:
    """A number that is worth large letters."""

    name: str
    value: str
    note: str = ""
    bad: bool = False
    """Whether it tells of a failure."""


@dataclass(frozen=True, kw_only=True)
class Tiles:
    """Numbers in a row."""

    kind: ClassVar = "tiles"
    items: tuple[Tile, ...]


@dataclass(frozen=True, kw_only=True)
class Table:
    """Rows of text under a head; the first cell of a row names it."""

    kind: ClassVar = "table"
    caption: str
    head: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    words: frozenset[int] = field(default_factory=frozenset)
    """The columns that hold sentences; the others hold numbers, which stand to the right."""


@dataclass(frozen=True, kw_only=True)
class Bars:
    """Lengths side by side."""

    kind: ClassVar = "bars"
    caption: str
    items: tuple[tuple[str, str, float], ...]
    """Name, value as text, share of the longest in [0, 1]."""


@dataclass(frozen=True, kw_only=True)
class Card:
    """Something that happened, with its picture."""

    title: str
    words: str
    picture: Picture | None = None
    frame: int | None = None
    """Where the 3D view is to go, if the page has one."""
    bad: bool = False


@dataclass(frozen=True, kw_only=True)
class Cards:
    """Cards side by side, as many as fit."""

    kind: ClassVar = "cards"
    items: tuple[Card, ...]
    title: str = ""


@dataclass(frozen=True, kw_only=True)
class View:
    """The scene in 3D; `evaluation.report.cloud` makes its content."""

    kind: ClassVar = "view"
    header: str
    """JSON."""
    points: str
    """Base64 of gzip."""
    frames: int
    fps: float
    layers: tuple[tuple[str, str, bool], ...]
    """Key, name, whether it is shown at first."""
    legend: tuple[tuple[str, str], ...]
    """Name and colour of each motion."""


@dataclass(frozen=True, kw_only=True)
class Fold:
    """What is shown when it is asked for."""

    kind: ClassVar = "fold"
    title: str
    blocks: tuple["Block", ...]


Block = Picture | Text | Tiles | Table | Bars | Cards | View | Fold


@dataclass(frozen=True, kw_only=True)
class Section:
    """A part of the page with a heading that the menu leads to."""

    key: str
    title: str
    blocks: tuple[Block, ...]
    lead: str = ""


@dataclass(frozen=True, kw_only=True)
class Page:
    """The whole page."""

    title: str
    subtitle: str
    sections: tuple[Section, ...]


def html_of(page: Page) -> str:
    """The page as HTML with styles, scripts, pictures and points inside."""
    environment = Environment(
        loader=FileSystemLoader(_ASSETS),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    has_view = any(block.kind == "view" for section in page.sections for block in section.blocks)
    return environment.get_template("page.html.jinja").render(
        page=page,
        version=VERSION,
        style=_asset("style.css"),
        colours=COLOURS,
        scripts=[_asset(name) for name in ("drawing.js", "view.js")] if has_view else [],
    )


def write_page(page: Page, path: Path, *, overwrite: bool = False) -> None:
    """Write the page, whole or not at all."""
    with whole_file(path, overwrite=overwrite) as partial:
        partial.write_text(html_of(page), encoding="utf-8")


def _asset(name: str) -> Markup:
    """A file of our own, which is not to be escaped."""
    return Markup((_ASSETS / name).read_text(encoding="utf-8"))
