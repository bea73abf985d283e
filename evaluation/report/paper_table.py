"""The page of Table 1: the folder that `unocclude table1` leaves."""

import csv
from collections.abc import Mapping
from pathlib import Path

from evaluation.figures.scenes import crowd_figure
from evaluation.figures.stages import Solved
from evaluation.report.definitions import NOTHING
from evaluation.report.images import drawn
from evaluation.report.page import Card, Cards, Page, Picture, Section, Table
from evaluation.table1_text import COUNTED, FOUND
from recording.errors import InputError
from recording.parquet import load_motions
from recording.progress import tracked
from recording.store import load_recording

TABLE1 = "table1.csv"
Record = Mapping[str, str]
_PRINTED = 7.0
_SHOWN_DIGITS = 16
"""Of a digest."""
_COUNTS = {
    "frames": ("Fr", "paper_frames"),
    "points": ("Pts", "paper_points_least"),
    "objects": ("Obj", "paper_objects"),
    "static": ("Stat", "paper_static"),
    "holes": ("Occ", "paper_holes"),
    "longest_hole_frames": ("Max Occ", "paper_longest_hole_frames"),
}
"""Our column -> its name in the paper, and the paper's column."""
_NEEDED = {"test", "scene", "missed", "preset", "motions_found", *_COUNTS}


def table1_page(folder: Path) -> Page:
    """Scenes with what was found in them, the worst first; what the scenes hold; what each preset finds."""
    records = _records(folder / TABLE1)
    presets = list(dict.fromkeys(record["preset"] for record in records if record["preset"]))
    scenes = {record["scene"]: record for record in records}
    found = tuple(_found_table(preset, [one for one in records if one["preset"] == preset]) for preset in presets)
    ordered = sorted((record for record in records if record["preset"]), key=_badness)
    worst = list({record["scene"]: record for record in reversed(ordered)}.values())[::-1]
    cards = tuple(_card(folder, record) for record in tracked(worst, "drawing", total=len(worst)))
    return Page(
        title="Table 1, the paper's and ours",
        subtitle=f"{len(scenes)} scenes, {'presets ' + ' and '.join(presets) if presets else 'nothing solved'}",
        sections=(
            *([_cards_section(cards)] if cards else []),
            Section(key="holds", title="What the scenes hold", lead=COUNTED, blocks=(_counts_table(scenes),)),
            *([Section(key="found", title="What is found", lead=FOUND, blocks=found)] if found else []),
            _making_section(folder, records),
        ),
    )


def _cards_section(cards: tuple[Card, ...]) -> Section:
    return Section(
        key="failures",
        title="Failures first",
        lead="Each scene under the preset that does worst on it; fewest objects found first, then the largest error.",
        blocks=(Cards(items=cards),),
    )


def _records(path: Path) -> list[Record]:
    try:
        with path.open(encoding="utf-8", newline="") as file:
            records: list[Record] = [{"preset": "", "motions_found": "", **record} for record in csv.DictReader(file)]
    except (OSError, UnicodeDecodeError):
        raise InputError(f"{path}: expected what 'unocclude table1' writes: make the table again") from None
    missing = next((name for name in sorted(_NEEDED) if any(name not in record for record in records)), None)
    if missing is not None or not records:
        raise InputError(f"{path}: expected what 'unocclude table1' writes, got no {missing or 'rows'}: make it again")
    return records


def _badness(record: Record) -> tuple[float, float]:
    found, objects = _value(record, "motions_found"), _value(record, "objects")
    centre = _value(record, "centre_mean_m")
    share = -1.0 if found is None or not objects else found / objects
    return share, 0.0 if centre is None else -centre


def _card(folder: Path, record: Record) -> Card:
    found, objects = record["motions_found"] or "0", record["objects"]
    words = [f"{found} of {objects} objects found, among {record.get('motions') or NOTHING} motions"]
    words += [f"centre of the hidden off by {_centimetres(record, 'centre_mean_m')} on average"]
    words += [record["failure"]] if record.get("failure") else []
    words += [f"missed: {record['missed'].replace('_', ' ')}"] if record["missed"] else []
    return Card(
        title=f"{record['test']}, preset {record['preset']}",
        words="; ".join(words) + ".",
        picture=_picture(folder, record),
        bad=found != objects,
    )


def _picture(folder: Path, record: Record) -> Picture | None:
    """The scene from input to completed motion; none where the folder does not hold its recording and motions."""
    place = folder / record["scene"]
    motions = _motions_path(folder, record)
    if not (place / "recording.json").is_file() or not motions.is_file():
        return None
    case = Solved(recording=load_recording(place), motions=load_motions(motions))
    alt = f"{record['test']}: input frames, segments, curves of the motions, completed motion."
    return drawn(lambda: crowd_figure([case]), alt=alt, letters=_PRINTED)


def _counts_table(scenes: Mapping[str, Record]) -> Table:
    rows = tuple(
        (
            record["test"],
            record["scene"],
            *(f"{_printed(record, paper)} / {_whole(record, own)}" for own, (_, paper) in _COUNTS.items()),
            record["missed"].replace("_", " ") or NOTHING,
        )
        for record in scenes.values()
    )
    head = ("test", "scene", *(name for name, _ in _COUNTS.values()), "missed")
    return Table(caption="The paper's number / ours", head=head, rows=rows)


def _found_table(preset: str, records: list[Record]) -> Table:
    rows = tuple(
        (
            record["test"],
            f"{record['paper_segments']} / {record['segments'] or NOTHING}",
            *(f"{record[f'paper_{one}']} / {_number(record, f'{one}_s', 1)}" for one in ("flow", "total")),
            *(_number(record, f"eps{number}", None) for number in range(1, 6)),
            f"{record['motions_found'] or NOTHING} of {record['objects']}",
            record["motions"] or NOTHING,
            _number(record, "purity", 3),
            _number(record, "inverse_purity", 3),
            *(_centimetres(record, name) for name in ("centre_mean_m", "centre_max_m", "points_mean_m")),
        )
        for record in records
    )
    head = (
        *("test", "Seg", "Flow [s]", "Total [s]", "e1", "e2", "e3", "e4", "e5", "found", "motions"),
        *("purity", "inverse", "centre, mean", "centre, largest", "points, mean"),
    )
    return Table(caption=f"Preset {preset}", head=head, rows=rows)


def _making_section(folder: Path, records: list[Record]) -> Section:
    """What the motions in the folder say of their making."""
    rows = []
    for record in records:
        place = _motions_path(folder, record)
        if place.is_file():
            making = load_motions(place).making
            digest = (making.recording_digest or NOTHING)[:_SHOWN_DIGITS]
            rows.append((record["test"], record["preset"], making.version or NOTHING, digest))
    head = ("test", "preset", "version", "recording digest")
    words = "Settings not listed above are those of the preset."
    table = Table(caption="Motions", head=head, rows=tuple(rows), words=frozenset({1}))
    return Section(key="making", title="What was run", lead=words, blocks=(table,))


def _motions_path(folder: Path, record: Record) -> Path:
    return folder / record["scene"] / f"motions_{record['preset']}.parquet"


def _value(record: Record, key: str) -> float | None:
    try:
        return float(record.get(key) or "")
    except ValueError:
        return None


def _printed(record: Record, key: str) -> str:
    """The paper's number; of points a range where it prints one."""
    least, most = record[key], record.get(key.replace("least", "most"))
    return (least if most in (None, least) else f"{least} to {most}") or NOTHING


def _whole(record: Record, key: str) -> str:
    return _number(record, key, 0)


def _number(record: Record, key: str, digits: int | None) -> str:
    value = _value(record, key)
    if value is None:
        return NOTHING
    return f"{value:g}" if digits is None else f"{value:.{digits}f}"


def _centimetres(record: Record, key: str) -> str:
    value = _value(record, key)
    return NOTHING if value is None else f"{100 * value:.1f} cm"
