"""What was run and how: the recording, the settings, the versions, the time."""

from typing import Any

from algorithm.settings import Settings
from evaluation.methods import settings_of
from evaluation.remarks import count_by_hand
from evaluation.report.definitions import NOTHING
from evaluation.report.page import Bars, Block, Fold, Section, Table, Text
from recording.motions import Making
from recording.recording import Recording

_STAGES = {
    "flow": "optical flow",
    "match": "matching of points",
    "trajectories": "trajectories",
    "affinity": "affinity",
    "clustering": "clustering",
    "completion": "links and completion",
}
"""Names of the stages whose times are told."""
_SHOWN_DIGITS = 16
"""Of a digest."""


def making_section(recording: Recording, making: Making) -> Section:
    """What was run: recording, versions, digests, settings."""
    known = recording.metadata
    sensor = (known.sensor or {}).get("preset")
    rows = (
        ("recording", known.name or "unnamed"),
        ("frames", f"{known.frames}, {known.fps:g} a second, {known.frames / known.fps:.2f} s"),
        ("picture", f"{known.width} x {known.height} pixels"),
        ("sensor", str(sensor) if sensor else NOTHING),
        ("seed", NOTHING if known.seed is None else str(known.seed)),
        ("recording made by", known.made_by or NOTHING),
        ("recording digest", making.recording_digest or NOTHING),
        ("scene digest", _short(known.scene_digest)),
        ("solved by", f"Unocclude {making.version}" if making.version else NOTHING),
        ("preset", str(making.settings.get("preset", NOTHING))),
        ("corrections by hand", str(count_by_hand(making))),
    )
    blocks: list[Block] = [_table("Recording and solver", ("what", "value"), rows)]
    return Section(key="making", title="What was run", blocks=(*blocks, *_settings_blocks(recording, making.settings)))


def seconds_section(making: Making) -> Section | None:
    """The time of each stage; None where the motions do not tell it."""
    known = {name: making.seconds[key] for key, name in _STAGES.items() if key in making.seconds}
    total = making.seconds.get("total", sum(known.values()))
    rest = total - sum(known.values())
    if rest > 0.05 * total:
        known["everything else"] = rest
    longest = max(known.values(), default=0.0)
    if longest <= 0:
        return None
    items = tuple(
        (name, f"{value:.1f} s, {100 * value / total:.0f} %", value / longest) for name, value in known.items()
    )
    caption = f"Seconds of wall clock by stage without the cache, {total:.1f} s in all"
    return Section(key="seconds", title="Time by stage", blocks=(Bars(caption=caption, items=items),))


def _settings_blocks(recording: Recording, settings: dict[str, Any]) -> tuple[Block, ...]:
    if not settings:
        return (Text(words="The motions do not say with which settings they were made."),)
    name = settings.get("preset")
    if name not in ("default", "paper"):
        rows = tuple((key, str(value)) for key, value in sorted(settings.items()))
        return (Fold(title="All settings", blocks=(_table("Settings", ("setting", "value"), rows),)),)
    usual = settings_of(recording, name).model_dump()
    changed = tuple(
        (key, str(value), str(usual.get(key, NOTHING)), _effect(key))
        for key, value in settings.items()
        if usual.get(key) != value
    )
    every = tuple((key, str(value), _effect(key)) for key, value in settings.items())
    differing: Block = Text(words=f"All settings are those of the preset {name}.")
    if changed:
        head = ("setting", "value", f"in the preset {name}", "effect")
        differing = Table(
            caption="Settings that differ from the preset's", head=head, rows=changed, words=frozenset({3})
        )
    listed = Table(caption="Settings", head=("setting", "value", "effect"), rows=every, words=frozenset({2}))
    return differing, Fold(title=f"All {len(every)} settings", blocks=(listed,))


def _effect(key: str) -> str:
    """What a setting does; nothing is known of one that there is no more."""
    field = Settings.model_fields.get(key)
    return NOTHING if field is None else " ".join((field.description or "").split())


def _table(caption: str, head: tuple[str, str], rows: tuple[tuple[str, str], ...]) -> Table:
    return Table(caption=caption, head=head, rows=rows, words=frozenset({1}))


def _short(digest: str | None) -> str:
    return NOTHING if digest is None else digest[:_SHOWN_DIGITS]
