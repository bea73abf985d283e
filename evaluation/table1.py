"""Table 1 of the paper beside ours: what the scenes hold, and what is found in them."""

from collections.abc import Sequence
from dataclasses import dataclass

from algorithm.settings import Preset
from evaluation.kept import Kept
from evaluation.methods import settings_of
from evaluation.paper_rows import PAPER, PaperRow
from evaluation.scores import Scores, scores
from recording.checks import nearest_name
from recording.errors import InputError
from recording.recording import Recording
from recording.visibility import Visibility, holes, longest_hole, visibility_of

PRESETS: tuple[Preset, ...] = ("paper", "default")
"""What the scenes are solved with."""
POINTS_TOLERANCE = 0.15
LONGEST_TOLERANCE = 2


@dataclass(frozen=True, kw_only=True)
class OwnRow:
    """What Table 1 counts of a scene, of our recording."""

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


@dataclass(frozen=True, kw_only=True)
class Result:
    """What was found in a scene under a preset."""

    preset: Preset
    epsilons: tuple[float, ...]
    """Epsilon 1 to 5, as used."""
    scores: Scores | None
    """As `unocclude evaluate` has them; None where solving failed."""
    failure: str | None = None
    """Why solving failed."""


@dataclass(frozen=True, kw_only=True)
class Row:
    """A scene: the paper's row, and ours."""

    paper: PaperRow
    own: OwnRow
    results: tuple[Result, ...] = ()
    """One a preset."""


def measured_rows(scenes: Sequence[str], kept: Kept, presets: Sequence[Preset] = ()) -> list[Row]:
    """The rows of the scenes (`all` for every one), with the results of the presets.

    Recordings and motions are those of the folder, as far as it holds them. A scene that cannot be solved
    has its failure in its row; the others go on.
    """
    known = {row.scene: row for row in PAPER}
    unknown = next((name for name in scenes if name not in (*known, "all")), None)
    if unknown is not None:
        raise InputError(f"--scenes: unknown scene {unknown!r}, {nearest_name(unknown, known)}")
    names = list(known) if "all" in scenes else list(dict.fromkeys(scenes))
    failures = kept.solve_all([(name, preset) for name in names for preset in presets])
    return [_row(known[name], kept, presets, failures) for name in names]


def own_row(recording: Recording, visibility: Visibility | None = None) -> OwnRow:
    """What Table 1 counts, from a recording that knows its objects."""
    visibility = visibility or visibility_of(recording)
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


def _row(paper: PaperRow, kept: Kept, presets: Sequence[Preset], failures: dict[tuple[str, Preset], str]) -> Row:
    recording = kept.recording(paper.scene)
    visibility = visibility_of(recording)
    results = []
    for preset in presets:
        failure = failures.get((paper.scene, preset))
        motions = kept.motions(paper.scene, preset) if failure is None else None
        settings = settings_of(recording, preset)
        results.append(
            Result(
                preset=preset,
                epsilons=tuple(float(getattr(settings, f"eps{number}")) for number in range(1, 6)),
                scores=scores(recording, motions, visibility) if motions is not None else None,
                failure=failure,
            )
        )
    return Row(paper=paper, own=own_row(recording, visibility), results=tuple(results))
