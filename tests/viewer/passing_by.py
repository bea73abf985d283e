"""A small simulated recording in which one person passes behind a wall, and its motions."""

from pathlib import Path

from small_scenes import box, small_scene, walker

from algorithm.settings import Settings
from recording.recording import Recording
from simulator.simulate import simulate

SCENE = small_scene(
    walker(begin_m=-1.6, end_m=1.6, beyond_m=0.3, speed=1.6),
    box(width_m=0.6, height_m=2.1, before_m=0.8),
    frames=30,
    width=96,
    away_m=4.5,
)
SETTINGS = Settings(eps4=3.0)


def passing_by(folder: Path) -> Recording:
    """The recording; its scene is written into the folder."""
    path = folder / "small.toml"
    path.write_text(SCENE, encoding="utf-8")
    return simulate(path, backend="scalar")
