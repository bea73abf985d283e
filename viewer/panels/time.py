"""The panel of time: play, pause, scrub, step; and when each motion is seen or hidden."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import UInt8

from recording.motions import Representative
from recording.palette import rgb_of
from viewer.colours import pale
from viewer.lines import presence
from viewer.panels.desk import Desk
from viewer.playback import SPEEDS

_LEAP_SECONDS = 1.0
_WIDTH_PX, _ROWS_PX, _GAP_PX = 600, 90, 2
_LEAST_PX, _MOST_PX = 5, 16
"""Height of a row; there are as many as motions, in about `_ROWS_PX` together."""
_STEPS = ("|\u25c0", "\u25c0", "\u25b6", "\u25b6|")
_CURSOR = 0


def time_panel(desk: Desk) -> None:
    """A slider over the frames, buttons and keys for play and steps, and a strip that shows who is seen when."""
    gui, session, playback = desk.gui, desk.session, desk.session.playback
    last, leap = session.frames - 1, max(round(_LEAP_SECONDS * session.recording.fps), 1)
    frame = gui.add_slider("Frame", min=0, max=max(last, 1), step=1, initial_value=0, hint="Left and right: J and L")
    play = gui.add_button("Play", hint="Space")
    steps = gui.add_button_group("Step", _STEPS, hint="First, one back, one on, last frame")
    speed = gui.add_dropdown("Speed", [_times(each) for each in SPEEDS], initial_value=_times(playback.speed))
    strip = gui.add_image(_strip(desk), label="Motions over time", format="png")
    jumps = dict(
        zip(
            _STEPS,
            (
                lambda: playback.go_to(0),
                lambda: playback.step(-1),
                lambda: playback.step(1),
                lambda: playback.go_to(last),
            ),
            strict=True,
        )
    )

    def moved() -> None:
        desk.set(frame, session.frame)
        strip.image = _strip(desk)

    def played() -> None:
        play.label = "Pause" if playback.playing else "Play"

    desk.when_set(frame, playback.go_to)
    desk.when_set(speed, lambda text: playback.set_speed(float(text.rstrip("\u00d7"))))
    play.on_click(lambda _: session.post(lambda: playback.play(not playback.playing)))
    steps.on_click(lambda event: session.post(jumps[event.target.value]))
    for signal in (playback.moved, session.answered, session.picked_changed):
        signal.connect(moved)
    playback.playing_changed.connect(played)
    desk.on_key("Play or pause", "space", lambda: playback.play(not playback.playing))
    desk.on_key("One frame back", "J", lambda: playback.step(-1))
    desk.on_key("One frame on", "L", lambda: playback.step(1))
    desk.on_key("One second back", "J", lambda: playback.step(-leap), modifier="shift")
    desk.on_key("One second on", "L", lambda: playback.step(leap), modifier="shift")
    desk.on_key("First frame", "home", lambda: playback.go_to(0))
    desk.on_key("Last frame", "end", lambda: playback.go_to(last))


def _times(speed: float) -> str:
    return f"{speed:g}\u00d7"


def _strip(desk: Desk) -> UInt8[np.ndarray, "row column 3"]:
    """The motions over time with a line at the frame that is shown."""
    session = desk.session
    return time_strip(session.answer.curves if session.answer else (), session.frames, session.frame)


def time_strip(curves: Sequence[Representative], frames: int, frame: int) -> UInt8[np.ndarray, "row column 3"]:
    """A row a motion: its colour where it is seen, pale where it was completed, white where it is not; and a cursor."""
    table = presence(curves, frames)
    colours = rgb_of(np.array([curve.motion for curve in curves], int))[:, None]
    light = pale(colours.reshape(-1, 3), np.ones(len(curves), bool))[:, None]
    row = np.where((table == 2)[..., None], colours, np.where((table == 1)[..., None], light, 255)).astype(np.uint8)
    column = np.arange(_WIDTH_PX) * frames // _WIDTH_PX
    height = min(max(_ROWS_PX // max(len(curves), 1), _LEAST_PX), _MOST_PX)
    wide = np.repeat(row[:, column], height, axis=0)
    wide[np.arange(len(wide)) % height >= height - _GAP_PX] = 255
    picture = np.concatenate([wide, np.full((_GAP_PX + 1, _WIDTH_PX, 3), 255, np.uint8)])
    cursor = int((frame + 0.5) * _WIDTH_PX / frames)
    picture[:, max(cursor - 1, 0) : cursor + 1] = _CURSOR
    return picture
