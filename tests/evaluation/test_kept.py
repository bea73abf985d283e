"""Recordings and motions kept in a folder: used again while they hold, made again when they do not."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from evaluation.kept import Kept
from evaluation.methods import settings_of
from recording.errors import InputError
from recording.motions import Making, Motions
from recording.parquet import load_motions, save_motions


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a small house, solved."""
    kept = small(tmp_path_factory.mktemp("kept"))
    assert kept.solve_all([("house", "default")]) == {}
    return kept.folder


def small(folder: Path, **changes: object) -> Kept:
    return replace(Kept(folder=folder, size="64x48", frames=8), **changes)


def made_otherwise(motions: Motions, **changes: object) -> Motions:
    return replace(motions, making=replace(motions.making, **changes))


def test_what_is_there_is_used_again(folder: Path) -> None:
    files = [folder / "house" / "recording.json", small(folder).motions_path("house", "default")]
    before = [path.stat().st_mtime_ns for path in files]
    small(folder).motions("house", "default")
    assert [path.stat().st_mtime_ns for path in files] == before


@pytest.mark.parametrize(
    "change",
    [{"recording_digest": "0" * 64}, {"version": "0.0.0"}, {"settings": {"preset": "default"}}],
    ids=lambda change: next(iter(change)),
)
def test_motions_of_another_recording_version_or_settings_are_made_again(
    change: dict[str, object], folder: Path
) -> None:
    kept = small(folder)
    place = kept.motions_path("house", "default")
    good = load_motions(place)
    save_motions(made_otherwise(good, **change), place, overwrite=True)
    found = kept.motions("house", "default")
    assert isinstance(found.making, Making)
    assert found.making.recording_digest == good.making.recording_digest
    assert found.making.version == good.making.version
    assert found.making.settings == settings_of(kept.recording("house"), "default").model_dump()
    np.testing.assert_array_equal(found.position, good.position)


def test_motions_of_other_code_are_made_again(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    place = small(folder).motions_path("house", "default")
    before = place.stat().st_mtime_ns
    monkeypatch.setattr("evaluation.kept.code_digest", lambda: "other code")
    small(folder).motions("house", "default")
    after = place.stat().st_mtime_ns
    assert after > before
    small(folder).motions("house", "default")
    assert place.stat().st_mtime_ns == after
    monkeypatch.undo()
    small(folder).motions("house", "default")
    assert place.stat().st_mtime_ns > after


def test_a_recording_of_another_size_is_refused_and_replaced_only_when_asked_for(folder: Path, tmp_path: Path) -> None:
    kept = small(tmp_path)
    kept.recording("house")
    with pytest.raises(InputError, match="another size, length or scene: choose another folder, or pass --overwrite"):
        small(tmp_path, size="32x24").recording("house")
    assert small(tmp_path, size="32x24", overwrite=True).recording("house").metadata.width == 32


def test_the_paper_preset_takes_the_scenes_epsilons(folder: Path) -> None:
    recording = small(folder).recording("house")
    assert settings_of(recording, "paper").eps5 == 10
    assert settings_of(recording, "default").preset == "default"


def test_what_fails_is_told_and_the_others_go_on(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(*_: object) -> Motions:
        raise ArithmeticError("no convergence")

    monkeypatch.setattr("evaluation.kept.solve", broken)
    failures = small(folder).solve_all([("house", "paper"), ("house", "default")])
    assert failures == {("house", "paper"): "ArithmeticError: no convergence"}
