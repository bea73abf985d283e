"""The panel of layers: what is shown, in which colours, how large."""

from collections.abc import Mapping
from functools import partial

from viser import GuiCheckboxHandle

from viewer.colours import COLOURINGS, legend
from viewer.panels.desk import Desk

_WORDS: Mapping[str, tuple[str, str]] = {
    "still": ("Background", "What stands still"),
    "sensed": ("Sensed", "All points that the sensor saw"),
    "truth": ("Truth", "X-ray: the front side of everything that moves, hidden or not"),
    "observed": ("Observed", "Points that were followed while they were seen; those of no motion are grey"),
    "intra": ("Intra", "Points completed between trajectories of one segment"),
    "inter": ("Inter", "Points completed between segments"),
    "representatives": ("Curves", "The representative of each motion, dashed where it was completed"),
    "motions": ("Motions", "A box about each motion, and its name"),
    "segments": ("Segments", "The path of each segment, and its number where it begins"),
    "holes": ("Holes", "The true paths of what is hidden; without truth, the completed parts of the curves"),
    "camera": ("Camera", "The camera and its depth image"),
}
"""Name and meaning of each layer; the keys B, 1 to 9 and 0 switch them in this order."""
_KEYS = "B1234567890"


def layers_panel(desk: Desk) -> None:
    """A box to tick for each layer, the colouring with its legend, the size of points."""
    gui, session, scene = desk.gui, desk.session, desk.scene
    colour = gui.add_dropdown("Colour by", COLOURINGS, initial_value=session.colouring, hint="C: the next one")
    meaning = gui.add_html(legend(scene.shades))
    for (name, (words, says)), key in zip(_WORDS.items(), _KEYS, strict=True):
        there = name != "truth" or session.recording.xray is not None
        box = gui.add_checkbox(
            words,
            scene.shown[name],
            disabled=not there,
            hint=f"{says} (key {key})" if there else "This recording has none",
        )

        def flip(name: str = name, box: GuiCheckboxHandle = box) -> None:
            scene.show(name, not scene.shown[name])
            desk.set(box, scene.shown[name])

        desk.when_set(box, partial(scene.show, name))
        if there:
            desk.on_key(f"Show or hide: {words}", key, flip)
    size = gui.add_slider("Points [mm]", min=1, max=100, step=1, initial_value=_clipped(1000 * scene.point_m))
    desk.when_set(size, lambda millimetres: scene.resize(millimetres / 1000))
    desk.when_set(colour, session.colour_by)

    def recoloured() -> None:
        desk.set(colour, session.colouring)
        meaning.content = legend(scene.shades)

    def next_colouring() -> None:
        session.colour_by(COLOURINGS[(COLOURINGS.index(session.colouring) + 1) % len(COLOURINGS)])

    session.recoloured.connect(recoloured)
    desk.on_key("Next colouring", "C", next_colouring)


def _clipped(millimetres: float) -> int:
    return int(min(max(round(millimetres), 1), 100))
