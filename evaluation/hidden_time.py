"""Errors and recall of methods by how long somebody was hidden."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

from evaluation.interval import Interval, mean_interval
from evaluation.outcome import HiddenLength, Outcome, one_group

EDGES_S = (0.0, 0.2, 0.4, 0.8, 1.6, float("inf"))
"""The spans of time hidden that runs of hidden frames are gathered in, seconds; each from its begin up to its end."""


@dataclass(frozen=True, kw_only=True)
class Span:
    """How one method completes the runs of hidden frames that last from `begin_s` to `end_s` seconds.

    Each recording counts once in an interval: with its mean over all hidden object-frames, or points, of the span.
    Over recordings of several groups there are means without intervals.
    """

    method: str
    begin_s: float
    end_s: float
    object_frames: int
    """Hidden object-frames of all recordings."""
    recall: Interval
    points_m: Interval | None
    """Error of completed points, metres."""
    centre_m: Interval | None
    """Error of the motions' places, metres."""

    @property
    def name(self) -> str:
        """The span in words."""
        return f"over {self.begin_s:g} s" if self.end_s == EDGES_S[-1] else f"{self.begin_s:g} to {self.end_s:g} s"


def spans_of(outcomes: Sequence[Outcome]) -> list[Span]:
    """The spans of every method in which something is hidden, by method, then time."""
    spans = []
    alike = one_group(outcomes)
    for method in dict.fromkeys(outcome.method for outcome in outcomes):
        own = [outcome for outcome in outcomes if outcome.method == method]
        for begin, end in pairwise(EDGES_S):
            parts = [[row for row in one.by_length if begin <= row.seconds < end] for one in own]
            parts = [part for part in parts if part]
            recall = mean_interval(
                [_mean(part, lambda row: row.recall, lambda row: row.object_frames) for part in parts], alike=alike
            )
            if recall is not None:
                spans.append(
                    Span(
                        method=method,
                        begin_s=begin,
                        end_s=end,
                        object_frames=sum(row.object_frames for part in parts for row in part),
                        recall=recall,
                        points_m=mean_interval(
                            [_mean(part, _points_m, lambda row: row.points) for part in parts], alike=alike
                        ),
                        centre_m=mean_interval(
                            [_mean(part, _centre_m, lambda row: row.centres) for part in parts], alike=alike
                        ),
                    )
                )
    return spans


def _points_m(row: HiddenLength) -> float | None:
    return row.mean_m


def _centre_m(row: HiddenLength) -> float | None:
    return row.centre_mean_m


def _mean(
    rows: Sequence[HiddenLength], value: Callable[[HiddenLength], float | None], weight: Callable[[HiddenLength], int]
) -> float | None:
    """The weighted mean of the rows that have a value; None without any."""
    known = [(found, weight(row)) for row in rows if (found := value(row)) is not None]
    total = sum(part for _, part in known)
    return sum(found * part for found, part in known) / total if total else None
