"""The search for settings goes on from its file, and says what is best."""

import tomllib
from pathlib import Path
from typing import Any

import pytest

from algorithm.settings import Settings, settings_from_file
from evaluation.sweeps.plan import Sweep
from evaluation.sweeps.tune import STUDY, Attempt, tuned
from evaluation.sweeps.tune_report import tuning_text, write_tuning
from recording.cache import Cache
from recording.cluster import Client
from recording.errors import InputError


def sweep_of(small: Path, **changes: Any) -> Sweep:
    axes = {
        "eps6": {"from": 0.05, "to": 0.5, "scale": "logarithmic"},
        "neighbours": {"from": 4, "to": 16},
        "flow": ["dis", "farneback"],
    }
    document = {"name": "search", "recordings": [str(small)], "axes": axes, "settings": {"chaining": "between_pixels"}}
    return Sweep.model_validate(document | changes | {"design": "random"})


def test_a_study_begins_with_the_preset_and_goes_on_to_as_many_trials(
    small: Path, client: Client, tmp_path: Path
) -> None:
    cache = Cache(folder=tmp_path / "cache")
    first = tuned(sweep_of(small), tmp_path / "out", client, trials=3, at_once=2, cache=cache)
    assert sorted(one.number for one in first) == [0, 1, 2]
    preset = next(one for one in first if one.number == 0)
    assert preset.values == {"eps6": Settings().eps6, "neighbours": Settings().neighbours, "flow": "dis"}
    more = tuned(sweep_of(small), tmp_path / "out", client, trials=5, at_once=2, cache=cache)
    reached = {one.number: (one.values, one.error, one.seconds) for one in more}
    assert all(reached[one.number] == (one.values, one.error, one.seconds) for one in first)
    assert len(more) == 5
    assert [one.error for one in more] == sorted(one.error for one in more)
    assert all(0 <= one.error <= 1 and one.seconds > 0 for one in more)
    with pytest.raises(InputError, match=rf"{STUDY}: expected a study of the same axes"):
        tuned(sweep_of(small, settings={"eps2": 0.2}), tmp_path / "out", client, trials=6, cache=cache)


def test_reporting_seeds_are_refused(client: Client, tmp_path: Path) -> None:
    sweep = Sweep.model_validate({"name": "search", "scenes": ["wall"], "seeds": [1001], "axes": {"eps6": [0.1]}})
    with pytest.raises(InputError, match="expected development seeds, below 1000"):
        tuned(sweep, tmp_path, client, trials=1)


def test_what_was_found_is_a_settings_file_a_table_and_a_picture(small: Path, tmp_path: Path) -> None:
    sweep = sweep_of(small)
    attempts = [
        Attempt(number=1, values={"eps6": 0.2, "neighbours": 8, "flow": "dis"}, error=0.1, seconds=2.0, front=True),
        Attempt(number=0, values={"eps6": 0.15, "neighbours": 12, "flow": "dis"}, error=0.2, seconds=3.0, front=False),
    ]
    write_tuning(sweep, attempts, tmp_path)
    assert {path.name for path in tmp_path.iterdir()} == {"trials.json", "best.toml", "front.png", "front.svg"}
    best = settings_from_file(Settings(), tmp_path / "best.toml")
    assert (best.eps6, best.neighbours, best.flow) == (0.2, 8, "dis")
    assert tomllib.loads((tmp_path / "best.toml").read_text())["chaining"] == "between_pixels"
    assert "search: 2 trials" in tuning_text(sweep, attempts)
