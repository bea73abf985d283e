"""Table 1 of the paper beside ours, measured from recordings alone."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from recording.checks import nearest_name
from recording.errors import InputError
from recording.recording import Recording
from recording.store import load_recording
from recording.visibility import holes, longest_hole, visibility_of
from simulator.simulate import prepared, simulate, write_simulation


@dataclass(frozen=True, kw_only=True)
class PaperRow:
    """What the paper prints of a scene."""

    test: str
    """Its name in the paper."""
    scene: str
    """Our scene of it."""
    frames: int
    points: tuple[int, int]
    """Returns a frame; a range for the real scans."""
    objects: int
    static: int
    holes: int
    longest: int
    """Frames."""
    at_least: bool = False
    """Whether the number of holes is a lower bound ("25+")."""


PAPER = (
    PaperRow(
        test="9men",
        scene="9men",
        frames=100,
        points=(2000, 2000),
        objects=9,
        static=0,
        holes=25,
        longest=10,
        at_least=True,
    ),
    PaperRow(test="wall", scene="wall", frames=100, points=(4800, 4800), objects=2, static=1, holes=2, longest=35),
    PaperRow(test="house", scene="house", frames=30, points=(3500, 3500), objects=2, static=1, holes=2, longest=8),
    PaperRow(test="forest", scene="forest", frames=110, points=(3100, 3100), objects=1, static=4, holes=4, longest=7),
    PaperRow(test="4men", scene="4men", frames=100, points=(800, 800), objects=4, static=0, holes=11, longest=5),
    PaperRow(
        test="Jugg 3 ball", scene="juggler3", frames=110, points=(5700, 5700), objects=3, static=1, holes=5, longest=5
    ),
    PaperRow(
        test="Jugg 5 ball", scene="juggler5", frames=110, points=(7000, 7000), objects=5, static=1, holes=7, longest=12
    ),
    PaperRow(
        test="real scan 1", scene="scan1", frames=16, points=(3000, 8000), objects=2, static=0, holes=1, longest=3
    ),
    PaperRow(
        test="real scan 2", scene="scan2", frames=22, points=(2300, 5000), objects=3, static=0, holes=1, longest=4
    ),
    PaperRow(
        test="real scan 3", scene="scan3", frames=20, points=(2300, 6500), objects=3, static=0, holes=2, longest=4
    ),
)
"""The ten rows. The paper prints 4 objects for its five juggled balls: 5 here."""
POINTS_TOLERANCE = 0.15
LONGEST_TOLERANCE = 2


@dataclass(frozen=True, kw_only=True)
class OwnRow:
    """The same of a recording."""

    frames: int
    points: float
    """Mean number of returns a frame, ground excluded."""
    objects: int
    """Objects that move."""
    static: int
    """Objects that do not, ground excluded; a juggler stands, whatever his arms do."""
    holes: int
    longest: int
    """Frames; 0 without a hole."""


def measured_rows(
    scenes: Sequence[str], *, folder: Path | None = None, size: str | None = None
) -> list[tuple[PaperRow, OwnRow]]:
    """The paper's rows of the scenes (`all` for every one), each with ours.

    With a `folder` the recordings are kept there, and those that it holds already are measured as they are.
    """
    known = {row.scene: row for row in PAPER}
    unknown = next((name for name in scenes if name not in (*known, "all")), None)
    if unknown is not None:
        raise InputError(f"--scenes: unknown scene {unknown!r}, {nearest_name(unknown, known)}")
    names = known if "all" in scenes else scenes
    return [(known[name], own_row(_recorded(name, folder, size))) for name in names]


def _recorded(scene: str, folder: Path | None, size: str | None) -> Recording:
    """The recording of a scene, from the folder if there is one."""
    if folder is None:
        return simulate(scene, size=size)
    if not (folder / scene).exists():
        write_simulation(prepared(scene, size=size), folder / scene)
    return load_recording(folder / scene)


def own_row(recording: Recording) -> OwnRow:
    """What Table 1 counts, from a recording that knows its objects."""
    visibility = visibility_of(recording)
    objects = recording.metadata.objects or ()
    return OwnRow(
        frames=recording.metadata.frames,
        points=visibility.points_per_frame,
        objects=sum(entry.moving for entry in objects),
        static=sum(not entry.moving and entry.kind != "ground" for entry in objects),
        holes=len(holes(visibility) or ()),
        longest=longest_hole(visibility) or 0,
    )


def points_deviation(paper: PaperRow, own: OwnRow) -> float:
    """By which share our points lie outside the paper's number or range; 0 inside."""
    low, high = paper.points
    if own.points < low:
        return own.points / low - 1
    return max(own.points / high - 1, 0.0)


def misses(paper: PaperRow, own: OwnRow) -> list[str]:
    """The columns in which our row is not the paper's within the tolerances.

    Frames, objects, static objects and holes are to be exact (or at least as many, where the paper says
    so), points within 15 %, the longest hole within 2 frames.
    """
    wrong = {
        "Fr": own.frames != paper.frames,
        "Pts": abs(points_deviation(paper, own)) > POINTS_TOLERANCE,
        "Obj": own.objects != paper.objects,
        "Stat": own.static != paper.static,
        "Occ": own.holes < paper.holes if paper.at_least else own.holes != paper.holes,
        "Max Occ": abs(own.longest - paper.longest) > LONGEST_TOLERANCE,
    }
    return [name for name, missed in wrong.items() if missed]


def table_cells(rows: Sequence[tuple[PaperRow, OwnRow]]) -> list[dict[str, str]]:
    """The table as text: in each cell the paper's number and ours."""
    return [_cells(paper, own) for paper, own in rows]


def _cells(paper: PaperRow, own: OwnRow) -> dict[str, str]:
    low, high = paper.points
    points = f"{low}" if low == high else f"{low}-{high}"
    more = "+" if paper.at_least else ""
    return {
        "test": paper.test,
        "scene": paper.scene,
        "Fr": f"{paper.frames} | {own.frames}",
        "Pts": f"{points} | {own.points:.0f} ({100 * points_deviation(paper, own):+.0f} %)",
        "Obj": f"{paper.objects} | {own.objects}",
        "Stat": f"{paper.static} | {own.static}",
        "Occ": f"{paper.holes}{more} | {own.holes}",
        "Max Occ": f"{paper.longest} | {own.longest}",
        "missed": ", ".join(misses(paper, own)) or "-",
    }
