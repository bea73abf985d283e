"""Which figures there are, of which scenes, and how they get to disk."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from matplotlib.figure import Figure

from algorithm.settings import Preset
from evaluation.figures.curves import candidates_figure, intra_figure, matchings_figure, representative_figure
from evaluation.figures.pipeline import pipeline_figure
from evaluation.figures.scans import completion_figure, person_figure, scan_figure
from evaluation.figures.scenes import crowd_figure, gallery_figure, wall_figure
from evaluation.figures.stages import Solved
from evaluation.figures.style import KINDS, styled, write_figure
from evaluation.kept import Kept
from recording.errors import InputError

Drawing = Callable[[Sequence[Solved]], Figure]
ALL = "all"


@dataclass(frozen=True, kw_only=True)
class Entry:
    """A figure of the paper."""

    scenes: tuple[str, ...]
    """What it shows, in order."""
    draw: Drawing


FIGURES: Mapping[str, Entry] = {
    "1": Entry(scenes=("9men",), draw=crowd_figure),
    "3": Entry(scenes=("wall",), draw=wall_figure),
    "4": Entry(scenes=("4men",), draw=pipeline_figure),
    "6": Entry(scenes=("wall",), draw=representative_figure),
    "7": Entry(scenes=("4men",), draw=intra_figure),
    "8": Entry(scenes=("wall",), draw=candidates_figure),
    "9": Entry(scenes=("forest",), draw=matchings_figure),
    "10": Entry(scenes=("wall", "house", "forest", "4men", "9men", "juggler3", "juggler5"), draw=gallery_figure),
    "11": Entry(scenes=("scan1",), draw=scan_figure),
    "12": Entry(scenes=("scan2",), draw=scan_figure),
    "13": Entry(scenes=("scan2",), draw=person_figure),
    "14": Entry(scenes=("scan3",), draw=scan_figure),
    "15": Entry(scenes=("scan3",), draw=completion_figure),
}
"""By the paper's numbers. Its figures 2 and 5 are drawings, not results."""


def chosen_figures(numbers: Sequence[str]) -> list[str]:
    """The numbers of the figures, each once and in the paper's order; `all` for every one."""
    unknown = next((number for number in numbers if number not in (*FIGURES, ALL)), None)
    if unknown is not None:
        raise InputError(f"expected figures among {', '.join(FIGURES)} or {ALL}, got {unknown!r}")
    return [number for number in FIGURES if number in numbers or ALL in numbers]


def figure_paths(numbers: Sequence[str], folder: Path) -> list[Path]:
    """The files that the figures are written to."""
    return [folder / f"figure{int(number):02d}.{kind}" for number in numbers for kind in KINDS]


def draw_figures(
    numbers: Sequence[str], kept: Kept, preset: Preset, *, folder: Path, overwrite: bool = False
) -> list[Path]:
    """Draw figures as PNG and SVG; scenes that the folder of recordings lacks are simulated and solved first."""
    paths = figure_paths(numbers, folder)
    existing = next((path for path in paths if path.exists()), None)
    if existing is not None and not overwrite:
        raise InputError(f"{existing} exists already: choose another place, or pass --overwrite to replace it")
    scenes = dict.fromkeys(scene for number in numbers for scene in FIGURES[number].scenes)
    failures = kept.solve_all([(scene, preset) for scene in scenes])
    for (scene, _), reason in failures.items():
        raise InputError(f"expected scene {scene!r} to be solved, but {reason}: try other settings or another size")
    solved = {scene: Solved(recording=kept.recording(scene), motions=kept.motions(scene, preset)) for scene in scenes}
    for number in numbers:
        entry = FIGURES[number]
        with styled():
            figure = entry.draw([solved[scene] for scene in entry.scenes])
            for path in figure_paths([number], folder):
                write_figure(figure, path, overwrite=overwrite)
    return paths
