"""Methods side by side: intervals, groups, resuming, failures, methods from elsewhere, refusals."""

import csv
import json
import os
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from known import crossing, empty, masks_only, perfect
from scipy import stats

from evaluation import outcome as outcome_module
from evaluation.compare import compared, labelled
from evaluation.compare_tables import comparison_document, comparison_text, intervals_of, write_comparison
from evaluation.hidden_time import spans_of
from evaluation.interval import mean_interval
from evaluation.methods import METHODS, Method
from evaluation.outcome import Outcome
from evaluation.scores import evaluate
from recording.errors import InputError
from recording.motions import Making
from recording.parquet import load_motions, save_motions
from recording.recording import Recording
from recording.store import save_recording


@pytest.fixture(scope="module")
def recordings(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two recordings: `a/crossing` with a wall and `b/crossing` with a few lost returns."""
    folder = tmp_path_factory.mktemp("recordings")
    save_recording(crossing(), folder / "a" / "crossing")
    save_recording(crossing(lost=0.05), folder / "b" / "crossing")
    return folder


@pytest.fixture(scope="module")
def places(recordings: Path) -> list[Path]:
    return [recordings / "a" / "crossing", recordings / "b" / "crossing"]


@pytest.fixture
def answers(recordings: Path, tmp_path: Path) -> Path:
    """What somebody else's method wrote: files, and nothing but the rows."""
    for name, recording in (("a", crossing()), ("b", crossing(lost=0.05))):
        motions = replace(perfect(recording), representatives=(), links=(), making=Making())
        save_motions(motions, tmp_path / "answers" / name / "crossing" / "motions.parquet")
    return tmp_path / "answers"


def test_the_interval_is_students() -> None:
    values = [0.2, 0.5, 0.9, None, 0.4]
    found = mean_interval(values)
    assert found is not None
    low, high = stats.t.interval(0.95, 3, loc=0.5, scale=stats.sem([0.2, 0.5, 0.9, 0.4]))
    assert (found.mean, found.count) == (pytest.approx(0.5), 4)
    assert found.half_width == pytest.approx((high - low) / 2)


def test_one_value_has_no_interval_and_none_no_mean() -> None:
    found = mean_interval([0.7])
    assert found is not None
    assert (found.mean, found.half_width) == (0.7, None)
    assert mean_interval([None, None]) is None


def test_the_interval_holds_the_true_mean_in_95_of_100_cases() -> None:
    generator = np.random.default_rng(5)
    draws = generator.normal(3.0, 2.0, (2000, 6))
    found = [mean_interval(list(draw)) for draw in draws]
    held = np.mean([abs(one.mean - 3.0) <= one.half_width for one in found])
    assert held == pytest.approx(0.95, abs=0.015)


def test_methods_from_elsewhere_are_scored_like_any(places: list[Path], answers: Path, tmp_path: Path) -> None:
    outcomes = compared(places, tmp_path / "out", methods=["tracker"], elsewhere={"perfect": answers})
    assert [(one.recording, one.method) for one in outcomes] == [
        ("a/crossing", "tracker"),
        ("a/crossing", "perfect"),
        ("b/crossing", "tracker"),
        ("b/crossing", "perfect"),
    ]
    direct = evaluate(crossing(), load_motions(answers / "a" / "crossing" / "motions.parquet"))
    assert outcomes[1].scores == json.loads(json.dumps(direct))
    assert outcomes[1].scores["motions"]["found"] == 2
    perfect_span = next(span for span in spans_of(outcomes) if span.method == "perfect")
    assert perfect_span.recall.mean == 1
    assert perfect_span.points_m.mean < 1e-5
    assert perfect_span.centre_m.mean < 1e-5


def test_the_same_call_again_makes_nothing_again(
    places: list[Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    first = compared(places, tmp_path, methods=["tracker"])
    calls = counted_calls(monkeypatch)
    assert compared(places, tmp_path, methods=["tracker"]) == first
    assert calls == []
    compared(places, tmp_path, methods=["tracker"], overwrite=True)
    assert len(calls) == 2


def test_what_has_changed_is_made_again(places: list[Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    compared(places[:1], tmp_path, methods=["tracker"])
    calls = counted_calls(monkeypatch)
    monkeypatch.setattr(outcome_module, "code_digest", lambda: "other code")
    compared(places[:1], tmp_path, methods=["tracker"])
    assert len(calls) == 1
    monkeypatch.setattr(outcome_module, "VERSION", "0.0.1")
    compared(places[:1], tmp_path, methods=["tracker"])
    assert len(calls) == 2
    (kept,) = tmp_path.glob("*/tracker/outcome.json")
    kept.write_text(kept.read_text(encoding="utf-8")[:100], encoding="utf-8")
    compared(places[:1], tmp_path, methods=["tracker"])
    assert len(calls) == 3


def counted_calls(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The calls of the tracker from now on."""
    calls: list[str] = []
    real = METHODS["tracker"]

    def solver(recording, settings):
        calls.append("tracker")
        return real.solver(recording, settings)

    changed = {**METHODS, "tracker": replace(real, solver=solver)}
    monkeypatch.setattr(outcome_module, "METHODS", changed)
    return calls


def test_a_method_that_fails_is_told_and_does_not_stop_the_rest(tmp_path: Path) -> None:
    save_recording(masks_only(crossing()), tmp_path / "masks")
    outcomes = compared([tmp_path / "masks"], tmp_path / "out", methods=["tracker", "true_flow", "true_segments"])
    assert [one.failure is None for one in outcomes] == [True, False, False]
    text = comparison_text(outcomes)
    assert "true_flow failed on masks: InputError: " in text
    assert counts_in(text) == {"tracker": ["1"], "true_flow (1 failed)": ["0"], "true_segments (1 failed)": ["0"]}
    document = comparison_document(outcomes)
    assert [entry["method"] for entry in document["failures"]] == ["true_flow", "true_segments"]
    write_comparison(outcomes, tmp_path / "out")


def test_a_mean_over_fewer_recordings_says_so(places: list[Path], tmp_path: Path) -> None:
    first, second = compared(places, tmp_path, methods=["tracker"])
    broken = [one.model_copy(update={"method": "mine"}) for one in (first, second)]
    broken[1] = broken[1].model_copy(update={"scores": None, "by_length": (), "failure": "ValueError: too few"})
    assert counts_in(comparison_text([first, second, *broken])) == {"tracker": ["2"], "mine (1 failed)": ["1"]}


def counts_in(text: str) -> dict[str, list[str]]:
    """The column `n` of the first table, by the row's first column."""
    rows = [re.split(r" {2,}", line.strip()) for line in text.split("\n\n")[1].splitlines()]
    assert rows[0][:2] == ["method", "n"]
    return {row[0]: row[1:2] for row in rows[1:]}


def test_several_processes_say_the_same_as_one(places: list[Path], tmp_path: Path) -> None:
    one = compared(places, tmp_path / "one", methods=["tracker"])
    two = compared(places, tmp_path / "two", methods=["tracker"], workers=2)
    for first, second in zip(one, two, strict=True):
        assert without_times(first) == without_times(second)


def without_times(outcome: Outcome) -> dict:
    document = outcome.model_dump()
    del document["scores"]["seconds"]
    return document


def test_everything_is_written_and_can_be_read(places: list[Path], tmp_path: Path) -> None:
    outcomes = compared(places, tmp_path, methods=["tracker", "gap_closing"])
    write_comparison(outcomes, tmp_path)
    write_comparison(outcomes, tmp_path)  # A later call replaces it.
    document = json.loads((tmp_path / "comparison.json").read_text(encoding="utf-8"))
    assert list(document["groups"]) == ["crossing"]
    assert document["groups"]["crossing"]["tracker"]["recordings"] == 2
    with (tmp_path / "comparison.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["method"] for row in rows] == ["tracker", "gap_closing"] * 2
    coverage = np.mean([float(row["coverage"]) for row in rows if row["method"] == "tracker"])
    assert document["groups"]["crossing"]["tracker"]["scores"]["coverage"]["mean"] == pytest.approx(coverage)
    assert "| tracker " in (tmp_path / "comparison.md").read_text(encoding="utf-8")
    assert (tmp_path / "hidden_time.png").read_bytes().startswith(b"\x89PNG")
    assert "<svg" in (tmp_path / "hidden_time.svg").read_text(encoding="utf-8")


def test_intervals_are_over_the_recordings_of_a_group(places: list[Path], tmp_path: Path) -> None:
    outcomes = compared(places, tmp_path, methods=["tracker"])
    assert {one.group for one in outcomes} == {"crossing"}
    found = intervals_of(outcomes)["coverage"]
    assert found is not None
    assert found.count == 2
    assert found.half_width is not None
    assert all(span.recall.half_width is not None for span in spans_of(outcomes) if span.recall.count > 1)
    renamed = outcomes[1].model_copy(update={"name": "crowded-000123"})
    assert list(comparison_document([outcomes[0], renamed])["groups"]) == ["crossing", "crowded", "all recordings"]


def test_recordings_of_several_kinds_have_means_without_intervals(places: list[Path], tmp_path: Path) -> None:
    first, second = compared(places, tmp_path, methods=["tracker"])
    mixed = [first, second.model_copy(update={"name": "crowded-1"})]
    found = intervals_of(mixed)["coverage"]
    assert found is not None
    assert (found.count, found.half_width) == (2, None)
    assert all(span.recall.half_width is None for span in spans_of(mixed))
    assert "±" in comparison_text([first, second])
    assert "±" not in comparison_text(mixed)


def test_another_sensor_makes_another_group(tmp_path: Path) -> None:
    recording = crossing()
    for sensor in (None, "ideal", "tof"):
        stated = {"name": "crowded-1000", "sensor": {"preset": sensor} if sensor else None}
        seen = replace(recording, metadata=recording.metadata.model_copy(update=stated))
        save_recording(seen, tmp_path / f"{sensor}")
    places = [tmp_path / name for name in ("None", "ideal", "tof")]
    outcomes = compared(places, tmp_path / "out", methods=["tracker"])
    assert [one.group for one in outcomes] == ["crowded", "crowded", "crowded/tof"]


def test_only_oracles_see_the_truth_and_paper_is_told_its_epsilons() -> None:
    recording = crossing()
    stated = recording.metadata.model_copy(update={"scene": {"paper": {"eps5": 7.0}}})
    recording = replace(recording, metadata=stated)
    assert [name for name, method in METHODS.items() if method.sees_truth] == [
        "true_flow",
        "true_segments",
        "true_links",
    ]
    for method in METHODS.values():
        calls: list[tuple[Recording, dict]] = []
        watched(method, calls).motions(recording)
        ((seen, settings),) = calls
        known = [seen.truth, seen.xray, seen.metadata.scene, seen.metadata.objects, seen.frames[0].labels]
        assert [fact is not None for fact in known] == [method.sees_truth] * len(known)
        assert settings == method.settings(recording)
        assert seen.digest() == recording.digest()
    assert METHODS["paper"].settings(recording)["eps5"] == 7


def watched(method: Method, calls: list[tuple[Recording, dict]]) -> Method:
    """The method, of which is written down what its solver is given; it finds nothing."""

    def solver(recording, settings):
        calls.append((recording, settings))
        return empty()

    return replace(method, solver=solver)


def test_recordings_are_told_apart_by_their_folders(places: list[Path]) -> None:
    assert list(labelled(places)) == ["a/crossing", "b/crossing"]
    assert list(labelled(places[:1])) == ["crossing"]


def test_methods_of_another_recording_are_refused(places: list[Path], answers: Path, tmp_path: Path) -> None:
    save_motions(perfect(crossing(lost=0.05)), answers / "crossing.parquet")
    with pytest.raises(InputError, match="expected motions of this recording"):
        compared(places[:1], tmp_path / "out", methods=[], elsewhere={"mine": answers})


def test_damaged_motions_are_refused(places: list[Path], answers: Path, tmp_path: Path) -> None:
    (answers / "crossing.parquet").write_bytes(b"PAR1 and no more")
    with pytest.raises(InputError, match="cannot be read") as raised:
        compared(places[:1], tmp_path / "out", methods=[], elsewhere={"mine": answers})
    assert "\n" not in str(raised.value)
    assert not list((tmp_path / "out").rglob("outcome.json"))


WRONG = {
    "no recordings": ({"recordings": []}, "at least one recording"),
    "no recording": ({"recordings": [Path("nowhere")]}, "nowhere: expected a recording or a data set"),
    "one twice": ({"recordings": ["a/crossing", "a/crossing"]}, "every recording once"),
    "unknown method": ({"methods": ["trackr"]}, "unknown method 'trackr', did you mean 'tracker'"),
    "one method twice": ({"methods": ["tracker", "default", "tracker"]}, "every method once, got 'tracker'"),
    "no method": ({"methods": []}, "at least one, got none"),
    "our name": ({"elsewhere": {"tracker": Path("answers")}}, "'tracker' is one of our methods"),
    "no file": ({"elsewhere": {"mine": Path("answers")}}, "--motions mine: expected"),
    "no worker": ({"workers": 0}, "at least one worker"),
}


@pytest.mark.parametrize("what", WRONG)
def test_wrong_input_is_refused_in_one_line(what: str, recordings: Path, tmp_path: Path) -> None:
    changed, sentence = WRONG[what]
    given = {"recordings": ["a/crossing"], "methods": ["tracker"]} | changed
    wanted = [recordings / place for place in given.pop("recordings")]
    with pytest.raises(InputError, match=sentence) as raised:
        compared(wanted, tmp_path / "out", **given)
    assert "\n" not in str(raised.value)
    assert not os.listdir(tmp_path)
