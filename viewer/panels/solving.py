"""The panel of settings: sliders for the epsilons, which solve anew, and what that does to the scores."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any, get_args

from algorithm.settings import Preset, Settings, changed_settings
from algorithm.stages import stage_of
from evaluation.methods import settings_of
from evaluation.report.definitions import NOTHING, dotted, meaning_of
from evaluation.scores import Scores
from viewer.answer import Answer
from viewer.panels.desk import Desk
from viewer.session import Session
from viewer.wish import command

_SCORES = (
    "motions.found",
    "motions.count",
    "segments.count",
    "motions.purity",
    "motions.inverse_purity",
    "coverage",
    "identity.idf1",
    "links.precision",
    "links.recall",
    "completion.recall",
    "completion.centre_mean_m",
    "completion.mean_m",
)

_DIGITS = 6


@dataclass(frozen=True, kw_only=True)
class Dial:
    """How a setting is dialled."""

    low: float
    high: float
    step: float
    unit: str


DIALS: Mapping[str, Dial] = {
    "eps1": Dial(low=0.1, high=5.0, step=0.1, unit="spacings"),
    "eps2": Dial(low=0.0, high=0.5, step=0.01, unit="m"),
    "eps3": Dial(low=0.5, high=50.0, step=0.5, unit="traj_sim"),
    "eps4": Dial(low=0.0, high=100.0, step=1.0, unit="trajectories"),
    "eps5": Dial(low=1.0, high=20.0, step=1.0, unit="every n-th"),
    "eps6": Dial(low=0.01, high=1.0, step=0.01, unit="m"),
}


def idle(settings: Settings) -> dict[str, str]:
    """The epsilons that have no effect under the settings, with the reason."""
    found: dict[str, str] = {}
    if settings.clustering == "common_fate":
        found |= dict.fromkeys(("eps3", "eps5"), "not for the clustering common_fate")
    if settings.completing == "continuation":
        found["eps6"] = "only for the completing bottom_up"
    return found


def solving_panel(desk: Desk) -> None:
    """The preset, a slider for each epsilon, the scores before and now, and the command that does the same."""
    gui, session = desk.gui, desk.session
    preset = gui.add_dropdown("Preset", get_args(Preset), initial_value=session.settings.preset)
    sliders = {name: _slider(desk, name, dial) for name, dial in DIALS.items()}
    status = gui.add_markdown(session.status)
    solve = gui.add_button("Solve", visible=session.answer is None, hint="This recording has no motions yet")
    reset = gui.add_button("As opened", hint="The settings that the viewer was opened with")
    table = gui.add_markdown("")

    def changed() -> None:
        without = idle(session.settings)
        desk.set(preset, session.settings.preset)
        for name, slider in sliders.items():
            desk.set(slider, getattr(session.settings, name))
            slider.disabled = name in without

    def told() -> None:
        status.content = f"*{session.status}*" if session.status else ""

    def scored() -> None:
        solve.visible = session.answer is None
        table.content = scores_table(session.opened, session.answer) + command_text(session)

    desk.when_set(preset, lambda name: session.want(settings_of(session.recording, name)))
    for name, slider in sliders.items():
        desk.when_set(slider, partial(_dial, desk, name))
    solve.on_click(lambda _: session.post(session.solve))
    reset.on_click(lambda _: session.post(session.reset))
    session.settings_changed.connect(changed)
    session.status_changed.connect(told)
    for signal in (session.judged, session.settings_changed, session.corrections_changed):
        signal.connect(scored)
    changed()
    scored()


def _slider(desk: Desk, name: str, dial: Dial) -> Any:
    value = getattr(desk.session.settings, name)
    number = type(value)  # A whole number's dial turns in whole numbers.
    says = Settings.model_fields[name].description or ""
    return desk.gui.add_slider(
        f"{name} [{dial.unit}]",
        min=number(min(dial.low, value)),
        max=number(max(dial.high, value)),
        step=number(dial.step),
        initial_value=value,
        hint=f"{says} Solves anew from: {stage_of(name)}.",
    )


def _dial(desk: Desk, name: str, value: float) -> None:
    told = round(value, _DIGITS)  # The page counts steps in halves, quarters and so on, and misses by a trifle.
    desk.session.want(changed_settings(desk.session.settings, {name: told}, source="slider"))


def scores_table(opened: Answer | None, now: Answer | None) -> str:
    """The scores of the motions as opened, those of the motions now, and the change, as Markdown."""
    before, after = _scores(opened), _scores(now)
    if not after:
        return ""
    lines = ["| | opened | now | change |", "| --- | --- | --- | --- |"]
    for key in _SCORES:
        meaning, old, new = meaning_of(key), before.get(key), after.get(key)
        change = "" if old is None or new is None or old == new else f"**{_signed(meaning.text(new - old))}**"
        lines.append(
            f"| {meaning.name} | {meaning.text(old) if before else NOTHING} | {meaning.text(new)} | {change} |"
        )
    return "\n".join(lines)


def _scores(answer: Answer | None) -> Scores:
    return dotted(answer.judgement.scores) if answer and answer.judgement else {}


def _signed(text: str) -> str:
    return text if text.startswith("-") else f"+{text}"


def command_text(session: Session) -> str:
    """The command line that solves alike, as Markdown."""
    path = session.file.path if session.file is not None else None
    return f"\n\nTo solve alike, RECORDING being the folder:\n\n`{command(session.wish, session.recording, path)}`"
