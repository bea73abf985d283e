"""Scores for people: a few lines with units."""

from collections.abc import Sequence
from typing import Any

_NOTHING = "-"


def summary(scores: dict[str, Any], remarks: Sequence[tuple[str, str]] = ()) -> str:
    """The scores in lines of text, and remarks after them; "-" stands for what cannot be computed."""
    return "\n".join(f"{name:<15} {text}" for name, text in [*summary_rows(scores), *remarks])


def summary_rows(scores: dict[str, Any]) -> list[tuple[str, str]]:
    """The scores, line by line: what each is about, and what is to be said of it."""
    motions, segments, completion = scores["motions"], scores["segments"], scores["completion"]
    identity, links, seconds = scores["identity"], scores["links"], scores["seconds"]
    objects, hidden = _number(scores["objects"]), _number(completion["hidden_object_frames"])
    holes, longest = _number(scores["holes"]), _number(scores["longest_hole_frames"])
    about = f"{scores['scene'] or 'unnamed'}: {scores['frames']} frames"
    points = f"{_number(scores['points_per_frame'], '.0f')} points a frame"
    if scores["objects"] is None:
        return [
            ("recording", f"{about}, {points}; no truth"),
            ("motions", f"{motions['count']}, of {segments['count']} segments"),
            ("time", _time(seconds)),
        ]
    return [
        ("recording", f"{about}, {objects} moving objects"),
        ("", f"{points}; holes: {holes}, longest {longest} frames"),
        ("motions found", f"{_number(motions['found'])} of {objects}, among {_number(motions['count'])} motions"),
        ("purity", f"{_number(motions['purity'], '.3f')}; of segments {_number(segments['purity'], '.3f')}"),
        (
            "inverse purity",
            f"{_number(motions['inverse_purity'], '.3f')}; of segments {_number(segments['inverse_purity'], '.3f')}",
        ),
        ("coverage", _number(scores["coverage"], ".3f")),
        ("identity", f"IDF1 {_number(identity['idf1'], '.3f')}, HOTA {_number(identity['hota'], '.3f')}"),
        ("links", f"precision {_number(links['precision'], '.2f')}, recall {_number(links['recall'], '.2f')}"),
        (
            "centre, hidden",
            f"mean error {_centimetres(completion['centre_mean_m'])}, "
            f"largest {_centimetres(completion['centre_max_m'])}",
        ),
        (
            "points, hidden",
            f"mean error {_centimetres(completion['mean_m'])}, 95 % within {_centimetres(completion['p95_m'])}",
        ),
        (
            "completed",
            f"recall {_number(completion['recall'], '.2f')} of {hidden} hidden object-frames, "
            f"surface within 10 cm {_number(completion['surface_coverage_10cm'], '.2f')}",
        ),
        ("events", _events(scores["events"])),
        ("links hold", _calibration(scores["calibration"], "links")),
        ("points hold", _calibration(scores["calibration"], "completed")),
        ("time", _time(seconds)),
    ]


def _time(seconds: dict[str, float | None]) -> str:
    """What solving takes; the seconds of stages that came from the cache are those that their making took."""
    if seconds["total"] is None:
        return _NOTHING
    return f"{seconds['total']:.1f} s without the cache, of it flow {_number(seconds['flow'], '.1f')} s"


def _events(events: dict[str, Any] | None) -> str:
    if events is None:
        return _NOTHING
    shares = [f"{name} {_number(events.get(name), '.2f')}" for name in ("precision", "recall")]
    return f"{events['count']} told, {events['true']} true, {', '.join(shares)}"


def _calibration(calibration: dict[str, Any] | None, what: str) -> str:
    """The share that holds of what was said with each confidence."""
    tenths = calibration[what] if calibration is not None else []
    said = [
        f"{tenth['share']:.2f} of {tenth['count']} at {tenth['begin']:.1f} to {tenth['end']:.1f}" for tenth in tenths
    ]
    return "; ".join(said) or _NOTHING


def _number(value: float | int | None, form: str = "") -> str:
    return _NOTHING if value is None else format(value, form)


def _centimetres(metres: float | None) -> str:
    return _NOTHING if metres is None else f"{100 * metres:.1f} cm"
