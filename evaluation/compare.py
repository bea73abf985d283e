"""Methods side by side on any list of recordings: the same scores for all, by several processes, resumable."""

import os
from collections.abc import Mapping, Sequence
from contextlib import closing
from pathlib import Path

from evaluation.gap_closing import require_laptrack
from evaluation.methods import METHODS
from evaluation.outcome import Contest, Outcome
from recording.checks import lack_of, nearest_name
from recording.errors import InputError
from recording.manifest import MANIFEST, load_manifest
from recording.progress import tracked
from recording.workers import reported


def compared(
    recordings: Sequence[Path],
    folder: Path,
    *,
    methods: Sequence[str] = tuple(METHODS),
    elsewhere: Mapping[str, Path] | None = None,
    workers: int = 1,
    overwrite: bool = False,
) -> list[Outcome]:
    """The outcomes of every method on every recording, by recording, then method.

    `elsewhere` are methods that only write files: the folder of each holds `<recording>.parquet` or
    `<recording>/motions.parquet`. Outcomes are kept below `folder`, and those that hold are used again.
    """
    elsewhere = elsewhere or {}
    _check_methods(methods, elsewhere)
    labels = labelled(recordings)
    everyone = (*elsewhere, *methods)
    parts = max(1, workers // max(len(labels), 1))
    tasks = [
        Contest(
            place=place,
            label=label,
            methods=everyone[part::parts],
            files={name: _file_of(name, elsewhere[name], label) for name in elsewhere},
            folder=folder,
            overwrite=overwrite,
        )
        for label, place in labels.items()
        for part in range(min(parts, len(everyone)))
    ]
    with closing(reported(tasks, at_once=workers)) as outcomes:
        found = list(tracked(outcomes, "comparing", total=len(labels) * len(everyone)))
    order = list(labels), [*methods, *elsewhere]
    return sorted(found, key=lambda one: (order[0].index(one.recording), order[1].index(one.method)))


def labelled(recordings: Sequence[Path]) -> dict[str, Path]:
    """The recordings by their place below the folder that all of them lie in; a data set stands for all of its own."""
    places = [place.resolve() for given in recordings for place in _expanded(given)]
    if not places:
        raise InputError("expected at least one recording, got none: try 'unocclude compare recordings/wall'")
    above = Path(os.path.commonpath([place.parent for place in places]))
    labels = {place.relative_to(above).as_posix(): place for place in places}
    if len(labels) < len(places):
        raise InputError("expected every recording once, got one of them several times")
    return labels


def _expanded(given: Path) -> list[Path]:
    if (given / MANIFEST).is_file():
        return [given / entry.name for entry in load_manifest(given).recordings]
    if not (given / "recording.json").is_file():
        raise InputError(f"{given}: expected a recording or a data set, but {lack_of('recording.json', given)}")
    return [given]


def _check_methods(methods: Sequence[str], elsewhere: Mapping[str, Path]) -> None:
    wrong = next((name for name in methods if name not in METHODS), None)
    if wrong is not None:
        raise InputError(f"--methods: unknown method {wrong!r}, {nearest_name(wrong, METHODS)}")
    twice = next((name for name in methods if methods.count(name) > 1), None)
    if twice is not None:
        raise InputError(f"--methods: expected every method once, got {twice!r} several times")
    ours = next((name for name in elsewhere if name in METHODS), None)
    if ours is not None:
        raise InputError(f"--motions: {ours!r} is one of our methods: choose another name")
    if not methods and not elsewhere:
        raise InputError("--methods: expected at least one, got none")
    if "gap_closing" in methods:
        require_laptrack()


def _file_of(name: str, folder: Path, label: str) -> Path:
    """The motions of a method from elsewhere for a recording."""
    places = (folder / f"{label}.parquet", folder / label / "motions.parquet")
    found = next((place for place in places if place.is_file()), None)
    if found is None:
        raise InputError(f"--motions {name}: expected {places[0]} or {places[1]}, but there is neither")
    return found
