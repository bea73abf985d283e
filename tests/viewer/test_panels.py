"""What panels say: numbers of a motion, the change of scores, which settings do nothing, who is seen when."""

from pathlib import Path

import numpy as np
from known_motions import FRAMES, two_motions

from algorithm.settings import Settings, preset_settings
from evaluation.completion import CentreErrors
from evaluation.report.definitions import meaning_of
from recording.palette import COLOURS, rgb
from viewer.answer import Answer, Judgement, Match
from viewer.panels.catalogue import PANELS
from viewer.panels.motion import numbers_of
from viewer.panels.solving import DIALS, idle, scores_table
from viewer.panels.time import time_strip

MOTIONS = two_motions()


def judgement(**scores: dict[str, float | None]) -> Judgement:
    hidden = CentreErrors(hidden_frames=np.array([2, 2]), error_m=np.array([0.1, 0.2]))
    return Judgement(
        scores=scores,
        error_m=np.full(len(MOTIONS), np.nan, np.float32),
        matches={1: Match(name="walker", f=0.98, hidden=hidden)},
    )


def test_a_motions_numbers_come_with_its_links() -> None:
    text = numbers_of(Answer(motions=MOTIONS), 1, 10.0)
    for line in (
        "| segments | 1, 2 |",
        "| points observed | 4 |",
        "| completed, inter | 2 |",
        "| frames | 0 to 5 |",
        "| of them completed | 2 |",
        "| way | 5.0 m (10.00 m/s) |",
        "| **1** \u2192 **2** | 0.90 | made |",
        "| 0 \u2192 **2** | 0.20 | not made |",
    ):
        assert line in text
    assert "centre" not in text


def test_with_truth_they_come_with_its_object_and_errors() -> None:
    text = numbers_of(Answer(motions=MOTIONS, judgement=judgement()), 1, 10.0)
    assert "| object | walker (F 0.98) |" in text
    assert "| centre while hidden | mean 15.0 cm, largest 20.0 cm |" in text


def test_a_motion_without_links_says_so() -> None:
    assert "No candidate links." in numbers_of(Answer(motions=MOTIONS.rows(MOTIONS.motion != 1)), 3, 10.0)


def test_scores_stand_side_by_side_with_their_change_and_unit() -> None:
    before = Answer(
        motions=MOTIONS, judgement=judgement(motions={"found": 2}, completion={"mean_m": 0.2, "recall": None})
    )
    after = Answer(
        motions=MOTIONS, judgement=judgement(motions={"found": 2}, completion={"mean_m": 0.15, "recall": 0.5})
    )
    table = scores_table(before, after)
    name = {key: meaning_of(key).name for key in ("motions.found", "completion.mean_m", "completion.recall")}
    assert f"| {name['motions.found']} | 2 | 2 |  |" in table
    assert f"| {name['completion.mean_m']} | 20.0 cm | 15.0 cm | **-5.0 cm** |" in table
    assert f"| {name['completion.recall']} | - | 0.500 |  |" in table


def test_without_truth_there_is_no_table_of_scores() -> None:
    assert scores_table(Answer(motions=MOTIONS), Answer(motions=MOTIONS)) == scores_table(None, None) == ""


def test_settings_that_do_nothing_are_told_with_the_reason() -> None:
    assert set(idle(Settings())) == {"eps3", "eps5", "eps6"}
    assert idle(preset_settings("paper")) == {}


def test_every_epsilon_has_a_dial_that_reaches_the_presets_values() -> None:
    assert list(DIALS) == [name for name in sorted(Settings.model_fields) if name.startswith("eps")]
    for preset in ("default", "paper"):
        settings = preset_settings(preset)
        assert all(dial.low <= getattr(settings, name) <= dial.high for name, dial in DIALS.items())


def test_the_strip_shows_who_is_seen_completed_and_absent() -> None:
    strip = time_strip(MOTIONS.representatives, FRAMES + 1, FRAMES)
    middles = ((np.arange(FRAMES + 1) + 0.5) * strip.shape[1] / (FRAMES + 1)).astype(int)
    first, second = strip[3, middles], strip[strip.shape[0] // 2, middles]
    np.testing.assert_array_equal(first[:6], np.tile(rgb(COLOURS[0]), (6, 1)))
    np.testing.assert_array_equal(second[0], rgb(COLOURS[1]))
    assert rgb(COLOURS[1]).sum() < second[2].astype(int).sum() < 3 * 255
    np.testing.assert_array_equal(first[6], [0, 0, 0])  # The cursor, where nobody is.


def test_without_motions_the_strip_has_the_cursor_alone() -> None:
    strip = time_strip((), 3, 0)
    assert set(np.unique(strip)) == {0, 255}


def test_every_panel_has_a_file_of_its_own() -> None:
    files = {panel.__module__.rpartition(".")[2] for panel in PANELS.values()}
    assert len(files) == len(PANELS)
    folder = Path(__file__).parents[2] / "viewer" / "panels"
    assert all((folder / f"{name}.py").is_file() for name in files)
