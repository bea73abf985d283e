"""What is to be said of motions beside their scores: why there are none, and what was said by hand."""

import numpy as np

from algorithm.settings import Settings
from algorithm.static import background
from recording.motions import Making, Motions
from recording.over_time import spread_numbers
from recording.recording import Recording

_FEWEST_FRAMES = 3
_LOOKED_AT = 31
"""Frames, spread over the recording, that are enough to say whether anything moves."""
_FEW, _MOST = 0.001, 0.9
"""Share of the returns: where no more move, nothing does; where more do, everything."""


def remarks(recording: Recording, motions: Motions) -> list[tuple[str, str]]:
    """What each is about, and what is to be said of it; empty where nothing is out of the ordinary."""
    said = count_by_hand(motions.making)
    why = [] if motions.motion_ids else [("no motions", why_no_motions(recording, motions))]
    return why + [("corrections", f"{said} by hand")] * (said > 0)


def why_no_motions(recording: Recording, motions: Motions) -> str:
    """Half a sentence that says why no motion was found."""
    tracks, frames = len(np.unique(motions.trajectory)), recording.metadata.frames
    if tracks:
        least = motions.making.settings.get("eps4")
        enough = "enough" if least is None else f"eps4 = {least:g}"
        were = "trajectory was" if tracks == 1 else "trajectories were"
        return f"{tracks} {were} followed, but no motion has {enough} of them"
    if frames < _FEWEST_FRAMES:
        return f"{frames} frame{'s' * (frames > 1)}, too few to follow anything"
    share = _moving_share(recording)
    if share is None:
        return "no frame holds a depth"
    if _FEW < share < _MOST:
        return "what moves is too small, or in sight for too short a time, to be followed"
    return "nothing moves" if share <= _FEW else "all that is seen moves: noise, or a camera that moves"


def count_by_hand(making: Making) -> int:
    """How many corrections by hand the solver respected."""
    return len(making.corrections.correction) if making.corrections is not None else 0


def _moving_share(recording: Recording) -> float | None:
    """The share of the returns, in frames spread over the recording, that do not stand still; None without returns."""
    frames = recording.metadata.frames
    depths = [recording.frames[number].depth for number in spread_numbers(frames, _LOOKED_AT)]
    still = background(depths, tolerance_m=Settings().static_tolerance_m)
    returns = sum(int(np.isfinite(depth).sum()) for depth in depths)
    return sum(int(still.moving(depth).sum()) for depth in depths) / returns if returns else None
