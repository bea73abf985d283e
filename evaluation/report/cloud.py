"""The points of the 3D view: few enough to send, packed as the view's script unpacks them.

The content is gzip of columns, one after the other, over all points of all layers: place (three uint16 each, between
the corners that the header names), colour of the motion, colour of the segment, confidence (uint8 each). Within a layer
points are sorted by frame; the header says where each frame begins. Axes: right, up, towards the viewer.
"""

import gzip
import json
from base64 import b64encode
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int, UInt8

from evaluation.figures.stages import Solved
from evaluation.report.page import View
from recording.motions import NOISE, Representative
from recording.palette import COLOURS, FAINT, TRUTH, colour_of
from recording.progress import tracked
from recording.recording import Recording
from recording.visibility import surface_points

MOST_OBSERVED, MOST_COMPLETED, MOST_TRUE, MOST_STILL = 400_000, 200_000, 120_000, 12_000
"""Points of the layers at the most; a few bytes each."""
_STEPS = 65_535
_PALETTE = (*COLOURS, FAINT, TRUTH)
_FAINT, _TRUTH = len(COLOURS), len(COLOURS) + 1
"""Their numbers in the palette."""
LAYERS = (
    ("observed", "observed", True),
    ("completed", "completed", True),
    ("truth", "truth", False),
    ("still", "background", True),
)
"""Key, name, whether it is shown at first."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Layer:
    """Points of one kind, sorted by frame."""

    frame: Int[np.ndarray, "point"]
    position: Float[np.ndarray, "point 3"]
    """World axes, metres."""
    motion: UInt8[np.ndarray, "point"]
    """Number of the colour."""
    segment: UInt8[np.ndarray, "point"]
    """Number of the colour."""
    confidence: UInt8[np.ndarray, "point"]
    """0 to 255."""


def view_of(case: Solved) -> View:
    """The 3D view of a solved recording."""
    frames = case.recording.metadata.frames
    layers = {
        "observed": _motion_points(case, observed=True, most=MOST_OBSERVED),
        "completed": _motion_points(case, observed=False, most=MOST_COMPLETED),
        "truth": _true_points(case.recording),
        "still": _still_points(case),
    }
    turn = display_from_world(case.recording)
    places = np.concatenate([layer.position for layer in layers.values()]) @ turn.T
    low = places.min(axis=0) if len(places) else np.zeros(3)
    span = np.maximum(np.ptp(places, axis=0) if len(places) else np.zeros(3), 1e-3)
    header = {
        "low": low.round(4).tolist(),
        "span": span.round(4).tolist(),
        "fps": case.recording.fps,
        "palette": _PALETTE,
        "layers": {name: _starts(layer, frames) for name, layer in layers.items() if len(layer.frame)},
        "curves": [_curve(curve, turn) for curve in case.representatives],
        "ground": bool(case.recording.metadata.scene is not None),
        **_shown(places[: len(layers["observed"].frame)] if len(layers["observed"].frame) else places),
    }
    known = {"curves"} | set(header["layers"])
    return View(
        header=json.dumps(header, separators=(",", ":")),
        points=_packed(list(layers.values()), (places - low) / span),
        frames=frames,
        fps=case.recording.fps,
        layers=tuple(layer for layer in (*LAYERS, ("curves", "paths", True)) if layer[0] in known),
        legend=tuple((f"motion {curve.motion}", colour_of(curve.motion)) for curve in case.representatives),
    )


def _packed(layers: Sequence[Layer], shares: Float[np.ndarray, "point 3"]) -> str:
    """The columns as text; `shares` are the places between the corners, 0 to 1."""
    columns = [np.round(shares * _STEPS).astype("<u2")]
    columns += [
        np.concatenate([getattr(layer, name) for layer in layers]) for name in ("motion", "segment", "confidence")
    ]
    content = gzip.compress(b"".join(column.tobytes() for column in columns), compresslevel=6, mtime=0)
    return b64encode(content).decode("ascii")


def display_from_world(recording: Recording) -> Float[np.ndarray, "3 3"]:
    """The rotation to the axes right, up, towards the viewer.

    Upwards is the world's z axis of a simulated scene; of any other recording nothing says what is up but its camera.
    """
    right, down, forward = recording.camera.world_from_camera[:3, :3].T
    if recording.metadata.scene is not None:
        level = np.array([forward[0], forward[1], 0.0])
        if np.linalg.norm(level) > 1e-3:
            forward, down = level / np.linalg.norm(level), np.array([0.0, 0.0, -1.0])
            right = np.cross(down, forward)
    return np.stack([right, -down, -forward])


def _motion_points(case: Solved, *, observed: bool, most: int) -> Layer:
    """The points of the motions, of whole trajectories, so that none comes and goes."""
    motions = case.motions
    wanted = (motions.observed == observed) & (motions.motion != NOISE)
    step = max(1, -(-int(wanted.sum()) // most))
    rows = np.flatnonzero(wanted & (motions.trajectory % step == 0))
    rows = rows[np.argsort(motions.frame[rows], kind="stable")]
    return Layer(
        frame=motions.frame[rows].astype(int),
        position=motions.position[rows].astype(np.float64),
        motion=_colour_numbers(motions.motion[rows]),
        segment=_colour_numbers(motions.segment[rows]),
        confidence=np.round(255 * np.clip(motions.confidence[rows], 0, 1)).astype(np.uint8),
    )


def _true_points(recording: Recording) -> Layer:
    """The front sides of the moving objects as if nothing stood before them, from the X-ray twins."""
    frames = recording.metadata.frames
    if recording.xray is None or not recording.moving_ids:
        return _plain(np.zeros(0, int), np.zeros((0, 3)), _TRUTH)
    each = max(1, MOST_TRUE // (frames * len(recording.moving_ids)))
    parts = [
        (number, _some(surface_points(recording.camera, depth), each))
        for number, xray in enumerate(tracked(recording.xray, "truth", total=frames))
        for depth in xray.values()
    ]
    frame = np.concatenate([np.full(len(places), number) for number, places in parts])
    return _plain(frame, np.concatenate([places for _, places in parts]), _TRUTH)


def _still_points(case: Solved) -> Layer:
    places = _some(case.still, MOST_STILL)
    return _plain(np.zeros(len(places), int), places, _FAINT)


def _plain(frame: np.ndarray, position: np.ndarray, colour: int) -> Layer:
    """Points of one colour."""
    colours = np.full(len(frame), colour, np.uint8)
    return Layer(
        frame=frame, position=position, motion=colours, segment=colours, confidence=np.full(len(frame), 255, np.uint8)
    )


def _some(places: np.ndarray, most: int) -> np.ndarray:
    """So many of the places at the most, spread evenly over them."""
    return places[np.linspace(0, len(places) - 1, min(most, len(places))).round().astype(int)]


def _colour_numbers(number: np.ndarray) -> UInt8[np.ndarray, "point"]:
    return np.where(number == NOISE, _FAINT, number % len(COLOURS)).astype(np.uint8)


def _starts(layer: Layer, frames: int) -> list[int]:
    """Where each frame begins in the layer, and where the last one ends."""
    return np.searchsorted(layer.frame, np.arange(frames + 1)).tolist()


def _curve(curve: Representative, turn: np.ndarray) -> dict[str, object]:
    """A motion's path: a place each frame, and whether it was observed there."""
    places = curve.position @ turn.T
    return {
        "motion": curve.motion,
        "colour": curve.motion % len(COLOURS),
        "frames": curve.frame.tolist(),
        "places": places.round(3).ravel().tolist(),
        "observed": curve.observed.astype(int).tolist(),
    }


def _shown(places: Float[np.ndarray, "point 3"]) -> dict[str, object]:
    """What the view turns about, and how far it reaches: what moves, strays left out."""
    if not len(places):
        return {"target": [0.0, 0.0, 0.0], "radius": 1.0}
    low, high = np.percentile(places, (1, 99), axis=0)
    return {"target": ((low + high) / 2).round(3).tolist(), "radius": round(float(np.linalg.norm(high - low)) / 2, 3)}
