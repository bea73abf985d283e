"""A small simulated recording in which one person passes behind a wall, and its motions."""

from pathlib import Path

from algorithm.settings import Settings
from recording.recording import Recording
from simulator.simulate import simulate

SCENE = """
name = "passing_by"
frames = 30
fps = 12
[camera]
width = 96
height = 72
position = [0, -4.5, 1.4]
look_at = [0, 0, 1]
horizontal_fov_deg = 50
[[people]]
body = "man"
waypoints = [[-1.6, 0.3], [1.6, 0.3]]
speed = 1.3
[[obstacles]]
shape = "box"
size = [0.6, 0.1, 2.1]
position = [0.0, -0.8, 0.0]
"""
SETTINGS = Settings(eps4=3.0)


def passing_by(folder: Path) -> Recording:
    """The recording; its scene is written into the folder."""
    path = folder / "passing_by.toml"
    path.write_text(SCENE, encoding="utf-8")
    return simulate(path, backend="scalar")
