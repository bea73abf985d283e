"""The occlusion that a recording has achieved, by the tallies of its frames."""

from collections import Counter
from collections.abc import Sequence

import numpy as np

from recording.causes import NOT_HIDDEN, OUT_OF_VIEW, SENSOR, Causes, Tally, causes_from
from recording.metadata import Metadata
from recording.occlusion import Achieved, Hiders, Holes, Nearness
from recording.visibility import runs_of

_DIGITS = 6
_HIDERS = {"person": "people", "juggler": "people", "ball": "balls"}
"""By the kind of an object; all others are obstacles."""


def achieved_occlusion(tallies: Sequence[Tally], metadata: Metadata, *, clearance_m: Nearness) -> Achieved:
    """What the frames with these tallies, in their order, have come to."""
    causes = causes_from(tallies, metadata)
    in_view = int(np.sum(causes.cause != OUT_OF_VIEW))
    hidden = int(np.sum(_is_hidden(causes)))
    return Achieved(
        object_frames=in_view,
        hidden_object_frames=hidden,
        hidden_share=round(hidden / in_view, _DIGITS) if in_view else None,
        hole_frames=_holes(causes),
        by=_hiders(causes, metadata),
        clearance_m=clearance_m,
    )


def _is_hidden(causes: Causes) -> np.ndarray:
    return (causes.cause != NOT_HIDDEN) & (causes.cause != OUT_OF_VIEW)


def _holes(causes: Causes) -> Holes:
    runs = runs_of(causes.ids, hidden=_is_hidden(causes), in_view=causes.unoccluded > 0)
    lengths = sorted(run.frames for run in runs if run.hole)
    if not lengths:
        return Holes(count=0, lengths=())
    lower, median, upper = np.quantile(lengths, [0.25, 0.5, 0.75]).tolist()
    return Holes(
        count=len(lengths),
        median=median,
        lower_quartile=lower,
        upper_quartile=upper,
        longest=lengths[-1],
        lengths=tuple(lengths),
    )


def _hiders(causes: Causes, metadata: Metadata) -> Hiders | None:
    kind = {entry.id: _HIDERS.get(entry.kind, "obstacles") for entry in metadata.objects or ()} | {SENSOR: "sensor"}
    by = Counter(kind[cause] for cause in causes.cause[_is_hidden(causes)].tolist())
    shares = {name: round(by[name] / by.total(), _DIGITS) for name in Hiders.model_fields} if by else None
    return None if shares is None else Hiders(**shares)
