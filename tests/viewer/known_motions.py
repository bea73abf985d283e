"""Motions that are written down, not solved: two, one of them with a hole."""

import numpy as np

from recording.motions import INTER, NOISE, OBSERVED, Link, Motions, Representative

FRAMES = 6


def two_motions() -> Motions:
    """Motion 0 is seen in all frames as segment 0; motion 1 as segments 1 and 2, and completed between them.

    One more point is noise. All places are whole numbers of metres: x counts frames, z trajectories.
    """
    rows = [(frame, 0, 0, 0, OBSERVED) for frame in range(FRAMES)]
    rows += [(0, 1, 1, 1, OBSERVED), (1, 1, 1, 1, OBSERVED)]
    rows += [(2, 1, 1, 1, INTER), (3, 1, 1, 1, INTER)]
    rows += [(4, 1, 2, 1, OBSERVED), (5, 1, 2, 1, OBSERVED)]
    rows += [(0, 2, NOISE, NOISE, OBSERVED)]
    frame, trajectory, segment, motion, source = np.array(rows).T
    seen = source == OBSERVED
    return Motions(
        frame=frame.astype(np.int32),
        trajectory=trajectory.astype(np.int32),
        position=np.stack([frame, 0 * frame, trajectory], axis=1).astype(np.float32),
        column_row=np.where(seen[:, None], 1.5, np.nan).repeat(2, axis=1).astype(np.float32),
        segment=segment.astype(np.int32),
        motion=motion.astype(np.int32),
        source=source.astype(np.uint8),
        confidence=np.ones(len(rows), np.float32),
        representatives=tuple(_representative(number) for number in range(2)),
        links=(Link(before=1, after=2, confidence=0.9),),
        alternatives=(Link(before=0, after=2, confidence=0.2, chosen=False),),
    )


def _representative(motion: int) -> Representative:
    frame = np.arange(FRAMES)
    observed = np.ones(FRAMES, bool)
    observed[2:4] = motion == 0
    position = np.stack([frame, 0 * frame, np.full(FRAMES, motion)], axis=1).astype(float)
    return Representative(motion=motion, frame=frame.astype(np.int32), position=position, observed=observed)
