"""What a row of the table of wrong inputs is, and the folder that each of them damages."""

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

import unocclude
from fuzz.samples import BVH, SWEEP
from recording.exr import write_channels

Damage = Callable[[Path], object]
"""Does something to a folder like `bench`'s."""
SCENE = """
name = "small"
frames = 6
fps = 15
[camera]
width = 24
height = 18
position = [0, -4, 1.2]
look_at = [0, 0, 1]
[[people]]
body = "man"
"""
WALK = "waypoints = [[-1, 0], [1, 0]]\nspeed = 1.2\n"
TRAJECTORY = "trajectory = {file = 'walks.txt', id = 3, fps = 10}\n"
CLIP = "motion = {file = 'clip.bvh'}\n"
FAMILY = 'name = "tiny"\nframes = 2\n[camera]\nwidth = 24\nheight = 18\n[people]\ncount = 1\n'


@dataclass(frozen=True, kw_only=True)
class Case:
    """A wrong input."""

    input: str
    """What is wrong, in words of the table."""
    command: str
    """What is called, in a copy of the bench; `{place}` is the copy."""
    says: str
    """What the line on standard error says; of what is not refused, what the output says."""
    damage: Damage = lambda _: None
    """What makes it wrong."""
    status: int = 2
    becomes: str = ""
    """What happens in place of a refusal."""


def bench(place: Path) -> None:
    """A recording with motions, a data set, and all kinds of files that a user writes."""
    files = {
        "small.toml": SCENE + WALK,
        "walked.toml": SCENE + TRAJECTORY,
        "captured.toml": SCENE + CLIP,
        "tiny.toml": FAMILY,
        "sweep.toml": SWEEP,
        "clip.bvh": BVH,
        "walks.txt": "".join(f"3 {frame} {frame / 10 - 1} 0\n" for frame in range(40)),
        "settings.toml": "eps3 = 2.0\n",
    }
    for name, text in files.items():
        (place / name).write_text(text, encoding="utf-8")
    simulation = unocclude.simulate(place / "small.toml", backend="scalar")
    unocclude.save_recording(simulation, place / "small")
    unocclude.save_motions(unocclude.solve(simulation), place / "small" / "motions.parquet")
    digest = simulation.digest()
    unocclude.save_corrections(unocclude.Corrections(recording_digest=digest), place / "corrections.toml")
    order = unocclude.Order(family=unocclude.load_family(place / "tiny.toml"), folder=place / "set")
    unocclude.generate(order, seeds=[1], backend="scalar")


def written(name: str, content: bytes | str) -> Damage:
    """Put something else in place of a file."""
    data = content.encode() if isinstance(content, str) else content

    def damage(place: Path) -> None:
        (place / name).unlink(missing_ok=True)
        (place / name).write_bytes(data)

    return damage


def replaced(name: str, old: str, new: str) -> Damage:
    """Change text in a file, which has it."""

    def damage(place: Path) -> None:
        text = (place / name).read_text(encoding="utf-8")
        assert old in text
        (place / name).write_text(text.replace(old, new), encoding="utf-8")

    return damage


def cut(name: str, share: float) -> Damage:
    """Keep only the first part of a file."""

    def damage(place: Path) -> None:
        content = (place / name).read_bytes()
        (place / name).write_bytes(content[: int(len(content) * share)])

    return damage


def linked(name: str, goal: str) -> Damage:
    """Put a symbolic link in place of a file."""

    def damage(place: Path) -> None:
        (place / name).unlink(missing_ok=True)
        (place / name).symlink_to(goal)

    return damage


def removed(name: str) -> Damage:
    """Remove a file."""
    return lambda place: (place / name).unlink()


def keyed(key: str, value: object, name: str = "small/recording.json") -> Damage:
    """Set a key of a JSON file, or remove it with None; a number is a place in a list."""

    def damage(place: Path) -> None:
        document: Any = json.loads((place / name).read_text(encoding="utf-8"))
        part = document
        *outer, last = (int(word) if word.isdigit() else word for word in key.split("."))
        for word in outer:
            part = part[word]
        if value is None:
            del part[last]
        else:
            part[last] = value
        (place / name).write_text(json.dumps(document), encoding="utf-8")

    return damage


def framed(**channels: np.ndarray) -> Damage:
    """Put a frame of other channels in place of the recording's second."""
    return lambda place: write_channels(place / "small" / "frames" / "000001.exr", channels, attributes={})


def deep(value: float) -> Damage:
    """Put a depth into a pixel of the recording's second frame."""
    depth = np.full((18, 24), 3, np.float32)
    depth[2, 1] = value
    return framed(Z=depth)


def every_frame(depth: Callable[[int], np.ndarray]) -> Damage:
    """Put depths in place of all of the recording's frames."""

    def damage(place: Path) -> None:
        for number, path in enumerate(sorted((place / "small" / "frames").iterdir())):
            write_channels(path, {"Z": depth(number).astype(np.float32)}, attributes={})

    return damage
