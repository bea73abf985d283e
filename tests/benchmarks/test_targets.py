"""The table of what has to hold: means over recordings, held against the targets."""

from typing import Any

import pytest

from benchmarks.calibrations import calibration_rows
from benchmarks.targets import COLUMNS, FOUND, SCENES, TARGETS, judged, printed, scene_means, tracker_factors
from evaluation.outcome import MadeOf, Outcome

MADE_OF = MadeOf(recording_digest="0", settings={}, version="0", code="0")


def outcome(scene: str = "wall", method: str = "default", *, found: int = 2, centre_m: float | None = 0.05) -> Outcome:
    tenth = {"begin": 0.9, "end": 1.0, "count": 60, "holding": 54, "share": 0.9}
    scores: dict[str, Any] = {
        "objects": 2,
        "coverage": 0.8,
        "motions": {"count": 3, "found": found, "purity": 0.99, "inverse_purity": 0.98},
        "identity": {"idf1": 0.5},
        "completion": {
            "centre_mean_m": centre_m,
            "centre_max_m": 0.2,
            "mean_m": 0.1,
            "recall": 1.0,
            "surface_coverage_10cm": 0.7,
        },
        "calibration": {"links": [tenth], "completed": []},
    }
    return Outcome(recording="r", name=scene, seed=1, sensor="ideal", method=method, made_of=MADE_OF, scores=scores)


def failed() -> Outcome:
    return outcome().model_copy(update={"scores": None, "failure": "ValueError: no"})


def test_a_number_is_the_mean_over_the_recordings_that_have_it() -> None:
    rows = scene_means([outcome(centre_m=0.05), outcome(centre_m=0.15, found=1), outcome(centre_m=None), failed()])
    assert rows["wall"]["recordings"] == 4
    assert rows["wall"][FOUND] == 0.5
    assert rows["wall"]["centre cm"] == pytest.approx(10)
    assert rows["wall"]["too many"] == 1
    assert scene_means([failed()])["wall"]["purity"] is None


def test_what_is_missed_is_named_and_printed_with_its_target() -> None:
    row = judged("wall", scene_means([outcome(), outcome(found=1)])["wall"], TARGETS["wall"])
    assert row["missed"] == [FOUND, "IDF1"]
    cells = printed(row)
    assert cells["IDF1"] == "0.500 (< 0.97)"
    assert cells[FOUND] == "1 of 2 (< 1)"
    assert cells["max cm"] == "20.0"  # As much as is allowed.
    assert cells["met"] == "9 of 11"


def test_what_cannot_be_computed_misses_its_target() -> None:
    row = judged("wall", scene_means([failed()])["wall"], TARGETS["wall"])
    assert row["missed"] == list(TARGETS["wall"])
    assert printed(row)["purity"] == "- (< 0.99)"


def test_of_a_scene_without_targets_nothing_is_asked() -> None:
    row = judged("stop", scene_means([outcome("stop")])["stop"], None)
    assert row["missed"] == []
    assert printed(row)["met"] == "-"


def test_every_scene_of_the_table_has_targets_of_known_columns() -> None:
    assert set(TARGETS) == set(SCENES)
    assert all(set(targets) <= {FOUND, *COLUMNS} for targets in TARGETS.values())
    assert TARGETS["juggler3"].keys() == TARGETS["wall"].keys() - {"points cm"}


def test_the_trackers_factor_is_the_mean_over_scenes() -> None:
    def means(method: str, *errors_m: float) -> dict[str, Any]:
        return scene_means(
            [outcome(scene, method, centre_m=e) for scene, e in zip(("wall", "house"), errors_m, strict=True)]
        )

    rows = tracker_factors({"default": means("default", 0.05, 0.1), "tracker": means("tracker", 0.2, 0.1)})
    assert [row["factor"] for row in rows] == pytest.approx([4, 1, 2.5])
    assert rows[-1]["scene"] == "mean"


def test_calibrations_are_pooled_over_recordings() -> None:
    *tenths, miss, sure = calibration_rows([outcome(), outcome(), failed()])
    assert [row["links"] for row in tenths] == [0] * 9 + [120]
    assert tenths[-1]["links hold"] == 0.9
    assert miss["links hold"] == pytest.approx(0.05)
    assert (sure["links hold"], sure["points hold"]) == (1, None)
