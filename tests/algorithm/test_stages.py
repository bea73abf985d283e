"""Stages: each result is a function of what its key says, and a result from the cache is the same to the last bit."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from unittest.mock import patch

import numpy as np
import pytest
from worlds import ball_behind_another

from algorithm import pipeline, staged
from algorithm.flow_parts import FlowParts
from algorithm.given import Given
from algorithm.settings import Settings, preset_settings
from algorithm.staged import Course, solve
from algorithm.stages import FIRST_FIELD, MODULES, STAGES, fields_of, keys_of, readable, stage_of
from recording.cache import Cache
from recording.code import imported_modules
from recording.motions import COLUMNS, Motions
from recording.recording import Recording

SHARED = {"algorithm.given", "algorithm.settings", "algorithm.stopwatch"}
"""What all stages know."""


@pytest.fixture(scope="module")
def recording() -> Recording:
    return ball_behind_another()


@pytest.fixture
def calls() -> Iterator[dict[str, int]]:
    """How often each stage was made."""
    made = dict.fromkeys(("flowing", "observed", "grouped"), 0)

    def counting(name: str, owner: type, method: str) -> object:
        original = getattr(owner, method)

        def counted(*arguments: object) -> object:
            made[name] += 1
            return original(*arguments)

        return patch.object(owner, method, counted)

    flowing = counting("flowing", FlowParts, "_made")
    with flowing, counting("observed", Course, "_made_observed"), counting("grouped", Course, "_made_grouped"):
        yield made


def assert_same(one: Motions, other: Motions) -> None:
    for name in COLUMNS:
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name))
    assert one.links == other.links
    assert len(one.representatives) == len(other.representatives)
    for first, second in zip(one.representatives, other.representatives, strict=True):
        np.testing.assert_array_equal(first.position, second.position)


def test_every_setting_belongs_to_exactly_one_stage() -> None:
    everything = [name for stage in STAGES for name in fields_of(stage)]
    assert sorted(everything) == sorted(set(Settings.model_fields) - {"preset"})
    assert [stage_of(FIRST_FIELD[stage]) for stage in STAGES] == list(STAGES)


def test_a_stage_cannot_read_what_belongs_to_a_later_one() -> None:
    settings = Settings(eps1=1.25)
    assert readable(settings, "trajectories").eps1 == 1.25
    with pytest.raises(AttributeError, match="the setting 'eps1' belongs to the stage 'trajectories'"):
        _ = readable(settings, "flow").eps1


def test_every_module_of_the_pipeline_belongs_to_a_stage() -> None:
    """What a stage is made by is part of its key: whoever adds a module to the pipeline says to which stage."""
    used = {name for name in imported_modules("algorithm.pipeline") if name.startswith("algorithm.")}
    assert used <= SHARED.union(*MODULES.values())


@pytest.mark.parametrize(
    ("changes", "first"),
    [
        ({"static_tolerance_m": 0.04}, "flow"),
        ({"eps1": 1.0}, "trajectories"),
        ({"clustering": "spectral"}, "segments"),
        ({"eps6": 0.2}, "motions"),
        ({"preset": "paper"}, None),
    ],
)
def test_a_setting_changes_the_keys_of_its_stage_and_of_all_later_ones(
    changes: dict[str, object], first: str | None
) -> None:
    before, after = (keys_of("digest", settings) for settings in (Settings(), Settings(**changes)))
    changed = [stage for stage in STAGES if before[stage] != after[stage]]
    assert changed == ([] if first is None else list(STAGES[STAGES.index(first) :]))


def test_another_recording_has_other_keys() -> None:
    one, other = (keys_of(digest, Settings()) for digest in ("one", "other"))
    assert not set(one.values()) & set(other.values())


@pytest.mark.parametrize("preset", ["default", "paper"])
def test_in_stages_or_at_once_and_from_the_cache_the_result_is_the_same(
    preset: str, recording: Recording, tmp_path: Path
) -> None:
    """Also: in both presets no stage reads a setting of a later one."""
    settings, cache = preset_settings(preset), Cache(folder=tmp_path)
    plain = pipeline.solve(recording, settings)
    assert len(plain) > 100
    for _ in range(2):
        assert_same(solve(recording, settings, cache=cache), plain)


def test_a_change_makes_again_only_what_depends_on_it(
    recording: Recording, tmp_path: Path, calls: dict[str, int]
) -> None:
    cache = Cache(folder=tmp_path)
    for changes in ({}, {}, {"eps6": 0.2}, {"clustering": "graph_merging"}, {"eps2": 0.05}, {"flow": "dis"}):
        solve(recording, Settings(**changes), cache=cache)
    assert calls == {"flowing": 2, "observed": 3, "grouped": 4}


def test_seconds_are_those_of_the_making_cached_or_not(recording: Recording, tmp_path: Path) -> None:
    cache = Cache(folder=tmp_path)
    first, again = (solve(recording, cache=cache).making.seconds for _ in range(2))
    assert first["flow"] == again["flow"] > 0
    assert again["total"] >= again["flow"]


def test_damaged_results_are_made_again(recording: Recording, tmp_path: Path) -> None:
    cache = Cache(folder=tmp_path)
    plain = solve(recording, cache=cache)
    for path in tmp_path.rglob("*-*"):
        path.write_bytes(path.read_bytes()[:-20])
    assert_same(solve(recording, cache=cache), plain)


def test_what_is_given_is_not_kept_and_nothing_kept_takes_its_place(
    recording: Recording, tmp_path: Path, calls: dict[str, int]
) -> None:
    cache = Cache(folder=tmp_path)
    solve(recording, cache=cache)
    alone = Given(segments=lambda trajectories: np.zeros(trajectories.count, int))
    motions = solve(recording, given=alone, cache=cache)
    assert set(motions.segment) == {0}
    assert calls == {"flowing": 1, "observed": 1, "grouped": 2}
    solve(recording, cache=cache)
    assert calls["grouped"] == 2


def test_a_recording_that_is_another_by_its_depths_shares_nothing(
    recording: Recording, tmp_path: Path, calls: dict[str, int]
) -> None:
    cache = Cache(folder=tmp_path)
    shifted = replace(
        recording, frames=tuple(replace(frame, depth=frame.depth + np.float32(0.1)) for frame in recording.frames)
    )
    for one in (recording, shifted):
        solve(one, cache=cache)
    assert calls == {"flowing": 2, "observed": 2, "grouped": 2}
    assert staged.keys_of(recording.digest(), Settings()) != staged.keys_of(shifted.digest(), Settings())
