"""The panel of one motion: its numbers, what the truth says of it, and the links that were made or might have been."""

from collections.abc import Sequence

import numpy as np

from recording.motions import INTER, INTRA, OBSERVED, Link
from viewer.answer import Answer, Match
from viewer.lines import links_of
from viewer.panels.desk import Desk

_NONE = "none"
_HINT = "Click on a point in the scene, or choose a motion here. Escape lets it go."


def motion_panel(desk: Desk) -> None:
    """A list of the motions, and what is known of the picked one."""
    gui, session = desk.gui, desk.session
    chosen = gui.add_dropdown("Motion", _names(session.answer), initial_value=_NONE, hint=_HINT)
    numbers = gui.add_markdown(_HINT)

    def renamed() -> None:
        chosen.options = _names(session.answer)
        picked()

    def picked() -> None:
        answer, motion = session.answer, session.picked
        if answer is None or motion is None:
            desk.set(chosen, _NONE)
            numbers.content = _HINT
        else:
            desk.set(chosen, answer.name(motion))
            numbers.content = numbers_of(answer, motion, session.recording.fps)

    def choose(name: str) -> None:
        answer = session.answer
        named = {answer.name(motion): motion for motion in answer.motions.motion_ids} if answer else {}
        session.pick(named.get(name))

    desk.when_set(chosen, choose)
    session.judged.connect(renamed)
    session.picked_changed.connect(picked)
    desk.on_key("Let the picked motion go", "escape", lambda: session.pick(None))


def _names(answer: Answer | None) -> list[str]:
    return [_NONE, *map(answer.name, answer.motions.motion_ids)] if answer else [_NONE]


def numbers_of(answer: Answer, motion: int, fps: float) -> str:
    """What is known of a motion, as Markdown."""
    motions = answer.motions
    rows = motions.rows(motions.motion == motion)
    points = np.bincount(rows.source, minlength=3)
    segments = np.unique(rows.segment[rows.observed]).tolist()
    lines = [
        ("segments", ", ".join(map(str, segments))),
        ("points observed", f"{points[OBSERVED]:,}"),
        ("completed, intra", f"{points[INTRA]:,}"),
        ("completed, inter", f"{points[INTER]:,}"),
        *_course(answer, motion, fps),
    ]
    match = answer.judgement.matches.get(motion) if answer.judgement else None
    if match is not None:
        lines += _truth(match)
    return _table(("", ""), lines) + "\n\n" + _links(links_of(motions, motion), set(segments))


def _course(answer: Answer, motion: int, fps: float) -> list[tuple[str, str]]:
    """When and how far the motion goes, by its representative."""
    curve = next((curve for curve in answer.curves if curve.motion == motion), None)
    if curve is None or not len(curve.frame):
        return []
    way = float(np.linalg.norm(np.diff(curve.position, axis=0), axis=1).sum())
    seconds = float(curve.frame[-1] - curve.frame[0]) / fps
    speed = f" ({way / seconds:.2f} m/s)" if seconds > 0 else ""
    return [
        ("frames", f"{curve.frame[0]} to {curve.frame[-1]}"),
        ("of them completed", str(int((~curve.observed).sum()))),
        ("way", f"{way:.1f} m{speed}"),
    ]


def _truth(match: Match) -> list[tuple[str, str]]:
    error = 100 * match.hidden.error_m
    hidden = f"mean {error.mean():.1f} cm, largest {error.max():.1f} cm" if len(error) else "never hidden"
    return [
        ("object", f"{match.name} (F {match.f:.2f})"),
        ("centre while hidden", hidden),
        ("hidden frames", str(len(error))),
    ]


def _links(links: list[Link], own: set[int]) -> str:
    if not links:
        return "No candidate links."
    rows = [
        (
            f"{_bold(link.before, own)} \u2192 {_bold(link.after, own)}",
            f"{link.confidence:.2f}",
            "made" if link.chosen else "not made",
        )
        for link in links
    ]
    return "Candidate links between segments; in the scene green where made, dashed where not:\n\n" + _table(
        ("link", "confidence", ""), rows
    )


def _bold(segment: int, own: set[int]) -> str:
    return f"**{segment}**" if segment in own else str(segment)


def _table(head: tuple[str, ...], rows: Sequence[tuple[str, ...]]) -> str:
    lines = [head, ("---",) * len(head), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)
